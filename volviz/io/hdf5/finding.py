"""Which data sets of an HDF5 file could be volumes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from volviz.io.entries import Entry

if TYPE_CHECKING:
    import h5py

#: Objects of a file that are looked at, and data sets that are offered.
_LOOKED_AT, _OFFERED = 20_000, 500


def candidates(file: h5py.File) -> list[Entry]:
    """Data sets of numbers with three axes or more, in the order of the file; links are followed once."""
    import h5py

    found: list[Entry] = []
    seen: set[tuple[int, int]] = set()
    waiting: list[tuple[str, Any]] = [("", file)]
    looked_at = 0
    while waiting and len(found) < _OFFERED:
        path, owner = waiting.pop(0)
        for name in owner:
            looked_at += 1
            if looked_at > _LOOKED_AT:
                return found
            try:
                each = owner[name]
                about = h5py.h5o.get_info(each.id)
            except (KeyError, OSError, RuntimeError, ValueError):
                # a link that leads nowhere, or into a file that is not there
                continue
            if (about.fileno, about.addr) in seen:
                continue
            seen.add((about.fileno, about.addr))
            inside = f"{path}/{name}" if path else str(name)
            if isinstance(each, h5py.Group):
                waiting.append((inside, each))
            elif isinstance(each, h5py.Dataset) and could_be_a_volume(each):
                found.append(Entry(inside, tuple(map(int, each.shape)), each.dtype.name))
    return found


def could_be_a_volume(dataset: h5py.Dataset) -> bool:
    """Whether it has three axes or more, with numbers."""
    shape = dataset.shape
    return (
        is_of_numbers(dataset) and 3 <= len(shape) <= 5 and min(shape) > 0 and sum(n > 1 for n in shape) >= 3
    )


def is_of_numbers(owner: Any) -> bool:
    """Whether this is a data set that holds numbers."""
    return getattr(owner, "shape", None) is not None and owner.dtype.kind in "buifc"
