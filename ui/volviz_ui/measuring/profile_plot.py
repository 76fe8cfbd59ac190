"""Values along a line as curves, with their errors as a band."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPalette, QPen, QPolygonF
from PySide6.QtWidgets import QSizePolicy, QWidget

from volviz.measure.profiles import Profile
from volviz.model.measurements import COLORS
from volviz.model.ticks import round_values, value_text

LEFT, RIGHT, TOP, BOTTOM = 52.0, 10.0, 8.0, 22.0


class ProfilePlot(QWidget):
    """Draws one profile; of several volumes each has a colour of its own."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._profile: Profile | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setAccessibleName(self.tr("Values along the line"))

    def sizeHint(self) -> QSize:
        """High enough to read values off."""
        return QSize(240, 150)

    def show_profile(self, profile: Profile | None) -> None:
        """Show another profile, None for nothing."""
        self._profile = profile
        self.setVisible(profile is not None)
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Axes with round numbers, bands, curves."""
        if self._profile is None:
            return
        profile = self._profile
        known = [np.column_stack([v - e, v + e]) for v, e in zip(profile.values, profile.errors, strict=True)]
        finite = np.concatenate([band[np.isfinite(band).all(axis=1)] for band in known])
        if not finite.size:
            return
        low, high = float(finite.min()), float(finite.max())
        if not low < high:
            low, high = low - 0.5, high + 0.5
        place = QRectF(self.rect()).adjusted(LEFT, TOP, -RIGHT, -BOTTOM)
        length = float(profile.distance[-1])

        def at(distance: float, value: float) -> QPointF:
            return QPointF(
                place.left() + place.width() * distance / length,
                place.bottom() - place.height() * (value - low) / (high - low),
            )

        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(self.palette().color(QPalette.ColorRole.PlaceholderText))
        for value in round_values(low, high, max(2, int(place.height() / 32))):
            y = at(0.0, value).y()
            box = QRectF(0.0, y - 8, LEFT - 6, 16)
            painter.drawText(
                box,
                Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter,
                value_text(value, high - low),
            )
        for value in round_values(0.0, length, max(2, int(place.width() / 60))):
            x = at(value, low).x()
            words = value_text(value, length)
            painter.drawText(QRectF(x - 30, place.bottom() + 3, 60, 16), Qt.AlignmentFlag.AlignHCenter, words)
        painter.setPen(self.palette().color(QPalette.ColorRole.Mid))
        painter.drawRect(place)
        for number, (values, band) in enumerate(zip(profile.values, known, strict=True)):
            color = QColor.fromRgbF(*COLORS[(number + 1) % len(COLORS)])
            inside = np.isfinite(values)
            if not inside.any():
                continue
            distance = profile.distance[inside]
            edges = [at(d, v) for d, v in zip(distance, band[inside, 0], strict=True)]
            edges += [at(d, v) for d, v in zip(distance[::-1], band[inside, 1][::-1], strict=True)]
            shade = QColor(color)
            shade.setAlphaF(0.3)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(shade)
            painter.drawPolygon(QPolygonF(edges))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(QPen(color, 1.5))
            painter.drawPolyline(QPolygonF([at(d, v) for d, v in zip(distance, values[inside], strict=True)]))
        painter.end()
