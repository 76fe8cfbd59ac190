"""The joint histogram of value and gradient magnitude, counted on a worker."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, Signal, Slot

from volviz.kernels.histogram import JointHistogram, progressive_joint_histogram
from volviz_ui.session.workers import Task, Workers
from volviz_ui.transfer_editor.histogram_worker import bins_of

if TYPE_CHECKING:
    from volviz.volume_data.volume import Volume

BINS = (512, 192)
WORK = "joint histogram"


class JointCounter(QObject):
    """Counts one volume at a time, when first asked; `changed` reports each better result."""

    changed = Signal()

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.histogram: JointHistogram | None = None
        self._volume: Volume | None = None
        self._asked: Volume | None = None
        self._workers = Workers(self)

    def set_volume(self, volume: Volume | None) -> None:
        """Forget the old counts; `count` begins with the new volume."""
        self._workers.cancel(WORK)
        self.histogram, self._volume, self._asked = None, volume, None
        self.changed.emit()

    def count(self) -> None:
        """Begin to count, unless that has been done or is being done."""
        volume = self._volume
        if volume is None or volume is self._asked:
            return
        self._asked = volume
        # whole numbers fill whole bins, or a comb of empty ones appears
        columns, limits = bins_of(volume, BINS[0])

        def work(task: Task) -> None:
            for result in progressive_joint_histogram(
                volume.array,
                volume.spacing,
                bins=(columns, BINS[1]),
                value_range=limits,
                cancel=lambda: task.is_cancelled,
            ):
                task.publish(result)

        self._workers.start(work, key=WORK).published.connect(self._on_counted)

    @property
    def gradient_top(self) -> float:
        """Gradient up to which to draw: that of all but one in ten thousand voxels, and some room."""
        if self.histogram is None:
            return 1.0
        rows = self.histogram.counts.sum(axis=1).cumsum()
        edges = self.histogram.gradient_edges
        if not rows[-1]:
            return float(edges[-1])
        row = int(np.searchsorted(rows, 0.9999 * rows[-1]))
        return float(max(1.25 * edges[min(row + 1, len(edges) - 1)], edges[-1] * 0.05))

    def close(self) -> None:
        """Stop counting: the window closes."""
        self._workers.close()

    @Slot(object)
    def _on_counted(self, histogram: JointHistogram) -> None:
        self.histogram = histogram
        self.changed.emit()
