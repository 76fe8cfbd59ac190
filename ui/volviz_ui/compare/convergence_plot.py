"""Errors over the distance of the samples, on logarithmic axes, with the fitted lines and their slopes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPalette, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

HEIGHT = 190
TIP = 4.0
LEVELS = "levels of 255"
COLORS = ("#4795ee", "#e8923c", "#6fbf73", "#c678dd")
"""One for each side, told apart on light and dark ground."""


@dataclass(frozen=True)
class Curve:
    """Errors of one side.

    Attributes
    ----------
    name : str
    distances, errors : tuple of floats
        In voxels, and in levels of 0..255; only points with an error above 0 are drawn.
    factor, slope : float
        The fitted error factor * (distance^slope - finest^slope); NaN when nothing could be fitted.
    finest : float
        Distance of the converged image where it counts, in voxels.
    unit : str
        Of the errors: "levels of 255" for images, "voxels" for meshes.
    """

    name: str
    distances: tuple[float, ...]
    errors: tuple[float, ...]
    factor: float
    slope: float
    finest: float = 0.0
    unit: str = LEVELS

    def expected(self, distance: float) -> float:
        """The fitted error at a distance."""
        return self.factor * float(
            distance**self.slope - (self.finest**self.slope if self.finest > 0 else 0.0)
        )

    @property
    def points(self) -> list[tuple[float, float]]:
        """Distance and error of the points that can be drawn on logarithmic axes."""
        pairs = zip(self.distances, self.errors, strict=True)
        return [(d, e) for d, e in pairs if d > 0 and e > 0]


def decades(low: float, high: float) -> list[float]:
    """Powers of ten within a range, or 1, 2 and 5 times them when that would be fewer than two."""
    first, last = math.floor(math.log10(low)), math.ceil(math.log10(high))
    whole = [10.0**n for n in range(first, last + 1) if low <= 10.0**n <= high]
    if len(whole) > 1:
        return whole
    steps = [m * 10.0**n for n in range(first - 1, last + 1) for m in (1, 2, 5)]
    return [value for value in steps if low <= value <= high]


class ConvergencePlot(QWidget):
    """A log-log plot; hovering tells nothing that is not written in it."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.curves: tuple[Curve, ...] = ()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setAccessibleName(self.tr("Error over the distance of samples"))
        self.setToolTip(
            self.tr(
                "Error (pictures: levels of 255, root mean square; meshes: mean distance in voxels) over the distance "
                "of samples, slices, splats or grid points in voxels, with fitted slopes"
            )
        )

    def sizeHint(self) -> QSize:
        """As wide as the panel."""
        rows = max(len(self.curves) - 2, 0)
        return QSize(240, HEIGHT + rows * self.fontMetrics().height())

    def set_curves(self, curves: Sequence[Curve]) -> None:
        """Show other errors."""
        self.curves = tuple(curves)
        self.setAccessibleDescription("; ".join(_words(curve) for curve in self.curves))
        self.updateGeometry()
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Axes, points, lines, and a legend above them."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        points = [point for curve in self.curves for point in curve.points]
        if len(points) > 1:
            self._paint(painter, points)
        painter.end()

    def _paint(self, painter: QPainter, points: list[tuple[float, float]]) -> None:
        metrics, palette = painter.fontMetrics(), self.palette()
        quiet = palette.color(QPalette.ColorRole.PlaceholderText)
        line = metrics.height()
        top = len(self.curves) * line + 6
        left = metrics.horizontalAdvance("0.001") + 8
        area = QRectF(left, top, self.width() - left - 6, self.height() - top - line - 6)
        xs, ys = [x for x, _ in points], [y for _, y in points]
        x_low, x_high = min(xs) / 1.25, max(xs) * 1.25
        y_low, y_high = min(ys) / 1.6, max(ys) * 1.6

        def place(x: float, y: float) -> QPointF:
            across = math.log(x / x_low) / math.log(x_high / x_low)
            up = math.log(y / y_low) / math.log(y_high / y_low)
            return QPointF(area.left() + across * area.width(), area.bottom() - up * area.height())

        painter.fillRect(area, palette.color(QPalette.ColorRole.Base))
        grid = palette.color(QPalette.ColorRole.Mid)
        for x in decades(x_low, x_high):
            at = place(x, y_low)
            painter.setPen(QPen(grid, 1))
            painter.drawLine(QPointF(at.x(), area.top()), at)
            painter.setPen(quiet)
            painter.drawText(
                QRectF(at.x() - 24, area.bottom() + 2, 48, line), Qt.AlignmentFlag.AlignHCenter, f"{x:g}"
            )
        for y in decades(y_low, y_high):
            at = place(x_low, y)
            painter.setPen(QPen(grid, 1))
            painter.drawLine(at, QPointF(area.right(), at.y()))
            painter.setPen(quiet)
            painter.drawText(
                QRectF(0, at.y() - line / 2, left - 4, line),
                Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter,
                f"{y:g}",
            )
        for number, curve in enumerate(self.curves):
            color = QColor(COLORS[number % len(COLORS)])
            painter.setPen(color)
            words = metrics.elidedText(_words(curve), Qt.TextElideMode.ElideMiddle, self.width() - 20)
            painter.drawText(QRectF(18, number * line, self.width() - 18, line), words)
            painter.setBrush(color)
            painter.drawEllipse(QPointF(9, (number + 0.5) * line), TIP - 1, TIP - 1)
            painter.setClipRect(area)
            if math.isfinite(curve.slope) and curve.points:
                ends = [min(x for x, _ in curve.points), max(x for x, _ in curve.points)]
                painter.setPen(QPen(color, 1.4))
                painter.setBrush(Qt.BrushStyle.NoBrush)
                painter.drawPolyline([place(x, curve.expected(x)) for x in _between(*ends)])
                painter.setBrush(color)
            painter.setPen(QPen(palette.color(QPalette.ColorRole.Base), 1))
            for x, y in curve.points:
                painter.drawEllipse(place(x, y), TIP - 1, TIP - 1)
            painter.setClipping(False)


def _between(low: float, high: float) -> list[float]:
    """Distances from one to another, in equal steps of their logarithms."""
    return [low * (high / low) ** (n / 32) for n in range(33)]


def _words(curve: Curve) -> str:
    words = f"{curve.name}: slope {curve.slope:.2f}" if math.isfinite(curve.slope) else curve.name
    return words if curve.unit == LEVELS else f"{words} ({curve.unit})"
