"""Stored values to the values they stand for: ``value = slope * stored + intercept``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt


def is_scaling(slope: float, intercept: float) -> bool:
    """Whether these change values: a slope of 0, or numbers that are not finite, mean "not scaled"."""
    usable = slope != 0 and np.isfinite(slope) and np.isfinite(intercept)
    return bool(usable) and (slope, intercept) != (1.0, 0.0)


def rescaled(
    array: npt.NDArray[Any],
    slope: float,
    intercept: float,
    *,
    in_place: bool = False,
    may_narrow: bool = True,
) -> npt.NDArray[Any]:
    """Apply slope and intercept in the smallest type that holds the result.

    Whole numbers stay whole: int16 values with an intercept of -1024 stay int16 when they fit. Everything
    else becomes float32, or float64 where float32 would lose digits of the stored integers.

    Parameters
    ----------
    array : ndarray
        Stored values.
    slope, intercept : float
        A slope of 0, or numbers that are not finite, mean "not scaled", as in NIfTI.
    in_place : bool, default: False
        The memory of `array` may be taken for the result, where that has values of the same width.

    may_narrow : bool, default: True
        Whether whole numbers may take fewer bytes than those that are stored. Where they may not, a few slices of a
        stack nearly always get the type that all of them have.

    Returns
    -------
    ndarray
        `array` itself when nothing is to be done.
    """
    if not is_scaling(slope, intercept):
        return array
    kind, size = array.dtype.kind, array.dtype.itemsize
    if kind in "ui" and size <= 4 and float(slope).is_integer() and float(intercept).is_integer():
        ends = [
            int(array.min()) * int(slope) + int(intercept),
            int(array.max()) * int(slope) + int(intercept),
        ]
        for whole in (np.uint8, np.int16, np.uint16, np.int32):
            if not may_narrow and np.dtype(whole).itemsize < size:
                continue
            if np.iinfo(whole).min <= min(ends) and max(ends) <= np.iinfo(whole).max:
                reuses = in_place and np.dtype(whole).itemsize == size and array.dtype.isnative
                result = array.view(whole) if reuses else np.empty(array.shape, whole)
                # wider in between, slab by slab: stored and final type may both be too narrow for a product
                largest = max(abs(int(array.min())), abs(int(array.max()))) * abs(int(slope)) + abs(
                    int(intercept)
                )
                between = np.int32 if largest < 2**31 else np.int64
                for slab, out in zip(array, result, strict=True):
                    values = slab.astype(between)
                    if slope != 1:
                        values *= between(slope)
                    values += between(intercept)
                    out[...] = values
                return result
    real = np.dtype(np.float64 if size > 4 or (kind in "ui" and size == 4) else np.float32)
    values = array.astype(real)
    # a damaged slope may lead to infinity, which `Volume` counts like any other
    with np.errstate(over="ignore", invalid="ignore"):
        values *= real.type(slope)
        values += real.type(intercept)
    return values
