"""Frame times of several sides, taken in turn in one process, so that a busy machine hits all alike."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from volviz.errors import InputError

if TYPE_CHECKING:
    from volviz.model.camera import Camera
    from volviz.model.render_spec import RenderSpec, View
    from volviz.renderer import Renderer

#: Draws frame i of a side and gives the seconds it took, on the wall clock or as (wall clock, GPU clock).
Draw = Callable[[int], "float | tuple[float, float]"]


@dataclass(frozen=True)
class FrameTimes:
    """Times of the frames of one side, in seconds.

    Attributes
    ----------
    name : str
        The side.
    seconds : tuple of floats
        Wall time of each measured frame, in the order of measurement.
    first : float or None
        Wall time of the first frame, which uploads and compiles; not among `seconds`.
    gpu_seconds : tuple of floats
        OpenGL's own clock (`GL_TIME_ELAPSED`) for the same frames; empty with software OpenGL, where it stops
        before the work is done.
    """

    name: str
    seconds: tuple[float, ...]
    first: float | None = None
    gpu_seconds: tuple[float, ...] = ()

    @property
    def median(self) -> float:
        """Median wall time; NaN before the first frame."""
        return float(np.median(self.seconds)) if self.seconds else float("nan")

    @property
    def quartiles(self) -> tuple[float, float]:
        """Wall times that a quarter and three quarters of the frames stay below."""
        if not self.seconds:
            return float("nan"), float("nan")
        low, high = np.quantile(self.seconds, (0.25, 0.75))
        return float(low), float(high)

    @property
    def spread(self) -> float:
        """Distance of the quartiles as a fraction of the median."""
        low, high = self.quartiles
        return (high - low) / self.median if self.seconds else float("nan")

    @property
    def gpu_median(self) -> float | None:
        """Median of OpenGL's own clock; None where there is none."""
        return float(np.median(self.gpu_seconds)) if self.gpu_seconds else None


@dataclass(frozen=True)
class Ratio:
    """How many times as long one side takes as another.

    Attributes
    ----------
    median, low, high : float
        Median and quartiles of the quotients round by round: a machine that is slow for a while is so for both.
    """

    median: float
    low: float
    high: float


def ratio(side: FrameTimes, base: FrameTimes) -> Ratio:
    """Time of `side` over that of `base`: above 1, `base` is the faster one.

    Raises
    ------
    InputError
        One of them has no frames.
    """
    rounds = min(len(side.seconds), len(base.seconds))
    if not rounds:
        raise InputError(
            f"there are no frame times of {side.name} or {base.name} to compare; measure some first."
        )
    by_round = np.array(side.seconds[:rounds]) / np.array(base.seconds[:rounds])
    low, middle, high = np.quantile(by_round, (0.25, 0.5, 0.75))
    return Ratio(float(middle), float(low), float(high))


class FrameTimer:
    """Frames of several sides in turn: first one round that does not count, then the rounds that do.

    The order of the sides is turned round after every round. To measure all at once::

        for _ in timer.steps():
            pass

    Whoever stops iterating keeps what has been measured.

    Parameters
    ----------
    draws : mapping of str to callable
        For each side a function that draws frame i (0, 1, ...) completely and gives its seconds.
    rounds : int, default: 7
        Measured frames of each side.
    warm_up : int, default: 1
        Frames of each side before them.
    patience : float, optional
        Seconds for the frames of each side: one for which the next frame would probably take longer than what is left
        draws no more. Every side has one measured frame at least, be it the one that was meant for warming up.
    first : mapping of str to float, optional
        Times of the very first frames, to be kept with the others.

    Raises
    ------
    InputError
        No side, or fewer than one round.
    """

    def __init__(
        self,
        draws: Mapping[str, Draw],
        rounds: int = 7,
        warm_up: int = 1,
        patience: float | None = None,
        first: Mapping[str, float] | None = None,
    ) -> None:
        if not draws:
            raise InputError("times are taken of at least one side, got none.")
        if rounds < 1 or warm_up < 0:
            raise InputError(f"times need at least one round, got {rounds} after {warm_up} for warming up.")
        self._draws = dict(draws)
        self._rounds = rounds
        self._warm_up = warm_up
        self._patience = math.inf if patience is None else patience
        self._first = dict(first or {})
        self._seconds: dict[str, list[float]] = {name: [] for name in draws}
        self._gpu_seconds: dict[str, list[float]] = {name: [] for name in draws}

    def steps(self) -> Generator[float, None, None]:
        """Measure; gives the finished fraction, 0..1, after every frame."""
        names, spent = list(self._draws), dict.fromkeys(self._draws, 0.0)
        rounds = self._warm_up + self._rounds
        tired: set[str] = set()
        for turn in range(rounds):
            order = names if turn % 2 == 0 else names[::-1]
            drawn = [name for name in order if name not in tired]
            for done, name in enumerate(drawn, 1):
                taken = self._draws[name](turn)
                seconds = taken[0] if isinstance(taken, tuple) else taken
                spent[name] += seconds
                last = spent[name] + seconds > self._patience
                if last:
                    tired.add(name)
                if turn >= self._warm_up or last:
                    self._keep(name, taken)
                yield 1.0 if len(tired) == len(names) else (turn + done / len(drawn)) / rounds
            if len(tired) == len(names):
                return

    def _keep(self, name: str, taken: float | tuple[float, float]) -> None:
        if isinstance(taken, tuple):
            taken, gpu = taken
            self._gpu_seconds[name].append(gpu)
        self._seconds[name].append(taken)

    @property
    def times(self) -> dict[str, FrameTimes]:
        """What has been measured so far."""
        return {
            name: FrameTimes(
                name, tuple(self._seconds[name]), self._first.get(name), tuple(self._gpu_seconds[name])
            )
            for name in self._draws
        }


def time_frames(
    draws: Mapping[str, Draw], rounds: int = 7, warm_up: int = 1, patience: float | None = None
) -> dict[str, FrameTimes]:
    """Frame times of all sides, measured at once; see `FrameTimer`."""
    timer = FrameTimer(draws, rounds, warm_up, patience)
    for _ in timer.steps():
        pass
    return timer.times


@dataclass(frozen=True)
class Drawn:
    """One side whose frames are timed: a renderer of its own, and what that draws.

    Attributes
    ----------
    renderer : Renderer
    spec : RenderSpec
    view : View
        With a camera.
    first_seconds : float
        Wall time of the first frame in the open window: uploads, shaders, extraction of meshes.
    """

    renderer: Renderer
    spec: RenderSpec
    view: View
    first_seconds: float

    @classmethod
    def first(cls, renderer: Renderer, spec: RenderSpec, view: View) -> Drawn:
        """Draw the first frame; the window itself and its OpenGL context are not what is compared."""
        seconds, _ = renderer.timed(spec, view)
        return cls(renderer, spec, view, seconds)

    def draw(self, frame: int) -> float | tuple[float, float]:
        """Draw a frame from a slightly turned camera; the GPU's clock is told where it counts."""
        assert self.view.camera is not None
        seconds, gpu = self.renderer.timed(
            self.spec, replace(self.view, camera=nudged(self.view.camera, frame))
        )
        return seconds if gpu is None else (seconds, gpu)


def frame_timer(
    sides: Mapping[str, Drawn], rounds: int = 7, warm_up: int = 1, patience: float | None = None
) -> FrameTimer:
    """A timer of off-screen renderers, each frame from a slightly turned camera."""
    draws = {name: side.draw for name, side in sides.items()}
    return FrameTimer(draws, rounds, warm_up, patience, {n: side.first_seconds for n, side in sides.items()})


def nudged(camera: Camera, frame: int) -> Camera:
    """The camera of a frame while times are taken: turned by little, never the same twice running.

    Half a degree to the right, to the left, a degree to the right and so on, so that all frames together look
    from where the image does.
    """
    return camera.turned(0.5 * (1 + frame // 2) * (1 if frame % 2 else -1))
