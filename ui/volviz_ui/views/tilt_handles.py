"""Knobs at the lines of the cross-hair: dragging one turns the other slices about this one's normal."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from volviz.annotations.projection import Projection
from volviz.annotations.shapes import Area, Color, Shape
from volviz.annotations.style import DARK
from volviz.annotations.subject import Subject

#: Where knobs lie, in the shorter side of the view from the middle of the cross-hair; their radius in pixels.
AWAY, RADIUS = 0.36, 5.0
#: A press no farther away takes a knob up.
GRIP = 9.0


def knobs(subject: Subject, projection: Projection) -> list[tuple[Color, tuple[float, float]]]:
    """Colours and places in pixels of the knobs of a view that faces a plane; none elsewhere."""
    if subject.plane is None:
        return []
    middle = projection.pixels([subject.plane[0]])[0]
    found = []
    for color, points in subject.lines:
        ends = projection.pixels(points)
        way = ends[-1] - ends[0]
        way = way / max(float(np.linalg.norm(way)), 1e-9) * AWAY * min(projection.size)
        found += [(color, (float(x), float(y))) for x, y in (middle + way, middle - way)]
    return found


def shapes(subject: Subject, projection: Projection) -> Iterator[Shape]:
    """The knobs, with a dark rim."""
    turn = np.linspace(0.0, 2 * np.pi, 17)[:-1]
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    for color, place in knobs(subject, projection):
        for radius, filled in ((RADIUS + 1.5, DARK), (RADIUS, color)):
            yield Area(tuple((float(x), float(y)) for x, y in place + radius * circle), filled)


def is_on_knob(subject: Subject, projection: Projection, place: tuple[float, float]) -> bool:
    """Whether a press at a place, in pixels, takes a knob up."""
    return any(np.hypot(x - place[0], y - place[1]) <= GRIP for _, (x, y) in knobs(subject, projection))
