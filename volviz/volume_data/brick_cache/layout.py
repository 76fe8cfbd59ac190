"""How the levels of a volume are cut into bricks that cover the same cells of space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from volviz.volume_data.boxes import index_matrix, index_offset

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.volume_data.description import Box, Level

Ints = tuple[int, int, int]


class Brick(NamedTuple):
    """A brick: its level, 0 is the finest, and its number along (x, y, z)."""

    level: int
    x: int
    y: int
    z: int


class BrickLayout:
    """Bricks of all levels on one grid.

    Space is cut into cells of `edge` voxels of the finest level, counted in continuous voxel indices of that level
    from its first voxel centre. A brick of a level covers a block of cells, 1, 2, 4, ... along each axis, as many as
    make it about `edge` voxels of that level. So levels need be neither halved nor aligned: each has its own affine
    map.

    Parameters
    ----------
    levels : sequence of Level
        Finest first, with parallel axes.
    edge : int
        Edge of a cell in voxels of the finest level, a power of two.

    Attributes
    ----------
    cells : ndarray of shape (L, 3)
        Cells that a brick of each level covers along (x, y, z).
    counts : ndarray of shape (L, 3)
        Bricks of each level along (x, y, z).
    scale, offset : ndarray of shape (L, 3)
        Continuous voxel index of a level = that of the finest one * scale + offset.
    stored : int
        Edge of a stored brick in voxels: what linear interpolation anywhere in its block needs.

    Raises
    ------
    ValueError
        The axes of the levels are not parallel.
    """

    def __init__(self, levels: Sequence[Level], edge: int) -> None:
        finest = levels[0]
        matrices = np.array([index_matrix(finest, level) for level in levels])
        scale = np.array([np.diag(matrix) for matrix in matrices])
        if np.abs(matrices - scale[:, None, :] * np.eye(3)).max() > 1e-4 or scale.min() <= 0:
            raise ValueError("the axes of the levels are not parallel")
        self.levels = tuple(levels)
        self.edge = edge
        self.scale = scale
        self.offset = np.array([index_offset(finest, level) for level in levels])
        dimensions = np.array(finest.dimensions)
        grid = np.maximum(-(-(dimensions - 1) // edge), 1)
        wanted = 2 ** np.maximum(np.rint(np.log2(1.0 / scale)), 0).astype(int)
        # a level finer along an axis than the one before it changes nothing there
        self.cells = np.minimum(
            np.maximum.accumulate(wanted, axis=0), 2 ** np.ceil(np.log2(grid)).astype(int)
        )
        self.counts = -(-grid // self.cells)
        self.stored = int(np.ceil(edge * self.cells * scale - 1e-6).max()) + 2

    def first_voxel(self, brick: Brick) -> npt.NDArray[np.int64]:
        """Index (x, y, z) in its level of the first voxel that a brick stores; may lie before the first one."""
        low = np.array(brick[1:]) * self.cells[brick.level] * self.edge
        first = np.floor(low * self.scale[brick.level] + self.offset[brick.level] + 1e-6)
        return np.asarray(first, np.int64)

    def box(self, brick: Brick) -> Box:
        """Voxels (i0, i1, j0, j1, k0, k1) of its level that a brick stores, as far as there are any."""
        count = np.array(self.levels[brick.level].dimensions)
        first = self.first_voxel(brick)
        low = np.clip(first, 0, count - 1).tolist()
        high = np.clip(first + self.stored, 1, count).tolist()
        return low[0], high[0], low[1], high[1], low[2], high[2]

    def filled(self, brick: Brick, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """What was read of `box`, with the outermost voxels repeated until the brick is full, shape (S, S, S)."""
        first, box = self.first_voxel(brick), self.box(brick)
        pad = []
        for axis in (2, 1, 0):
            before = int(box[2 * axis] - first[axis])
            pad.append((before, self.stored - before - (box[2 * axis + 1] - box[2 * axis])))
        return np.pad(values, pad, mode="edge")

    def count(self, level: int) -> int:
        """Bricks of a level."""
        return int(self.counts[level].prod())

    @property
    def coarsest(self) -> int:
        """Number of the coarsest level."""
        return len(self.levels) - 1
