"""How much chance there is in the values of a volume."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

#: Of the second difference along each of three axes: root of the sum of the squared weights.
_GAIN = 6.0**1.5
#: Median of the magnitude of a normal distribution, in standard deviations.
_MEDIAN = 0.6745
#: Voxels along an axis from which noise is found: what a larger volume holds beyond the middle adds nothing.
_MOST = 64


def noise_of(array: npt.NDArray[Any]) -> float:
    """Standard deviation of the noise of single voxels, in data units.

    The median of what second differences along all three axes leave: shapes with edges count as outliers (after
    Immerkær, "Fast noise variance estimation", 1996). Whole numbers have at least the noise of rounding.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars; those that are not finite are left out.
    """
    rounding = 12.0**-0.5 if array.dtype.kind in "iu" else 0.0
    if min(array.shape) < 3:
        return rounding
    middle = tuple(slice(max((n - _MOST) // 2, 0), max((n - _MOST) // 2, 0) + _MOST) for n in array.shape)
    rest = array[middle].astype(np.float64)
    for axis in range(3):
        rest = np.diff(rest, 2, axis=axis)
    found = np.abs(rest[np.isfinite(rest)])
    if not found.size:
        return rounding
    return max(float(np.median(found)) / _MEDIAN / _GAIN, rounding)
