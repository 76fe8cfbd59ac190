"""The plot as an image: which window of values it shows, and how it is painted."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QFocusEvent,
    QImage,
    QPainter,
    QPainterPath,
    QPaintEvent,
    QPalette,
    QPen,
    QPixmap,
    QPolygonF,
    QResizeEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from volviz.model.ticks import value_text
from volviz_ui.style.theme import is_palette_change
from volviz_ui.transfer_editor import painting
from volviz_ui.transfer_editor.axes import OpacityAxis, ValueAxis
from volviz_ui.transfer_editor.items import Hit, PlotLayout

if TYPE_CHECKING:
    from volviz_ui.transfer_editor.histogram_worker import HistogramWorker
    from volviz_ui.transfer_editor.model import EditorModel


class PlotView(QWidget):
    """Curve over histogram, colour ramp, points; `TransferPlot` adds what mouse and keyboard do.

    Parameters
    ----------
    model : EditorModel
        What is shown.
    counter : HistogramWorker
        Source of the histogram.
    parent : QWidget
        Owner.
    """

    axis_changed = Signal()

    def __init__(self, model: EditorModel, counter: HistogramWorker, parent: QWidget) -> None:
        super().__init__(parent)
        self.model = model
        self.counter = counter
        self.axis = ValueAxis.of_range(*model.data_range)
        self.opacities = OpacityAxis()
        self.log_counts = True
        self.band: QRectF | None = None
        self.markers: tuple[float, ...] = ()
        self.marker_colors: tuple[tuple[float, float, float], ...] = ()
        self.marker = -1
        """Isovalue chosen by the keyboard, -1 for none."""
        self._highlight: float | None = None
        self._under = Hit("none")
        self._pointer: QPointF | None = None
        self._histogram: QPainterPath | None = None
        self._ground: QPixmap | None = None
        self._curve: QPolygonF | None = None
        self._strip: QImage | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(240, 120)
        self.setAccessibleName(self.tr("Transfer function"))
        self.setAccessibleDescription(
            self.tr(
                "Opacity curve over the histogram. Page Up and Page Down choose a point, arrow keys move it."
            )
        )
        model.function_changed.connect(self._on_function_changed)
        model.selection_changed.connect(self._on_selection_changed)
        model.range_changed.connect(self._on_range_changed)
        counter.changed.connect(self._on_counted)
        self._on_range_changed()

    def sizeHint(self) -> QSize:
        """Wide and low."""
        return QSize(900, 170)

    # ------------------------------------------------------------------ what is shown

    @property
    def places(self) -> PlotLayout:
        """Where everything lies now."""
        return PlotLayout(self.width(), self.height(), self.axis, self.opacities)

    def set_axis(self, axis: ValueAxis) -> None:
        """Show another window of values."""
        if axis != self.axis:
            self.axis = axis
            self._forget(histogram=True)
            self.axis_changed.emit()

    def set_log_counts(self, logarithmic: bool) -> None:
        """Heights of the histogram by the logarithm of the counts."""
        self.log_counts = logarithmic
        self._forget(histogram=True)

    def set_log_values(self, logarithmic: bool) -> None:
        """Spread the values logarithmically."""
        self.set_axis(self.axis.toggled(logarithmic))

    def set_fine_opacity(self, fine: bool) -> None:
        """Give small opacities room."""
        self.opacities = OpacityAxis(fine)
        self._forget(histogram=True)

    def set_markers(
        self, values: tuple[float, ...], colors: tuple[tuple[float, float, float], ...] = ()
    ) -> None:
        """Show isovalues; `marker_moved` tells when the user drags one."""
        if (values, colors) != (self.markers, self.marker_colors):
            self.markers, self.marker_colors = tuple(values), tuple(colors)
            self.marker = min(self.marker, len(self.markers) - 1)
            self.update()

    def set_highlight(self, value: float | None) -> None:
        """Mark a value, or none."""
        if value != self._highlight:
            self._highlight = value
            self.update()

    def fit_data(self) -> None:
        """Show the range of the data."""
        self.set_axis(self.axis.with_points(self.axis.data_low, self.axis.data_high))

    def fit_function(self) -> None:
        """Show all points."""
        function = self.model.function
        if function is not None:
            self.set_axis(self.axis.showing(function.points[0].value, function.points[-1].value))

    def fit_percentiles(self, low: float = 0.5, high: float = 99.5) -> None:
        """Show the values between two percentiles of the voxels."""
        counts = self.counter.counts
        if counts is not None:
            self.set_axis(self.axis.showing(*counts.percentiles(low, high)))

    def zoom(self, factor: float, at: float = 0.5) -> None:
        """Narrow the window by a factor about a fraction of its width."""
        self.set_axis(self.axis.zoomed(factor, at))

    # ------------------------------------------------------------------ painting

    def paintEvent(self, _event: QPaintEvent) -> None:
        """All layers; outline, curve and ramp are kept until something changes them."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        palette, places, function = self.palette(), self.places, self.model.function
        painter.drawPixmap(0, 0, self._drawn_ground(places))
        if function is None:
            painter.setPen(palette.color(QPalette.ColorRole.PlaceholderText))
            painter.drawText(
                places.plot,
                Qt.AlignmentFlag.AlignCenter,
                self.tr("Open a volume to edit its colours and opacities"),
            )
            return
        if self._curve is None or self._strip is None:
            self._curve = painting.curve_polygon(places, function)
            columns = max(round(places.plot.width() * self.devicePixelRatioF()), 2)
            self._strip = painting.strip_image(places, function, columns)
        painting.paint_area(painter, places, self._curve, self._strip)
        if function.opacity < 1.0:
            thin = painting.curve_polygon(places, function, function.opacity)
            painting.paint_curve(painter, places, thin, palette, dashed=True)
        self._paint_border(painter, places, palette)
        painting.paint_curve(painter, places, self._curve, palette, dashed=False)
        if self._highlight is not None:
            painting.paint_highlight(painter, places, self._highlight, palette)
        painting.paint_markers(painter, places, self.markers, self.marker_colors, palette, self.marker)
        under = self._under
        painting.paint_points(
            painter, places, function, self.model.selection, under.index if under.part == "point" else -1,
            palette, focused=self.hasFocus(),
        )  # fmt: skip
        painting.paint_ramp(
            painter, places, self._strip, self.model.channels[0], self.model.color_point,
            under.index if under.part == "stop" else -1, palette,
        )  # fmt: skip
        painting.paint_edges(painter, places, function, palette, self.font())
        if self.band is not None:
            accent = palette.color(QPalette.ColorRole.Highlight)
            painter.setPen(QPen(accent, 1.0))
            painter.setBrush(painting.with_alpha(accent, 0.15))
            painter.drawRect(self.band)
        painting.paint_note(painter, places, self.note(), palette, self.font())

    def note(self) -> str:
        """Words on what lies under the pointer: value, voxels, opacity."""
        function, pointer = self.model.function, self._pointer
        if function is None or pointer is None or not self.rect().contains(pointer.toPoint()):
            return ""
        value = self.places.value(pointer.x())
        if self._under.part == "point" and self._under.index < len(function.points):
            value = function.points[self._under.index].value
        words = [f"{value_text(value, self.axis.high - self.axis.low)} {self.model.unit}".strip()]
        counts = self.counter.counts
        if counts is not None:
            step = (self.axis.high - self.axis.low) / max(self.places.plot.width(), 1)
            voxels = counts.in_intervals(np.array([value - step / 2, value + step / 2]))[0]
            words.append(self.tr("%1 voxels").replace("%1", f"{round(voxels):,}".replace(",", "\u202f")))
        opacity = float(function.evaluate([value])[0, 3])
        words.append(self.tr("opacity %1").replace("%1", f"{opacity:.3g}"))
        return "  ·  ".join(words)

    def _drawn_ground(self, places: PlotLayout) -> QPixmap:
        """Axes and histogram: kept while a point is dragged, since lines of text and counts take their time."""
        ratio = self.devicePixelRatioF()
        if self._ground is None or self._ground.devicePixelRatio() != ratio:
            self._ground = QPixmap(self.size() * ratio)
            self._ground.setDevicePixelRatio(ratio)
            self._ground.fill(Qt.GlobalColor.transparent)
            painter = QPainter(self._ground)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painting.paint_frame(painter, places, self.palette(), self.model.unit, self.font())
            self._paint_histogram(painter, places, self.palette())
            painter.end()
        return self._ground

    def _paint_histogram(self, painter: QPainter, places: PlotLayout, palette: QPalette) -> None:
        counts = self.counter.counts
        if counts is None:
            return
        if self._histogram is None:
            self._histogram = painting.histogram_path(places, counts, self.log_counts)
        painter.save()
        painter.setClipRect(places.plot)
        painter.setPen(Qt.PenStyle.NoPen)
        quiet = palette.color(QPalette.ColorRole.PlaceholderText)
        painter.setBrush(painting.with_alpha(quiet, 0.34 if self.counter.is_done else 0.24))
        painter.drawPath(self._histogram)
        painter.restore()

    def _paint_border(self, painter: QPainter, places: PlotLayout, palette: QPalette) -> None:
        focused = self.hasFocus()
        color = palette.color(QPalette.ColorRole.Highlight if focused else QPalette.ColorRole.Mid)
        painter.setPen(QPen(color, 1.4 if focused else 1.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRoundedRect(places.plot, 3, 3)

    # ------------------------------------------------------------------ changes from outside

    def resizeEvent(self, _event: QResizeEvent) -> None:
        """Outlines fit the old size only."""
        self._forget(histogram=True)

    def changeEvent(self, event: QEvent) -> None:
        """Another palette or font is drawn at once."""
        changes = (QEvent.Type.FontChange, QEvent.Type.StyleChange, QEvent.Type.EnabledChange)
        if is_palette_change(event) or event.type() in changes:
            self._forget(histogram=True)
        super().changeEvent(event)

    def focusInEvent(self, event: QFocusEvent) -> None:
        """The frame shows the focus."""
        super().focusInEvent(event)
        self.update()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """The frame shows that the focus has gone."""
        super().focusOutEvent(event)
        self.update()

    def _on_function_changed(self) -> None:
        self._forget()

    def _on_selection_changed(self) -> None:
        if self.model.selection or self.model.color_point is not None:
            self.marker = -1
        self._describe()
        self.update()

    def _on_range_changed(self) -> None:
        low, high = self.model.data_range
        axis = ValueAxis.of_range(low, high, logarithmic=self.axis.logarithmic)
        function = self.model.function
        if function is not None:
            axis = axis.with_points(function.points[0].value, function.points[-1].value)
        self.set_axis(axis)
        self._forget(histogram=True)

    def _on_counted(self) -> None:
        self._forget(histogram=True)

    def _forget(self, *, histogram: bool = False) -> None:
        self._curve = self._strip = None
        if histogram:
            self._histogram = self._ground = None
        self.update()

    def describe_marker(self) -> None:
        """Tell a screen reader which isovalue is chosen."""
        if self.marker >= 0:
            words = self.tr("Isovalue %1 of %2: %3").replace("%1", str(self.marker + 1))
            words = words.replace("%2", str(len(self.markers)))
            self.setAccessibleDescription(
                words.replace("%3", f"{self.markers[self.marker]:.6g} {self.model.unit}".strip())
            )

    def _describe(self) -> None:
        """Tell a screen reader what is chosen."""
        function, chosen = self.model.function, sorted(self.model.selection)
        color_point, colors = self.model.color_point, self.model.channels[0]
        if function is not None and color_point is not None and color_point < len(colors):
            words = self.tr("Colour %1 of %2: value %3").replace("%1", str(color_point + 1))
            words = words.replace("%2", str(len(colors)))
            self.setAccessibleDescription(
                words.replace("%3", f"{colors[color_point].value:.6g} {self.model.unit}".strip())
            )
            return
        if function is None or not chosen:
            return
        point = function.points[chosen[0]]
        words = self.tr("Point %1 of %2: value %3, opacity %4")
        for mark, text in (
            ("%1", str(chosen[0] + 1)),
            ("%2", str(len(function.points))),
            ("%3", f"{point.value:.6g} {self.model.unit}".strip()),
            ("%4", f"{point.opacity:.3g}"),
        ):
            words = words.replace(mark, text)
        self.setAccessibleDescription(words)
