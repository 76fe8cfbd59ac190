"""The plot of one ray: values above, opacity and what has gathered below, the colour so far at the foot."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QFocusEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPainterPath,
    QPaintEvent,
    QPalette,
    QPen,
    QPolygonF,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from volviz.model.ticks import round_values, value_text
from volviz.ray_inspection import RayInspection
from volviz_ui.style.theme import is_palette_change
from volviz_ui.transfer_editor.axes import OpacityAxis
from volviz_ui.transfer_editor.painting import small_font, with_alpha

LEFT, RIGHT, TOP, FOOT, STRIP, GAP = 52.0, 10.0, 8.0, 20.0, 14.0, 6.0
VALUE_SHARE = 0.56
"""Part of the height that the curve of the values gets."""

Role = QPalette.ColorRole
BACKGROUND = np.array([0.11, 0.12, 0.14])
"""Behind the accumulated colours: dark, as the viewport."""


class RayPlot(QWidget):
    """Shows the samples of a ray; the pointer or the arrow keys choose one.

    Parameters
    ----------
    parent : QWidget
        Owner.
    """

    sample_chosen = Signal(int)
    """Index of the sample under the pointer or chosen by keys; -1 when there is none."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.found: RayInspection | None = None
        self.unit, self.length_unit = "", ""
        self.value_range = (0.0, 1.0)
        self.chosen = -1
        self.marked_value: float | None = None
        self._opacity = OpacityAxis(fine=True)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(240, 132)
        self.setAccessibleName(self.tr("Samples along the ray"))
        self.setToolTip("")

    def sizeHint(self) -> QSize:
        """As wide and low as the editor's plot beside it."""
        return QSize(420, 170)

    # ------------------------------------------------------------------ what is shown

    def show_ray(
        self, found: RayInspection | None, unit: str, length_unit: str, value_range: tuple[float, float]
    ) -> None:
        """Show another ray; the chosen sample stays at its distance."""
        place = self._distance_of(self.chosen)
        self.found, self.unit, self.length_unit, self.value_range = found, unit, length_unit, value_range
        chosen = -1 if place is None or found is None else self._nearest(place)
        if chosen != self.chosen:
            self.chosen = chosen
        self.update()

    def choose(self, index: int) -> None:
        """Choose a sample, -1 for none."""
        count = 0 if self.found is None else len(self.found.profile.values)
        index = min(index, count - 1) if index >= 0 else -1
        if index != self.chosen:
            self.chosen = index
            self.sample_chosen.emit(index)
            self.update()

    def mark_value(self, value: float | None) -> None:
        """Draw a line at a value that is pointed at elsewhere."""
        if value != self.marked_value:
            self.marked_value = value
            self.update()

    def _distance_of(self, index: int) -> float | None:
        if self.found is None or not 0 <= index < len(self.found.profile.distances):
            return None
        return float(self.found.profile.distances[index])

    def _nearest(self, distance: float) -> int:
        if self.found is None or not len(self.found.profile.distances):
            return -1
        return int(np.argmin(np.abs(self.found.profile.distances - distance)))

    # ------------------------------------------------------------------ places

    @property
    def _columns(self) -> QRectF:
        return QRectF(LEFT, TOP, max(self.width() - LEFT - RIGHT, 1.0), max(self.height() - TOP - FOOT, 1.0))

    @property
    def values_area(self) -> QRectF:
        """Where the values are drawn."""
        whole = self._columns
        height = (whole.height() - STRIP - 2 * GAP) * VALUE_SHARE
        return QRectF(whole.left(), whole.top(), whole.width(), height)

    @property
    def opacity_area(self) -> QRectF:
        """Where opacities and what has gathered are drawn."""
        whole, above = self._columns, self.values_area
        top = above.bottom() + GAP
        return QRectF(whole.left(), top, whole.width(), whole.bottom() - STRIP - GAP - top)

    @property
    def strip_area(self) -> QRectF:
        """Where the accumulated colour is drawn."""
        whole = self._columns
        return QRectF(whole.left(), whole.bottom() - STRIP, whole.width(), STRIP)

    @property
    def _length(self) -> float:
        return max(self.found.span.exit - self.found.span.entry, 1e-12) if self.found is not None else 1.0

    def x_of(self, distance: float) -> float:
        """Pixel of a distance along the ray."""
        area = self._columns
        return area.left() + distance / self._length * area.width()

    def _limits(self) -> tuple[float, float]:
        """Values from the lower to the upper edge: what the ray meets, with a little room."""
        low, high = self.value_range
        if self.found is not None and len(self.found.profile.values):
            values = self.found.profile.values
            low, high = float(values.min()), float(values.max())
            room = max(0.06 * (high - low), 0.01 * (self.value_range[1] - self.value_range[0]), 1e-12)
            low, high = low - room, high + room
        return (low, high) if high > low else (low, low + 1.0)

    # ------------------------------------------------------------------ painting

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Axes, curves, strip, and the chosen sample over them."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        palette = self.palette()
        for area in (self.values_area, self.opacity_area):
            painter.fillRect(area, palette.color(Role.Base))
        found = self.found
        if found is None or not len(found.profile.values):
            painter.setPen(palette.color(Role.PlaceholderText))
            words = self.tr("Click in the picture to follow the ray behind that pixel")
            if found is not None:
                words = self.tr("No samples: the ray misses what is shown")
            painter.drawText(self.values_area, Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, words)
            self._paint_borders(painter, palette)
            return
        low, high = self._limits()
        self._paint_axes(painter, palette, low, high)
        self._paint_values(painter, palette, found, low, high)
        self._paint_opacities(painter, palette, found)
        self._paint_strip(painter, found)
        self._paint_borders(painter, palette)
        self._paint_chosen(painter, palette, found, low, high)

    def _y(self, value: float, low: float, high: float) -> float:
        area = self.values_area
        return area.bottom() - (value - low) / (high - low) * area.height()

    def _paint_axes(self, painter: QPainter, palette: QPalette, low: float, high: float) -> None:
        values, opacities, whole = self.values_area, self.opacity_area, self._columns
        painter.setFont(small_font(self.font()))
        grid, text = QPen(with_alpha(palette.color(Role.Mid), 0.6), 1.0), palette.color(Role.PlaceholderText)
        right = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        for tick in round_values(low, high, max(int(values.height() / 26), 2)):
            y = round(self._y(tick, low, high)) + 0.5
            painter.setPen(grid)
            painter.drawLine(QPointF(values.left(), y), QPointF(values.right(), y))
            if y > values.bottom() - 7:
                continue  # the scale below begins there
            painter.setPen(text)
            painter.drawText(QRectF(0, y - 8, LEFT - 6, 16), right, value_text(tick, high - low))
        below = 1e9
        for level in (0.0, 0.01, 0.1, 1.0):
            y = round(opacities.bottom() - self._opacity.fraction(level) * opacities.height()) + 0.5
            painter.setPen(grid)
            painter.drawLine(QPointF(opacities.left(), y), QPointF(opacities.right(), y))
            if below - y >= 11:
                below = y
                painter.setPen(text)
                painter.drawText(QRectF(0, y - 8, LEFT - 6, 16), right, f"{level:g}")
        metrics = painter.fontMetrics()
        unit = metrics.horizontalAdvance(self.length_unit) + 10
        for tick in round_values(0.0, self._length, max(int(whole.width() / 80), 2)):
            x = self.x_of(tick)
            painter.setPen(grid)
            for area in (values, opacities):
                painter.drawLine(QPointF(round(x) + 0.5, area.top()), QPointF(round(x) + 0.5, area.bottom()))
            label = value_text(tick, self._length)
            wide = metrics.horizontalAdvance(label) + 6.0
            if x + wide / 2 < whole.right() - unit:
                painter.setPen(text)
                box = QRectF(x - wide / 2, whole.bottom() + 3, wide, 16)
                painter.drawText(box, Qt.AlignmentFlag.AlignCenter, label)
        painter.setPen(text)
        painter.drawText(QRectF(whole.right() - unit, whole.bottom() + 3, unit, 16), right, self.length_unit)

    def _paint_values(
        self, painter: QPainter, palette: QPalette, found: RayInspection, low: float, high: float
    ) -> None:
        area, profile = self.values_area, found.profile
        painter.save()
        painter.setClipRect(area)
        # the colours of the transfer function under the curve, as strong as the samples are opaque
        path = QPainterPath()
        curve = self._polyline(profile.values, low, high)
        path.addPolygon(curve)
        path.lineTo(curve.last().x(), area.bottom())
        path.lineTo(curve.first().x(), area.bottom())
        path.closeSubpath()
        painter.save()
        painter.setClipPath(path, Qt.ClipOperation.IntersectClip)
        painter.drawImage(area, self._colors(found))
        painter.restore()
        if self.marked_value is not None and low <= self.marked_value <= high:
            pen = QPen(palette.color(Role.Highlight), 1.2)
            pen.setStyle(Qt.PenStyle.DotLine)
            painter.setPen(pen)
            y = self._y(self.marked_value, low, high)
            painter.drawLine(QPointF(area.left(), y), QPointF(area.right(), y))
        if found.acts_on_scalar:
            pen = QPen(palette.color(Role.Highlight), 1.6)
            painter.setPen(pen)
            seen = np.isfinite(profile.results)
            painter.drawPolyline(self._polyline(profile.results, low, high, seen))
        painter.setPen(QPen(with_alpha(palette.color(Role.Text), 0.95), 1.5))
        painter.drawPolyline(curve)
        painter.setPen(QPen(palette.color(Role.Highlight), 1.2))
        for crossing in found.crossings:
            x = self.x_of(crossing.distance)
            painter.drawLine(QPointF(x, area.top()), QPointF(x, area.bottom()))
        painter.restore()

    def _polyline(
        self,
        values: npt.NDArray[np.float64],
        low: float,
        high: float,
        which: npt.NDArray[np.bool_] | None = None,
    ) -> QPolygonF:
        """Samples as a line; where there are more than pixels, the extremes of each pixel."""
        assert self.found is not None
        x = self._columns.left() + self.found.profile.distances / self._length * self._columns.width()
        area = self.values_area
        y = area.bottom() - (values - low) / (high - low) * area.height()
        if which is not None:
            x, y = x[which], y[which]
        if len(x) > 4 * area.width():
            column = np.floor(x).astype(np.intp)
            firsts = np.flatnonzero(np.diff(column, prepend=-1))
            tops, bottoms = np.minimum.reduceat(y, firsts), np.maximum.reduceat(y, firsts)
            x, y = np.repeat(x[firsts], 2), np.column_stack([tops, bottoms]).ravel()
        return QPolygonF([QPointF(a, b) for a, b in zip(x.tolist(), y.tolist(), strict=True)])

    def _paint_opacities(self, painter: QPainter, palette: QPalette, found: RayInspection) -> None:
        area, profile = self.opacity_area, found.profile
        heights = self._opacity.fractions(np.clip(profile.opacities, 0.0, 1.0)) * area.height()
        # behind the sample at which a ray ends early there is nothing
        last = float(profile.distances[-1])
        step = last - float(profile.distances[-2]) if len(profile.distances) > 1 else self._length - last
        edges = np.append(profile.distances, last + step)
        painter.save()
        painter.setClipRect(area)
        bars = QPainterPath(QPointF(area.left(), area.bottom()))
        for distance, after, height in zip(
            edges[:-1].tolist(), edges[1:].tolist(), heights.tolist(), strict=True
        ):
            half = (after - distance) / 2
            bars.lineTo(self.x_of(distance - half), area.bottom() - height)
            bars.lineTo(self.x_of(distance + half), area.bottom() - height)
        bars.lineTo(self.x_of(float(profile.distances[-1])), area.bottom())
        bars.closeSubpath()
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(with_alpha(palette.color(Role.PlaceholderText), 0.45))
        painter.drawPath(bars)
        gathered = self._opacity.fractions(np.clip(profile.accumulated[:, 3], 0.0, 1.0)) * area.height()
        line = QPolygonF([QPointF(area.left(), area.bottom())])
        for distance, height in zip(profile.distances.tolist(), gathered.tolist(), strict=True):
            line.append(QPointF(self.x_of(distance), area.bottom() - height))
        painter.setPen(QPen(palette.color(Role.Highlight), 1.8))
        painter.drawPolyline(line)
        painter.restore()

    def _paint_strip(self, painter: QPainter, found: RayInspection) -> None:
        painter.drawImage(self.strip_area, self._accumulated(found))
        # behind the last sample nothing is added
        end = self.x_of(float(found.profile.distances[-1]))
        if found.ends == "opacity":
            pen = QPen(self.palette().color(Role.Text), 1.2)
            painter.setPen(pen)
            painter.drawLine(QPointF(end, self.values_area.top()), QPointF(end, self.strip_area.bottom()))

    def _per_column(self, found: RayInspection) -> npt.NDArray[np.intp]:
        """Index of the sample that each column of pixels shows."""
        columns = max(round(self._columns.width() * self.devicePixelRatioF()), 2)
        distances = (np.arange(columns) + 0.5) / columns * self._length
        middles = (found.profile.distances[1:] + found.profile.distances[:-1]) / 2
        return np.searchsorted(middles, distances)

    def _colors(self, found: RayInspection) -> QImage:
        profile, which = found.profile, self._per_column(found)
        rgb = np.clip(profile.colors[which], 0, 1)
        strength = np.clip(profile.opacities[which], 0, 1) ** 0.4
        # behind the end of the ray there are no samples
        columns = len(which)
        behind = (np.arange(columns) + 0.5) / columns * self._length > profile.distances[
            -1
        ] + self._length / columns
        strength[behind] = 0.0
        pixels = np.zeros((1, columns, 4), np.uint8)
        pixels[0, :, :3] = np.rint(rgb * 255)
        pixels[0, :, 3] = np.rint(strength * 200)
        return QImage(pixels.tobytes(), columns, 1, 4 * columns, QImage.Format.Format_RGBA8888).copy()

    def _accumulated(self, found: RayInspection) -> QImage:
        rgba = np.clip(found.profile.accumulated[self._per_column(found)], 0, 1)
        rgb = np.rint(np.clip(rgba[:, :3] + (1 - rgba[:, 3:]) * BACKGROUND, 0, 1) * 255).astype(np.uint8)
        pixels = np.full((1, len(rgb), 4), 255, np.uint8)
        pixels[0, :, :3] = rgb
        return QImage(pixels.tobytes(), len(rgb), 1, 4 * len(rgb), QImage.Format.Format_RGBA8888).copy()

    def _paint_borders(self, painter: QPainter, palette: QPalette) -> None:
        color = palette.color(Role.Highlight if self.hasFocus() else Role.Mid)
        painter.setPen(QPen(color, 1.4 if self.hasFocus() else 1.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRoundedRect(self.values_area, 3, 3)
        painter.setPen(QPen(palette.color(Role.Mid), 1.0))
        painter.drawRoundedRect(self.opacity_area, 3, 3)

    def _paint_chosen(
        self, painter: QPainter, palette: QPalette, found: RayInspection, low: float, high: float
    ) -> None:
        distance = self._distance_of(self.chosen)
        if distance is None:
            return
        x = self.x_of(distance)
        painter.setPen(QPen(with_alpha(palette.color(Role.Text), 0.7), 1.0))
        painter.drawLine(QPointF(x, self.values_area.top()), QPointF(x, self.strip_area.bottom()))
        painter.setPen(QPen(palette.color(Role.Base), 2.0))
        painter.setBrush(palette.color(Role.Highlight))
        painter.drawEllipse(
            QPointF(x, self._y(float(found.profile.values[self.chosen]), low, high)), 4.5, 4.5
        )

    # ------------------------------------------------------------------ choosing

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """The sample nearest to the pointer."""
        if self.found is not None:
            part = (event.position().x() - self._columns.left()) / self._columns.width()
            self.choose(self._nearest(part * self._length) if -0.02 <= part <= 1.02 else -1)

    def leaveEvent(self, event: QEvent) -> None:
        """Nothing is pointed at; what keys have chosen stays."""
        if not self.hasFocus():
            self.choose(-1)
        super().leaveEvent(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Arrows walk along the ray, Home and End go to its ends, Escape lets go."""
        count = 0 if self.found is None else len(self.found.profile.values)
        far = 10 if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1
        steps = {
            Qt.Key.Key_Left: -far,
            Qt.Key.Key_Right: far,
            Qt.Key.Key_PageUp: -50,
            Qt.Key.Key_PageDown: 50,
        }
        key = Qt.Key(event.key())
        if count and key in steps:
            self.choose(0 if self.chosen < 0 else min(max(self.chosen + steps[key], 0), count - 1))
        elif count and key in (Qt.Key.Key_Home, Qt.Key.Key_End):
            self.choose(0 if key == Qt.Key.Key_Home else count - 1)
        elif key == Qt.Key.Key_Escape and self.chosen >= 0:
            self.choose(-1)
        else:
            super().keyPressEvent(event)

    def event(self, event: QEvent) -> bool:
        """Keys that choose a sample must not reach the window's commands of the same keys."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent) and event.key() in (
            Qt.Key.Key_Left, Qt.Key.Key_Right, Qt.Key.Key_Home, Qt.Key.Key_End, Qt.Key.Key_PageUp,
            Qt.Key.Key_PageDown,
        ):  # fmt: skip
            event.accept()
            return True
        return super().event(event)

    def changeEvent(self, event: QEvent) -> None:
        """Another palette is shown at once."""
        if is_palette_change(event):
            self.update()
        super().changeEvent(event)

    def focusInEvent(self, event: QFocusEvent) -> None:
        """The frame shows the focus."""
        super().focusInEvent(event)
        self.update()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """The frame shows that the focus has gone."""
        super().focusOutEvent(event)
        self.update()
