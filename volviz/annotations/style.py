"""Sizes and colours that annotations share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from volviz.annotations.shapes import Color, Line, Point, Text

LIGHT: Color = (0.86, 0.89, 0.92)
DARK: Color = (0.06, 0.075, 0.09)
QUIET_ON_DARK: Color = (0.55, 0.60, 0.65)
QUIET_ON_LIGHT: Color = (0.42, 0.46, 0.50)
#: Directions x, y, z of the world, readable on dark and on light.
AXIS_COLORS: tuple[Color, Color, Color] = ((0.90, 0.38, 0.30), (0.42, 0.70, 0.32), (0.30, 0.60, 0.95))
#: Width of a letter in ems, about: what is laid out needs no fonts.
LETTER = 0.56


@dataclass(frozen=True)
class Style:
    """How annotations of a picture look.

    Attributes
    ----------
    scale : float
        Pixels for each of the 96 to an inch in which sizes are thought.
    ground : tuple of 3 floats or None
        What lies behind; None where nobody knows (transparent pictures).
    """

    scale: float = 1.0
    ground: Color | None = None

    @property
    def is_light(self) -> bool:
        """Whether dark letters are read better."""
        if self.ground is None:
            return True
        r, g, b = self.ground
        return 0.2126 * r + 0.7152 * g + 0.0722 * b > 0.45

    @property
    def ink(self) -> Color:
        """Colour of letters."""
        return DARK if self.is_light else LIGHT

    @property
    def rim(self) -> Color:
        """Colour around letters."""
        return (1.0, 1.0, 1.0) if self.is_light else DARK

    @property
    def quiet(self) -> Color:
        """Colour of lines around the volume."""
        return QUIET_ON_LIGHT if self.is_light else QUIET_ON_DARK

    @property
    def em(self) -> float:
        """Size of letters in pixels."""
        return 12.0 * self.scale

    def text(
        self, words: str, place: Point, *, size: float = 1.0, color: Color | None = None, **how: Any
    ) -> Text:
        """A line of words; `size` counts in usual sizes."""
        return Text(words, place, self.em * size, color or self.ink, self.rim, **how)

    def line(
        self, *points: Point, color: Color | None = None, width: float = 1.0, behind: bool = False
    ) -> Line:
        """A line; `width` counts in pixels of a screen."""
        return Line(points, color or self.ink, width * self.scale, behind)

    def length_of(self, words: str, size: float = 1.0) -> float:
        """About how long words are, in pixels."""
        return LETTER * self.em * size * len(words)
