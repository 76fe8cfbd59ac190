"""The generated tables: manifold cells, running numbers, and the known sums."""

from __future__ import annotations

from collections import Counter
from itertools import permutations

import numpy as np
import pytest

from volviz.kernels.marching.cube import CUBE_EDGES, Edge, boundary_loops, share_a_face
from volviz.kernels.marching.tables import lorensen_tables, mirrored, tetrahedra_tables, with_hidden_cases
from volviz.kernels.marching.topology import (
    boundary_regions,
    configuration_triangles,
    topological_tables,
    tunnel_loops,
)
from volviz.kernels.marching.triangulation import CENTRE, fill_loop, fill_tunnel
from volviz.kernels.marching.trilinear import INSIDE_TUNNEL, NO_TUNNEL, OUTSIDE_TUNNEL

from .meshes import for_every_case
from .test_cube import every_decision

TUNNELS = (NO_TUNNEL, INSIDE_TUNNEL, OUTSIDE_TUNNEL)


def rows_of(tables, row):
    count = tables.triangle_count[row]
    return [tuple(map(int, t)) for t in tables.triangles[row, : 3 * count].reshape(-1, 3)]


def sides(triangles):
    return Counter((t[i], t[(i + 1) % 3]) for t in triangles for i in range(3))


def assert_cell_is_manifold(triangles, loops):
    """Every side is used once each way but for the loops, and no chord lies in a face of the cube."""
    directed = sides(triangles)
    assert max(directed.values(), default=1) == 1
    boundary = {side for side in directed if side[::-1] not in directed}
    wanted = {(a, b) for loop in loops for a, b in zip(loop, (*loop[1:], loop[0]), strict=True)}
    assert boundary == wanted
    for a, b in directed:
        if (a, b) not in wanted and (b, a) not in wanted and max(a, b) < CENTRE:
            assert not share_a_face(a, b)


@for_every_case
def test_lorensen_cells_are_filled_without_chords_in_faces(case):
    assert_cell_is_manifold(rows_of(lorensen_tables(), case), boundary_loops(case))


def test_lorensen_has_820_triangles_in_all_cases_and_at_most_5_in_one():
    assert lorensen_tables().triangle_count.sum() == 820
    assert lorensen_tables().triangle_count.max() == 5


def test_the_number_of_triangles_does_not_depend_on_how_the_cell_is_turned():
    counts = lorensen_tables().triangle_count
    for axes in permutations(range(3)):
        for flips in range(8):
            corner = [sum(((c ^ flips) >> axis & 1) << i for i, axis in enumerate(axes)) for c in range(8)]
            for case in range(256):
                turned = sum(1 << corner[c] for c in range(8) if case >> c & 1)
                assert counts[turned] == counts[case]


@for_every_case
def test_every_topological_configuration_is_manifold(case):
    for joined in every_decision(case):
        for tunnel in TUNNELS:
            triangles = configuration_triangles(case, joined, tunnel)
            assert_cell_is_manifold(triangles, boundary_loops(case, joined))


def test_a_tunnel_lowers_the_euler_characteristic_by_two():
    met = 0
    for case in range(256):
        for joined in every_decision(case):
            for tunnel in TUNNELS[1:]:
                if len(tunnel_loops(case, joined, tunnel)) != 1:
                    continue
                met += 1
                chi = [_euler(configuration_triangles(case, joined, kind)) for kind in (NO_TUNNEL, tunnel)]
                assert chi[1] == chi[0] - 2
    assert met > 200


def _euler(triangles):
    edges = {frozenset(side) for side in sides(triangles)}
    return len({v for t in triangles for v in t}) - len(edges) + len(triangles)


def test_inside_and_outside_regions_are_one_more_than_loops():
    for case in range(1, 255):
        for joined in every_decision(case):
            assert len(set(boundary_regions(case, joined))) == len(boundary_loops(case, joined)) + 1


def test_topological_rows_without_decisions_are_those_of_lorensen():
    topological, lorensen = topological_tables(), lorensen_tables()
    for case in range(256):
        assert rows_of(topological.cells, case) == rows_of(lorensen, case)
        assert (topological.first_row[case] < 0) == (
            len(boundary_loops(case)) < 2 and not _is_ambiguous(case)
        )


def _is_ambiguous(case):
    return any(True for joined in every_decision(case) if joined)


@for_every_case
def test_tetrahedra_close_inside_the_cell(case):
    tables = tetrahedra_tables()
    directed = sides(rows_of(tables, case))
    assert max(directed.values(), default=1) == 1
    for a, b in directed:
        if (b, a) not in directed:
            corners = {c for lane in (a, b) for c in (tables.edges[lane].start, tables.edges[lane].end)}
            assert _lie_in_one_face(corners)


def _lie_in_one_face(corners):
    return any(len({c >> axis & 1 for c in corners}) == 1 for axis in range(3))


@pytest.mark.parametrize("make", [lorensen_tables, tetrahedra_tables, lambda: topological_tables().cells])
def test_triangles_use_crossed_edges_only_and_all_of_them(make):
    tables = make()
    for case in range(256):
        used = {lane for t in rows_of(tables, case) for lane in t}
        assert used == {lane for lane, edge in enumerate(tables.edges) if edge.is_crossed(case)}


@pytest.mark.parametrize("make", [lorensen_tables, tetrahedra_tables])
def test_running_numbers_give_the_number_of_crossed_edges_before(make):
    """A row of random corners, walked by the tables, against counting crossed edges directly."""
    tables = make()
    inside = np.random.default_rng(3).integers(0, 2, (2, 2, 40))

    def case_at(x):
        return sum(int(inside[c >> 2 & 1, c >> 1 & 1, x + (c & 1)]) << c for c in range(8))

    counters = np.zeros(tables.shift.shape[1], int)
    for x in range(39):
        case = case_at(x)
        numbers = counters + tables.shift[case]
        for lane, edge in enumerate(tables.edges):
            if not edge.is_crossed(case):
                continue
            own = x + (edge.start & 1)
            before = sum(_row_edge(edge, inside, at) for at in range(own))
            assert numbers[lane] == before
        counters += tables.advance[case]


def _row_edge(edge, inside, x):
    y, z = edge.start >> 1 & 1, edge.start >> 2 & 1
    dx, dy, dz = edge.step & 1, edge.step >> 1 & 1, edge.step >> 2 & 1
    if x + dx >= inside.shape[2]:
        return 0
    return int(inside[z, y, x] != inside[z + dz, y + dy, x + dx])


def test_mirrored_tables_have_every_triangle_turned_over():
    tables, turned = lorensen_tables(), mirrored(lorensen_tables())
    for case in range(256):
        assert [(a, c, b) for a, b, c in rows_of(tables, case)] == rows_of(turned, case)


def test_hidden_cases_count_edges_but_draw_nothing():
    tables = with_hidden_cases(topological_tables().cells)
    assert not tables.triangle_count[-256:].any()
    assert np.array_equal(tables.advance[-256:], tables.advance[:256])
    assert np.array_equal(tables.shift[-256:], tables.shift[:256])


def test_a_loop_that_only_chords_in_faces_could_fill_is_refused():
    # The four crossed edges of one face, taken as a loop: both diagonals lie in the face.
    assert fill_loop((0, 5, 1, 4)) is None
    assert all(CUBE_EDGES[e].start & 4 == 0 and CUBE_EDGES[e].end & 4 == 0 for e in (0, 5, 1, 4))


def test_a_tube_between_opposite_corners_needs_no_more_vertices():
    first, second = boundary_loops(0b10000001)
    triangles = fill_tunnel(first, second)
    assert len(triangles) == 6
    assert max(max(t) for t in triangles) < CENTRE


def test_lanes_of_the_topological_tables_end_with_two_vertices_in_the_cell():
    assert topological_tables().cells.edges[-2:] == (Edge(0, 0), Edge(0, 0))
