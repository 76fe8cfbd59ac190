"""Numbers that stand for "no data", and rare extremes that stretch the range: found in a sample of the values."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]

#: Voxels along an axis that are looked at.
LATTICE = 36
#: The range counts as stretched when it is so many times as wide as that of the bulk of the values.
STRETCHED = 100.0
#: Numbers that programs write where they have no data. So is any other one from `ENORMOUS` on that is repeated.
USUAL = frozenset(
    (-999.0, -9999.0, -99999.0, -999999.0, -32768.0, 32767.0, 65535.0, -(2.0**31), 2.0**31 - 1, 2.0**32 - 1)
)
ENORMOUS = 1e9
#: Distinct other values that there must be: a mask of 0 and 65535 is no image with holes.
FEWEST_OTHERS = 4


class NoData(NamedTuple):
    """What `no_data_of` finds.

    Attributes
    ----------
    values : tuple of floats
        Numbers that stand for "no data", ascending; nearly always none.
    share : float
        Part of the voxels that hold one of them, about.
    others : tuple of 2 floats
        Lowest and highest of the other values that were looked at.
    """

    values: tuple[float, ...]
    share: float
    others: tuple[float, float]


def no_data_of(array: Array) -> NoData:
    """Numbers that stand for "no data": usual for it, repeated, and further from all else than that is wide.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars of any real type. Some ten thousand of them are looked at.
    """
    if array.dtype.itemsize == 1:
        return NoData((), 0.0, (0.0, 0.0))
    seen = _sample(array)
    if not seen.size or not (_may_stand_for_none(seen.min()) or _may_stand_for_none(seen.max())):
        return NoData((), 0.0, (0.0, 0.0))
    levels, counts = np.unique(seen, return_counts=True)
    found: list[int] = []
    first, last = 0, len(levels) - 1
    while True:
        low, high = (bool(_may_stand_for_none(levels[i]) and counts[i] > 1) for i in (first, last))
        inner = levels[first + low : last + 1 - high]
        if len(inner) < FEWEST_OTHERS:
            break
        with np.errstate(over="ignore"):
            width = inner[-1] - inner[0]
            low = low and bool(inner[0] - levels[first] >= width)
            high = high and bool(levels[last] - inner[-1] >= width)
        if not (low or high):
            break
        found += [first] * low + [last] * high
        first, last = first + low, last - high
    share = float(counts[found].sum() / seen.size)
    return NoData(
        tuple(sorted(float(levels[i]) for i in found)), share, (float(levels[first]), float(levels[last]))
    )


def bulk_range(array: Array, low: float, high: float, no_data: tuple[float, ...] = ()) -> tuple[float, float]:
    """The range of the bulk of the values where a few others stretch it a hundredfold or more, else the whole range.

    Single hot voxels would leave everything else in a sliver of the range, with few of the digits of 32-bit floats.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars of any real type. Those of 8 and 16 bits lose no digits: theirs is always the whole range.
    low, high : float
        Their finite range.
    no_data : tuple of floats, optional
        Left out, as is the outermost thousandth at either end.
    """
    if not low < high or (array.dtype.kind in "biu" and array.dtype.itemsize <= 2):
        return low, high
    values = _sample(array)
    values = values[~np.isin(values, no_data)] if no_data else values
    if not values.size:
        return low, high
    first, last = (float(v) for v in np.quantile(values, (0.001, 0.999)))
    if not first < last:
        # one value nearly everywhere: what else there is counts
        others = values[values != first]
        if not others.size:
            return low, high
        a, b = (float(v) for v in np.quantile(others, (0.01, 0.99)))
        first, last = min(a, first), max(b, first)
    if not first < last or high / STRETCHED - low / STRETCHED <= last - first:
        return low, high
    return first, last


def _sample(array: Array) -> npt.NDArray[np.float64]:
    """Finite values of voxels spread evenly over a volume."""
    steps = [max(1, -(-n // LATTICE)) for n in array.shape]
    taken = array[tuple(slice((n - 1) % s // 2, None, s) for n, s in zip(array.shape, steps, strict=True))]
    values = np.asarray(taken, np.float64).ravel()
    return values[np.isfinite(values)]


def _may_stand_for_none(value: float) -> bool:
    return float(value) in USUAL or abs(value) >= ENORMOUS
