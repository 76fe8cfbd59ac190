"""The joint histogram of value and gradient magnitude, counted on a worker."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QObject, Signal, Slot

from volviz.kernels.histogram import JointHistogram, progressive_joint_histogram
from volviz_ui.transfer_editor.counting import bins_of
from volviz_ui.workers import Task, Workers

if TYPE_CHECKING:
    from volviz.model.volume import Volume

BINS = (512, 192)


class _Relay(QObject):
    counted = Signal(object)


class JointCounter(QObject):
    """Counts one volume at a time, when first asked; `changed` tells of each better result."""

    changed = Signal()

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.histogram: JointHistogram | None = None
        self._volume: Volume | None = None
        self._asked: Volume | None = None
        self._stop = threading.Event()
        self._workers = Workers(self)
        self._relay = _Relay(self)
        self._relay.counted.connect(self._on_counted)

    def set_volume(self, volume: Volume | None) -> None:
        """Forget the old counts; `count` begins with the new volume."""
        self._stop.set()
        self.histogram, self._volume, self._asked = None, volume, None
        self.changed.emit()

    def count(self) -> None:
        """Begin to count, unless that has been done or is being done."""
        volume = self._volume
        if volume is None or volume is self._asked:
            return
        self._asked = volume
        self._stop = stop = threading.Event()
        self._workers.destroyed.connect(stop.set)
        relay = self._relay

        # whole numbers fill whole bins, or a comb of empty ones appears
        columns, limits = bins_of(volume, BINS[0])

        def work(_task: Task) -> None:
            for result in progressive_joint_histogram(
                volume.array,
                volume.spacing,
                bins=(columns, BINS[1]),
                value_range=limits,
                cancel=stop.is_set,
            ):
                if stop.is_set():
                    return
                relay.counted.emit((stop, result))

        self._workers.start(work, key="joint histogram")

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

    def wait(self) -> None:
        """Stop and wait for the worker."""
        self._stop.set()
        self._workers.close()

    @Slot(object)
    def _on_counted(self, message: Any) -> None:
        stop, histogram = message
        if stop is self._stop:
            self.histogram = histogram
            self.changed.emit()
