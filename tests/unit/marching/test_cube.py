"""The geometry of the cell, and the polygons in which a surface leaves it."""

from __future__ import annotations

from collections import Counter

import numpy as np

from volviz.kernels.marching.cube import (
    CUBE_EDGES,
    FACES,
    ambiguous_faces,
    boundary_loops,
    corner_position,
    edge_between,
    share_a_face,
)

from .meshes import for_every_case


def every_decision(case):
    faces = ambiguous_faces(case)
    for bits in range(1 << len(faces)):
        yield frozenset(face for i, face in enumerate(faces) if bits >> i & 1)


def test_the_cube_has_12_edges_of_length_one():
    assert len(set(CUBE_EDGES)) == 12
    lengths = [np.linalg.norm(corner_position(e.end) - corner_position(e.start)) for e in CUBE_EDGES]
    assert lengths == [1.0] * 12
    assert all(
        edge_between(e.start, e.end) == edge_between(e.end, e.start) == i for i, e in enumerate(CUBE_EDGES)
    )


def test_faces_are_counter_clockwise_seen_from_outside():
    for corners in FACES:
        a, b, c, d = map(corner_position, corners)
        outward = (a + b + c + d) / 4 - 0.5
        assert np.cross(b - a, c - a) @ outward > 0
        assert np.allclose(a + c, b + d)


def test_every_edge_lies_in_two_faces():
    uses = Counter(edge_between(face[i], face[(i + 1) % 4]) for face in FACES for i in range(4))
    assert uses == dict.fromkeys(range(12), 2)


def test_edges_share_a_face_when_all_their_corners_lie_in_one():
    for i, first in enumerate(CUBE_EDGES):
        for j, second in enumerate(CUBE_EDGES):
            corners = {first.start, first.end, second.start, second.end}
            assert share_a_face(i, j) == any(corners <= set(face) for face in FACES)


@for_every_case
def test_loops_pass_every_crossed_edge_once(case):
    crossed = [i for i, edge in enumerate(CUBE_EDGES) if edge.is_crossed(case)]
    for joined in every_decision(case):
        loops = boundary_loops(case, joined)
        assert sorted(edge for loop in loops for edge in loop) == crossed
        for loop in loops:
            assert len(loop) >= 3
            assert all(share_a_face(a, b) for a, b in zip(loop, (*loop[1:], loop[0]), strict=True))


def test_a_single_corner_is_cut_off_with_its_triangle_facing_away():
    for corner in range(8):
        (loop,) = boundary_loops(1 << corner)
        a, b, c = (CUBE_EDGES[edge].middle for edge in loop)
        assert np.cross(b - a, c - a) @ ((a + b + c) / 3 - corner_position(corner)) > 0


@for_every_case
def test_the_complement_has_the_reversed_loops_when_its_faces_are_decided_the_other_way(case):
    for joined in every_decision(case):
        other = frozenset(ambiguous_faces(case)) - joined
        turned = {
            frozenset(zip(loop, (*loop[1:], loop[0]), strict=True)) for loop in boundary_loops(case, joined)
        }
        complement = {
            frozenset((b, a) for a, b in zip(loop, (*loop[1:], loop[0]), strict=True))
            for loop in boundary_loops(255 - case, other)
        }
        assert turned == complement


def test_neighbouring_cells_draw_the_same_segments_on_their_common_face():
    def segments(case, joined, face):
        on_face = {edge_between(FACES[face][i], FACES[face][(i + 1) % 4]) for i in range(4)}
        pairs = {
            (a, b)
            for loop in boundary_loops(case, joined)
            for a, b in zip(loop, (*loop[1:], loop[0]), strict=True)
        }
        # Two edges of one face may also be neighbours round a corner of another face: those have no common
        # face edge.
        return {(a, b) for a, b in pairs if a in on_face and b in on_face and _is_on(face, a, b)}

    def _is_on(face, a, b):
        corners = {CUBE_EDGES[e][0] for e in (a, b)} | {CUBE_EDGES[e].end for e in (a, b)}
        return corners <= set(FACES[face])

    # The face x = 1 of a cell is the face x = 0 of the next one: corners 1, 3, 5, 7 become 0, 2, 4, 6.
    for pattern in range(16):
        corners = [1, 3, 5, 7]
        case = sum(1 << c for i, c in enumerate(corners) if pattern >> i & 1)
        neighbour = case >> 1
        for is_joined in (False, True):
            left = segments(case, frozenset({1}) if is_joined else frozenset(), 1)
            right = segments(neighbour, frozenset({0}) if is_joined else frozenset(), 0)
            moved = {(_moved(a), _moved(b)) for a, b in left}
            assert moved == {(b, a) for a, b in right}


def _moved(edge):
    start, end = CUBE_EDGES[edge].start, CUBE_EDGES[edge].end
    return edge_between(start - 1, end - 1)
