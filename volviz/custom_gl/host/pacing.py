"""How much is drawn at once: resolution while something moves, chunks while it rests."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol

Quality = Literal["fast", "balanced", "full"]

#: Linear fractions of the full resolution that are used while interacting.
FRACTIONS = (1.0, 0.75, 0.5, 0.375, 0.25, 0.1875, 0.125)
#: Seconds that our part of an interactive frame may take: 15 frames a second leave 66 ms for everything.
BUDGET = {"fast": 0.02, "balanced": 0.038, "full": math.inf}
#: Fraction of the very first interactive frame, when nothing is known of the cost yet.
FIRST_FRACTION = 0.25


class Pacer(Protocol):
    """What a window with an event loop gives the host, so that full pictures come piece by piece."""

    def request(self, handle: object) -> None:
        """The picture now shown is not the full one: call ``handle.refine()`` soon, from the event loop."""


@dataclass(frozen=True)
class FrameStatus:
    """What the viewport now shows.

    Attributes
    ----------
    resolution : float
        Linear fraction of the full resolution, 0..1.
    seconds : float
        Time that drawing this picture took.
    complete : bool
        Whether it is the full picture.
    progress : float
        Part of the full picture that is ready, 0..1.
    """

    resolution: float = 1.0
    seconds: float = 0.0
    complete: bool = False
    progress: float = 0.0


class CostModel:
    """Estimates the time of a picture from those drawn before, and chooses the interactive resolution."""

    def __init__(self) -> None:
        self._full_seconds: float | None = None

    @property
    def full_seconds(self) -> float | None:
        """Estimated seconds of a full picture, None before the first one."""
        return self._full_seconds

    def observe(self, fraction: float, seconds: float) -> None:
        """A picture at that linear fraction of the resolution took so long."""
        estimate = seconds / fraction**2
        if self._full_seconds is None or fraction == 1.0:
            self._full_seconds = estimate
        else:
            # falls quickly when frames get cheap, so that resolution returns soon; rises at once when they get dear
            weight = 0.6 if estimate > self._full_seconds else 0.35
            self._full_seconds += weight * (estimate - self._full_seconds)

    def forget(self) -> None:
        """Another technique or volume: nothing is known."""
        self._full_seconds = None

    def fraction(self, quality: Quality) -> float:
        """Linear fraction of the resolution that keeps the interactive budget."""
        budget = BUDGET[quality]
        if math.isinf(budget):
            return 1.0
        if self._full_seconds is None:
            return FIRST_FRACTION
        for fraction in FRACTIONS:
            if self._full_seconds * fraction**2 <= budget:
                return fraction
        return FRACTIONS[-1]


StatusListener = Callable[[FrameStatus], None]
