"""How much is drawn at once: resolution while something moves, chunks while it rests."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol

if TYPE_CHECKING:
    from volviz.volume_data.brick_cache.cache import BrickStatus

Quality = Literal["fast", "balanced", "full"]


@dataclass(frozen=True)
class QualityLevel:
    """How coarsely an image is drawn while something moves.

    Attributes
    ----------
    fraction : float
        Linear fraction of the full resolution, 0..1.
    step_scale : float
        Factor on the distance of samples.
    """

    fraction: float = 1.0
    step_scale: float = 1.0

    @property
    def share(self) -> float:
        """Expected time as a share of the full image's.

        Fewer pixels save less than their number promises, since the rays that are left lie farther apart and
        find less in the caches: measured times of ray casting and slicing on software OpenGL follow a power
        near 1.5 of the linear fraction.
        """
        return float(self.fraction**1.5 / self.step_scale)


FULL = QualityLevel()

#: Levels in the order in which quality is given up: first resolution, then sampling, then both.
LEVELS = (
    FULL,
    QualityLevel(0.75),
    QualityLevel(0.5),
    QualityLevel(0.5, 2.0),
    QualityLevel(0.375, 2.0),
    QualityLevel(0.25, 2.0),
    QualityLevel(0.1875, 2.0),
    QualityLevel(0.125, 2.0),
    QualityLevel(0.125, 4.0),
    QualityLevel(0.125, 8.0),
)
#: Seconds that our part of an interactive frame may take: 15 frames a second leave 66 ms for everything, and VTK's
#: part and the window system's take some 35 of them on software OpenGL.
BUDGET = {"fast": 0.012, "balanced": 0.022, "full": math.inf}
#: Level of the very first interactive frame, when nothing is known of the cost yet: a coarse one, since that frame
#: may have to wait for shaders too.
FIRST_LEVEL = QualityLevel(0.125, 4.0)


class FrameScheduler(Protocol):
    """What a window with an event loop gives the host, so that full images come piece by piece."""

    def request(self, handle: object) -> None:
        """The image now shown is not the full one: call ``handle.refine()`` soon, from the event loop.

        There is no hurry while ``handle.is_waiting``: `wake` tells when there is more to draw.
        """

    def wake(self, handle: object) -> None:
        """Something that the image waits for is ready; called on any thread.

        From the event loop, draw the next frame during a gesture, and go on with ``handle.refine()`` otherwise.
        """


@dataclass(frozen=True)
class FrameStatus:
    """What the viewport now shows.

    Attributes
    ----------
    resolution : float
        Linear fraction of the full resolution, 0..1.
    seconds : float
        Time that drawing this image took.
    complete : bool
        Whether it is the full image, with all bricks that it needs.
    progress : float
        Part of the full image that is ready, 0..1.
    notice : str
        A sentence on what the image shows differently from what was asked for; empty when nothing.
    waiting : float or None
        While the technique waits for a task in the background: how far that is, 0..1.
    samples : int
        Images of which the mean is shown; 1 until further ones have been drawn at rest.
    gpu_seconds : float or None
        The same time by OpenGL's own clock, where that was asked for.
    bricks : BrickStatus or None
        Of a volume that is drawn brick by brick, how much of what the view needs is there.
    """

    resolution: float = 1.0
    seconds: float = 0.0
    complete: bool = False
    progress: float = 0.0
    notice: str = ""
    waiting: float | None = None
    samples: int = 1
    gpu_seconds: float | None = None
    bricks: BrickStatus | None = None


class CostModel:
    """Estimates the time of an image from those drawn before, and chooses the interactive resolution."""

    def __init__(self) -> None:
        self._full_seconds: float | None = None
        self._last_full_seconds = 0.0

    @property
    def full_seconds(self) -> float | None:
        """Seconds to expect of a full image, None before the first one.

        Never less than the last full image took: techniques that draw a simpler thing while something moves
        make the full one look cheaper than it is.
        """
        return None if self._full_seconds is None else max(self._full_seconds, self._last_full_seconds)

    def observe(self, level: QualityLevel, seconds: float) -> None:
        """An image at that level took so long."""
        estimate = seconds / level.share
        if level == FULL:
            self._last_full_seconds = seconds
        if self._full_seconds is None or level == FULL:
            self._full_seconds = estimate
        else:
            # falls quickly when frames get cheap, so that resolution returns soon; rises at once when they
            # get expensive
            weight = 0.6 if estimate > self._full_seconds else 0.35
            self._full_seconds += weight * (estimate - self._full_seconds)

    def forget(self) -> None:
        """Another technique or volume: nothing is known."""
        self._full_seconds = None
        self._last_full_seconds = 0.0

    def level(self, quality: Quality, share: float = 1.0) -> QualityLevel:
        """The best level that keeps the interactive budget, or a part of it where several images share it."""
        budget = BUDGET[quality] * share
        if math.isinf(budget):
            return FULL
        if self._full_seconds is None:
            return FIRST_LEVEL
        for level in LEVELS:
            expected = self.full_seconds if level == FULL else self._full_seconds * level.share
            if expected is not None and expected <= budget:
                return level
        return LEVELS[-1]


StatusListener = Callable[[FrameStatus], None]
