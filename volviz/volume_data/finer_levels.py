"""The levels behind a volume in memory: finer ones that are read box by box, coarser ones down to a single brick."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np

from volviz.kernels.halving import halved
from volviz.volume_data.description import Box, Level

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.volume_data.volume import Volume

Cancel = Callable[[], bool]

#: Halving ends where no axis has more voxels.
SMALLEST = 16


class FinerLevels:
    """One time point and channel of a source in all its levels, and in coarser ones that are computed.

    Parameters
    ----------
    levels : sequence of Level
        Those that are stored, finest first.
    read : callable(level, box, cancel) -> ndarray
        Reads a box of voxels of one of them, shape (z, y, x), from any thread.
    held : ndarray of shape (Z, Y, X)
        All values of the level that is in memory.
    held_level : int
        Its number.

    Attributes
    ----------
    stored_count : int
        Number of the stored levels.
    levels : tuple of Level
        The stored ones, and after them those that are computed: each half as fine as the one before.
    """

    def __init__(
        self,
        levels: tuple[Level, ...],
        read: Callable[[int, Box, Cancel | None], npt.NDArray[Any]],
        held: npt.NDArray[Any],
        held_level: int,
    ) -> None:
        self._read = read
        self._held = held
        self.held_level = held_level
        self.stored_count = len(levels)
        self._steps: list[tuple[int, int, int]] = []
        all_levels = list(levels)
        while max(all_levels[-1].dimensions) > SMALLEST:
            level, step = _half(all_levels[-1])
            self._steps.append(step)
            all_levels.append(level)
        self.levels = tuple(all_levels)

    @classmethod
    def of_memory(cls, volume: Volume) -> FinerLevels:
        """A volume in memory and the coarser levels that are computed of it."""
        first, second, third = (tuple(row) for row in volume.direction.tolist())
        level = Level(volume.dimensions, volume.spacing, volume.origin, (first, second, third))

        def read(_level: int, _box: Box, _cancel: Cancel | None) -> npt.NDArray[Any]:
            raise AssertionError("the only level is in memory")

        return cls((level,), read, volume.array, 0)

    @property
    def is_aligned(self) -> bool:
        """Whether the axes of all levels are parallel, so that bricks of several levels fill space together."""
        first = np.asarray(self.levels[0].direction)
        return all(np.abs(np.asarray(level.direction) - first).max() < 1e-6 for level in self.levels)

    def read(self, level: int, box: Box, cancel: Cancel | None = None) -> npt.NDArray[Any]:
        """Values of a box of voxels (i0, i1, j0, j1, k0, k1), shape (z, y, x), from any thread.

        Raises
        ------
        LoadError
            They cannot be read.
        Cancelled
        """
        i0, i1, j0, j1, k0, k1 = box
        if level == self.held_level:
            return self._held[k0:k1, j0:j1, i0:i1]
        if level >= self.stored_count:
            step = self._steps[level - self.stored_count]
            dimensions = self.levels[level - 1].dimensions
            below = [
                min(s * n, count)
                for s, count, pair in zip(step, dimensions, ((i0, i1), (j0, j1), (k0, k1)), strict=True)
                for n in pair
            ]
            values = self.read(
                level - 1, (below[0], below[1], below[2], below[3], below[4], below[5]), cancel
            )
            return halved(values, step[::-1], is_labels=False)
        wide = _at_least_two(box, self.levels[level].dimensions)
        values = self._read(level, wide, cancel)
        return values[k0 - wide[4] : k1 - wide[4], j0 - wide[2] : j1 - wide[2], i0 - wide[0] : i1 - wide[0]]


def _half(level: Level) -> tuple[Level, tuple[int, int, int]]:
    """A level half as fine along the axes that are long enough, and how many voxels become one along (x, y, z)."""
    x, y, z = (2 if n > SMALLEST else 1 for n in level.dimensions)
    step = np.array([x, y, z])
    dimensions = -(-np.array(level.dimensions) // step)
    shift = np.asarray(level.direction) * level.spacing @ ((step - 1) / 2)
    half = Level(
        tuple(dimensions.tolist()), tuple((step * level.spacing).tolist()),
        tuple((shift + level.origin).tolist()), level.direction,
    )  # fmt: skip
    return half, (x, y, z)


def _at_least_two(box: Box, dimensions: tuple[int, int, int]) -> Box:
    """A box that a source reads: two voxels along each axis at least."""
    wide: list[int] = []
    for low, high, count in zip(box[::2], box[1::2], dimensions, strict=True):
        first = min(low, count - 2)
        wide += [first, max(high, first + 2)]
    return wide[0], wide[1], wide[2], wide[3], wide[4], wide[5]


_behind: WeakKeyDictionary[Volume, FinerLevels] = WeakKeyDictionary()


def levels_behind(volume: Volume) -> FinerLevels | None:
    """The levels of the data of which a volume is the one that fits into memory; None where nobody has told any."""
    return _behind.get(volume)


def tell_levels_behind(volume: Volume, levels: FinerLevels) -> None:
    """Let techniques that can read finer levels while they draw do so for a volume."""
    _behind[volume] = levels
