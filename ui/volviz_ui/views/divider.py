"""The line between the two images of a wipe, to be dragged."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPalette, QPen
from PySide6.QtWidgets import QWidget

WIDTH = 17
LINE = 2.0
LEAST = 0.02
"""Neither image can be wiped away altogether."""
KEY_STEP = 0.01


class Divider(QWidget):
    """A vertical line with a grip, over the images."""

    moved = Signal(float)
    """Where it is wanted, as a fraction of the width of the images."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._share = 0.5
        self._grip: float | None = None
        self.setCursor(Qt.CursorShape.SplitHCursor)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setToolTip(
            self.tr("Drag to wipe between the two pictures; a double-click puts it in the middle")
        )
        self.setAccessibleName(self.tr("Divider of the wipe"))

    def place(self, left: int, top: int, width: int, height: int, share: float) -> None:
        """Lie over images of that place, at a fraction of their width."""
        self._share = share
        self.setGeometry(left + round(share * width) - WIDTH // 2, top, WIDTH, height)
        self.raise_()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take the line where it was grasped."""
        self._grip = event.position().x() - self.width() / 2
        event.accept()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Follow the pointer."""
        if self._grip is not None:
            at = self.parentWidget().mapFromGlobal(event.globalPosition()).x() - self._grip
            self._move_to(at / max(self.parentWidget().width(), 1))
        event.accept()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Stay there."""
        self._grip = None
        event.accept()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Back to the middle."""
        self._move_to(0.5)
        event.accept()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """The arrows move it by a hundredth."""
        steps = {Qt.Key.Key_Left: -KEY_STEP, Qt.Key.Key_Right: KEY_STEP}
        step = steps.get(Qt.Key(event.key()))
        if step is None:
            event.ignore()
        else:
            self._move_to(self._share + step)

    def _move_to(self, share: float) -> None:
        self.moved.emit(min(max(share, LEAST), 1 - LEAST))

    def paintEvent(self, _event: QPaintEvent) -> None:
        """A line, and a round grip half-way down."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        color = self.palette().color(QPalette.ColorRole.Highlight)
        middle = self.width() / 2
        painter.fillRect(QRectF(middle - LINE / 2, 0, LINE, self.height()), color)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(color)
        center = QPointF(middle, self.height() / 2)
        painter.drawEllipse(center, 8, 8)
        painter.setPen(QPen(self.palette().color(QPalette.ColorRole.HighlightedText), 1.4))
        for side in (-1, 1):
            tip = center + QPointF(5.0 * side, 0)
            painter.drawLine(tip, tip + QPointF(-2.5 * side, -2.5))
            painter.drawLine(tip, tip + QPointF(-2.5 * side, 2.5))
        painter.end()
