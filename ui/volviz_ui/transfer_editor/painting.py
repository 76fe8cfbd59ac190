"""The layers of the plot, painted from plain values; nothing here knows of events."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QImage, QPainter, QPainterPath, QPalette, QPen, QPolygonF

from volviz.model.ticks import value_text
from volviz.model.transfer.channels import Channel
from volviz.model.transfer.function import TransferFunction
from volviz_ui.transfer_editor.histogram_worker import Counts
from volviz_ui.transfer_editor.items import RADIUS, PlotLayout

Role = QPalette.ColorRole


def small_font(font: QFont) -> QFont:
    """The font of ticks: a little smaller than that of the widget."""
    small = QFont(font)
    if font.pointSizeF() > 0:
        small.setPointSizeF(max(font.pointSizeF() * 0.85, 6.5))
    return small


def with_alpha(color: QColor, alpha: float) -> QColor:
    """The colour with another opacity, 0..1."""
    result = QColor(color)
    result.setAlphaF(alpha)
    return result


def color_of(rgb: tuple[float, ...]) -> QColor:
    """A Qt colour from numbers in 0..1."""
    return QColor.fromRgbF(*(min(max(float(c), 0.0), 1.0) for c in rgb[:3]))


def paint_frame(painter: QPainter, places: PlotLayout, palette: QPalette, unit: str, font: QFont) -> None:
    """Background, grid, ticks of both axes, and a shade over what lies outside the data."""
    plot = places.plot
    painter.fillRect(plot, palette.color(Role.Base))
    text = palette.color(Role.PlaceholderText)
    grid = QPen(with_alpha(palette.color(Role.Mid), 0.6), 1.0)
    painter.setFont(small_font(font))
    below = 1e9
    for opacity in places.opacities.ticks():
        y = round(places.y(opacity)) + 0.5
        painter.setPen(grid)
        painter.drawLine(QPointF(plot.left(), y), QPointF(plot.right(), y))
        if below - y < 12:
            continue
        below = y
        painter.setPen(text)
        box = QRectF(0, y - 8, plot.left() - 6, 16)
        painter.drawText(box, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, f"{opacity:g}")
    metrics = painter.fontMetrics()
    most = max(int(plot.width() / 86), 2)
    span = places.axis.high - places.axis.low
    base = places.color_points.bottom() + 1
    unit = metrics.elidedText(unit, Qt.TextElideMode.ElideRight, int(0.25 * plot.width()))
    unit_width = metrics.horizontalAdvance(unit) + 8 if unit else 0
    if unit:
        box = QRectF(plot.right() - unit_width + 6, base, unit_width, 16)
        painter.drawText(box, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, unit)
    last_end = -1e9
    for tick in places.axis.ticks(most):
        x = places.x(tick)
        if not plot.left() - 1 <= x <= plot.right() + 1:
            continue
        painter.setPen(grid)
        painter.drawLine(QPointF(round(x) + 0.5, plot.top()), QPointF(round(x) + 0.5, plot.bottom()))
        label = value_text(tick, span)
        wide = metrics.horizontalAdvance(label) + 8.0
        left = min(max(x - wide / 2, 0.0), places.width - wide)
        if left < last_end or left + wide > plot.right() - unit_width + 6:
            continue
        last_end = left + wide
        painter.setPen(text)
        painter.drawText(QRectF(left, base, wide, 16), Qt.AlignmentFlag.AlignCenter, label)
    _shade_outside(painter, places, palette)


def _shade_outside(painter: QPainter, places: PlotLayout, palette: QPalette) -> None:
    plot = places.plot
    shade = with_alpha(palette.color(Role.Mid), 0.35)
    low, high = places.x(places.axis.data_low), places.x(places.axis.data_high)
    if low > plot.left():
        painter.fillRect(
            QRectF(plot.left(), plot.top(), min(low, plot.right()) - plot.left(), plot.height()), shade
        )
    if high < plot.right():
        painter.fillRect(
            QRectF(max(high, plot.left()), plot.top(), plot.right() - max(high, plot.left()), plot.height()),
            shade,
        )


def histogram_path(places: PlotLayout, counts: Counts, logarithmic: bool) -> QPainterPath:
    """Outline of the histogram over the window, one column a pixel.

    With linear counts the tallest hundredth of the columns is cut off: a peak of air would flatten the rest.
    """
    plot = places.plot
    columns = max(int(plot.width()), 2)
    values = places.axis.values((np.arange(columns) + 0.5) / columns)
    # voxels per unit of value: a peak is as high on a logarithmic axis as on a linear one, only wider
    span = places.axis.high - places.axis.low
    heights = counts.density(values, np.gradient(values)) * (span / columns)
    if not heights.any():
        return QPainterPath()
    if logarithmic:
        heights = np.log1p(heights)
        top = float(heights.max())
    else:
        positive = heights[heights > 0]
        top = float(np.quantile(positive, 0.99)) if len(positive) > 20 else float(positive.max())
    heights = np.minimum(heights / max(top, 1e-12), 1.0) * (plot.height() - 4)
    path = QPainterPath(QPointF(plot.left(), plot.bottom()))
    step = plot.width() / columns
    for i, height in enumerate(heights.tolist()):
        path.lineTo(plot.left() + (i + 0.5) * step, plot.bottom() - height)
    path.lineTo(plot.right(), plot.bottom())
    path.closeSubpath()
    return path


def strip_image(places: PlotLayout, function: TransferFunction, columns: int) -> QImage:
    """The opaque colours of the function over the window, one row of pixels."""
    values = places.axis.values((np.arange(columns) + 0.5) / columns)
    rgb = np.rint(function.evaluate(values)[:, :3] * 255.0).astype(np.uint8)
    pixels = np.full((1, columns, 4), 255, np.uint8)
    pixels[0, :, :3] = rgb
    qimage = QImage(pixels.tobytes(), columns, 1, 4 * columns, QImage.Format.Format_RGBA8888)
    return qimage.copy()


def curve_polygon(places: PlotLayout, function: TransferFunction, factor: float = 1.0) -> QPolygonF:
    """The opacity curve over the window; sampled, since straight lines bend on a fine opacity axis."""
    plot = places.plot
    samples = places.axis.values(np.arange(0.0, plot.width() + 1.0, 2.5) / plot.width())
    opacities = function.with_opacity(1.0).evaluate(samples)[:, 3]
    bends = [p for p in function.points if places.axis.low <= p.value <= places.axis.high]
    values = np.concatenate([samples, [p.value for p in bends]])
    levels = np.concatenate([opacities, [p.opacity for p in bends]])
    # Stable, and samples stand first: at a jump the two points follow one another and the line is upright.
    order = np.argsort(values, kind="stable")
    x = plot.left() + places.axis.fractions(values[order]) * plot.width()
    y = plot.bottom() - places.opacities.fractions(levels[order] * factor) * plot.height()
    return QPolygonF([QPointF(a, b) for a, b in zip(x.tolist(), y.tolist(), strict=True)])


def paint_area(painter: QPainter, places: PlotLayout, curve: QPolygonF, strip: QImage) -> None:
    """The area under the curve in the colours of the function."""
    plot = places.plot
    area = QPainterPath()
    area.addPolygon(curve)
    area.lineTo(plot.right(), plot.bottom())
    area.lineTo(plot.left(), plot.bottom())
    area.closeSubpath()
    painter.save()
    painter.setClipRect(plot)
    painter.setClipPath(area, Qt.ClipOperation.IntersectClip)
    painter.setOpacity(0.5)
    painter.drawImage(plot, strip)
    painter.restore()


def paint_curve(
    painter: QPainter, places: PlotLayout, curve: QPolygonF, palette: QPalette, *, dashed: bool
) -> None:
    """The line of the curve."""
    color = palette.color(Role.Text)
    pen = QPen(with_alpha(color, 0.55 if dashed else 0.95), 1.2 if dashed else 1.8)
    pen.setStyle(Qt.PenStyle.DashLine if dashed else Qt.PenStyle.SolidLine)
    # round joins cost a multiple, and between samples so near there is nothing to round
    pen.setJoinStyle(Qt.PenJoinStyle.BevelJoin)
    painter.save()
    painter.setClipRect(places.plot.adjusted(0, -3, 0, 3))
    painter.setPen(pen)
    painter.drawPolyline(curve)
    painter.restore()


def paint_points(
    painter: QPainter,
    places: PlotLayout,
    function: TransferFunction,
    selection: frozenset[int],
    hovered: int,
    palette: QPalette,
    *,
    focused: bool,
) -> None:
    """The control points: chosen ones on top, ringed in the accent colour."""
    accent, base, text = (palette.color(r) for r in (Role.Highlight, Role.Base, Role.Text))
    order = sorted(range(len(function.points)), key=lambda i: (i in selection, i))
    for i in order:
        p = function.points[i]
        if not places.is_visible(p.value):
            continue
        center = places.point(p.value, p.opacity)
        if i in selection:
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(with_alpha(accent, 0.35 if focused else 0.22))
            painter.drawEllipse(center, RADIUS + 5, RADIUS + 5)
        elif i == hovered:
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(with_alpha(text, 0.16))
            painter.drawEllipse(center, RADIUS + 5, RADIUS + 5)
        painter.setPen(QPen(base, 4.2))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawEllipse(center, RADIUS, RADIUS)
        painter.setPen(QPen(accent if i in selection else text, 2.0))
        painter.setBrush(color_of(p.color))
        painter.drawEllipse(center, RADIUS, RADIUS)


def paint_ramp(
    painter: QPainter,
    places: PlotLayout,
    strip: QImage,
    colors: Channel,
    chosen: int | None,
    hovered: int,
    palette: QPalette,
) -> None:
    """The colour ramp and the handles of its stops."""
    ramp = places.ramp
    path = QPainterPath()
    path.addRoundedRect(ramp, 3, 3)
    painter.save()
    painter.setClipPath(path)
    painter.drawImage(ramp, strip)
    painter.restore()
    painter.setPen(QPen(palette.color(Role.Mid), 1.0))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.drawPath(path)
    accent, text = palette.color(Role.Highlight), palette.color(Role.Text)
    top = ramp.bottom() + 1.0
    for i, color_point in enumerate(colors):
        if not places.is_visible(color_point.value):
            continue
        x = places.x(color_point.value)
        handle = QPolygonF(
            [QPointF(x, top), QPointF(x + 5, top + 5), QPointF(x + 5, top + 12), QPointF(x - 5, top + 12),
             QPointF(x - 5, top + 5)]
        )  # fmt: skip
        wide = 2.2 if i in (chosen, hovered) else 1.2
        painter.setPen(QPen(accent if i == chosen else with_alpha(text, 0.8), wide))
        painter.setBrush(color_of(color_point.level))
        painter.drawPolygon(handle)


def paint_edges(
    painter: QPainter, places: PlotLayout, function: TransferFunction, palette: QPalette, font: QFont
) -> None:
    """Markers that tell how many points lie outside the window."""
    left, right = places.outside(function)
    painter.setFont(small_font(font))
    for is_right, there in ((False, left), (True, right)):
        if not there:
            continue
        box = places.edge_marker(is_right)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(with_alpha(palette.color(Role.Highlight), 0.92))
        painter.drawRoundedRect(box, 5, 5)
        painter.setPen(palette.color(Role.HighlightedText))
        label = f"{len(there)} ▸" if is_right else f"◂ {len(there)}"
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, label)


def paint_markers(
    painter: QPainter,
    places: PlotLayout,
    markers: tuple[float, ...],
    colors: tuple[tuple[float, float, float], ...],
    palette: QPalette,
    chosen: int = -1,
) -> None:
    """Isovalues: an upright line with a grip at the top; the chosen one in the accent colour."""
    plot = places.plot
    for i, value in enumerate(markers):
        if not places.is_visible(value):
            continue
        x = places.x(value)
        color = color_of(colors[i]) if i < len(colors) else palette.color(Role.Highlight)
        painter.setPen(QPen(palette.color(Role.Base), 3.5))
        painter.drawLine(QPointF(x, plot.top()), QPointF(x, plot.bottom()))
        line = palette.color(Role.Highlight if i == chosen else Role.Text)
        painter.setPen(QPen(line, 2.4 if i == chosen else 1.4))
        painter.drawLine(QPointF(x, plot.top()), QPointF(x, plot.bottom()))
        grip = QPolygonF(
            [QPointF(x - 7, plot.top() - 7), QPointF(x + 7, plot.top() - 7), QPointF(x, plot.top() + 6)]
        )
        painter.setBrush(color)
        painter.drawPolygon(grip)


def paint_highlight(painter: QPainter, places: PlotLayout, value: float, palette: QPalette) -> None:
    """A value that something else points at, the ray inspector say."""
    if places.is_visible(value):
        pen = QPen(palette.color(Role.Highlight), 1.4)
        pen.setStyle(Qt.PenStyle.DotLine)
        painter.setPen(pen)
        x = places.x(value)
        painter.drawLine(QPointF(x, places.plot.top()), QPointF(x, places.ramp.bottom()))


def paint_note(painter: QPainter, places: PlotLayout, text: str, palette: QPalette, font: QFont) -> None:
    """A line of words at the top right of the plot, on a faint ground."""
    if not text:
        return
    painter.setFont(small_font(font))
    width = painter.fontMetrics().horizontalAdvance(text) + 14
    box = QRectF(places.plot.right() - width - 4, places.plot.top() + 4, width, 19)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(with_alpha(palette.color(Role.Window), 0.85))
    painter.drawRoundedRect(box, 4, 4)
    painter.setPen(palette.color(Role.Text))
    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)


def thumbnail(
    function: TransferFunction, data_range: tuple[float, float], width: int, height: int, ratio: float
) -> QImage:
    """A small image of a function: its colours under its opacity curve, on black."""
    columns, rows = round(width * ratio), round(height * ratio)
    low, high = data_range
    shown = function.visible_range(data_range)
    if shown is not None:
        reach = 0.15 * max(shown[1] - shown[0], 1e-9)
        low, high = max(low, shown[0] - reach), min(high, shown[1] + reach)
    rgba = function.evaluate(np.linspace(low, high, columns), data_range)
    heights = 0.15 + 0.8 * rgba[:, 3] ** 0.4
    level: npt.NDArray[np.float64] = (np.arange(rows)[::-1, None] + 0.5) / rows
    # two rows of softness at the edge of the curve
    inside = np.clip((heights[None] - level) * rows / 2 + 0.5, 0.0, 1.0)[..., None]
    image = 0.055 + inside * (rgba[None, :, :3] * 0.95)
    pixels = np.full((rows, columns, 4), 255, np.uint8)
    pixels[..., :3] = np.rint(np.clip(image, 0, 1) * 255)
    qimage = QImage(pixels.tobytes(), columns, rows, 4 * columns, QImage.Format.Format_RGBA8888).copy()
    qimage.setDevicePixelRatio(ratio)
    return qimage
