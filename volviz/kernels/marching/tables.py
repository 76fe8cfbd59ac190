"""What the compiled loops read: triangles and running vertex numbers of every configuration of a cell.

A row of voxels is walked from left to right over its active cells only. Each edge of the cell (a *lane*) has
a counter that holds the number of the next vertex on the row of edges it belongs to; passing a cell moves it
on by the crossed edges of that cell. So no vertex is ever looked up in a neighbour: the numbers follow from
the configurations alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import permutations

import numpy as np
import numpy.typing as npt

from volviz.kernels.marching.cube import AXES, Edge, boundary_loops, corner_position, edges_with_steps
from volviz.kernels.marching.triangulation import Triangle, fill_loop

#: Width of the rows of `CellTables.shift` and `advance`: one 512-bit vector of int32 for the cube's edges,
#: two for those of six tetrahedra.
LANE_MULTIPLE = 16


@dataclass(frozen=True, eq=False)
class CellTables:
    """Tables of one method; the first 256 configurations are the cases, see `volviz.kernels.marching.cube`.

    Attributes
    ----------
    edges : tuple of Edge
        What each lane stands for, ordered by step; a last lane with step 0 stands for the cell's own middle
        vertex.
    steps : tuple of int
        The different steps, ascending: kinds of vertices.
    triangle_count : ndarray of shape (N,), uint8
        Triangles of each configuration.
    triangles : ndarray of shape (N, 3 * most), uint8
        Lanes of their vertices, three for each triangle; room for an even number of triangles.
    shift : ndarray of shape (N, lanes), int32
        What to add to a lane's counter for its vertex in this cell: 1 on the right-hand edges whose left-hand
        neighbour, which has the same counter, is crossed.
    middle_count : ndarray of shape (N,), uint8
        Vertices in the middle of the cell.
    advance : ndarray of shape (N, lanes), int32
        By how much a lane's counter moves on behind this cell.
    """

    edges: tuple[Edge, ...]
    steps: tuple[int, ...]
    triangle_count: npt.NDArray[np.uint8]
    triangles: npt.NDArray[np.uint8]
    shift: npt.NDArray[np.int32]
    advance: npt.NDArray[np.int32]
    middle_count: npt.NDArray[np.uint8]


def pack(edges: Sequence[Edge], cases: Sequence[int], triangles: Sequence[Sequence[Triangle]]) -> CellTables:
    """Put generated triangles into arrays for the compiled loops.

    Parameters
    ----------
    edges : sequence of Edge
        What each lane stands for.
    cases : sequence of int
        Which corners are inside, for each of the N configurations.
    triangles : sequence of N sequences of triangles
        Lanes of the vertices.
    """
    middle_count = np.zeros(len(cases), np.uint8)
    lanes = -(-len(edges) // LANE_MULTIPLE) * LANE_MULTIPLE
    shift = np.zeros((len(cases), lanes), np.int32)
    advance = np.zeros((len(cases), lanes), np.int32)
    for row, case in enumerate(cases):
        middles = len({lane for triangle in triangles[row] for lane in triangle if not edges[lane].step})
        middle_count[row] = middles
        first_middle = len([edge for edge in edges if edge.step])
        for lane, edge in enumerate(edges):
            if edge.step == 0:
                advance[row, lane] = middles
                shift[row, lane] = lane - first_middle
                continue
            left = Edge(edge.start & ~1, edge.step)
            advance[row, lane] = left.is_crossed(case)
            shift[row, lane] = left != edge and left.is_crossed(case)
    most = max(len(t) for t in triangles)
    most += most % 2
    flat = np.zeros((len(cases), 3 * most), np.uint8)
    for row, t in enumerate(triangles):
        flat[row, : 3 * len(t)] = np.array(t, np.uint8).ravel()
    for array in (flat, shift, advance, middle_count):
        array.flags.writeable = False
    count = np.array([len(t) for t in triangles], np.uint8)
    count.flags.writeable = False
    steps = tuple(sorted({edge.step for edge in edges if edge.step}))
    return CellTables(tuple(edges), steps, count, flat, shift, advance, middle_count)


@cache
def lorensen_tables() -> CellTables:
    """Tables of the classic method: 256 cases, inside corners of ambiguous faces cut off apart (as VTK does).

    After Lorensen and Cline (1987); the consistent choice on faces after Nielson and Hamann (1991).
    """
    triangles = []
    for case in range(256):
        filled = [fill_loop(loop) for loop in boundary_loops(case)]
        triangles.append([triangle for loop in filled if loop is not None for triangle in loop])
    return pack(edges_with_steps(AXES), range(256), triangles)


@cache
def tetrahedra_tables() -> CellTables:
    """Tables of the six tetrahedra round the diagonal from corner 0 to corner 7.

    Each tetrahedron goes from corner 0 to 7 by three steps along the axes, in one of the six orders;
    neighbouring cells then agree on the diagonals of their common face without mirroring. After Bloomenthal
    (1994).
    """
    edges = edges_with_steps(tuple(range(1, 8)))
    lane = {frozenset((edge.start, edge.end)): number for number, edge in enumerate(edges)}
    triangles = []
    for case in range(256):
        here: list[Triangle] = []
        for a, b, _ in permutations(AXES):
            here += _tetrahedron_triangles((0, a, a + b, 7), case, edges, lane)
        triangles.append(here)
    return pack(edges, range(256), triangles)


def _tetrahedron_triangles(
    corners: tuple[int, int, int, int], case: int, edges: Sequence[Edge], lane: dict[frozenset[int], int]
) -> list[Triangle]:
    """None, one or two triangles that part a tetrahedron's inside corners from the others."""
    inside = [c for c in corners if case >> c & 1]
    outside = [c for c in corners if not case >> c & 1]
    if not inside or not outside:
        return []
    # In this order neighbours in the list lie on a common face of the tetrahedron.
    ring = [lane[frozenset((i, o))] for i in inside for o in outside]
    if len(inside) == len(outside):
        ring[2], ring[3] = ring[3], ring[2]
    middle = [edges[number].middle for number in ring]
    outward = sum(corner_position(c) for c in outside) / len(outside) - sum(
        corner_position(c) for c in inside
    ) / len(inside)
    if np.cross(middle[1] - middle[0], middle[2] - middle[0]) @ outward < 0:
        ring.reverse()
    return [(ring[0], ring[k], ring[k + 1]) for k in range(1, len(ring) - 1)]


def mirrored(tables: CellTables) -> CellTables:
    """The same tables with all triangles turned over."""
    triangles = tables.triangles.reshape(len(tables.triangles), -1, 3)[:, :, [0, 2, 1]]
    turned = np.ascontiguousarray(triangles.reshape(tables.triangles.shape))
    turned.flags.writeable = False
    return replace(tables, triangles=turned)


def with_hidden_cases(tables: CellTables) -> CellTables:
    """The same tables, then the 256 cases once more without triangles: cells that count but are not drawn."""
    drawn = (tables.triangle_count, tables.triangles, tables.middle_count)
    empty = [np.zeros_like(table[:256]) for table in drawn]
    longer = [
        np.concatenate([table, more])
        for table, more in (
            (tables.triangle_count, empty[0]),
            (tables.triangles, empty[1]),
            (tables.shift, tables.shift[:256]),
            (tables.advance, tables.advance[:256]),
            (tables.middle_count, empty[2]),
        )
    ]
    for table in longer:
        table.flags.writeable = False
    return CellTables(tables.edges, tables.steps, *longer)
