"""Coarser levels of a pyramid: blocks of one or two voxels along each axis become one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt


def halved(array: npt.NDArray[Any], step: Sequence[int], *, is_labels: bool) -> npt.NDArray[Any]:
    """Means of blocks of 1 or 2 voxels along each axis; what the last block lacks is its last voxel again.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
    step : sequence of 3 ints
        Voxels of a block along (z, y, x), 1 or 2.
    is_labels : bool
        Between the values lies nothing: the first voxel of a block stands for it.

    Returns
    -------
    ndarray of the same type
        Means of whole numbers are rounded.
    """
    if is_labels:
        return array[:: step[0], :: step[1], :: step[2]]
    pad = [(0, -n % s) for n, s in zip(array.shape, step, strict=True)]
    if any(after for _, after in pad):
        array = np.pad(array, pad, mode="edge")
    real = np.float32 if array.dtype.itemsize <= 2 or array.dtype == np.float32 else np.float64
    corners = [
        array[a :: step[0], b :: step[1], c :: step[2]]
        for a in range(step[0]) for b in range(step[1]) for c in range(step[2])
    ]  # fmt: skip
    mean: npt.NDArray[np.float64] = corners[0].astype(real)
    for corner in corners[1:]:
        mean += corner
    mean /= len(corners)
    return (np.rint(mean) if array.dtype.kind in "ui" else mean).astype(array.dtype)


def most_frequent(array: npt.NDArray[Any], step: Sequence[int]) -> npt.NDArray[Any]:
    """The value that most voxels of a block have, the lowest of several; what the last block lacks is its last voxel.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
    step : sequence of 3 ints
        Voxels of a block along (z, y, x), 1 or 2.

    Returns
    -------
    ndarray of the same type
    """
    pad = [(0, -n % s) for n, s in zip(array.shape, step, strict=True)]
    if any(after for _, after in pad):
        array = np.pad(array, pad, mode="edge")
    voxels = [
        array[a :: step[0], b :: step[1], c :: step[2]]
        for a in range(step[0]) for b in range(step[1]) for c in range(step[2])
    ]  # fmt: skip
    best = voxels[0].copy()
    most = np.zeros(best.shape, np.uint8)
    for voxel in voxels:
        count = np.zeros(best.shape, np.uint8)
        for other in voxels:
            count += voxel == other
        better = (count > most) | ((count == most) & (voxel < best))
        best[better], most[better] = voxel[better], count[better]
    return best
