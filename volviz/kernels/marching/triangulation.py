"""Filling the polygons of a cell with triangles, without chords that lie in a face of the cube.

A chord inside a face would be an edge of the neighbouring cell's polygon, or of its chord, as well: an edge
with four triangles. Without such chords the surface is edge-manifold whatever the neighbours are.
"""

from __future__ import annotations

from collections.abc import Sequence

from volviz.kernels.marching.cube import CUBE_EDGES, share_a_face

Triangle = tuple[int, int, int]
#: Stands for the vertex in the middle of a cell.
CENTRE = len(CUBE_EDGES)


def chord_length(first: int, second: int) -> float:
    """Squared distance of the middles of two cube edges, in cells."""
    difference = CUBE_EDGES[first].middle - CUBE_EDGES[second].middle
    return float(difference @ difference)


def fill_loop(loop: Sequence[int]) -> tuple[Triangle, ...] | None:
    """Triangles that fill one loop, with the shortest chords that lie in no face of the cube.

    Parameters
    ----------
    loop : sequence of int
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


def fill_loop_round_the_centre(loop: Sequence[int]) -> tuple[Triangle, ...]:
    """Triangles from every side of a loop to one more vertex in the middle of the cell (number `CENTRE`)."""
    return tuple((loop[i], loop[(i + 1) % len(loop)], CENTRE) for i in range(len(loop)))


def fill_tunnel(first: Sequence[int], second: Sequence[int]) -> tuple[Triangle, ...] | None:
    """Triangles of the tube between two loops, with the shortest chords that lie in no face of the cube.

    Parameters
    ----------
    first, second : sequence of int
        Two loops of one cell, each with its own orientation.

    Returns
    -------
    tuple of triangles or None
        ``len(first) + len(second)`` triangles with the loops' orientation; None when every way needs a
        forbidden chord.
    """
    answers = []
    for shift in range(len(second)):
        # Along the tube the second loop runs against its own orientation.
        other = [second[(shift - i) % len(second)] for i in range(len(second) + 1)]
        answer = _zip_up([*first, first[0]], other)
        if answer is not None:
            answers.append(answer)
    return min(answers)[1] if answers else None


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
