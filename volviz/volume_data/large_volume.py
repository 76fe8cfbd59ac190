"""A volume whose finest level does not fit into memory, as those see it who draw it brick by brick."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

from volviz.volume_data.finer_levels import levels_behind, tell_levels_behind
from volviz.volume_data.volume import Volume

if TYPE_CHECKING:
    from volviz.kernels.outliers import NoData
    from volviz.volume_data.description import Level


_at_finest: WeakKeyDictionary[Volume, LargeVolume] = WeakKeyDictionary()


def at_finest(volume: Volume) -> Volume:
    """What draws brick by brick: the lattice of the finest level; the volume itself where that is in memory."""
    finer = levels_behind(volume)
    if finer is None or finer.held_level == 0 or not finer.is_aligned:
        return volume
    found = _at_finest.get(volume)
    if found is None:
        found = _at_finest[volume] = LargeVolume(volume, finer.levels[0])
        tell_levels_behind(found, finer)
    return found


class LargeVolume(Volume):
    """The lattice of the finest level, with the values of the level that is in memory.

    Where it lies, its `dimensions` and `spacing` are those of the finest level; ranges and whatever else is told of the
    values come from `array`, which is coarser. Only what draws bricks may take it in the place of the volume itself.

    Parameters
    ----------
    overview : Volume
        The level in memory.
    finest : Level
    """

    def __init__(self, overview: Volume, finest: Level) -> None:
        super().__init__(
            overview.array, finest.spacing, finest.origin, finest.direction, unit=overview.unit,
            name=overview.name, metadata=overview.metadata,
        )  # fmt: skip
        self._dimensions = finest.dimensions
        self._known = overview._finite, overview._no_data, overview.bulk_range  # noqa: SLF001 - the same values

    @property
    def dimensions(self) -> tuple[int, int, int]:
        """Number of voxels of the finest level along (x, y, z)."""
        return self._dimensions

    @cached_property
    def _finite(self) -> tuple[float, float, int]:
        return self._known[0]

    @cached_property
    def _no_data(self) -> NoData:
        return self._known[1]

    @cached_property
    def bulk_range(self) -> tuple[float, float]:
        """That of the level in memory."""
        return self._known[2]
