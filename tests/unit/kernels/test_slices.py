"""Plane and box: areas by an exact formula, convex order, every direction and every kind of box."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from volviz.errors import InputError
from volviz.kernels.slices import (
    box_distance_range,
    crop_corners,
    edge_order,
    fan_triangles,
    outline_segments,
    slab_centres,
    slice_polygons,
)

BITS = np.array([[c & 1, c >> 1 & 1, c >> 2 & 1] for c in range(8)], float)


def oblique_box(seed, left_handed=False):
    """An anisotropic box in a random orientation."""
    rng = np.random.default_rng(seed)
    edges = Rotation.random(random_state=seed).as_matrix() * rng.uniform(0.3, 40, 3)
    if left_handed:
        edges[:, 0] *= -1
    return BITS @ edges.T + rng.uniform(-50, 50, 3)


def random_direction(seed):
    d = np.random.default_rng(seed + 1).normal(size=3)
    return d / np.linalg.norm(d)


def area_vector(polygon):
    """Half the sum of cross products: its length is the area, it points along the normal."""
    return 0.5 * np.cross(polygon - polygon[0], np.roll(polygon, -1, axis=0) - polygon[0]).sum(axis=0)


def exact_area(corners, direction, distance):
    """Derivative of the volume that a half-space cuts off a box, by inclusion and exclusion of its corners.

    V(d) = |box| / (6 a1 a2 a3) * sum over corners of (-1)^bits max(0, d - distance of the corner)^3, with a
    = extent of the edges along the direction; exact for directions that are parallel to no face.
    """
    edges = corners[[1, 2, 4]] - corners[0]
    along = edges @ direction
    lowest = (corners @ direction).min()
    a = np.abs(along)
    total = sum((-1) ** int(sum(bits)) * max(0.0, distance - lowest - np.dot(bits, a)) ** 2 for bits in BITS)
    return abs(np.linalg.det(edges)) * total / (2 * np.prod(a))


def test_the_derived_table_walks_every_edge_of_the_box_once():
    edges_of_the_box = {frozenset((a, a ^ bit)) for a in range(8) for bit in (1, 2, 4)}
    for front, order in enumerate(edge_order()):
        assert len(order) == 12
        assert {frozenset(edge) for edge in order.tolist()} == edges_of_the_box
        for start in (0, 4, 8):
            path = order[start : start + 3]
            assert path[0, 0] == front
            assert path[2, 1] == front ^ 7
            assert path[0, 1] == path[1, 0]
            assert path[1, 1] == path[2, 0]
        for start in (0, 4, 8):
            between = order[start + 3]
            assert between[1] == order[start + 1, 1]
            assert between[0] == order[(start + 4) % 12, 1]


@settings(max_examples=200, deadline=None)
@given(seed=st.integers(0, 10**6), share=st.floats(0.001, 0.999), left_handed=st.booleans())
def test_areas_match_the_exact_formula(seed, share, left_handed):
    corners, direction = oblique_box(seed, left_handed), random_direction(seed)
    lo, hi = box_distance_range(corners, direction)
    distance = lo + share * (hi - lo)
    edges = corners[[1, 2, 4]] - corners[0]
    if np.min(np.abs(edges @ direction)) < 0.02 * (hi - lo):
        return  # the formula divides by these extents; flat directions have their own tests
    vertices, counts = slice_polygons(corners, direction, [distance])
    assert 3 <= counts[0] <= 6
    vector = area_vector(vertices[0, : counts[0]])
    scale = np.prod(np.sort(np.linalg.norm(edges, axis=1))[1:])
    assert abs(np.linalg.norm(vector) - exact_area(corners, direction, distance)) < 1e-9 * scale


@settings(max_examples=200, deadline=None)
@given(seed=st.integers(0, 10**6), left_handed=st.booleans(), flat=st.sampled_from([None, 0, 1, 2]))
def test_polygons_are_convex_counter_clockwise_and_equal_to_their_hull(seed, left_handed, flat):
    corners, direction = oblique_box(seed, left_handed), random_direction(seed)
    if flat is not None:
        axis = corners[1 << flat] - corners[0]
        direction -= (direction @ axis) / (axis @ axis) * axis
        direction /= np.linalg.norm(direction)
    lo, hi = box_distance_range(corners, direction)
    vertices, counts = slice_polygons(corners, direction, slab_centres(lo, hi, 17))
    size = np.linalg.norm(corners[7] - corners[0])
    helper = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
    helper /= np.linalg.norm(helper)
    plane = np.stack([helper, np.cross(direction, helper)], axis=1)
    for polygon, n, d in zip(vertices, counts, slab_centres(lo, hi, 17), strict=True):
        assert 3 <= n <= 6
        used = polygon[:n]
        np.testing.assert_allclose(used @ direction, d, atol=1e-10 * size + 1e-10)
        assert area_vector(used) @ direction < 0, (
            "counter-clockwise seen by the eye means a normal towards it"
        )
        sides = np.roll(used, -1, axis=0) - used
        turns = np.cross(sides, np.roll(sides, -1, axis=0)) @ direction
        assert np.all(turns <= 1e-9 * size**2)
        hull = ConvexHull(used @ plane)
        assert abs(hull.volume - np.linalg.norm(area_vector(used))) < 1e-8 * size**2
        np.testing.assert_array_equal(polygon[n:], np.broadcast_to(polygon[n - 1], (6 - n, 3)))


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_face_on_view_gives_the_full_rectangle_even_on_the_faces(axis, sign):
    size = np.array([3.0, 5.0, 7.0])
    corners = BITS * size + 1
    direction = np.zeros(3)
    direction[axis] = sign
    lo, hi = box_distance_range(corners, direction)
    vertices, counts = slice_polygons(corners, direction, [lo, lo + 1e-9, (lo + hi) / 2, hi])
    np.testing.assert_array_equal(counts, 4)
    expected = np.prod(size) / size[axis]
    for polygon in vertices:
        np.testing.assert_allclose(np.linalg.norm(area_vector(polygon[:4])), expected, rtol=1e-12)


@pytest.mark.parametrize("direction", list(itertools.product([-1, 0, 1], repeat=3)))
def test_a_cube_cut_through_its_middle_has_the_known_shape(direction):
    if not any(direction):
        return
    d = np.array(direction, float) / np.linalg.norm(direction)
    vertices, counts = slice_polygons(BITS - 0.5, d, [0.0])
    nonzero = sum(v != 0 for v in direction)
    expected_area = {1: 1.0, 2: np.sqrt(2), 3: 3 * np.sqrt(3) / 4}[nonzero]
    assert counts[0] == {1: 4, 2: 4, 3: 6}[nonzero]
    np.testing.assert_allclose(
        np.linalg.norm(area_vector(vertices[0, : counts[0]])), expected_area, rtol=1e-12
    )


def test_planes_outside_or_at_a_corner_give_nothing():
    d = np.ones(3) / np.sqrt(3)
    _, counts = slice_polygons(BITS, d, [-0.1, 0.0, np.sqrt(3) + 0.1])
    np.testing.assert_array_equal(counts, 0)


def test_areas_sum_up_to_the_volume_of_the_box():
    corners, direction = oblique_box(4), random_direction(4)
    lo, hi = box_distance_range(corners, direction)
    count = 4000
    vertices, counts = slice_polygons(corners, direction, slab_centres(lo, hi, count))
    positions, _ = fan_triangles(vertices, counts)
    a, b, c = positions.astype(float).reshape(-1, 3, 3).swapaxes(0, 1)
    volume = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() * (hi - lo) / count
    edges = corners[[1, 2, 4]] - corners[0]
    np.testing.assert_allclose(volume, abs(np.linalg.det(edges)), rtol=1e-5)


def test_fans_and_outlines_hold_exactly_the_polygons():
    corners, direction = oblique_box(7), random_direction(7)
    lo, hi = box_distance_range(corners, direction)
    distances = np.concatenate([[lo - 1], slab_centres(lo, hi, 9), [hi + 1]])
    vertices, counts = slice_polygons(corners, direction, distances)
    triangles, first = fan_triangles(vertices, counts)
    assert len(triangles) == first[-1] == 3 * np.maximum(counts - 2, 0).sum()
    lines, first_line = outline_segments(vertices, counts)
    assert len(lines) == first_line[-1] == 2 * counts.sum()
    for s, n in enumerate(counts):
        fan = triangles[first[s] : first[s + 1]].reshape(-1, 3, 3)
        expected = [vertices[s, [0, i + 1, i + 2]] for i in range(max(n - 2, 0))]
        np.testing.assert_array_equal(fan, np.array(expected, np.float32).reshape(-1, 3, 3))
        segments = lines[first_line[s] : first_line[s + 1]].reshape(-1, 2, 3)
        expected = [vertices[s, [i, (i + 1) % n]] for i in range(n)]
        np.testing.assert_array_equal(segments, np.array(expected, np.float32).reshape(-1, 2, 3))


def test_slab_centres_lie_in_the_middle_of_equal_slabs():
    np.testing.assert_allclose(slab_centres(2.0, 4.0, 4), [2.25, 2.75, 3.25, 3.75])


def test_crop_corners_follow_the_index_axes():
    matrix = np.eye(4)
    matrix[:3, :3] = np.array([[0, -2, 0], [1, 0, 0], [0, 0, 3]], float)
    matrix[:3, 3] = 10, 20, 30
    full = crop_corners(matrix, None, (5, 6, 7))
    np.testing.assert_array_equal(full[0], [10, 20, 30])
    np.testing.assert_array_equal(full[7], [10 - 10, 20 + 4, 30 + 18])
    cropped = crop_corners(matrix, (1, 2, 0.5, 3, 0, 6), (5, 6, 7))
    np.testing.assert_array_equal(cropped[1], [10 - 1, 20 + 2, 30])


def test_bad_arguments_are_refused_in_words():
    with pytest.raises(InputError, match="length zero"):
        slice_polygons(BITS, (0, 0, 0), [0.5])
    with pytest.raises(InputError, match=r"\(8, 3\)"):
        slice_polygons(BITS[:4], (0, 0, 1), [0.5])
    with pytest.raises(InputError, match="at least 1"):
        slab_centres(0, 1, 0)


def test_cutting_two_thousand_slices_is_timed(benchmark):
    """`make bench` says how long it takes: 5 ms leave time to draw."""
    corners, direction = oblique_box(3), random_direction(3)
    distances = slab_centres(*box_distance_range(corners, direction), 2048)
    vertices, triangles = benchmark(lambda: fan_triangles(*slice_polygons(corners, direction, distances)))[:2]
    assert len(vertices) > 3 * 2048
    assert len(triangles) > 2048
