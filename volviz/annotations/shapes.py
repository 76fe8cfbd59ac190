"""Lines, areas, colours and words in pixels of a picture: what annotations are made of, whoever draws them.

Pixels count from the upper left corner of the picture, to the right and downwards.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

Color = tuple[float, float, float]
Point = tuple[float, float]


@dataclass(frozen=True)
class Line:
    """Points joined by straight lines.

    Attributes
    ----------
    points : tuple of pairs of floats
        At least two.
    color : tuple of 3 floats
        Red, green, blue (0..1).
    width : float
        In pixels.
    behind : bool
        Whether the volume lies before it.
    """

    points: tuple[Point, ...]
    color: Color
    width: float = 1.0
    behind: bool = False


@dataclass(frozen=True)
class Area:
    """A filled polygon."""

    points: tuple[Point, ...]
    color: Color
    behind: bool = False


@dataclass(frozen=True)
class Ramp:
    """An upright rectangle of colours.

    Attributes
    ----------
    left, top, width, height : float
        In pixels.
    colors : tuple of colours
        Of strips of equal height, from bottom to top.
    """

    left: float
    top: float
    width: float
    height: float
    colors: tuple[Color, ...]
    behind: bool = False


@dataclass(frozen=True)
class Text:
    """A line of words.

    Attributes
    ----------
    words : str
    place : pair of floats
        The point at which they are aligned.
    size : float
        Of the letters, in pixels an em.
    color, rim : tuple of 3 floats
        Of the letters, and of the rim around them that sets them off from any ground.
    across : {"left", "middle", "right"}
        Which part of the words lies at the point.
    upright : {"top", "middle", "bottom"}
        Likewise.
    bold : bool
    """

    words: str
    place: Point
    size: float
    color: Color
    rim: Color
    across: Literal["left", "middle", "right"] = "left"
    upright: Literal["top", "middle", "bottom"] = "middle"
    bold: bool = False
    behind: bool = False


Shape = Line | Area | Ramp | Text


def moved(shape: Shape, across: float, down: float) -> Shape:
    """A shape in another place."""
    if isinstance(shape, Ramp):
        return replace(shape, left=shape.left + across, top=shape.top + down)
    if isinstance(shape, Text):
        return replace(shape, place=(shape.place[0] + across, shape.place[1] + down))
    return replace(shape, points=tuple((x + across, y + down) for x, y in shape.points))
