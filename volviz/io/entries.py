"""What a file with several images or arrays holds, and which of them is meant."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from volviz.errors import InputError

if TYPE_CHECKING:
    from volviz.io.reader import LoadRequest

#: Entries that a sentence names.
_NAMED = 6


@dataclass(frozen=True)
class Entry:
    """One of several images or arrays in a file or folder.

    Attributes
    ----------
    name : str
        What chooses it: ``series=name``.
    sizes : tuple of int
        As they are stored, slowest first; empty where only opening tells.
    dtype : str
        Type of the values, "uint16" say.
    title : str
        What else it is called; empty for the name alone.
    is_labels : bool
        Its values are numbers that stand for something.
    """

    name: str
    sizes: tuple[int, ...] = ()
    dtype: str = ""
    title: str = ""
    is_labels: bool = False

    @property
    def voxels(self) -> int:
        """Number of values."""
        return math.prod(self.sizes) if self.sizes else 0

    @property
    def bytes(self) -> int:
        """Size of all values in memory, 0 where it is not known."""
        return self.voxels * (np.dtype(self.dtype).itemsize if self.dtype else 0)

    @property
    def words(self) -> str:
        """Name and sizes for a sentence: "'raw' (64 x 512 x 512, uint16)"."""
        sizes = " x ".join(str(n) for n in self.sizes)
        inside = ", ".join(part for part in (self.title, sizes, self.dtype) if part)
        return f"'{self.name}'" + (f" ({inside})" if inside else "")


def in_words(entries: Sequence[Entry]) -> str:
    """The first entries, and how many more there are."""
    more = len(entries) - _NAMED
    named = ", ".join(entry.words for entry in entries[:_NAMED])
    return named + (f" and {more} more" if more > 0 else "")


def largest_image(entries: Sequence[Entry]) -> int:
    """Number of the largest entry; labels belong to an image and are not what is looked at first."""
    images = [n for n, entry in enumerate(entries) if not entry.is_labels] or list(range(len(entries)))
    return max(images, key=lambda n: entries[n].voxels)


def choose_entry(request: LoadRequest, entries: Sequence[Entry], *, what: str = "image") -> int:
    """Number of the entry that ``series=`` names, else of the largest one, with a note.

    Parameters
    ----------
    entries : sequence of Entry, at least one
    what : str
        What they are called, in the singular.

    Raises
    ------
    InputError
        There is no such entry.
    """
    wanted = request.hints.series
    if wanted is not None:
        names = [entry.name for entry in entries]
        if isinstance(wanted, str):
            name = wanted.strip("/")
            for known in (names, [name.strip("/") for name in names], [entry.title for entry in entries]):
                if known.count(wanted) == 1 or known.count(name) == 1:
                    return known.index(wanted if wanted in known else name)
        number = int(wanted) if str(wanted).isdecimal() else -1
        if 0 <= number < len(entries):
            return number
        raise InputError(f"{request.path.name}: there is no {what} {wanted!r}; it holds {in_words(entries)}.")
    best = largest_image(entries)
    if len(entries) > 1:
        others = [entry for n, entry in enumerate(entries) if n != best]
        request.note(
            f"The {what} {entries[best].words} is shown; choose another with series=: {in_words(others)}."
        )
    return best
