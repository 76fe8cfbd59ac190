"""The icon of the program: a cube one can see into, painted at whatever size is asked for."""

from __future__ import annotations

from functools import lru_cache

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QIcon, QPainter, QPen, QPixmap, QPolygonF, QRadialGradient

SIZES = (16, 24, 32, 48, 64, 128, 256)


@lru_cache(maxsize=1)
def app_icon() -> QIcon:
    """The icon in the usual sizes."""
    result = QIcon()
    for size in SIZES:
        result.addPixmap(_painted(size))
    return result


def _painted(size: int) -> QPixmap:
    pixmap = QPixmap(size, size)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.scale(size / 64, size / 64)
    top, bottom = QPointF(32, 4), QPointF(32, 60)
    left_up, left_down = QPointF(7, 18), QPointF(7, 46)
    right_up, right_down = QPointF(57, 18), QPointF(57, 46)
    middle = QPointF(32, 32)
    painter.setPen(Qt.PenStyle.NoPen)
    for corners, color in (
        ((top, right_up, middle, left_up), "#7cc0f5"),
        ((left_up, middle, bottom, left_down), "#2f7fd3"),
        ((right_up, right_down, bottom, middle), "#1d5aa6"),
    ):
        painter.setBrush(QColor(color))
        painter.drawPolygon(QPolygonF(list(corners)))
    glow = QRadialGradient(QPointF(32, 33), 19)
    glow.setColorAt(0.0, QColor(255, 226, 150, 250))
    glow.setColorAt(0.45, QColor(255, 160, 70, 190))
    glow.setColorAt(1.0, QColor(255, 120, 50, 0))
    painter.setBrush(glow)
    painter.drawEllipse(QPointF(32, 33), 19, 19)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(QPen(QColor(255, 255, 255, 150), 1.6))
    painter.drawPolygon(QPolygonF([top, right_up, right_down, bottom, left_down, left_up]))
    for corner in (left_up, right_up, bottom):
        painter.drawLine(middle, corner)
    painter.end()
    return pixmap
