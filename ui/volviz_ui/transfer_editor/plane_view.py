"""The plane of value and gradient magnitude as an image: histogram, axes, regions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QImage, QPainter, QPainterPath, QPaintEvent, QPalette, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from volviz.model.ticks import round_values, value_text
from volviz.model.transfer.function_2d import Region, TransferFunction2D
from volviz_ui.transfer_editor import painting
from volviz_ui.transfer_editor.axes import ValueAxis
from volviz_ui.transfer_editor.items import BOTTOM, RIGHT, TOP

if TYPE_CHECKING:
    from volviz_ui.transfer_editor.joint import JointCounter
    from volviz_ui.transfer_editor.model import EditorModel

#: Room for the gradients' numbers.
LEFT = 56.0


class PlaneView(QWidget):
    """Regions over the joint histogram; `GradientPlot` adds what mouse and keyboard do.

    Parameters
    ----------
    model : EditorModel
        What is shown: the function's `by_gradient`.
    counter : JointCounter
        Source of the histogram.
    parent : QWidget
        Owner.
    """

    def __init__(self, model: EditorModel, counter: JointCounter, parent: QWidget) -> None:
        super().__init__(parent)
        self.model = model
        self.counter = counter
        self.axis = ValueAxis.of_range(*model.data_range)
        self.top = 1.0
        self.selected: int | None = None
        self._image: QImage | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(240, 120)
        self.setAccessibleName(self.tr("Transfer function over value and gradient"))
        model.range_changed.connect(self._on_range_changed)
        counter.changed.connect(self._on_counted)

    def sizeHint(self) -> QSize:
        """Wide and low."""
        return QSize(900, 170)

    @property
    def function(self) -> TransferFunction2D:
        """The regions; none when there is no function."""
        function = self.model.function
        by_gradient = None if function is None else function.by_gradient
        return by_gradient if by_gradient is not None else TransferFunction2D(enabled=False)

    @property
    def region(self) -> Region | None:
        """The chosen region."""
        regions = self.function.regions
        return regions[self.selected] if self.selected is not None and self.selected < len(regions) else None

    # ------------------------------------------------------------------ pixels

    @property
    def plot(self) -> QRectF:
        """Where the plane is drawn."""
        return QRectF(
            LEFT, TOP, max(self.width() - LEFT - RIGHT, 10.0), max(self.height() - TOP - BOTTOM - 4, 10.0)
        )

    def x(self, value: float) -> float:
        """Pixel of a value."""
        return self.plot.left() + self.axis.fraction(value) * self.plot.width()

    def y(self, gradient: float) -> float:
        """Pixel of a gradient."""
        return self.plot.bottom() - gradient / self.top * self.plot.height()

    def value(self, x: float) -> float:
        """Value at a pixel."""
        return self.axis.value((x - self.plot.left()) / self.plot.width())

    def gradient(self, y: float) -> float:
        """Gradient at a pixel."""
        return (self.plot.bottom() - y) / self.plot.height() * self.top

    def box(self, region: Region) -> QRectF:
        """Rectangle around a region."""
        left, right = self.x(region.value - region.width / 2), self.x(region.value + region.width / 2)
        top, bottom = self.y(region.gradient_high), self.y(region.gradient_low)
        return QRectF(left, top, right - left, bottom - top)

    # ------------------------------------------------------------------ painting

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Histogram, grid, regions."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        palette, plot = self.palette(), self.plot
        painter.fillRect(plot, palette.color(QPalette.ColorRole.Base))
        if self.counter.histogram is not None:
            if self._image is None:
                self._image = self._histogram_image()
            painter.drawImage(plot, self._image)
        self._paint_axes(painter, palette)
        painter.save()
        painter.setClipRect(plot)
        for i, region in enumerate(self.function.regions):
            self._paint_region(painter, region, chosen=i == self.selected)
        painter.restore()
        focused = self.hasFocus()
        role = QPalette.ColorRole.Highlight if focused else QPalette.ColorRole.Mid
        painter.setPen(QPen(palette.color(role), 1.4 if focused else 1.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRoundedRect(plot, 3, 3)
        if not self.function.regions:
            words = self.tr("Double-click to put a region on a border between materials")
            painter.setPen(palette.color(QPalette.ColorRole.Text))
            painter.drawText(plot, Qt.AlignmentFlag.AlignCenter, words)

    def _histogram_image(self) -> QImage:
        """Counts on a logarithmic scale as a veil of the text's colour, over the visible part of the plane."""
        histogram = self.counter.histogram
        assert histogram is not None
        columns, rows = max(round(self.plot.width()), 2), max(round(self.plot.height()), 2)
        values = self.axis.values((np.arange(columns) + 0.5) / columns)
        gradients = (np.arange(rows)[::-1] + 0.5) / rows * self.top
        i = np.searchsorted(histogram.value_edges, values, side="right") - 1
        j = np.searchsorted(histogram.gradient_edges, gradients, side="right") - 1
        inside = (j[:, None] >= 0) & (j[:, None] < len(histogram.counts))
        inside = inside & (i >= 0) & (i < histogram.counts.shape[1])
        counts = histogram.counts[np.clip(j, 0, len(histogram.counts) - 1)][
            :, np.clip(i, 0, histogram.counts.shape[1] - 1)
        ]
        level = np.log1p(np.where(inside, counts, 0))
        # the crowd of air at one place must not dim everything else
        top = float(np.quantile(level[level > 0], 0.995)) if (level > 0).any() else 1.0
        level = np.minimum(level / top, 1.0)
        color = self.palette().color(QPalette.ColorRole.Text)
        pixels = np.empty((rows, columns, 4), np.uint8)
        pixels[..., 0], pixels[..., 1], pixels[..., 2] = color.red(), color.green(), color.blue()
        pixels[..., 3] = np.rint(level * 190).astype(np.uint8)
        return QImage(pixels.tobytes(), columns, rows, 4 * columns, QImage.Format.Format_RGBA8888).copy()

    def _paint_axes(self, painter: QPainter, palette: QPalette) -> None:
        plot = self.plot
        painter.setFont(painting.small_font(self.font()))
        grid = QPen(painting.with_alpha(palette.color(QPalette.ColorRole.Mid), 0.6), 1.0)
        quiet = palette.color(QPalette.ColorRole.PlaceholderText)
        side = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        for tick in round_values(0.0, self.top, 4):
            y = round(self.y(tick)) + 0.5
            painter.setPen(grid)
            painter.drawLine(QPointF(plot.left(), y), QPointF(plot.right(), y))
            painter.setPen(quiet)
            painter.drawText(QRectF(0, y - 8, plot.left() - 6, 16), side, value_text(tick, self.top))
        for tick in self.axis.ticks(max(int(plot.width() / 86), 2)):
            x = round(self.x(tick)) + 0.5
            if plot.left() <= x <= plot.right():
                painter.setPen(grid)
                painter.drawLine(QPointF(x, plot.top()), QPointF(x, plot.bottom()))
                painter.setPen(quiet)
                label = value_text(tick, self.axis.high - self.axis.low)
                if x < plot.right() - 60:
                    painter.drawText(
                        QRectF(x - 40, plot.bottom() + 2, 80, 16), Qt.AlignmentFlag.AlignCenter, label
                    )
        painter.setPen(quiet)
        unit = f"{self.model.unit}/mm" if self.model.unit == "HU" else self.tr("per world unit")
        words = self.tr("Gradient (%1)").replace("%1", unit)
        painter.drawText(
            plot.adjusted(8, 4, 0, 0), Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop, words
        )
        painter.drawText(QRectF(plot.right() - 60, plot.bottom() + 2, 60, 16), side, self.model.unit)

    def _paint_region(self, painter: QPainter, region: Region, *, chosen: bool) -> None:
        box = self.box(region)
        path = QPainterPath()
        if region.kind == "rectangle":
            path.addRect(box)
        elif region.kind == "ellipse":
            path.addEllipse(box)
        else:
            path.moveTo(box.center().x(), box.bottom())
            path.lineTo(box.topLeft())
            path.lineTo(box.topRight())
            path.closeSubpath()
        color = painting.color_of(region.color)
        painter.setBrush(painting.with_alpha(color, 0.25 + 0.5 * region.opacity))
        accent = self.palette().color(QPalette.ColorRole.Highlight)
        painter.setPen(
            QPen(accent if chosen else self.palette().color(QPalette.ColorRole.Text), 2.2 if chosen else 1.3)
        )
        painter.drawPath(path)
        if chosen:
            painter.setBrush(self.palette().color(QPalette.ColorRole.Base))
            middle = box.center()
            for at in (
                QPointF(box.left(), middle.y()), QPointF(box.right(), middle.y()),
                QPointF(middle.x(), box.top()), QPointF(middle.x(), box.bottom()),
            ):  # fmt: skip
                painter.drawEllipse(at, 4.5, 4.5)

    # ------------------------------------------------------------------ changes from outside

    def resizeEvent(self, _event: QEvent) -> None:
        """The image fits the old size only."""
        self._image = None

    def changeEvent(self, event: QEvent) -> None:
        """Another palette is drawn at once."""
        self._image = None
        self.update()
        super().changeEvent(event)

    def _on_range_changed(self) -> None:
        self.axis = ValueAxis.of_range(*self.model.data_range)
        self._image = None
        self.update()

    def _on_counted(self) -> None:
        self.top = self.counter.gradient_top
        self._image = None
        self.update()
