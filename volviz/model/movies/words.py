"""Movies in words: "turn 360 degrees about z in 8 s, then cut from left to right in 4 s"."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

from volviz.errors import InputError
from volviz.model.movie import Easing, Move, Step
from volviz.model.movies.moves import (
    DIRECTIONS,
    Cut,
    Fade,
    Play,
    Scroll,
    Swing,
    Turn,
    Vary,
    Zoom,
)
from volviz.model.scene import Scene

#: Seconds of a step that does not say how long it takes.
SECONDS = 4.0
EXAMPLES = (
    "turn 360 degrees about z in 8 s",
    "swing 60 degrees in 4 s",
    "zoom in by 2 in 3 s",
    "cut from left to right in 4 s",
    "isovalue from 300 to 1200 in 5 s",
    "play in 6 s",
    "scroll toward superior in 6 s",
    "show layer 2 in 2 s",
    "hold 1 s",
)

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?"
_UNIT = r"(?:s|sec|secs|second|seconds|min|minute|minutes)"
_TIME = re.compile(rf"\s*\b(?:in|for|over)?\s*({_NUMBER})\s*({_UNIT})\s*$")
_EASING = {"evenly": "even", "gently": "gentle", "smoothly": "gentle"}
_OPPOSITE = {
    "left": "right",
    "right": "left",
    "top": "bottom",
    "bottom": "top",
    "front": "back",
    "back": "front",
}
_OPPOSITE |= {
    "anterior": "posterior",
    "posterior": "anterior",
    "superior": "inferior",
    "inferior": "superior",
}
_OPPOSITE |= {"patient left": "patient right", "patient right": "patient left"}
_SIDE = "|".join(sorted((re.escape(word) for word in DIRECTIONS), key=len, reverse=True))
#: Angle and axis of a turn, both optional.
_ABOUT = rf"(?: ({_NUMBER}) ?(?:degrees|degree|deg|°)?)?(?: (?:about|around) (?:the )?({_SIDE})(?: axis)?)?"


def steps_of(text: str) -> tuple[Step[Scene], ...]:
    """The steps that a sentence tells.

    Parameters
    ----------
    text : str
        Steps separated by "then", commas or semicolons, moves at once by "while" or "and", each with how long it takes
        ("in 4 s"); see `EXAMPLES`.

    Raises
    ------
    InputError
        Something that is none of these; it is quoted.
    """
    cleaned = re.sub(r"\s+", " ", text.strip().rstrip(".")).lower()
    clauses = [c for c in re.split(r"\s*(?:[,;]\s*(?:and\s+)?then\s|\bthen\b|[;,])\s*", cleaned) if c.strip()]
    if not clauses:
        raise InputError(f"a movie in words needs at least one move, such as {EXAMPLES[0]!r}.")
    return tuple(_step(clause.strip()) for clause in clauses)


def _step(clause: str) -> Step[Scene]:
    easing: Easing | None = None
    for word, meant in _EASING.items():
        if re.search(rf"\b{word}\b", clause):
            easing = meant  # type: ignore[assignment]
            clause = re.sub(rf"\s*\b{word}\b", "", clause)
    seconds: float | None = None
    moves: list[Move[Scene]] = []
    for part in re.split(r"\s+(?:while|and)\s+", clause):
        rest = part
        found = _TIME.search(rest)
        if found:
            told = float(found[1]) * (60.0 if found[2].startswith("min") else 1.0)
            if seconds is not None and told != seconds:
                raise InputError(f"{clause!r} gives two lengths; what happens at once takes one time.")
            seconds, rest = told, rest[: found.start()].strip()
        move = _move(rest.strip(), part)
        moves += [] if move is None else [move]
    if easing is None:
        # whole turns go on evenly when the film is played again; the rest begins and ends gently
        easing = (
            "even" if moves and all(isinstance(m, Turn | Play | Scroll | Swing) for m in moves) else "gentle"
        )
    return Step(tuple(moves), SECONDS if seconds is None else seconds, easing)


def _move(text: str, whole: str) -> Move[Scene] | None:
    for pattern, make in _PATTERNS:
        found = re.fullmatch(pattern, text)
        if found:
            return make(found)
    raise InputError(
        f"{whole!r} is no move of a movie; moves are "
        + ", ".join(f'"{example}"' for example in EXAMPLES)
        + "."
    )


def _between(first: str, last: str) -> str:
    """The direction from one side to the other."""
    if _OPPOSITE.get(first) != last:
        raise InputError(
            f"a cut goes from one side to the opposite one, such as left to right, got {first} to {last}."
        )
    return last


def _zoom(found: re.Match[str]) -> Move[Scene]:
    factor = float(found[2]) if found[2] else 1.5
    return Zoom(1.0 / factor if found[1] == "out" and factor > 0 else factor)


def _vary(found: re.Match[str]) -> Move[Scene]:
    begin = None if found[2] is None else float(found[2])
    return Vary(found[1], float(found[3]), begin)


_PATTERNS: Sequence[tuple[str, Callable[[re.Match[str]], Move[Scene] | None]]] = (
    (r"(?:hold|wait|pause)", lambda found: None),
    (
        rf"(?:turn|rotate|spin){_ABOUT}",
        lambda found: Turn(float(found[1] or 360.0), found[2] or "up"),
    ),
    (
        rf"(?:swing|rock){_ABOUT}",
        lambda found: Swing(float(found[1] or 60.0), found[2] or "up"),
    ),
    (rf"zoom (in|out)(?: (?:by )?({_NUMBER})(?: times)?)?", _zoom),
    (rf"cut from (?:the )?({_SIDE}) to (?:the )?({_SIDE})", lambda found: Cut(_between(found[1], found[2]))),
    (rf"cut (?:toward|towards|along) (?:the )?({_SIDE})", lambda found: Cut(found[1])),
    (rf"uncut (?:toward|towards|along) (?:the )?({_SIDE})", lambda found: Cut(found[1], 1.0, 0.0)),
    (
        r"(?:play|go through time)(?: from (\d+) to (\d+))?",
        lambda found: Play(*(None if found[n] is None else int(found[n]) for n in (1, 2))),
    ),
    (
        rf"scroll(?: (?:toward|towards|along) (?:the )?({_SIDE}))?",
        lambda found: Scroll(found[1] or "z"),
    ),
    (r"(?:show|fade in) layer (\d+)", lambda found: Fade(int(found[1]) - 1)),
    (r"(?:hide|fade out) layer (\d+)", lambda found: Fade(int(found[1]) - 1, appears=False)),
    (rf"(?:set )?([a-z_]\w*)(?: from ({_NUMBER}))? to ({_NUMBER})", _vary),
)


def words_of(move: Any) -> str:
    """A move as people say it, as `steps_of` reads it where it can be said there."""
    match move:
        case Turn():
            about = "" if move.axis == "up" else f" about {_said(move.axis)}"
            return f"turn {move.degrees:g} degrees{about}"
        case Swing():
            about = "" if move.axis == "up" else f" about {_said(move.axis)}"
            return f"swing {move.degrees:g} degrees{about}"
        case Zoom():
            return f"zoom in by {move.factor:g}" if move.factor >= 1 else f"zoom out by {1 / move.factor:g}"
        case Cut():
            if move.begin > move.end:
                return f"uncut toward {_said(move.toward)}"
            other = {v: k for k, v in _OPPOSITE.items()}.get(str(move.toward))
            return f"cut from {other} to {move.toward}" if other else f"cut toward {_said(move.toward)}"
        case Play():
            known = move.first is not None and move.last is not None
            return f"play from {move.first} to {move.last}" if known else "play"
        case Scroll():
            return f"scroll toward {_said(move.toward)}"
        case Fade():
            return f"{'show' if move.appears else 'hide'} layer {move.layer + 1}"
        case Vary():
            return f"{move.name}{'' if move.begin is None else f' from {move.begin:g}'} to {move.end:g}"
        case _:
            return str(getattr(move, "name", "") or "key frame")


def _said(direction: Any) -> str:
    if isinstance(direction, str):
        return direction
    return "(" + ", ".join(f"{part:g}" for part in direction) + ")"
