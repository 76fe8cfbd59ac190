"""Range of a volume, plane by plane and without a copy."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.kernels.arrays import check_scalars, native_slab
from volviz.kernels.threads import map_ranges

AnyArray = npt.NDArray[Any]

#: Planes read at a time: bounds the memory that arrays of foreign byte order need for conversion.
_PLANES = 8


class FiniteRange(NamedTuple):
    """What `finite_range` finds.

    Attributes
    ----------
    low, high : float
        Lowest and highest finite value, in data units; (0, 0) when no value is finite.
    nonfinite : int
        Number of NaN and infinite values.
    """

    low: float
    high: float
    nonfinite: int


def finite_range(array: AnyArray) -> FiniteRange:
    """Lowest and highest finite value and the number of values that are not finite.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars of any real type and byte order; read plane by plane, never copied as a whole.

    Returns
    -------
    FiniteRange
        A named tuple (low, high, nonfinite).

    Raises
    ------
    InputError
        Not a three-dimensional array of numbers.
    """
    check_scalars(array)
    depth = array.shape[0]
    chunks = (depth + _PLANES - 1) // _PLANES

    def scan(first: int, last: int) -> tuple[list[float], list[float], int]:
        lows, highs, nonfinite = [], [], 0
        for chunk in range(first, last):
            slab = native_slab(array, chunk * _PLANES, min((chunk + 1) * _PLANES, depth))
            low, high = slab.min(), slab.max()
            # NaN passes through both, and infinities are extremes
            if not (np.isfinite(low) and np.isfinite(high)):
                finite = slab[np.isfinite(slab)]
                nonfinite += slab.size - finite.size
                if not finite.size:
                    continue
                low, high = finite.min(), finite.max()
            lows.append(low)
            highs.append(high)
        return lows, highs, nonfinite

    pieces = map_ranges(scan, chunks)
    lows = [v for piece in pieces for v in piece[0]]
    highs = [v for piece in pieces for v in piece[1]]
    nonfinite = sum(piece[2] for piece in pieces)
    if not lows:
        return FiniteRange(0.0, 0.0, nonfinite)
    return FiniteRange(float(min(lows)), float(max(highs)), nonfinite)


def percentiles(
    counts: npt.ArrayLike, edges: npt.ArrayLike, percent: npt.ArrayLike
) -> npt.NDArray[np.float64]:
    """Values below which given shares of the voxels lie, from a histogram.

    Parameters
    ----------
    counts : array_like of shape (bins,)
        Voxels per bin.
    edges : array_like of shape (bins + 1,)
        Limits of the bins in data units, ascending.
    percent : array_like of any shape
        Shares in percent, 0..100.

    Returns
    -------
    ndarray of the shape of `percent`, float64
        Values in data units, linear inside a bin; exact to the width of a bin. NaN when the histogram is
        empty.
    """
    voxels = np.asarray(counts, np.float64)
    limits = np.asarray(edges, np.float64)
    share = np.asarray(percent, np.float64) / 100.0
    total = voxels.sum()
    if total == 0:
        return np.full(share.shape, np.nan)
    cumulative = np.concatenate(([0.0], np.cumsum(voxels))) / total
    # empty bins make steps of zero height: the first of equal nodes ends a run, the last begins the next
    used = voxels > 0
    x = np.stack([limits[:-1][used], limits[1:][used]], axis=1).ravel()
    y = np.stack([cumulative[:-1][used], cumulative[1:][used]], axis=1).ravel()
    return np.asarray(np.interp(share, y, x), np.float64)
