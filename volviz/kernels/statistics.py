"""Range of a volume, in one pass and without a copy."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.kernels.arrays import check_scalars, native_slab
from volviz.kernels.compiled import compiled
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
            slab = native_slab(array, chunk * _PLANES, min((chunk + 1) * _PLANES, depth)).reshape(-1)
            if slab.dtype.kind == "f":
                low, high, odd = _range_float(slab)
                nonfinite += odd
                if odd == slab.size:
                    continue
            else:
                low, high = _range_integer(slab)
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


@compiled
def _range_integer(values: AnyArray) -> Any:
    low = values[0]
    high = values[0]
    for v in values:
        low = min(low, v)
        high = max(high, v)
    return low, high


@compiled
def _range_float(values: AnyArray) -> Any:
    """Extremes of the finite values; eight lanes side by side, because one minimum waits for the last."""
    lanes = 8
    low = np.full(lanes, np.inf, values.dtype)
    high = np.full(lanes, -np.inf, values.dtype)
    odd = np.zeros(lanes, np.int64)
    whole = len(values) // lanes * lanes
    for i in range(0, whole, lanes):
        for k in range(lanes):
            v = values[i + k]
            finite = v - v == 0
            odd[k] += 0 if finite else 1
            low[k] = v if finite and v < low[k] else low[k]
            high[k] = v if finite and v > high[k] else high[k]
    for i in range(whole, len(values)):
        v = values[i]
        if v - v == 0:
            low[0] = min(low[0], v)
            high[0] = max(high[0], v)
        else:
            odd[0] += 1
    return low.min(), high.max(), odd.sum()


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
