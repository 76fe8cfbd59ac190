"""The histogram behind the curve, counted on a worker, shown while it grows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QObject, Signal, Slot

from volviz.kernels.histogram import progressive_histogram
from volviz.model.transfer.first_look import robust_range
from volviz_ui.session.workers import Task, Workers

if TYPE_CHECKING:
    from volviz.volume_data.volume import Volume

#: Bins of real-valued data, and the largest number for whole numbers.
BINS = 4096
WORK = "transfer histogram"


@dataclass(frozen=True)
class Counts:
    """Running sums over the bins, from which the count of any interval follows.

    Attributes
    ----------
    edges : ndarray of shape (n + 1,)
        Limits of the bins, ascending, data units.
    below : ndarray of shape (n + 1,)
        Voxels below each limit.
    """

    edges: npt.NDArray[np.float64]
    below: npt.NDArray[np.float64]

    @cached_property
    def grain(self) -> float:
        """Typical distance of values that occur: 1 of whole numbers, more where a scanner leaves values out."""
        used = self.edges[:-1][np.diff(self.below) > 0]
        return float(np.median(np.diff(used))) if len(used) > 8 else float(self.edges[1] - self.edges[0])

    def density(
        self, values: npt.NDArray[np.float64], widths: npt.NDArray[np.float64]
    ) -> npt.NDArray[np.float64]:
        """Voxels per unit of value around values, in windows of at least one grain: no comb of gaps appears."""
        half = np.maximum(widths, self.grain) / 2
        low = np.interp(values - half, self.edges, self.below)
        return np.asarray((np.interp(values + half, self.edges, self.below) - low) / (2 * half))

    def in_intervals(self, limits: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Voxels between consecutive limits, shape (len(limits) - 1,)."""
        return np.diff(np.interp(limits, self.edges, self.below))

    def percentiles(self, low: float, high: float) -> tuple[float, float]:
        """Values below which `low` and `high` per cent of the voxels lie."""
        total = self.below[-1]
        a, b = np.interp((low / 100 * total, high / 100 * total), self.below, self.edges)
        return float(a), float(b)


def bins_of(volume: Volume, most: int = BINS) -> tuple[int, tuple[float, float]]:
    """Number of bins and their range: one or several whole numbers a bin, so that no comb appears."""
    low, high = volume.range
    if volume.array.dtype.kind in "bui":
        each = max(1, -(-int(high - low + 1) // most))
        bins = -(-int(high - low + 1) // each)
        return bins, (low - 0.5, low - 0.5 + bins * each)
    return most, (low, high if high > low else low + 1.0)


class HistogramWorker(QObject):
    """Counts the values of one volume at a time; `changed` reports each better result."""

    changed = Signal()

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.counts: Counts | None = None
        self.is_done = False
        self.workers = Workers(self)

    def set_volume(self, volume: Volume | None) -> None:
        """Count another volume; what still runs for the old one is dropped."""
        self.workers.cancel(WORK)
        before = self.counts, self.is_done
        self.counts, self.is_done = None, volume is None
        if before != (self.counts, self.is_done):
            self.changed.emit()
        if volume is None:
            return

        def count(task: Task) -> None:
            for result in _progress(volume, lambda: task.is_cancelled):
                task.publish(result)

        self.workers.start(count, key=WORK, patient=True).published.connect(self._on_counted)

    def close(self) -> None:
        """Stop counting: the window closes."""
        self.workers.close()

    @Slot(object)
    def _on_counted(self, result: tuple[Counts, bool]) -> None:
        self.counts, self.is_done = result
        self.changed.emit()


def _progress(volume: Volume, cancel: Callable[[], bool]) -> Any:
    """Better and better counts: of the range without outliers where these leave the rest few bins."""
    bins, limits = bins_of(volume)
    coarse = None
    low, high = robust_range(volume)
    if volume.range[1] > volume.range[0] and high - low < 0.02 * (volume.range[1] - volume.range[0]):
        coarse = (low, high)
    for result in progressive_histogram(volume.array, bins, limits, cancel=cancel):
        counts = _sums(result.edges, result.counts)
        yield counts, result.done >= 1.0 and coarse is None
    if coarse is not None:
        for result in progressive_histogram(volume.array, BINS, coarse, cancel=cancel):
            if result.done >= 1.0:
                yield _joined(counts, _sums(result.edges, result.counts)), True


def _sums(edges: npt.NDArray[np.float64], counts: npt.NDArray[np.int64]) -> Counts:
    return Counts(edges, np.concatenate([[0.0], np.cumsum(counts, dtype=np.float64)]))


def _joined(wide: Counts, narrow: Counts) -> Counts:
    """The wide counts with the narrow range in fine bins."""
    left, right = wide.edges < narrow.edges[0], wide.edges > narrow.edges[-1]
    total = wide.below[-1]
    start = float(np.interp(narrow.edges[0], wide.edges, wide.below)) if left.any() else 0.0
    start = min(start, total - narrow.below[-1])
    below = np.concatenate([np.minimum(wide.below[left], start), start + narrow.below, wide.below[right]])
    edges = np.concatenate([wide.edges[left], narrow.edges, wide.edges[right]])
    return Counts(edges, np.maximum.accumulate(below))
