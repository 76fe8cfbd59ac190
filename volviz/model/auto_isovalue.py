"""The first isovalue of a data set nobody has seen."""

from __future__ import annotations

from threading import Lock
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from volviz.kernels.histogram import even_histogram
from volviz.model.transfer.first_look import FirstLook

if TYPE_CHECKING:
    from volviz.volume_data.volume import Volume

BINS = 128

_lock = Lock()
_known: WeakKeyDictionary[Volume, float] = WeakKeyDictionary()


def auto_isovalue(volume: Volume) -> float:
    """The value that best splits the object from what surrounds it, for a first surface.

    Otsu's threshold (Otsu 1979: least variance within the two classes) of the histogram in which every voxel
    counts by its gradient magnitude, so that borders decide and not the amount of air around them. Ties
    between equally good cuts, wide gaps in the histogram say, end in their middle.

    Parameters
    ----------
    volume : Volume
        Any data; `FirstLook` looks at a lattice of it, once.

    Returns
    -------
    float
        In data units, inside the range without outliers; the only value of a constant volume.
    """
    with _lock:
        known = _known.get(volume)
    if known is None:
        known = _otsu_by_gradient(volume)
        with _lock:
            _known[volume] = known
    return known


def keep_isovalue(volume: Volume, value: float) -> None:
    """Let `auto_isovalue` of a volume be another value: that of the first time point of a series, say."""
    with _lock:
        _known[volume] = value


def _otsu_by_gradient(volume: Volume) -> float:
    look = FirstLook.at(volume)
    if look is None:
        return volume.data_range[0]
    weights = look.gradient.ravel()
    counts, edges = even_histogram(look.values.ravel(), BINS, look.low, look.high, weights)
    mass = np.cumsum(counts)[:-1]
    moment = np.cumsum(counts * (np.arange(BINS) + 0.5))[:-1]
    total, mean = counts.sum(), (counts * (np.arange(BINS) + 0.5)).sum()
    if not total > 0:
        return (look.low + look.high) / 2
    other = total - mass
    with np.errstate(divide="ignore", invalid="ignore"):
        between = (mean * mass - total * moment) ** 2 / (mass * other)
    between = np.where((mass > 0) & (other > 1e-12 * total), between, 0.0)
    best = np.flatnonzero(between >= between.max() * (1 - 1e-9))
    return float((edges[best[0] + 1] + edges[best[-1] + 1]) / 2)
