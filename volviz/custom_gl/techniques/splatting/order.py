"""The order in which splats are drawn: arithmetic without OpenGL."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from volviz.kernels.compiled import compiled

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
    matrix = np.ascontiguousarray(index_to_world, np.float64)
    nearness = np.empty(len(indices), np.float32)
    _measure(indices, matrix, np.array(eye[:3]), eye[3] == 0, nearness)
    low, high = float(nearness.min()), float(nearness.max())
    scale = LEVELS / (high - low) if high > low else 0.0
    return np.argsort(((nearness - low) * scale).astype(np.uint16), kind="stable")


@compiled
def _measure(
    indices: npt.NDArray[np.float32],
    matrix: npt.NDArray[np.float64],
    eye: npt.NDArray[np.float64],
    is_far: bool,
    nearness: npt.NDArray[np.float32],
) -> None:
    """Negative distances from the eye, or lengths along the direction to it when it is infinitely far away."""
    for n in range(len(indices)):
        total = 0.0
        for row in range(3):
            # without the origin: it would only cost digits
            offset = 0.0 if is_far else matrix[row, 3] - eye[row]
            for column in range(3):
                offset += matrix[row, column] * indices[n, column]
            total += offset * eye[row] if is_far else offset * offset
        nearness[n] = total if is_far else -np.sqrt(total)


def shuffled(count: int) -> npt.NDArray[np.int64]:
    """A fixed random order: any number of splats from the beginning is spread evenly over all of them."""
    return np.random.default_rng(20).permutation(count)
