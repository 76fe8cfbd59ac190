"""Filling the polygons of a cell with triangles, without chords that lie in a face of the cube.

A chord inside a face would be an edge of the neighbouring cell's polygon, or of its chord, as well: an edge
with four triangles. Without such chords the surface is edge-manifold whatever the neighbours are.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import combinations

from volviz.kernels.marching.cube import CUBE_EDGES, share_a_face

Triangle = tuple[int, int, int]
#: Stands for a vertex in the middle of a cell; the next number stands for a second one.
CENTRE = len(CUBE_EDGES)
#: Most such vertices in one cell.
CENTRES = 2


@cache
def chord_length(first: int, second: int) -> float:
    """Squared distance of the middles of two cube edges, in cells."""
    difference = CUBE_EDGES[first].middle - CUBE_EDGES[second].middle
    return float(difference @ difference)


@cache
def fill_loop(loop: tuple[int, ...]) -> tuple[Triangle, ...] | None:
    """Triangles that fill one loop, with the shortest chords that lie in no face of the cube.

    Parameters
    ----------
    loop : tuple of int
        Cube edges, 3 to 12.

    Returns
    -------
    tuple of triangles or None
        ``len(loop) - 2`` triangles with the loop's orientation; None when every way needs a forbidden chord.
        Among equally short ones the first in lexical order, so that the result is always the same.
    """
    n = len(loop)
    best: dict[tuple[int, int], tuple[float, tuple[Triangle, ...]] | None] = {
        (i, i + 1): (0.0, ()) for i in range(n - 1)
    }
    for width in range(2, n):
        for i in range(n - width):
            j = i + width
            is_side = width == n - 1
            if not is_side and share_a_face(loop[i], loop[j]):
                best[i, j] = None
                continue
            own = 0.0 if is_side else chord_length(loop[i], loop[j])
            options = []
            for k in range(i + 1, j):
                left, right = best[i, k], best[k, j]
                if left is not None and right is not None:
                    triangles = ((loop[i], loop[k], loop[j]), *left[1], *right[1])
                    options.append((round(left[0] + right[0] + own, 9), triangles))
            best[i, j] = min(options) if options else None
    result = best[0, n - 1]
    return None if result is None else result[1]


def fill_loop_round_the_centre(loop: Sequence[int], centre: int = CENTRE) -> tuple[Triangle, ...]:
    """Triangles from every side of a loop to one more vertex in the middle of the cell."""
    return tuple((loop[i], loop[(i + 1) % len(loop)], centre) for i in range(len(loop)))


def fill_tunnel(first: Sequence[int], second: Sequence[int]) -> tuple[Triangle, ...]:
    """Triangles of the tube between two loops, with the shortest chords that lie in no face of the cube.

    Where such chords do not suffice, the tube is cut into two pieces, and a piece is filled round a vertex
    in the middle of the cell.

    Parameters
    ----------
    first, second : sequence of int
        Two loops of one cell, each with its own orientation.

    Returns
    -------
    tuple of triangles
        With the loops' orientation; numbers from `CENTRE` on are vertices in the middle of the cell.

    Raises
    ------
    ValueError
        The two loops cannot be connected; does not happen for the loops of a cell.
    """
    answers = []
    for shift in range(len(second)):
        # Along the tube the second loop runs against its own orientation.
        other = [second[(shift - i) % len(second)] for i in range(len(second) + 1)]
        answer = _zip_up([*first, first[0]], other)
        if answer is not None and _uses_each_side_once(answer[1]):
            answers.append(answer)
    if answers:
        return min(answers)[1]
    return _fill_in_two_pieces(first, second)


def _fill_in_two_pieces(first: Sequence[int], second: Sequence[int]) -> tuple[Triangle, ...]:
    """Fill a tube that two chords between the loops cut into two discs."""
    bridges = [
        (a, b) for a in range(len(first)) for b in range(len(second)) if not share_a_face(first[a], second[b])
    ]
    answers = []
    for (a1, b1), (a2, b2) in combinations(bridges, 2):
        if a1 == a2 or b1 == b2:
            continue
        length = chord_length(first[a1], second[b1]) + chord_length(first[a2], second[b2])
        pieces = (
            [*_arc(first, a1, a2), *_arc(second, b2, b1)],
            [*_arc(first, a2, a1), *_arc(second, b1, b2)],
        )
        filled = [fill_loop(tuple(piece)) for piece in pieces]
        for by_chords in ((True, True), (True, False), (False, True), (False, False)):
            triangles: list[Triangle] = []
            middles = 0
            for piece, fill, wanted in zip(pieces, filled, by_chords, strict=True):
                if not wanted:
                    triangles += fill_loop_round_the_centre(piece, CENTRE + middles)
                    middles += 1
                elif fill is not None:
                    triangles += fill
            is_complete = all(
                fill is not None or not wanted for fill, wanted in zip(filled, by_chords, strict=True)
            )
            if is_complete and _uses_each_side_once(triangles):
                answers.append((middles, round(length, 9), tuple(triangles)))
    if not answers:
        raise ValueError(f"no tube connects the loops {tuple(first)} and {tuple(second)}")
    return min(answers)[2]


def _arc(loop: Sequence[int], start: int, stop: int) -> list[int]:
    """The part of a loop from one place to another, both included."""
    return [loop[i % len(loop)] for i in range(start, stop + 1 + (len(loop) if stop < start else 0))]


def _uses_each_side_once(triangles: Sequence[Triangle]) -> bool:
    """Tell whether no two triangles run along an edge in the same direction."""
    sides = [(t[i], t[(i + 1) % 3]) for t in triangles for i in range(3)]
    return len(sides) == len(set(sides))


def _zip_up(first: Sequence[int], other: Sequence[int]) -> tuple[float, tuple[Triangle, ...]] | None:
    """Cheapest strip between two open chains that begins and ends with the chord of their first elements."""
    best: dict[tuple[int, int], tuple[float, tuple[Triangle, ...]]] = {}
    for i in range(len(first)):
        for j in range(len(other)):
            is_end = (i, j) in {(0, 0), (len(first) - 1, len(other) - 1)}
            repeats = not is_end and {first[i], other[j]} == {first[0], other[0]}
            if share_a_face(first[i], other[j]) or repeats:
                continue
            own = chord_length(first[i], other[j])
            options: list[tuple[float, tuple[Triangle, ...]]] = [(own, ())] if i == j == 0 else []
            if i and (i - 1, j) in best:
                cost, triangles = best[i - 1, j]
                options.append((round(cost + own, 9), (*triangles, (first[i - 1], first[i], other[j]))))
            if j and (i, j - 1) in best:
                cost, triangles = best[i, j - 1]
                options.append((round(cost + own, 9), (*triangles, (first[i], other[j], other[j - 1]))))
            if options:
                best[i, j] = min(options)
    return best.get((len(first) - 1, len(other) - 1))
