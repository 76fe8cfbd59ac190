"""References to volumes: names of data that cost nothing to keep, for scenes, histories and caches."""

from __future__ import annotations

import os
from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from pathlib import Path

#: What names of bundled samples begin with.
SAMPLE_PREFIX = "sample:"
_SCHEMES = ("http://", "https://", "s3://", "gs://", "file://")


def is_address(source: str) -> bool:
    """Whether a source is a URL."""
    return source.lower().startswith(_SCHEMES)


@dataclass(frozen=True)
class VolumeRef:
    """Where data comes from, without its array.

    Attributes
    ----------
    source : str
        Path of a file or folder, a URL, ``sample:<name>``, or ``array:<number>`` for one handed over by a program.
    hints : tuple of (name, value)
        How to read it (raw dimensions, series); time point and channel belong to the layer that shows
        it. Sorted by name.
    content_id : str
        Changes when the file changes; part of every cache key.
    """

    source: str
    hints: tuple[tuple[str, Hashable], ...] = ()
    content_id: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "hints", tuple(sorted(self.hints)))


@dataclass(frozen=True)
class VolumeKey:
    """Which values of which data: the key of one array in caches, and of everything derived from it.

    Attributes
    ----------
    ref : VolumeRef
    channel : int or None
        Counted from 0; None is what the file shows by itself (see `VolumeSource.read`).
    time : int
        Time point, counted from 0.
    level : int
        Level of resolution, 0 is the finest.
    """

    ref: VolumeRef
    channel: int | None = None
    time: int = 0
    level: int = 0


def reference_to(source: str | os.PathLike[str], hints: Mapping[str, Hashable]) -> VolumeRef:
    """The reference to a file, folder, URL or sample, as it is now.

    Parameters
    ----------
    source : str or path
    hints : mapping
        How to read it, as keywords of `volviz.open`.
    """
    text = os.fspath(source)
    if not text.startswith(SAMPLE_PREFIX) and not is_address(text):
        text = str(Path(text).expanduser().absolute())
    return VolumeRef(text, tuple(hints.items()), content_id(text))


def content_id(source: str) -> str:
    """What changes when a file changes: its size and time of modification; empty for what is no file."""
    path = Path(source)
    try:
        stat = path.stat()
    except OSError:
        return ""
    return f"{stat.st_size:x}-{stat.st_mtime_ns:x}"
