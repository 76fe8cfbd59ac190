"""The switch 1D | 2D of the transfer-function editor, and why its second half may be of no use."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QPainter, QPaintEvent, QPalette
from PySide6.QtWidgets import QButtonGroup, QFrame, QHBoxLayout, QLabel, QSizePolicy, QToolButton, QWidget


class DimensionSwitch(QWidget):
    """Two buttons, of which one is down, and a line of words while regions wait for another technique."""

    chosen = Signal(bool)
    """The user has clicked: True = regions over value and gradient."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.available = False
        self.one_button = self._button("1D", self.tr("Colour and opacity by value"))
        self.two_button = self._button("2D", self.tr("Colour and opacity by value and gradient"))
        self.one_button.setChecked(True)
        self._group = QButtonGroup(self)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        line = QFrame(self)
        line.setFrameShape(QFrame.Shape.VLine)
        line.setFrameShadow(QFrame.Shadow.Plain)
        line.setObjectName("section_line")
        line.setFixedWidth(1)
        layout.addWidget(line)
        for button in (self.one_button, self.two_button):
            self._group.addButton(button)
            layout.addWidget(button)
        #: For the editor to place where there is room.
        self.note = ElidedLabel(self)
        self._group.buttonClicked.connect(lambda _button: self.chosen.emit(self.two_button.isChecked()))

    def _button(self, label: str, tip: str) -> QToolButton:
        button = QToolButton(self)
        button.setText(label)
        button.setToolTip(tip)
        button.setAccessibleName(tip)
        button.setCheckable(True)
        button.setAutoRaise(True)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        button.setMinimumSize(30, 28)
        return button

    def offer(self, *, available: bool, why_not: str) -> None:
        """Say whether regions are drawn; without them and without a reason the switch is out of sight."""
        self.available = available
        self.setVisible(available or bool(why_not))
        self.two_button.setEnabled(available)
        self.two_button.setToolTip(why_not or self.tr("Colour and opacity by value and gradient"))
        self.note.setText(why_not)
        self.note.setToolTip(why_not)

    def show_state(self, *, two: bool, waiting: bool) -> None:
        """Put the right button down; `waiting`: there are regions that are not drawn now."""
        (self.two_button if two else self.one_button).setChecked(True)
        self.note.setVisible(waiting and bool(self.note.text()))


class ElidedLabel(QLabel):
    """One line of quiet words that are shortened where the room ends."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.setMinimumWidth(120)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """The words, with an ellipsis where they do not fit."""
        painter = QPainter(self)
        painter.setPen(self.palette().color(QPalette.ColorRole.PlaceholderText))
        words = self.fontMetrics().elidedText(self.text(), Qt.TextElideMode.ElideRight, self.width())
        painter.drawText(self.rect(), Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, words)
