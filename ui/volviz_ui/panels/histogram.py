"""A small histogram of the volume: how often each value occurs, on a logarithmic scale."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Slot
from PySide6.QtGui import QMouseEvent, QPainter, QPaintEvent, QPalette, QPen, QPolygonF
from PySide6.QtWidgets import QSizePolicy, QToolTip, QWidget

from volviz.kernels.histogram import progressive_histogram
from volviz.volume_data.volume import Volume
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import volume_of
from volviz_ui.session.workers import Task, Workers
from volviz_ui.widgets.binding import show_value

BINS = 256


def count_values(volume: Volume, task: Task | None = None) -> npt.NDArray[np.int64]:
    """Number of finite values in each of at most `BINS` equal parts of the range of the volume.

    Whole numbers get parts that hold equally many of them, or the outline would be a comb. Runs on a worker;
    `Cancelled` is raised when the task is cancelled.
    """
    low, high = volume.range
    bins = BINS
    if volume.array.dtype.kind in "iu":
        values = int(high - low) + 1
        each = -(-values // BINS)
        bins = -(-values // each)
        low, high = low - 0.5, low - 0.5 + bins * each
    high = max(high, low + 1e-9)
    for part in progressive_histogram(volume.array, bins, (low, high)):
        if task is not None:
            task.report(part.done)
    return part.counts


class HistogramView(QWidget):
    """Paints the counts; tells value and count under the pointer."""

    def __init__(self, documents: Documents, workers: Workers, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._workers = workers
        self._volume: Volume | None = None
        self.counts: npt.NDArray[np.int64] | None = None
        self.setMouseTracking(True)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setToolTip(self.tr("How often each value occurs; the counts are on a logarithmic scale"))
        self.setAccessibleName(self.tr("Histogram"))
        show_value(documents, volume_of, self._count)

    def sizeHint(self) -> QSize:
        """Low and wide."""
        return QSize(200, 64)

    def _count(self, volume: Volume | None) -> None:
        self._volume = volume
        self.counts = None
        self.update()
        if volume is not None:
            task = self._workers.start(lambda task: count_values(volume, task), key="histogram", patient=True)
            task.succeeded.connect(self._on_counted)

    @Slot(object)
    def _on_counted(self, counts: Any) -> None:
        self.counts = counts
        self.update()

    @property
    def words(self) -> str:
        """What stands in the place of counts that are not there yet."""
        gate = self._workers.gate
        if gate is not None and gate.is_held:
            return self.tr("Waits while time runs")
        return self.tr("Counting…")

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Say which value lies under the pointer."""
        if self._volume is None or self.counts is None:
            return
        part = min(max(event.position().x() / max(self.width(), 1), 0.0), 1.0)
        low, high = self._volume.range
        index = min(int(part * len(self.counts)), len(self.counts) - 1)
        words = self.tr("%1: %2 voxels").replace(
            "%1", f"{low + part * (high - low):.5g} {self._volume.unit}".strip()
        )
        words = words.replace("%2", f"{int(self.counts[index]):,}".replace(",", " "))
        QToolTip.showText(event.globalPosition().toPoint(), words, self)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the outline and fill it."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        palette = self.palette()
        frame = QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5)
        painter.setPen(QPen(palette.color(QPalette.ColorRole.Mid)))
        painter.setBrush(palette.color(QPalette.ColorRole.Base))
        painter.drawRoundedRect(frame, 3, 3)
        if self.counts is None:
            if self._volume is not None:
                painter.setPen(palette.color(QPalette.ColorRole.PlaceholderText))
                painter.drawText(frame, Qt.AlignmentFlag.AlignCenter, self.words)
            return
        heights = np.log1p(self.counts)
        heights = heights / max(float(heights.max()), 1e-9) * (frame.height() - 6)
        step = (frame.width() - 4) / len(heights)
        outline = QPolygonF([QPointF(frame.left() + 2, frame.bottom() - 1)])
        for index, height in enumerate(heights):
            x = frame.left() + 2 + index * step
            y = frame.bottom() - 1 - float(height)
            outline.append(QPointF(x, y))
            outline.append(QPointF(x + step, y))
        outline.append(QPointF(frame.right() - 2, frame.bottom() - 1))
        color = palette.color(QPalette.ColorRole.PlaceholderText)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(color)
        painter.drawPolygon(outline)
