"""Annotations that lie in the world of the volume: its box, axes with numbers, directions, planes of other views."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from volviz.annotations.projection import Projection
from volviz.annotations.shapes import Point, Shape, Text
from volviz.annotations.style import AXIS_COLORS, DARK, Style
from volviz.annotations.subject import Subject
from volviz.model.ticks import round_values, value_text

Floats = npt.NDArray[np.float64]
#: Edges of a box as pairs of corners, with the axis along which each runs.
EDGES = [
    (corner, corner | 1 << axis, axis) for axis in range(3) for corner in range(8) if not corner >> axis & 1
]
#: Pixels of a screen between two numbers of an axis, and what an axis must be long to have any.
BETWEEN, SHORTEST = 55.0, 36.0
TICK, GAP = 5.0, 4.0
#: Part of an edge that is to be seen for its numbers to stand there.
ENOUGH = 0.3
#: Length of an arm of the marker, and of its middle from the edges, in pixels of a screen.
ARM, FROM_EDGE = 30.0, 52.0


def box(subject: Subject, projection: Projection, style: Style) -> Iterator[Shape]:
    """The outline of the volume: edges on its far side lie behind it.

    The box is convex and holds everything, so an edge between two faces that look away from the eye has all matter
    before it, and any other edge has none.
    """
    for start, end, axis in EDGES:
        ends = projection.cut(subject.corners[start], subject.corners[end])
        if ends is None:
            continue
        behind = not any(_sees(subject.corners, projection, face) for face in _faces_of(start, axis))
        a, b = projection.pixels(ends)
        yield style.line(_point(a), _point(b), color=style.quiet, behind=behind)


def axes(
    subject: Subject, projection: Projection, style: Style, avoided: Sequence[Text] = ()
) -> Iterator[Shape]:
    """World axes along edges at the outline of the volume's bounds, with round numbers outside of it.

    Numbers that would lie over one another, or over the words to be avoided, are left out.
    """
    low, high = subject.bounds
    corners = np.array([[(low, high)[n >> axis & 1][axis] for axis in range(3)] for n in range(8)])
    places = projection.pixels(corners)
    if not np.all(np.isfinite(places)):
        return
    middle = places.mean(axis=0)
    unit = f" ({subject.length_unit})" if subject.length_unit else ""
    taken: list[tuple[float, float, float, float]] = []
    for text in avoided:
        _is_free(text, style, taken)
    for axis in range(3):
        edge = _outline_edge(corners, places, projection, axis)
        if edge is None:
            continue
        a, b = places[edge[0]], places[edge[1]]
        length = float(np.linalg.norm(b - a))
        if length < SHORTEST * style.scale or not low[axis] < high[axis]:
            continue
        outward = np.array([a[1] - b[1], b[0] - a[0]]) / length
        if outward @ ((a + b) / 2 - middle) < 0:
            outward = -outward
        yield style.line(_point(a), _point(b), color=style.quiet)
        span = float(high[axis] - low[axis])
        values = round_values(
            float(low[axis]), float(high[axis]), max(2, int(length / (BETWEEN * style.scale)))
        )
        words = [value_text(value, span) for value in values]
        for value, word in zip(values, words, strict=True):
            position = corners[edge[0]] + (corners[edge[1]] - corners[edge[0]]) * ((value - low[axis]) / span)
            at = projection.pixels(position[None])[0]
            tip = at + TICK * style.scale * outward
            text = _beside(word, at + (TICK + GAP) * style.scale * outward, outward, style)
            yield style.line(_point(at), _point(tip), color=style.quiet)
            if _is_free(text, style, taken):
                yield text
        widest = max((style.length_of(word) for word in words), default=0.0)
        away = (TICK + 2 * GAP) * style.scale + abs(outward[0]) * widest + abs(outward[1]) * 1.3 * style.em
        name = f"{'xyz'[axis]}{unit}"
        text = _beside(name, (a + b) / 2 + away * outward, outward, style)
        if _is_free(text, style, taken):
            yield text


def marker(subject: Subject, projection: Projection, style: Style) -> Iterator[Shape]:
    """Directions of the world in the lower left corner; letters of anatomy where the volume is a patient's."""
    names = ("L", "P", "S") if subject.is_anatomical else ("x", "y", "z")
    # columns: where x, y, z of the world point to in the picture
    directions = projection.axes
    x0, y0 = FROM_EDGE * style.scale, projection.size[1] - FROM_EDGE * style.scale
    arm = ARM * style.scale
    for axis in sorted(range(3), key=lambda n: directions[2, n]):
        across, up = float(directions[0, axis]), float(directions[1, axis])
        tip = (x0 + arm * across, y0 - arm * up)
        color = AXIS_COLORS[axis]
        yield style.line((x0, y0), tip, color=DARK if not style.is_light else (1.0, 1.0, 1.0), width=4.0)
        yield style.line((x0, y0), tip, color=color, width=2.5)
        place = (x0 + 1.35 * arm * across, y0 - 1.35 * arm * up)
        yield style.text(names[axis], place, across="middle", bold=True, color=color)


def cross_hair(subject: Subject, projection: Projection, style: Style) -> Iterator[Shape]:
    """Where the planes of other views lie, dark below bright so that they are seen on any slice."""
    for color, points in subject.lines:
        for start, end in pairwise(points):
            ends = projection.cut(start, end)
            if ends is None:
                continue
            a, b = projection.pixels(ends)
            yield style.line(_point(a), _point(b), color=DARK, width=3.0)
            yield style.line(_point(a), _point(b), color=color, width=1.25)


# ---------------------------------------------------------------------- boxes


def _faces_of(corner: int, axis: int) -> list[tuple[int, int]]:
    """The two faces at an edge: their axis, and the side (0 or 1) on which they lie."""
    return [(other, corner >> other & 1) for other in range(3) if other != axis]


def _sees(corners: Floats, projection: Projection, face: tuple[int, int]) -> bool:
    """Whether the eye sees a face of a box, also of an oblique one."""
    axis, side = face
    on = corners[[n for n in range(8) if n >> axis & 1 == side]].mean(axis=0)
    first, second = (corners[1 << other] - corners[0] for other in range(3) if other != axis)
    normal = np.cross(first, second)
    return projection.faces_eye(on, normal if normal @ (on - corners.mean(axis=0)) > 0 else -normal)


def _outline_edge(
    corners: Floats, places: Floats, projection: Projection, axis: int
) -> tuple[int, int] | None:
    """The edge along an axis where its numbers are read best: at the outline, the lowest or the leftmost.

    Where the outline lies outside of the picture, it is the edge of which most is seen.
    """
    edges = [(start, end) for start, end, along in EDGES if along == axis]
    outline = []
    for start, end in edges:
        first, second = (_sees(corners, projection, face) for face in _faces_of(start, axis))
        if first != second and _share_seen(places[[start, end]], projection.size) > ENOUGH:
            outline.append((start, end))
    if not outline:
        shares = {edge: _share_seen(places[list(edge)], projection.size) for edge in edges}
        best = max(edges, key=lambda edge: shares[edge])
        return best if shares[best] > 0 else None
    across, upwards = np.abs(places[outline[0][1]] - places[outline[0][0]])
    if upwards > across:
        return min(outline, key=lambda edge: float(places[list(edge), 0].sum()))
    return max(outline, key=lambda edge: float(places[list(edge), 1].sum()))


def _share_seen(ends: Floats, size: tuple[int, int]) -> float:
    """About which part of a line lies inside of the picture."""
    points = ends[0] + np.linspace(0.0, 1.0, 21)[:, None] * (ends[1] - ends[0])
    return float(np.mean(np.all((points >= 0) & (points <= size), axis=1)))


# ---------------------------------------------------------------------- words


def _beside(words: str, at: Floats, outward: Floats, style: Style) -> Text:
    """Words that lie outside of an edge."""
    across = "left" if outward[0] > 0.4 else "right" if outward[0] < -0.4 else "middle"
    upright = "top" if outward[1] > 0.6 else "bottom" if outward[1] < -0.6 else "middle"
    return style.text(words, _point(at), across=across, upright=upright)


def _is_free(text: Text, style: Style, taken: list[tuple[float, float, float, float]]) -> bool:
    """Whether words have room among those before, which are then among them."""
    width, height = style.length_of(text.words), 1.1 * text.size
    left = text.place[0] - {"left": 0.0, "middle": 0.5, "right": 1.0}[text.across] * width
    top = text.place[1] - {"top": 0.0, "middle": 0.5, "bottom": 1.0}[text.upright] * height
    if any(left < x + w and x < left + width and top < y + h and y < top + height for x, y, w, h in taken):
        return False
    taken.append((left, top, width, height))
    return True


def _point(pixel: Floats) -> Point:
    return float(pixel[0]), float(pixel[1])
