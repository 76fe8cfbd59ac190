"""The order in which splats are drawn: arithmetic without OpenGL."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

#: Where the eye stands among the lattice planes of each axis, as whole numbers; -1 before, N behind all N voxels.
EyePlanes = tuple[int, int, int]


def eye_planes(eye: npt.ArrayLike, dimensions: tuple[int, int, int]) -> EyePlanes:
    """The eye's place among the planes of voxels.

    Parameters
    ----------
    eye : array_like of shape (4,)
        Homogeneous point in voxel indices (i, j, k, w); w = 0 for an eye infinitely far away in that direction.
    dimensions : tuple of 3 ints
        Voxels along (x, y, z).
    """
    point = np.asarray(eye, np.float64)
    if point[3] == 0:
        # an axis along which the eye does not look may be taken either way
        i, j, k = (n if direction > 0 else -1 for n, direction in zip(dimensions, point[:3], strict=True))
    else:
        i, j, k = (
            int(np.clip(round(v), -1, n)) for v, n in zip(point[:3] / point[3], dimensions, strict=True)
        )
    return i, j, k


def back_to_front(
    indices: npt.NDArray[np.float32], planes: EyePlanes, dimensions: tuple[int, int, int]
) -> npt.NDArray[np.int64]:
    """Order in which voxels are painted over one another without an error, from the farthest.

    A plane of voxels farther from the eye's own plane cannot hide a nearer one, along any axis; so the voxels are
    ordered by that distance along z, then y, then x (Frieder, Gordon and Reynolds, "Back-to-front display of
    voxel-based objects", 1985). Distances to the eye are never computed, and the order changes only when the eye
    passes a plane of voxels.

    Parameters
    ----------
    indices : ndarray of shape (N, 3), float32
        Voxel indices (i, j, k).
    planes : tuple of 3 ints
        From `eye_planes`.
    dimensions : tuple of 3 ints
        Voxels along (x, y, z).

    Returns
    -------
    ndarray of shape (N,), int64
        Permutation of the rows.
    """
    key = np.zeros(len(indices), np.int64)
    for axis in (2, 1, 0):
        away = np.abs(np.arange(dimensions[axis]) - planes[axis])
        key *= dimensions[axis] + 2
        key += away[indices[:, axis].astype(np.int64)]
    return np.argsort(-key, kind="stable")


def shuffled(count: int) -> npt.NDArray[np.int64]:
    """A fixed random order: any number of splats from the beginning is spread evenly over all of them."""
    return np.random.default_rng(20).permutation(count)
