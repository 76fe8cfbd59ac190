"""The plot: curve over histogram, colour ramp below, everything that mouse and keyboard do there."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QContextMenuEvent,
    QFocusEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QNativeGestureEvent,
    QPainter,
    QPainterPath,
    QPaintEvent,
    QPalette,
    QPen,
    QPolygonF,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from volviz.model.transfer_lanes import with_stop, without_stop
from volviz_ui.theme import is_palette_change
from volviz_ui.transfer_editor import painting
from volviz_ui.transfer_editor.axes import OpacityAxis, ValueAxis, value_text
from volviz_ui.transfer_editor.gestures import (
    Gesture,
    MoveMarker,
    MovePoints,
    MoveStop,
    Pan,
    RubberBand,
    ShiftStretch,
)
from volviz_ui.transfer_editor.items import Hit, Places
from volviz_ui.transfer_editor.keys import handle_key, is_ours

if TYPE_CHECKING:
    from volviz_ui.transfer_editor.counting import Counter
    from volviz_ui.transfer_editor.model import EditorModel

#: Factor of one notch of the wheel.
NOTCH = 1.25
#: A double click this near to the curve adds a point on it, pixels.
ON_CURVE = 6.0


class TransferPlot(QWidget):
    """The interactive plot.

    Parameters
    ----------
    model : EditorModel
        What is shown and edited.
    counter : Counter
        Source of the histogram.
    parent : QWidget
        Owner.
    """

    axis_changed = Signal()
    color_wanted = Signal()
    fields_wanted = Signal()
    menu_wanted = Signal(QPointF)
    marker_moved = Signal(int, float)
    marker_released = Signal(int)
    hovered = Signal(object)
    """Value under the pointer, None when it has left."""

    def __init__(self, model: EditorModel, counter: Counter, parent: QWidget) -> None:
        super().__init__(parent)
        self.model = model
        self.counter = counter
        self.axis = ValueAxis.of_range(*model.data_range)
        self.opacities = OpacityAxis()
        self.log_counts = True
        self.band: QRectF | None = None
        self.markers: tuple[float, ...] = ()
        self.marker_colors: tuple[tuple[float, float, float], ...] = ()
        self._highlight: float | None = None
        self._gesture: Gesture | None = None
        self._under = Hit("none")
        self._pointer: QPointF | None = None
        self._histogram: QPainterPath | None = None
        self._curve: QPolygonF | None = None
        self._strip: QImage | None = None
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(240, 120)
        self.setAccessibleName(self.tr("Transfer function"))
        self.setAccessibleDescription(
            self.tr(
                "Opacity curve over the histogram. Page Up and Page Down choose a point, arrow keys move it."
            )
        )
        self.setToolTip(
            self.tr(
                "Double-click adds a point, drag moves it (Shift: along one axis), Del removes it.\n"
                "Wheel zooms, middle drag pans; drag the colour strip to shift and stretch everything."
            )
        )
        model.function_changed.connect(self._on_function_changed)
        model.selection_changed.connect(self._on_selection_changed)
        model.range_changed.connect(self._on_range_changed)
        counter.changed.connect(self._on_counted)

    def sizeHint(self) -> QSize:
        """Wide and low."""
        return QSize(900, 170)

    # ------------------------------------------------------------------ what is shown

    @property
    def places(self) -> Places:
        """Where everything lies now."""
        return Places(self.width(), self.height(), self.axis, self.opacities)

    def set_axis(self, axis: ValueAxis) -> None:
        """Show another window of values."""
        if axis != self.axis:
            self.axis = axis
            self._forget(histogram=True)
            self.axis_changed.emit()

    def set_log_counts(self, logarithmic: bool) -> None:
        """Heights of the histogram by the logarithm of the counts."""
        self.log_counts = logarithmic
        self._forget(histogram=True)

    def set_log_values(self, logarithmic: bool) -> None:
        """Spread the values logarithmically."""
        self.set_axis(self.axis.toggled(logarithmic))

    def set_fine_opacity(self, fine: bool) -> None:
        """Give small opacities room."""
        self.opacities = OpacityAxis(fine)
        self._forget()

    def set_markers(
        self, values: tuple[float, ...], colors: tuple[tuple[float, float, float], ...] = ()
    ) -> None:
        """Show isovalues; `marker_moved` tells when the user drags one."""
        if (values, colors) != (self.markers, self.marker_colors):
            self.markers, self.marker_colors = tuple(values), tuple(colors)
            self.update()

    def set_highlight(self, value: float | None) -> None:
        """Mark a value, or none."""
        if value != self._highlight:
            self._highlight = value
            self.update()

    def fit_data(self) -> None:
        """Show the range of the data."""
        self.set_axis(self.axis.with_points(self.axis.data_low, self.axis.data_high))

    def fit_function(self) -> None:
        """Show all points."""
        function = self.model.function
        if function is not None:
            self.set_axis(self.axis.showing(function.points[0].value, function.points[-1].value))

    def fit_percentiles(self, low: float = 0.5, high: float = 99.5) -> None:
        """Show the values between two percentiles of the voxels."""
        counts = self.counter.counts
        if counts is not None:
            self.set_axis(self.axis.showing(*counts.percentiles(low, high)))

    def zoom(self, factor: float, at: float = 0.5) -> None:
        """Narrow the window by a factor about a fraction of its width."""
        self.set_axis(self.axis.zoomed(factor, at))

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
            model.select_stop(hit.index)
            return MoveStop(self, at, hit.index)
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
                self.model.select_stop(hit.index)
            self.color_wanted.emit()
        elif hit.part == "ramp":
            self.add_stop(self.places.value(at.x()))
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
                self.model.select_stop(hit.index)
        else:
            at = self.places.plot.center()
        self.menu_wanted.emit(at)

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
        if not handle_key(self, event):
            super().keyPressEvent(event)

    def escape(self) -> bool:
        """Cancel the gesture, or choose nothing; False when there was neither."""
        if self._gesture is not None:
            self._cancel_gesture()
            return True
        if self.model.selection or self.model.stop is not None:
            self.model.select(())
            return True
        return False

    # ------------------------------------------------------------------ edits

    def add_point(self, at: QPointF) -> None:
        """Add a point at a pixel; on the curve when it is near."""
        function = self.model.function
        if function is None:
            return
        places = self.places
        value = places.value(at.x())
        red, green, blue, alpha = function.with_opacity(1.0).evaluate([value])[0].tolist()
        if abs(places.y(alpha) - at.y()) > ON_CURVE:
            alpha = places.opacity(at.y())
        function, index = function.with_point(value, (red, green, blue, alpha))
        self.model.apply(function, self.tr("Add point"), {index})

    def add_stop(self, value: float) -> None:
        """Add a stop to the colour ramp that leaves it as it looks."""
        colors, opacities = self.model.lanes
        colors, index = with_stop(colors, value)
        self.model.apply_lanes(colors, opacities, self.tr("Add colour"), index)

    def delete(self) -> None:
        """Remove the chosen points or the chosen stop."""
        stop = self.model.stop
        if stop is None:
            self.model.delete_selected()
            return
        colors, opacities = self.model.lanes
        self.model.select_stop(None)
        self.model.apply_lanes(without_stop(colors, stop), opacities, self.tr("Delete colour"))

    def duplicate(self) -> None:
        """Copy the chosen points a little to the right."""
        self.model.duplicate_selected(0.02 * (self.axis.high - self.axis.low))

    def select_neighbour(self, step: int, *, adding: bool = False) -> None:
        """Choose the next or previous point and bring it into view."""
        function = self.model.function
        if function is None:
            return
        chosen = sorted(self.model.selection)
        last = len(function.points) - 1
        if not chosen:
            index = 0 if step > 0 else last
        else:
            index = min(max((chosen[-1] if step > 0 else chosen[0]) + step, 0), last)
        self.model.select({*self.model.selection, index} if adding else {index})
        self.reveal(function.points[index].value)

    def reveal(self, value: float) -> None:
        """Pan so far that a value is visible."""
        if not self.places.is_visible(value):
            fraction = self.axis.fraction(value)
            self.set_axis(self.axis.panned(fraction - (0.1 if fraction < 0 else 0.9)))

    def shift_stretch(self, fraction: float, factor: float = 1.0, center: float | None = None) -> None:
        """Move all values by a fraction of the window and spread them; for keys and for other widgets."""
        function = self.model.function
        if function is None:
            return
        middle = (function.points[0].value + function.points[-1].value) / 2 if center is None else center
        offset = fraction * (self.axis.high - self.axis.low)
        self.model.apply(function.stretched(factor, middle).shifted(offset), self.tr("Shift and stretch"))

    # ------------------------------------------------------------------ painting

    def paintEvent(self, _event: QPaintEvent) -> None:
        """All layers; outline, curve and ramp are kept until something changes them."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        palette, places, function = self.palette(), self.places, self.model.function
        painting.paint_frame(painter, places, palette, self.model.unit, self.font())
        self._paint_histogram(painter, places, palette)
        if function is None:
            painter.setPen(palette.color(QPalette.ColorRole.PlaceholderText))
            painter.drawText(
                places.plot,
                Qt.AlignmentFlag.AlignCenter,
                self.tr("Open a volume to edit its colours and opacities"),
            )
            return
        if self._curve is None or self._strip is None:
            self._curve = painting.curve_polygon(places, function)
            columns = max(round(places.plot.width() * self.devicePixelRatioF()), 2)
            self._strip = painting.strip_image(places, function, columns)
        painting.paint_area(painter, places, self._curve, self._strip)
        if function.opacity < 1.0:
            thin = painting.curve_polygon(places, function, function.opacity)
            painting.paint_curve(painter, places, thin, palette, dashed=True)
        self._paint_border(painter, places, palette)
        painting.paint_curve(painter, places, self._curve, palette, dashed=False)
        if self._highlight is not None:
            painting.paint_highlight(painter, places, self._highlight, palette)
        painting.paint_markers(painter, places, self.markers, self.marker_colors, palette)
        under = self._under
        painting.paint_points(
            painter, places, function, self.model.selection, under.index if under.part == "point" else -1,
            palette, focused=self.hasFocus(),
        )  # fmt: skip
        painting.paint_ramp(
            painter, places, self._strip, self.model.lanes[0], self.model.stop,
            under.index if under.part == "stop" else -1, palette,
        )  # fmt: skip
        painting.paint_edges(painter, places, function, palette, self.font())
        if self.band is not None:
            accent = palette.color(QPalette.ColorRole.Highlight)
            painter.setPen(QPen(accent, 1.0))
            painter.setBrush(painting.with_alpha(accent, 0.15))
            painter.drawRect(self.band)
        painting.paint_note(painter, places, self.note(), palette, self.font())

    def note(self) -> str:
        """Words on what lies under the pointer: value, voxels, opacity."""
        function, pointer = self.model.function, self._pointer
        if function is None or pointer is None or not self.rect().contains(pointer.toPoint()):
            return ""
        value = self.places.value(pointer.x())
        if self._under.part == "point" and self._under.index < len(function.points):
            value = function.points[self._under.index].value
        words = [f"{value_text(value, self.axis.high - self.axis.low)} {self.model.unit}".strip()]
        counts = self.counter.counts
        if counts is not None:
            step = (self.axis.high - self.axis.low) / max(self.places.plot.width(), 1)
            voxels = counts.in_intervals(np.array([value - step / 2, value + step / 2]))[0]
            words.append(self.tr("%1 voxels").replace("%1", f"{round(voxels):,}".replace(",", "\u202f")))
        opacity = float(function.evaluate([value])[0, 3])
        words.append(self.tr("opacity %1").replace("%1", f"{opacity:.3g}"))
        return "  ·  ".join(words)

    def _paint_histogram(self, painter: QPainter, places: Places, palette: QPalette) -> None:
        counts = self.counter.counts
        if counts is None:
            return
        if self._histogram is None:
            self._histogram = painting.histogram_path(places, counts, self.log_counts)
        painter.save()
        painter.setClipRect(places.plot)
        painter.setPen(Qt.PenStyle.NoPen)
        quiet = palette.color(QPalette.ColorRole.PlaceholderText)
        painter.setBrush(painting.with_alpha(quiet, 0.34 if self.counter.is_done else 0.24))
        painter.drawPath(self._histogram)
        painter.restore()

    def _paint_border(self, painter: QPainter, places: Places, palette: QPalette) -> None:
        focused = self.hasFocus()
        color = palette.color(QPalette.ColorRole.Highlight if focused else QPalette.ColorRole.Mid)
        painter.setPen(QPen(color, 1.4 if focused else 1.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRoundedRect(places.plot, 3, 3)

    # ------------------------------------------------------------------ changes from outside

    def resizeEvent(self, _event: QResizeEvent) -> None:
        """Outlines fit the old size only."""
        self._forget(histogram=True)

    def changeEvent(self, event: QEvent) -> None:
        """Another palette or font is drawn at once."""
        if is_palette_change(event) or event.type() == QEvent.Type.FontChange:
            self._forget(histogram=True)
        super().changeEvent(event)

    def focusInEvent(self, event: QFocusEvent) -> None:
        """The frame shows the focus."""
        super().focusInEvent(event)
        self.update()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """The frame shows that the focus has gone."""
        super().focusOutEvent(event)
        self.update()

    def _on_function_changed(self) -> None:
        self._forget()

    def _on_selection_changed(self) -> None:
        self._describe()
        self.update()

    def _on_range_changed(self) -> None:
        low, high = self.model.data_range
        axis = ValueAxis.of_range(low, high, logarithmic=self.axis.logarithmic)
        function = self.model.function
        if function is not None:
            axis = axis.with_points(function.points[0].value, function.points[-1].value)
        self.set_axis(axis)
        self._forget(histogram=True)

    def _on_counted(self) -> None:
        self._forget(histogram=True)

    def _forget(self, *, histogram: bool = False) -> None:
        self._curve = self._strip = None
        if histogram:
            self._histogram = None
        self.update()

    def _describe(self) -> None:
        """Tell a screen reader what is chosen."""
        function, chosen = self.model.function, sorted(self.model.selection)
        if function is None or not chosen:
            return
        point = function.points[chosen[0]]
        words = self.tr("Point %1 of %2: value %3, opacity %4")
        for mark, text in (
            ("%1", str(chosen[0] + 1)),
            ("%2", str(len(function.points))),
            ("%3", f"{point.value:.6g} {self.model.unit}".strip()),
            ("%4", f"{point.opacity:.3g}"),
        ):
            words = words.replace(mark, text)
        self.setAccessibleDescription(words)

    def _hit(self, at: QPointF) -> Hit:
        return self.places.hit(
            at, self.model.function, self.model.lanes[0], self.markers, self.model.selection
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
