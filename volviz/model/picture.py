"""What belongs into a picture beside the volume: one list for the window, copies, files and scripts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
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


@dataclass(frozen=True)
class PicturePart:
    """A view in a picture.

    Attributes
    ----------
    view : int
        Its number.
    place : tuple of 4 ints
        Left, top, width and height in pixels of the picture.
    seen : tuple of 2 ints
        First column of the picture that shows it, and the first one that does not any more.
    caption : str
        What stands above it; empty for nothing.
    scale : float
        Size of letters and lines, 1 as on a screen.
    """

    view: int
    place: tuple[int, int, int, int]
    seen: tuple[int, int]
    caption: str = ""
    scale: float = 1.0

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.place[2:]

    @property
    def is_cut(self) -> bool:
        """Whether only some of its columns are seen, as in a wipe."""
        return self.seen[1] - self.seen[0] < self.place[2]


@dataclass(frozen=True)
class Picture:
    """How a picture of a scene is made, as far as the scene does not say it.

    Attributes
    ----------
    size : tuple of 2 ints
        Width and height in pixels.
    parts : tuple of PicturePart
        The views that are seen.
    contents : PictureContents
        What stands around the volume.
    transparent : bool
        Without background.
    dpi : float
        Pixels to an inch of paper.
    """

    size: tuple[int, int]
    parts: tuple[PicturePart, ...]
    contents: PictureContents = PictureContents()
    transparent: bool = False
    dpi: float = 96.0

    @classmethod
    def of_view(cls, view: int, size: tuple[int, int], scale: float = 1.0, **values: Any) -> Picture:
        """A picture of one view; the rest as in the class."""
        return cls(size, (PicturePart(view, (0, 0, *size), (0, size[0]), scale=scale),), **values)

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return asdict(self)

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Picture:
        """The picture that `to_dict` described.

        Raises
        ------
        KeyError, TypeError, ValueError
            The data are damaged.
        """
        parts = tuple(
            PicturePart(
                int(part["view"]), _whole(part["place"], 4), _whole(part["seen"], 2), str(part["caption"]),
                float(part["scale"]),
            )
            for part in data["parts"]
        )  # fmt: skip
        contents = PictureContents(**data["contents"])
        return cls(_whole(data["size"], 2), parts, contents, bool(data["transparent"]), float(data["dpi"]))


def _whole(values: Any, count: int) -> Any:
    numbers = tuple(int(value) for value in values)
    if len(numbers) != count:
        raise ValueError(f"{count} numbers, got {len(numbers)}")
    return numbers
