"""The geometry of one cell of the lattice, from which all tables of the marching methods are generated.

A *corner* is a number 0..7 whose bit 0 is x, bit 1 y and bit 2 z. A *case* is a number 0..255 whose bit c
tells that corner c is inside (value >= isovalue). An *edge* is a pair ``(start, step)`` of two such bit sets
without a common bit: it runs from corner ``start`` to corner ``start | step``. Steps with one bit are the
cube's 12 edges, steps with two or three are the diagonals that cutting the cube into tetrahedra adds.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

#: Steps of the cube's own edges: along x, y, z.
AXES = (1, 2, 4)


class Edge(NamedTuple):
    """An edge of the cell from corner ``start`` to corner ``start | step``."""

    start: int
    step: int

    @property
    def end(self) -> int:
        """The corner where the edge ends."""
        return self.start | self.step

    @property
    def middle(self) -> npt.NDArray[np.float64]:
        """Its middle (x, y, z) in the unit cube, shape (3,)."""
        return (corner_position(self.start) + corner_position(self.end)) / 2

    def is_crossed(self, case: int) -> bool:
        """Tell whether one end is inside and the other is not."""
        return (case >> self.start ^ case >> self.end) & 1 == 1


def corner_position(corner: int) -> npt.NDArray[np.float64]:
    """Position (x, y, z) of a corner in the unit cube, shape (3,)."""
    return np.array([corner & 1, corner >> 1 & 1, corner >> 2 & 1], dtype=np.float64)


def edges_with_steps(steps: tuple[int, ...]) -> tuple[Edge, ...]:
    """All edges of the cell with the given steps, ordered by step, then by start corner."""
    return tuple(Edge(start, step) for step in steps for start in range(8) if start & step == 0)


#: The 12 edges of the cube: 0-3 along x, 4-7 along y, 8-11 along z.
CUBE_EDGES = edges_with_steps(AXES)

_EDGE_BETWEEN = {frozenset((edge.start, edge.end)): number for number, edge in enumerate(CUBE_EDGES)}


def edge_between(first: int, second: int) -> int:
    """Number of the cube edge between two neighbouring corners."""
    return _EDGE_BETWEEN[frozenset((first, second))]


def _face(axis: int, side: int) -> tuple[int, int, int, int]:
    """Corners of a face, counter-clockwise seen from outside the cube, beginning with the lowest."""
    u, v = AXES[(axis + 1) % 3], AXES[(axis + 2) % 3]
    base = AXES[axis] * side
    return (base, base + u, base + u + v, base + v) if side else (base, base + v, base + u + v, base + u)


#: The 6 faces: x = 0, x = 1, y = 0, y = 1, z = 0, z = 1.
FACES = tuple(_face(axis, side) for axis in range(3) for side in range(2))


@cache
def share_a_face(first: int, second: int) -> bool:
    """Tell whether two cube edges lie in one face of the cube, so that a chord between them would as well."""
    ends = (first, second)
    corners = [c for number in ends for c in (CUBE_EDGES[number].start, CUBE_EDGES[number].end)]
    in_all, in_any = 7, 0
    for corner in corners:
        in_all &= corner
        in_any |= corner
    return in_all != 0 or in_any != 7


def is_ambiguous(case: int, face: int) -> bool:
    """Tell whether a face has its two inside corners on a diagonal."""
    first, second, third, fourth = (case >> corner & 1 for corner in FACES[face])
    return first == third and second == fourth and first != second


def ambiguous_faces(case: int) -> tuple[int, ...]:
    """Numbers of the faces whose inside corners lie on a diagonal, ascending."""
    return tuple(face for face in range(6) if is_ambiguous(case, face))


def boundary_loops(case: int, joined: frozenset[int] = frozenset()) -> tuple[tuple[int, ...], ...]:
    """Polygons in which the surface meets the boundary of the cell.

    On each face every run of inside corners is cut off by one segment; on an ambiguous face the two inside
    corners are cut off apart, or, for faces in `joined`, the two outside corners are. Both cells at a face
    see the same corners and so draw the same segments: that alone makes the surface watertight.

    Parameters
    ----------
    case : int
        Which corners are inside, 0..255.
    joined : frozenset of int
        Ambiguous faces on which the inside corners are connected.

    Returns
    -------
    tuple of loops
        Each loop is a tuple of cube edges, starting at its lowest one, counter-clockwise seen from outside
        (where values are low); ordered by their lowest edge.
    """
    successor: dict[int, int] = {}
    for number, face in enumerate(FACES):
        inside = [case >> corner & 1 for corner in face]
        # Walking round the face, the surface enters the inside at some edges and leaves it at others.
        around = [edge_between(face[i], face[(i + 1) % 4]) for i in range(4)]
        leaving = [i for i in range(4) if inside[i] and not inside[(i + 1) % 4]]
        for i in leaving:
            direction = 1 if number in joined and is_ambiguous(case, number) else -1
            j = (i + direction) % 4
            while inside[j] or not inside[(j + 1) % 4]:
                j = (j + direction) % 4
            successor[around[j]] = around[i]
    loops = []
    while successor:
        first = min(successor)
        loop = [first]
        while (edge := successor.pop(loop[-1])) != first:
            loop.append(edge)
        loops.append(tuple(loop))
    return tuple(loops)
