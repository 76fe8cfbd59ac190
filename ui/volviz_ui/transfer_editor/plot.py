"""The plot in use: everything that mouse and keyboard do in it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, QPointF, Qt, Signal
from PySide6.QtGui import (
    QContextMenuEvent,
    QFocusEvent,
    QHideEvent,
    QKeyEvent,
    QMouseEvent,
    QNativeGestureEvent,
    QWheelEvent,
)

from volviz_ui.transfer_editor.editable_plot import EditablePlot
from volviz_ui.transfer_editor.gestures import (
    Gesture,
    MoveColorPoint,
    MoveMarker,
    MovePoints,
    Pan,
    RubberBand,
    ShiftStretch,
)
from volviz_ui.transfer_editor.items import Hit
from volviz_ui.transfer_editor.keys import HELD, is_ours, press_key

if TYPE_CHECKING:
    from PySide6.QtWidgets import QWidget

    from volviz_ui.transfer_editor.histogram_worker import HistogramWorker
    from volviz_ui.transfer_editor.model import EditorModel

#: Factor of one notch of the wheel.
NOTCH = 1.25


class TransferPlot(EditablePlot):
    """The interactive plot.

    Parameters
    ----------
    model : EditorModel
        What is shown and edited.
    counter : HistogramWorker
        Source of the histogram.
    parent : QWidget
        Owner.
    """

    menu_requested = Signal(QPointF)
    hovered = Signal(object)
    """Value under the pointer, None when it has left."""

    def __init__(self, model: EditorModel, counter: HistogramWorker, parent: QWidget) -> None:
        super().__init__(model, counter, parent)
        self._gesture: Gesture | None = None
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setToolTip(
            self.tr(
                "Double-click adds a point, drag moves it (Shift: along one axis), Del removes it.\n"
                "Wheel zooms, middle drag pans; drag the colour strip to shift and stretch everything."
            )
        )

    # ------------------------------------------------------------------ mouse

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take hold of what lies under the pointer."""
        self.setFocus(Qt.FocusReason.MouseFocusReason)
        if self._gesture is not None:
            return
        at = event.position()
        if event.button() == Qt.MouseButton.MiddleButton:
            self._gesture = Pan(self, at)
        elif event.button() == Qt.MouseButton.LeftButton:
            self._gesture = self._press(at, event.modifiers())
        if self._gesture is not None:
            event.accept()

    def _press(self, at: QPointF, modifiers: Qt.KeyboardModifier) -> Gesture | None:
        model = self.model
        if model.function is None:
            return None
        adding = bool(modifiers & Qt.KeyboardModifier.ControlModifier)
        hit = self._hit(at)
        if modifiers & Qt.KeyboardModifier.AltModifier and hit.part != "none":
            return ShiftStretch(self, at)
        if hit.part == "point":
            if adding:
                model.select(model.selection ^ {hit.index})
                return None
            if hit.index not in model.selection:
                model.select({hit.index})
            return MovePoints(self, at, hit.index)
        if hit.part == "stop":
            model.select_color_point(hit.index)
            return MoveColorPoint(self, at, hit.index)
        if hit.part == "marker":
            return MoveMarker(self, at, hit.index)
        if hit.part == "edge":
            self._show_edge(right=bool(hit.index))
            return None
        if hit.part == "ramp":
            return ShiftStretch(self, at)
        return RubberBand(self, at, adding=adding) if hit.part == "plot" else None

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag, or look what lies under the pointer."""
        self._pointer = event.position()
        if self._gesture is not None:
            restricted = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
            self._gesture.move(event.position(), restricted=restricted)
        else:
            self._look(event.position())
        self.update()

    def mouseReleaseEvent(self, _event: QMouseEvent) -> None:
        """The gesture is over."""
        gesture, self._gesture = self._gesture, None
        if gesture is not None:
            gesture.finish()
            self.update()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Add a point or a stop where there is none; choose a colour where there is one."""
        self._cancel_gesture()
        if event.button() != Qt.MouseButton.LeftButton or self.model.function is None:
            return
        at = event.position()
        hit = self._hit(at)
        if hit.part in ("point", "stop"):
            if hit.part == "point":
                self.model.select({hit.index})
            else:
                self.model.select_color_point(hit.index)
            self.color_requested.emit()
        elif hit.part == "ramp":
            self.add_color_point(self.places.value(at.x()))
        elif hit.part == "plot":
            self.add_point(at)

    def leaveEvent(self, _event: QEvent) -> None:
        """Nothing lies under the pointer any more."""
        self._pointer = None
        self._under = Hit("none")
        self.hovered.emit(None)
        self.update()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom about the pointer; with Shift, or sideways, pan."""
        delta = event.angleDelta()
        sideways = delta.x() if abs(delta.x()) > abs(delta.y()) else 0
        if event.modifiers() & Qt.KeyboardModifier.ShiftModifier and delta.y():
            sideways = delta.y()
        if sideways:
            self.set_axis(self.axis.panned(-sideways / 120.0 * 0.08))
        elif delta.y():
            plot = self.places.plot
            at = min(max((event.position().x() - plot.left()) / plot.width(), 0.0), 1.0)
            self.zoom(NOTCH ** (delta.y() / 120.0), at)
        event.accept()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Everything that can be done here."""
        if event.reason() == QContextMenuEvent.Reason.Mouse:
            at = QPointF(event.pos())
            hit = self._hit(at)
            if hit.part == "point" and hit.index not in self.model.selection:
                self.model.select({hit.index})
            elif hit.part == "stop":
                self.model.select_color_point(hit.index)
        else:
            at = self.places.plot.center()
        self.menu_requested.emit(at)

    # ------------------------------------------------------------------ keyboard

    def event(self, event: QEvent) -> bool:
        """Keys of the plot come before the window's shortcuts of the same keys."""
        if (
            event.type() == QEvent.Type.ShortcutOverride
            and isinstance(event, QKeyEvent)
            and is_ours(self, event)
        ):
            event.accept()
            return True
        if isinstance(event, QNativeGestureEvent) and self._pinched(event):
            return True
        return super().event(event)

    def _pinched(self, event: QNativeGestureEvent) -> bool:
        """Two fingers on a touchpad zoom as the wheel does."""
        if event.gestureType() != Qt.NativeGestureType.ZoomNativeGesture:
            return False
        plot = self.places.plot
        at = min(max((event.position().x() - plot.left()) / plot.width(), 0.0), 1.0)
        self.zoom(max(1.0 + event.value(), 0.1), at)
        return True

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Everything the mouse can do."""
        escapes = event.key() == Qt.Key.Key_Escape
        if not (self.escape() if escapes else press_key(self, event)):
            super().keyPressEvent(event)

    def keyReleaseEvent(self, event: QKeyEvent) -> None:
        """A key that was held down is let go: what it has done is one step."""
        if event.key() in HELD and not event.isAutoRepeat():
            self._let_go()
        super().keyReleaseEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """The release of a held key goes elsewhere."""
        self._let_go()
        super().focusOutEvent(event)

    def _let_go(self) -> None:
        """End what a held key has begun, and nothing that others have, as the colour dialog."""
        if self.key_is_held:
            self.key_is_held = False
            self.model.finish()

    def hideEvent(self, event: QHideEvent) -> None:
        """Nor does a plot that is not seen hear that the button is let go."""
        gesture, self._gesture = self._gesture, None
        if gesture is not None:
            gesture.finish()
        super().hideEvent(event)

    def escape(self) -> bool:
        """Cancel the gesture, or choose nothing; False when there was neither."""
        if self._gesture is not None:
            self._cancel_gesture()
            return True
        if self.model.in_gesture:
            self.model.cancel()
            return True
        if self.model.selection or self.model.color_point is not None or self.marker >= 0:
            self.marker = -1
            self.model.select(())
            self.update()
            return True
        return False

    def _hit(self, at: QPointF) -> Hit:
        return self.places.hit(
            at, self.model.function, self.model.channels[0], self.markers, self.model.selection
        )

    def _look(self, at: QPointF) -> None:
        self._under = self._hit(at)
        cursors = {
            "point": Qt.CursorShape.PointingHandCursor,
            "stop": Qt.CursorShape.SizeHorCursor,
            "marker": Qt.CursorShape.SizeHorCursor,
            "edge": Qt.CursorShape.PointingHandCursor,
            "ramp": Qt.CursorShape.SizeAllCursor,
            "plot": Qt.CursorShape.CrossCursor,
        }
        self.setCursor(cursors.get(self._under.part, Qt.CursorShape.ArrowCursor))
        inside = self.places.plot.left() <= at.x() <= self.places.plot.right()
        self.hovered.emit(self.places.value(at.x()) if inside else None)

    def _show_edge(self, *, right: bool) -> None:
        """Widen the window just so far that the points outside on one side are in it."""
        function = self.model.function
        if function is not None:
            low = self.axis.low if right else function.points[0].value
            high = function.points[-1].value if right else self.axis.high
            self.set_axis(self.axis.showing(low, high))

    def _cancel_gesture(self) -> None:
        gesture, self._gesture = self._gesture, None
        if gesture is not None:
            gesture.cancel()
            self.update()
