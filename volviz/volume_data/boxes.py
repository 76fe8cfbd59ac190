"""The same part of the world at another level of resolution, and the finest level at which it fits into memory."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from volviz.volume_data.budgets import budgets

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.volume_data.description import Box, Level
    from volviz.volume_data.source import VolumeSource

Extent = tuple[float, float, float, float, float, float]


def between_levels(extent: Sequence[float], origin: Level, target: Level) -> Extent:
    """A box in continuous voxel indices of one level as the box around it in those of another.

    Parameters
    ----------
    extent : sequence of 6 floats
        (i0, i1, j0, j1, k0, k1) in voxels of `origin`.
    origin, target : Level
        Lattices of the same data.

    Returns
    -------
    tuple of 6 floats
        Not limited to what the level holds.
    """
    corners = np.array([[extent[c & 1], extent[2 + (c >> 1 & 1)], extent[4 + (c >> 2)]] for c in range(8)])
    indices = corners @ index_matrix(origin, target).T + index_offset(origin, target)
    low, high = indices.min(axis=0).tolist(), indices.max(axis=0).tolist()
    return low[0], high[0], low[1], high[1], low[2], high[2]


def index_matrix(origin: Level, target: Level) -> npt.NDArray[np.float64]:
    """3 x 3 matrix from steps in voxels (i, j, k) of one level to steps in voxels of another."""
    steps = np.asarray(target.direction) * target.spacing
    return np.asarray(np.linalg.solve(steps, np.asarray(origin.direction) * origin.spacing), np.float64)


def index_offset(origin: Level, target: Level) -> npt.NDArray[np.float64]:
    """Where voxel (0, 0, 0) of one level lies in continuous voxel indices of another."""
    steps = np.asarray(target.direction) * target.spacing
    return np.asarray(np.linalg.solve(steps, np.subtract(origin.origin, target.origin)), np.float64)


def voxels_around(extent: Sequence[float], level: Level) -> Box:
    """The voxels of a level that enclose a box in its continuous indices, at least two along each axis."""
    limits: list[int] = []
    for low, high, count in zip(extent[::2], extent[1::2], level.dimensions, strict=True):
        # an index that is whole but for rounding needs no further voxel
        first = min(max(math.floor(low + 1e-6), 0), count - 2)
        last = min(max(math.ceil(high - 1e-6), first + 1), count - 1)
        limits += [first, last + 1]
    return limits[0], limits[1], limits[2], limits[3], limits[4], limits[5]


def finest_box(
    source: VolumeSource, extent: Sequence[float], level: int, free: int | None
) -> tuple[int, Box]:
    """The finest level at which a part of the data fits into memory and textures.

    Parameters
    ----------
    source : VolumeSource
    extent : sequence of 6 floats
        (i0, i1, j0, j1, k0, k1) in continuous voxel indices of a level.
    level : int
        That level.
    free : int or None
        Bytes of memory that may be taken (`volviz.io.memory.free_bytes`); None asks nothing.

    Returns
    -------
    level : int
        The coarsest one where none fits.
    box : tuple of 6 ints
        Voxels of that level.
    """
    itemsize = np.dtype(source.description.dtype or "float32").itemsize
    found = 0, (0, 0, 0, 0, 0, 0)
    for number, each in enumerate(source.levels):
        box = voxels_around(between_levels(extent, source.levels[level], each), each)
        found = number, box
        voxels = math.prod(high - low for low, high in zip(box[::2], box[1::2], strict=True))
        # beside the values stand those that the graphics card gets, real numbers of four bytes at most
        fits = free is None or voxels * (itemsize + 4) <= free
        if fits and voxels * min(itemsize, 4) <= budgets().texture_bytes:
            break
    return found
