"""What belongs into a picture beside the volume: one list for the window, copies, files and scripts."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields
from typing import Any

from volviz.errors import InputError


@dataclass(frozen=True)
class PictureContents:
    """What stands around the volume in a picture.

    Attributes
    ----------
    box : bool
        Outline of the volume.
    axes : bool
        World axes with numbers along the volume.
    marker : bool
        Directions of the world, in the lower left corner.
    bar : bool
        Colours of the values, with numbers.
    scale : bool
        A line of known length.
    letters : bool
        What lies at the edges of a slice: right and left, front and back, head and feet of a patient.
    cross_hair : bool
        Where the slices of other views lie.
    measurements : bool
        What is measured and marked in the scene, with its numbers.
    legend : bool
        Names and colours of labels, and of layers where there are several.
    title : str
        A line above the picture; empty for none.
    """

    box: bool = False
    axes: bool = False
    marker: bool = False
    bar: bool = False
    scale: bool = False
    letters: bool = False
    cross_hair: bool = False
    measurements: bool = False
    legend: bool = False
    title: str = ""

    @classmethod
    def of(cls, show: PictureContents | str | Iterable[str], title: str = "") -> PictureContents:
        """The contents from names such as ("box", "bar") or "box,bar".

        Raises
        ------
        InputError
            A name that is none of `SWITCHES`.
        """
        if isinstance(show, PictureContents):
            return cls(**{**_values(show), "title": title or show.title})
        names = [name.strip() for name in (show.split(",") if isinstance(show, str) else show)]
        for name in names:
            if name not in SWITCHES:
                raise InputError(f"a picture cannot show {name!r}; choose among {', '.join(SWITCHES)}.")
        return cls(**dict.fromkeys(names, True), title=title)

    @property
    def names(self) -> tuple[str, ...]:
        """What is switched on, in the order of `SWITCHES`."""
        return tuple(name for name in SWITCHES if getattr(self, name))

    @property
    def is_empty(self) -> bool:
        """Whether nothing stands around the volume."""
        return not self.names and not self.title


def _values(contents: PictureContents) -> dict[str, Any]:
    return {field.name: getattr(contents, field.name) for field in fields(contents)}


#: Names of what can be switched on and off.
SWITCHES: tuple[str, ...] = tuple(f.name for f in fields(PictureContents) if f.name != "title")
