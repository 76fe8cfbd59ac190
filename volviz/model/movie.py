"""A movie as a value: steps one after another, each of one or more moves at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, Literal, Protocol, TypeVar, get_args

from volviz.errors import InputError

S = TypeVar("S")

#: How a step passes: begins and ends gently, evenly, or goes through key frames without a stop.
Easing = Literal["gentle", "even", "path"]
EASINGS: tuple[Easing, ...] = get_args(Easing)
#: Frames a second that players and encoders take.
FPS_LIMITS = (1, 240)
MOST_SECONDS = 24 * 3600.0


@dataclass(frozen=True)
class Surroundings:
    """What moves have to know beside the scene.

    Attributes
    ----------
    settings_of : callable
        Takes the id of a technique, gives its settings class.
    bounds : tuple of 6 floats
        World bounds (x0, x1, y0, y1, z0, z1) of what is shown.
    times : int
        Number of time points, 1 for what has no time.
    """

    settings_of: Callable[[str], type[Any]]
    bounds: tuple[float, float, float, float, float, float]
    times: int = 1


class Move(Protocol[S]):
    """A change of a scene that passes from 0 to 1."""

    @property
    def kind(self) -> str:
        """What it is called in files."""
        ...

    @property
    def closes(self) -> bool:
        """Whether it ends where it began, so that a film can be played again and again."""
        ...

    @property
    def is_place(self) -> bool:
        """Whether it says where everything is at its end, wherever it was before: a key frame."""
        ...

    def at(self, start: S, fraction: float, about: Surroundings) -> S:
        """The scene when a fraction of the move, 0..1, has passed.

        Raises
        ------
        InputError
            The scene has not what the move is about.
        """
        ...


@dataclass(frozen=True)
class Step(Generic[S]):
    """A part of a movie.

    Attributes
    ----------
    moves : tuple of Move
        What happens, at once; none holds the picture.
    seconds : float
        How long it takes, greater than 0.
    easing : {"gentle", "even", "path"}
        How it passes.
    """

    moves: tuple[Move[S], ...] = ()
    seconds: float = 2.0
    easing: Easing = "gentle"

    def __post_init__(self) -> None:
        if not 0.0 < self.seconds <= MOST_SECONDS:
            raise InputError(
                f"a step of a movie takes more than 0 s and at most a day, got {self.seconds:g} s."
            )
        if self.easing not in EASINGS:
            raise InputError(f"easing of a step must be one of {', '.join(EASINGS)}, got {self.easing!r}.")

    @property
    def closes(self) -> bool:
        """Whether it ends where it began."""
        return all(move.closes for move in self.moves)

    def passed(self, fraction: float) -> float:
        """How much of the moves has passed after a fraction of the time, both 0..1."""
        x = min(max(fraction, 0.0), 1.0)
        return x * x * (3.0 - 2.0 * x) if self.easing == "gentle" else x


@dataclass(frozen=True)
class Movie(Generic[S]):
    """Steps in the order in which they pass.

    Attributes
    ----------
    steps : tuple of Step
    fps : int
        Frames a second, 1..240.
    title : str
        Written over the picture; empty for none.
    stamp : bool
        The moment of the movie, in seconds, is written over the picture.
    """

    steps: tuple[Step[S], ...] = ()
    fps: int = 24
    title: str = ""
    stamp: bool = False

    def __post_init__(self) -> None:
        low, high = FPS_LIMITS
        if not low <= self.fps <= high:
            raise InputError(f"a movie has {low} to {high} frames a second, got {self.fps}.")

    @property
    def place(self) -> Move[S] | None:
        """The key frame that the movie begins with, without taking time; None begins with the present scene."""
        first = self.steps[0].moves if self.steps else ()
        return first[0] if len(first) == 1 and first[0].is_place else None

    @property
    def passing(self) -> tuple[Step[S], ...]:
        """The steps that take time: all but a key frame at the beginning."""
        return self.steps if self.place is None else self.steps[1:]

    @property
    def seconds(self) -> float:
        """How long it takes."""
        return sum(step.seconds for step in self.passing)

    @property
    def loops(self) -> bool:
        """Whether it ends where it began: then its last frame is the one before the first."""
        return bool(self.passing) and all(step.closes for step in self.passing)

    @property
    def frame_count(self) -> int:
        """Number of frames; 0 where nothing takes time."""
        return max(round(self.seconds * self.fps), 1) if self.passing else 0

    def moment(self, frame: int) -> float:
        """Second that a frame, counted from 0, shows.

        A film that loops stops one frame before its end, which is its beginning; others show both ends.
        """
        count = self.frame_count
        if self.loops:
            return self.seconds * frame / count
        return self.seconds * frame / (count - 1) if count > 1 else self.seconds
