"""A slider with two handles, in the colours of the theme and moved by keys."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtGui import QKeyEvent, QPalette
from superqt import QRangeSlider


class RangeSlider(QRangeSlider):
    """A range that the arrows move as well: its lower end, with Shift its upper one."""

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Left and right by one step, page keys by a tenth."""
        step = {
            Qt.Key.Key_Left: -1,
            Qt.Key.Key_Right: 1,
            Qt.Key.Key_PageDown: -max(1, self.maximum() // 10),
            Qt.Key.Key_PageUp: max(1, self.maximum() // 10),
        }.get(Qt.Key(event.key()))
        if step is None:
            super().keyPressEvent(event)
            return
        low, high = self.value()
        if event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
            high = min(max(high + step, low + 1), self.maximum())
        else:
            low = max(min(low + step, high - 1), self.minimum())
        self.setValue((low, high))
        event.accept()


def color_bar(slider: QRangeSlider) -> None:
    """Paint the range between the handles in the accent of the theme."""
    # superqt brings a blue of its own, and its property knows the active window only
    accent = slider.palette().color(QPalette.ColorRole.Highlight).name()
    style = slider._style  # noqa: SLF001
    style.brush_active = style.brush_inactive = accent
    slider.update()
