"""The order in which splats are drawn: arithmetic without OpenGL."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

#: Homogeneous world point (x, y, z, w) of the eye; w = 0: infinitely far away in that direction.
Eye = tuple[float, float, float, float]

#: Distances are told apart in so many levels, which a radix sort orders in linear time.
LEVELS = 65535


def back_to_front(
    indices: npt.NDArray[np.float32], eye: Eye, index_to_world: npt.NDArray[np.float64]
) -> npt.NDArray[np.int64]:
    """Order of voxels by falling distance of their centres from the eye.

    The order of cells along the axes of the lattice, which needs no sorting, holds for cells only: footprints reach
    into their neighbours, and a far one would be painted over a near one.

    Parameters
    ----------
    indices : ndarray of shape (N, 3), float32
        Voxel indices (i, j, k).
    eye : tuple of 4 floats
        Where the eye is.
    index_to_world : ndarray of shape (4, 4)
        Maps (i, j, k, 1) to world (x, y, z, 1).

    Returns
    -------
    ndarray of shape (N,), int64
        Permutation of the rows.
    """
    if len(indices) == 0:
        return np.zeros(0, np.int64)
    linear, point = index_to_world[:3, :3], np.array(eye[:3])
    if eye[3] == 0:
        nearness = indices @ (linear.T @ point).astype(np.float32)
    else:
        # relative to the eye before rounding to float32: world coordinates may be large
        offset = (index_to_world[:3, 3] - point / eye[3]).astype(np.float32)
        relative = indices @ linear.T.astype(np.float32)
        relative += offset
        nearness = -np.sqrt(np.einsum("ij,ij->i", relative, relative))
    low, high = float(nearness.min()), float(nearness.max())
    scale = LEVELS / (high - low) if high > low else 0.0
    return np.argsort(((nearness - low) * scale).astype(np.uint16), kind="stable")


def shuffled(count: int) -> npt.NDArray[np.int64]:
    """A fixed random order: any number of splats from the beginning is spread evenly over all of them."""
    return np.random.default_rng(20).permutation(count)
