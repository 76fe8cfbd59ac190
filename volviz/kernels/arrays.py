"""Views of scalar arrays that compiled kernels can read, without a copy of the whole volume."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError


def check_scalars(array: npt.NDArray[Any], what: str = "array") -> None:
    """Refuse anything but a (Z, Y, X) array of bool, integers or real numbers.

    Raises
    ------
    InputError
        Wrong number of dimensions, no voxels, or a type that has no order.
    """
    if array.ndim != 3 or 0 in array.shape:
        raise InputError(
            f"{what} has shape {array.shape}; give a three-dimensional array (z, y, x) that is not empty."
        )
    if array.dtype.kind not in "buif":
        raise InputError(
            f"{what} holds values of type {array.dtype}; convert them to integers or real numbers."
        )


def native_slab(array: npt.NDArray[Any], start: int, stop: int) -> npt.NDArray[Any]:
    """Planes ``start:stop`` of a volume, C-contiguous and in the machine's byte order.

    A view where the array already is so; otherwise a copy of these planes only. bool becomes uint8, and the
    half and extended precision that compiled code does not know become float32 and float64.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars; may be big-endian, strided or memory-mapped.
    start, stop : int
        Range of z indices, within 0..Z.

    Returns
    -------
    ndarray of shape (stop - start, Y, X)
        Read-only is kept: kernels never write to it.
    """
    slab = np.asarray(array[start:stop])
    if slab.dtype.kind == "b":
        slab = slab.view(np.uint8)
    elif slab.dtype.kind == "f" and slab.dtype.itemsize not in (4, 8):
        slab = slab.astype(np.float32 if slab.dtype.itemsize < 4 else np.float64)
    elif not slab.dtype.isnative:
        slab = slab.astype(slab.dtype.newbyteorder("="))
    slab = np.ascontiguousarray(slab)
    # one compiled variant serves writeable and read-only arrays
    slab = slab.view()
    slab.flags.writeable = False
    return slab
