"""Tables of the method with the topology of the trilinear interpolant (the 33 cases of Chernyaev 1995).

A configuration is a case, the ambiguous faces on which inside corners are joined, and the kind of tunnel. Its
loops on the boundary are filled with discs, or two of them are connected by a tube. A loop that no set of
chords inside the cell can fill gets one more vertex in the middle of the cell.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import combinations

import numpy as np
import numpy.typing as npt

from volviz.kernels.marching.cube import (
    AXES,
    CUBE_EDGES,
    FACES,
    Edge,
    ambiguous_faces,
    boundary_loops,
    edges_with_steps,
)
from volviz.kernels.marching.tables import CellTables, pack
from volviz.kernels.marching.triangulation import (
    CENTRES,
    Triangle,
    fill_loop,
    fill_loop_round_the_centre,
    fill_tunnel,
)
from volviz.kernels.marching.trilinear import INSIDE_TUNNEL, NO_TUNNEL, OUTSIDE_TUNNEL

Loop = tuple[int, ...]


@dataclass(frozen=True, eq=False)
class TopologicalTables:
    """Tables of all configurations, and how to find the one of a cell.

    Attributes
    ----------
    cells : CellTables
        One row a configuration; rows 0..255 are the cases that need no decision.
    first_row : ndarray of shape (256,), int64
        Where the configurations of a case that needs decisions begin; -1 for a case that needs none. They are
        ordered by the bits of the joined faces, ambiguous ones only, then by tunnel: row = first + 3 * bits +
        tunnel.
    faces : ndarray of shape (256, 6), int64
        Ambiguous faces of a case in the order of those bits, then -1.
    inside_regions : ndarray of shape (N,), int64
        Connected parts of the inside on the boundary of the cell.
    """

    cells: CellTables
    first_row: npt.NDArray[np.int64]
    faces: npt.NDArray[np.int64]
    inside_regions: npt.NDArray[np.int64]


def boundary_regions(case: int, joined: frozenset[int]) -> tuple[int, ...]:
    """Connected parts of inside and outside on the boundary of the cell.

    Parameters
    ----------
    case : int
        Which corners are inside.
    joined : frozenset of int
        Ambiguous faces on which the inside corners are connected.

    Returns
    -------
    tuple of 8 ints
        For each corner the lowest corner of its part.
    """
    region = list(range(8))

    def unite(first: int, second: int) -> None:
        old, new = max(region[first], region[second]), min(region[first], region[second])
        region[:] = [new if r == old else r for r in region]

    for edge in CUBE_EDGES:
        if not edge.is_crossed(case):
            unite(edge.start, edge.end)
    for face in ambiguous_faces(case):
        inside_first = case >> FACES[face][0] & 1 == 1
        a, b, c, d = FACES[face]
        if inside_first == (face in joined):
            unite(a, c)
        else:
            unite(b, d)
    return tuple(region)


def tunnel_loops(case: int, joined: frozenset[int], tunnel: int) -> tuple[tuple[Loop, Loop], ...]:
    """Pairs of boundary loops that a tunnel may connect.

    A tube through the cell joins two regions of one side that border on the same region of the other side.
    """
    region = boundary_regions(case, joined)

    def sides(loop: Loop) -> tuple[int, int]:
        edge = CUBE_EDGES[loop[0]]
        inside, outside = (edge.start, edge.end) if case >> edge.start & 1 else (edge.end, edge.start)
        return region[inside], region[outside]

    pairs = []
    for first, second in combinations(boundary_loops(case, joined), 2):
        (in1, out1), (in2, out2) = sides(first), sides(second)
        if tunnel == INSIDE_TUNNEL and in1 != in2 and out1 == out2:
            pairs.append((first, second))
        if tunnel == OUTSIDE_TUNNEL and out1 != out2 and in1 == in2:
            pairs.append((first, second))
    return tuple(pairs)


def configuration_triangles(case: int, joined: frozenset[int], tunnel: int) -> tuple[Triangle, ...]:
    """Triangles of one configuration, without the tunnel when there are no two loops to connect."""
    loops = list(boundary_loops(case, joined))
    triangles: list[Triangle] = []
    if tunnel != NO_TUNNEL:
        pairs = tunnel_loops(case, joined, tunnel)
        if len(pairs) == 1:
            triangles += fill_tunnel(*pairs[0])
            loops = [loop for loop in loops if loop not in pairs[0]]
    for loop in loops:
        triangles += fill_loop(loop) or fill_loop_round_the_centre(loop)
    return tuple(triangles)


@cache
def topological_tables() -> TopologicalTables:
    """Tables of all configurations of a cell."""
    rows: list[tuple[int, frozenset[int], int]] = [(case, frozenset(), NO_TUNNEL) for case in range(256)]
    first_row = np.full(256, -1, np.int64)
    faces = np.full((256, 6), -1, np.int64)
    for case in range(256):
        ambiguous = ambiguous_faces(case)
        if not ambiguous and len(boundary_loops(case)) < 2:
            continue
        faces[case, : len(ambiguous)] = ambiguous
        first_row[case] = len(rows)
        for bits in range(1 << len(ambiguous)):
            joined = frozenset(face for i, face in enumerate(ambiguous) if bits >> i & 1)
            rows += [(case, joined, tunnel) for tunnel in (NO_TUNNEL, INSIDE_TUNNEL, OUTSIDE_TUNNEL)]
    edges = (*edges_with_steps(AXES), *[Edge(0, 0)] * CENTRES)
    cells = pack(edges, [row[0] for row in rows], [configuration_triangles(*row) for row in rows])
    regions = []
    for case, joined, _ in rows:
        region = boundary_regions(case, joined)
        regions.append(len({region[corner] for corner in range(8) if case >> corner & 1}))
    inside_regions = np.array(regions, np.int64)
    for array in (first_row, faces, inside_regions):
        array.flags.writeable = False
    return TopologicalTables(cells, first_row, faces, inside_regions)
