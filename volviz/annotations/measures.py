"""Measurements, points and arrows of a scene: lines through their points, with the number beside them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from volviz.annotations.projection import Floats, Projection
from volviz.annotations.shapes import Color, Line, Point, Shape
from volviz.annotations.style import DARK, Style
from volviz.annotations.subject import Subject
from volviz.model.measurements import Measurement

#: Half the size of a point, and the length of the head of an arrow, in pixels of a screen.
POINT, HEAD = 4.0, 12.0
#: Sides of the polygon that stands for an ellipse or an arc.
SIDES = 64
#: Radius of the arc of an angle, in its shorter side.
ARC = 0.3


def measures(subject: Subject, projection: Projection, style: Style) -> Iterator[Shape]:
    """All measurements that are seen; on a slice those that lie in its plane; what crosses it is a thin line."""
    for measurement, words in subject.measurements:
        if not measurement.visible:
            continue
        beside = words
        places = np.array([point.position for point in measurement.points])
        width = 1.75
        if subject.plane is not None:
            point, normal, reach = subject.plane
            away = (places - point) @ np.asarray(normal)
            if np.all(away > reach) or np.all(away < -reach):
                continue
            if np.any(np.abs(away) > reach):
                width, beside = 0.75, ""
        yield from _measure(measurement, beside, places, projection, style, width)


def _measure(
    measurement: Measurement, words: str, places: Floats, projection: Projection, style: Style, width: float
) -> Iterator[Shape]:
    color = measurement.color
    for line in lines_of(measurement, places):
        for start, end in pairwise(line):
            cut = projection.cut(start, end)
            if cut is not None:
                a, b = projection.pixels(cut)
                yield from _stroke([_pair(a), _pair(b)], color, style, width)
    pixels = projection.pixels(places)
    if not np.all(np.isfinite(pixels)):
        return
    if measurement.kind == "arrow":
        yield from _head(pixels, color, style, width)
    else:
        for x, y in pixels:
            size = POINT * style.scale
            yield from _stroke([(x - size, y), (x + size, y)], color, style, width)
            yield from _stroke([(x, y - size), (x, y + size)], color, style, width)
    if words:
        at, across = _beside(measurement, pixels, style)
        yield style.text(words, at, size=1.1, color=_readable(color, style), across=across)


def lines_of(measurement: Measurement, places: Floats) -> Sequence[Floats]:
    """World points joined by lines that stand for a measurement, shapes (N, 3)."""
    match measurement.kind:
        case "point":
            return []
        case "polygon":
            return [np.concatenate([places, places[:1]])]
        case "ellipse":
            middle, first, second = places
            u, v = first - middle, second - middle
            length = float(u @ u)
            across = v - (v @ u) / length * u if length > 0 else v
            turn = np.linspace(0.0, 2 * np.pi, SIDES + 1)[:, None]
            return [middle + np.cos(turn) * u + np.sin(turn) * across]
        case "angle":
            return [places, *_arc(*places)]
        case _:
            return [places]


def _arc(first: Floats, vertex: Floats, last: Floats) -> list[Floats]:
    u, v = first - vertex, last - vertex
    lengths = float(np.linalg.norm(u)), float(np.linalg.norm(v))
    if min(lengths) == 0:
        return []
    u, v = u / lengths[0], v / lengths[1]
    turn = float(np.arccos(np.clip(u @ v, -1.0, 1.0)))
    across = v - (v @ u) * u
    if np.linalg.norm(across) < 1e-9:
        return []
    across /= np.linalg.norm(across)
    angles = np.linspace(0.0, turn, 24)[:, None]
    return [vertex + ARC * min(lengths) * (np.cos(angles) * u + np.sin(angles) * across)]


def _stroke(points: Sequence[Point], color: Color, style: Style, width: float) -> Iterator[Line]:
    """A line with a dark rim, seen on any ground."""
    yield style.line(*points, color=DARK, width=width + 1.75)
    yield style.line(*points, color=color, width=width)


def _head(pixels: Floats, color: Color, style: Style, width: float) -> Iterator[Line]:
    """The head of an arrow at its second point."""
    way = pixels[1] - pixels[0]
    length = float(np.linalg.norm(way))
    if length < 1.0:
        return
    back = -way / length * min(HEAD * style.scale, length)
    side = np.array([-back[1], back[0]]) * 0.5
    tips = [_pair(pixels[1] + back + side), _pair(pixels[1]), _pair(pixels[1] + back - side)]
    yield from _stroke(tips, color, style, width + 0.5)


def _beside(measurement: Measurement, pixels: Floats, style: Style) -> tuple[Point, str]:
    """Where the words stand: at the tail of an arrow, right of everything else."""
    gap = 8.0 * style.scale
    if measurement.kind == "arrow":
        leftwards = pixels[1, 0] > pixels[0, 0]
        x, y = pixels[0]
        return (x - gap if leftwards else x + gap, y), "right" if leftwards else "left"
    if measurement.kind in ("distance", "profile"):
        x, y = pixels.mean(axis=0)
        return (x + gap, y - gap), "left"
    x, y = pixels[int(np.argmax(pixels[:, 0]))] if measurement.kind != "angle" else pixels[1]
    return (x + gap, y - gap), "left"


def _readable(color: Color, style: Style) -> Color:
    """The colour itself on dark; darkened where letters have a light rim."""
    r, g, b = color
    return (0.55 * r, 0.55 * g, 0.55 * b) if style.is_light else color


def _pair(place: Floats) -> Point:
    return float(place[0]), float(place[1])
