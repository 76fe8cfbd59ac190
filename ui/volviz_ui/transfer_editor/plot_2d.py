"""The plane of value and gradient magnitude in use: regions chosen, dragged, resized."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal

from PySide6.QtCore import QEvent, QPointF, Qt, Signal
from PySide6.QtGui import QContextMenuEvent, QHideEvent, QKeyEvent, QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QMenu

from volviz.model.transfer.automatic_2d import auto_regions
from volviz.model.transfer.function_2d import KINDS, Kind, Region, TransferFunction2D
from volviz_ui.transfer_editor.gestures import SLACK
from volviz_ui.transfer_editor.items import REACH
from volviz_ui.transfer_editor.plane_view import PlaneView

if TYPE_CHECKING:
    from PySide6.QtWidgets import QWidget

    from volviz_ui.transfer_editor.joint import JointCounter
    from volviz_ui.transfer_editor.model import EditorModel

Grip = Literal["move", "left", "right", "top", "bottom"]


class GradientPlot(PlaneView):
    """Regions of a two-dimensional transfer function, dragged and resized over the joint histogram.

    Parameters
    ----------
    model : EditorModel
        What is shown and edited: the function's `by_gradient`.
    counter : JointCounter
        Source of the histogram.
    parent : QWidget
        Owner.
    """

    selection_changed = Signal()
    color_requested = Signal()

    def __init__(self, model: EditorModel, counter: JointCounter, parent: QWidget) -> None:
        super().__init__(model, counter, parent)
        self._drag: tuple[Grip, QPointF, Region] | None = None
        self._begun = False
        self._under: tuple[int, Grip] | None = None
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setToolTip(
            self.tr(
                "Borders between materials are arcs; put regions on them.\n"
                "Double-click adds a region, drag moves it, its edges resize it, Del removes it.\n"
                "Wheel zooms the values, Ctrl+wheel the gradients."
            )
        )
        model.function_changed.connect(self._on_function_changed)

    # ------------------------------------------------------------------ edits

    def select(self, index: int | None) -> None:
        """Choose a region."""
        if index != self.selected:
            self.selected = index
            self.selection_changed.emit()
            self.update()

    def apply(self, regions: TransferFunction2D, label: str) -> None:
        """Store other regions."""
        function = self.model.function
        if function is not None:
            self.model.apply(replace(function, by_gradient=regions), label)

    def change(self, label: str, **changes: object) -> None:
        """Change attributes of the chosen region."""
        if self.region is not None and self.selected is not None:
            self.apply(self.function.with_changed_region(self.selected, **changes), label)

    def add(self, kind: Kind, at: QPointF | None = None) -> None:
        """Add a region at a pixel, or in the middle."""
        plot = self.plot
        at = plot.center() if at is None else at
        value, gradient = self.value(at.x()), max(self.gradient(at.y()), 0.0)
        low = max(gradient - 0.18 * self.top, 0.0)
        width = 0.1 * (self.axis.high - self.axis.low)
        region = Region(kind, value, width, low, low + 0.36 * self.top, (0.95, 0.75, 0.45), 0.3, 0.5)
        self.apply(self.function.with_region(region), self.tr("Add region"))
        self.select(len(self.function.regions) - 1)

    def set_automatic(self) -> None:
        """Regions over the borders of materials."""
        if self.model.volume is not None:
            self.apply(auto_regions(self.model.volume), self.tr("Automatic regions"))
            self.select(None)

    def delete(self) -> None:
        """Remove the chosen region."""
        if self.selected is not None:
            index, self.selected = self.selected, None
            self.apply(self.function.without_regions((index,)), self.tr("Delete region"))
            self.selection_changed.emit()

    def hit(self, at: QPointF) -> tuple[int, Grip] | None:
        """Region and part of it under a pixel; the chosen one first, then the last drawn."""
        regions = self.function.regions
        order = sorted(range(len(regions)), key=lambda i: (i == self.selected, i), reverse=True)
        for i in order:
            box = self.box(regions[i])
            reach = min(REACH * 0.6, max(box.width(), box.height()) / 3)
            if not box.adjusted(-reach, -reach, reach, reach).contains(at):
                continue
            inner = min(reach, box.width() / 3, box.height() / 3)
            if i == self.selected:
                if abs(at.x() - box.left()) <= max(inner, 4):
                    return i, "left"
                if abs(at.x() - box.right()) <= max(inner, 4):
                    return i, "right"
                if abs(at.y() - box.top()) <= max(inner, 4):
                    return i, "top"
                if abs(at.y() - box.bottom()) <= max(inner, 4):
                    return i, "bottom"
            return i, "move"
        return None

    # ------------------------------------------------------------------ mouse

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take hold of a region or its edge."""
        self.setFocus(Qt.FocusReason.MouseFocusReason)
        if event.button() != Qt.MouseButton.LeftButton:
            return
        hit = self.hit(event.position())
        self.select(None if hit is None else hit[0])
        if hit is not None:
            self._drag = (hit[1], event.position(), self.function.regions[hit[0]])
            self._begun = False

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag, or look what lies under the pointer."""
        at = event.position()
        if self._drag is None:
            self._look(at)
            return
        grip, start, region = self._drag
        if not self._begun:
            if (at - start).manhattanLength() < SLACK:
                return
            self._begun = True
            self.model.begin()
        if event.modifiers() & Qt.KeyboardModifier.ShiftModifier and grip == "move":
            offset = at - start
            at = (
                QPointF(at.x(), start.y())
                if abs(offset.x()) >= abs(offset.y())
                else QPointF(start.x(), at.y())
            )
        value = self.value(at.x()) - self.value(start.x())
        gradient = self.gradient(at.y()) - self.gradient(start.y())
        label = self.tr("Move region") if grip == "move" else self.tr("Resize region")
        self._put(_dragged(region, grip, value, gradient), label)

    def mouseReleaseEvent(self, _event: QMouseEvent) -> None:
        """The drag is over."""
        self._finish()

    def hideEvent(self, event: QHideEvent) -> None:
        """A plot that is not seen does not hear that the button is let go."""
        self._finish()
        super().hideEvent(event)

    def _finish(self) -> None:
        if self._drag is not None:
            self._drag = None
            if self._begun:
                self.model.finish()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Add a region, or choose the colour of one."""
        if event.button() != Qt.MouseButton.LeftButton or self.model.function is None:
            return
        self._drag = None
        hit = self.hit(event.position())
        if hit is None:
            self.add("rectangle", event.position())
        else:
            self.select(hit[0])
            self.color_requested.emit()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom the values about the pointer; with Ctrl the gradients; with Shift pan."""
        notches = (event.angleDelta().y() or event.angleDelta().x()) / 120.0
        if event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            limit = (
                1.0 if self.counter.histogram is None else float(self.counter.histogram.gradient_edges[-1])
            )
            self.top = min(max(self.top * 1.25**-notches, 1e-4 * limit), 1.5 * limit)
        elif event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
            self.axis = self.axis.panned(-0.08 * notches)
        else:
            at = min(max((event.position().x() - self.plot.left()) / self.plot.width(), 0.0), 1.0)
            self.axis = self.axis.zoomed(1.25**notches, at)
        self._image = None
        self.update()
        event.accept()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Add, remove, begin anew."""
        at = QPointF(event.pos())
        hit = self.hit(at)
        if hit is not None:
            self.select(hit[0])
        menu = QMenu(self)
        names = {
            "rectangle": self.tr("Add rectangle here"),
            "ellipse": self.tr("Add ellipse here"),
            "triangle": self.tr("Add triangle here"),
        }
        for kind in KINDS:
            menu.addAction(names[kind]).triggered.connect(
                lambda _checked=False, kind=kind: self.add(kind, at)
            )
        menu.addSeparator()
        delete = menu.addAction(self.tr("Delete"))
        delete.setEnabled(self.region is not None)
        delete.triggered.connect(self.delete)
        menu.addAction(self.tr("Automatic regions")).triggered.connect(self.set_automatic)
        menu.aboutToHide.connect(menu.deleteLater)
        menu.popup(event.globalPos())

    # ------------------------------------------------------------------ keyboard

    def event(self, event: QEvent) -> bool:
        """Keys of the plot come before the window's shortcuts of the same keys."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent):
            mine = (
                Qt.Key.Key_Delete, Qt.Key.Key_Insert, Qt.Key.Key_PageUp, Qt.Key.Key_PageDown, Qt.Key.Key_Left,
                Qt.Key.Key_Right, Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_C,
            )  # fmt: skip
            if event.key() in mine or (event.key() == Qt.Key.Key_Escape and self.selected is not None):
                event.accept()
                return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Choose, move, add and remove regions."""
        key, count = event.key(), len(self.function.regions)
        step = 10.0 if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1.0
        arrows = {
            Qt.Key.Key_Left: (-1, 0), Qt.Key.Key_Right: (1, 0), Qt.Key.Key_Up: (0, 1), Qt.Key.Key_Down: (0, -1),
        }  # fmt: skip
        if key in arrows and self.region is not None:
            across, up = arrows[Qt.Key(key)]
            unit = 2.0 * step / self.plot.width() * (self.axis.high - self.axis.low)
            rise = 2.0 * step / self.plot.height() * self.top
            self._put(self.region.moved(across * unit, up * rise), self.tr("Move region"))
        elif key in (Qt.Key.Key_PageDown, Qt.Key.Key_PageUp) and count:
            turn = 1 if key == Qt.Key.Key_PageDown else -1
            self.select(((-1 if turn > 0 else 0) if self.selected is None else self.selected) + turn)
            self.select((self.selected or 0) % count)
        elif key in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace):
            self.delete()
        elif key == Qt.Key.Key_Insert and self.model.function is not None:
            self.add("rectangle")
        elif key == Qt.Key.Key_C and self.region is not None:
            self.color_requested.emit()
        elif key == Qt.Key.Key_Escape and (self._drag is not None or self.selected is not None):
            self._escape()
        else:
            super().keyPressEvent(event)

    def _escape(self) -> None:
        if self._drag is not None:
            self._drag = None
            if self._begun:
                self.model.cancel()
        else:
            self.select(None)

    # ------------------------------------------------------------------ inside

    def _put(self, region: Region, label: str) -> None:
        if self.selected is not None and self.selected < len(self.function.regions):
            regions = list(self.function.regions)
            regions[self.selected] = region
            self.apply(replace(self.function, regions=tuple(regions)), label)

    def _look(self, at: QPointF) -> None:
        self._under = self.hit(at)
        cursors = {
            "move": Qt.CursorShape.SizeAllCursor, "left": Qt.CursorShape.SizeHorCursor,
            "right": Qt.CursorShape.SizeHorCursor, "top": Qt.CursorShape.SizeVerCursor,
            "bottom": Qt.CursorShape.SizeVerCursor,
        }  # fmt: skip
        self.setCursor(Qt.CursorShape.CrossCursor if self._under is None else cursors[self._under[1]])

    def _on_function_changed(self) -> None:
        if self.selected is not None and self.selected >= len(self.function.regions):
            self.select(None)
        self.update()
        self.selection_changed.emit()


def _dragged(region: Region, grip: Grip, value: float, gradient: float) -> Region:
    """A region after a drag of one of its parts; no edge passes the opposite one."""
    least_width = region.width * 1e-3
    height = region.gradient_high - region.gradient_low
    if grip == "move":
        return region.moved(value, gradient)
    if grip in ("left", "right"):
        # the opposite edge stays
        sign = -1.0 if grip == "left" else 1.0
        width = max(region.width + sign * value, least_width)
        return replace(region, width=width, value=region.value + sign * (width - region.width) / 2)
    if grip == "top":
        high = max(region.gradient_high + gradient, region.gradient_low + height * 1e-3)
        return replace(region, gradient_high=high)
    low = min(max(region.gradient_low + gradient, 0.0), region.gradient_high - height * 1e-3)
    return replace(region, gradient_low=low)
