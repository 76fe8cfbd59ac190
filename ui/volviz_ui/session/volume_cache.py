"""Loaded volumes by where they come from, so that going back to an earlier file does not read it again."""

from __future__ import annotations

from collections import OrderedDict

from volviz.volume_data.references import VolumeKey
from volviz.volume_data.scalars import held_bytes
from volviz.volume_data.volume import Volume

DEFAULT_BUDGET = 1 << 30
"""Bytes that are kept."""


class VolumeCache:
    """Volumes by `VolumeKey`, the least recently used leave first.

    The history of the store holds references only; a volume that has left is read again when it is needed.

    Parameters
    ----------
    budget : int
        Bytes to keep, of values and of the texels made of them. The volume used last stays, however large it is.
    """

    def __init__(self, budget: int = DEFAULT_BUDGET) -> None:
        self.budget = budget
        self._volumes: OrderedDict[VolumeKey, Volume] = OrderedDict()

    def __len__(self) -> int:
        return len(self._volumes)

    def get(self, key: VolumeKey) -> Volume | None:
        """The volume, or None when it must be loaded."""
        volume = self._volumes.get(key)
        if volume is not None:
            self._volumes.move_to_end(key)
        return volume

    def put(self, key: VolumeKey, volume: Volume) -> None:
        """Keep a volume; others leave when the budget is exceeded."""
        self._volumes[key] = volume
        self._volumes.move_to_end(key)
        while len(self._volumes) > 1 and self.size > self.budget:
            self._volumes.popitem(last=False)

    @property
    def size(self) -> int:
        """Bytes of all values and of the texels made of them."""
        return sum(held_bytes(volume) for volume in self._volumes.values())

    def clear(self) -> None:
        """Forget all volumes."""
        self._volumes.clear()
