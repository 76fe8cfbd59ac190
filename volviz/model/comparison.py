"""How several views are looked at together: side by side, as a wipe, blinking, or as a difference."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

from volviz.errors import InputError

Mode = Literal["side_by_side", "wipe", "blink", "difference"]
Map = Literal["signed", "absolute", "ssim"]
Distances = Literal["off", "signed", "absolute"]
Channel = Literal["luminance", "rgb", "red", "green", "blue"]

MODES: tuple[Mode, ...] = ("side_by_side", "wipe", "blink", "difference")
MAPS: tuple[Map, ...] = ("signed", "absolute", "ssim")
DISTANCES: tuple[Distances, ...] = ("off", "signed", "absolute")
CHANNELS: tuple[Channel, ...] = ("luminance", "rgb", "red", "green", "blue")
MOST_VIEWS = 4
PERIODS = (0.2, 5.0)
LIMITS = (1.0, 255.0)


@dataclass(frozen=True)
class Comparison:
    """How two of the views are laid over each other.

    Attributes
    ----------
    mode : {"side_by_side", "wipe", "blink", "difference"}
        Only "side_by_side" shows all views; the others show the compared two.
    pair : tuple of 2 ints
        Numbers of the compared views: A, left of the line of a wipe and taken away in a difference, and B.
    divider : float
        Where the wipe passes from one image to the other, as a fraction of the width, 0..1.
    period : float
        Seconds for which one image stays before it blinks to the other, 0.2..5.
    map : {"signed", "absolute", "ssim"}
        What the difference shows: the difference with or without its sign, or the structural similarity.
    channel : {"luminance", "rgb", "red", "green", "blue"}
        Of what: "rgb" keeps the three channels apart.
    limit : float or None
        Difference that gets the strongest colour, in levels of 0..255, 1..255; None: the largest there is.
    distances : {"off", "signed", "absolute"}
        Whether two surfaces of triangles are coloured by their distance to each other, with a sign or without.
    distance_limit : float or None
        Distance that gets the strongest colour, in world units, above 0; None: the largest there is.

    Raises
    ------
    InputError
        A value is none of those.
    """

    mode: Mode = "side_by_side"
    pair: tuple[int, int] = (0, 1)
    divider: float = 0.5
    period: float = 0.7
    map: Map = "signed"
    channel: Channel = "luminance"
    limit: float | None = None
    distances: Distances = "off"
    distance_limit: float | None = None

    def __post_init__(self) -> None:
        for name, value, known in (
            ("mode", self.mode, MODES),
            ("map", self.map, MAPS),
            ("channel", self.channel, CHANNELS),
            ("distances", self.distances, DISTANCES),
        ):
            if value not in known:
                raise InputError(f"{name} of a comparison is one of {', '.join(known)}, got {value!r}.")
        if min(self.pair) < 0 or self.pair[0] == self.pair[1]:
            raise InputError(f"two different views are compared, got the numbers {self.pair!r}.")
        for name, number, (low, high) in (
            ("divider", self.divider, (0.0, 1.0)),
            ("period", self.period, PERIODS),
            ("limit", self.limit, LIMITS),
        ):
            if number is not None and not low <= number <= high:
                raise InputError(f"{name} of a comparison lies within {low:g} and {high:g}, got {number!r}.")
        limit = self.distance_limit
        if limit is not None and not 0.0 < limit < math.inf:
            raise InputError(f"distance_limit of a comparison is a length above 0, got {limit!r}.")

    def pair_of(self, count: int) -> tuple[int, int]:
        """The compared ones of so many views, at least two: what is not there gives way to a neighbour."""
        first, second = (min(view, count - 1) for view in self.pair)
        if first == second:
            first, second = (first - 1, first) if first else (0, 1)
        return first, second

    def with_side(self, side: int, view: int, count: int) -> Comparison:
        """Another view as A (side 0) or B (1); when it is the other side already, the two exchange places."""
        pair = list(self.pair_of(count))
        if pair[1 - side] == view:
            pair.reverse()
        else:
            pair[side] = view
        return replace(self, pair=(pair[0], pair[1]))

    def without_view(self, closed: int, count: int) -> Comparison:
        """After one of so many views is closed: the same two go on being compared, or what takes their place."""
        pair = self.pair_of(count)
        if closed not in pair:
            first, second = (view - (view > closed) for view in pair)
        else:
            (kept,) = (view - (view > closed) for view in pair if view != closed)
            other = next(view for view in range(count) if view != kept)
            first, second = sorted((kept, other))
        return replace(self, pair=(first, second))
