"""Dragging light and cut plane: what the pointer does to world points, without a window."""

from __future__ import annotations

import numpy as np
import pytest

from volviz.model.manipulators import Arcball, PlanePush, Projection, distance_to_segment, radius_in_view

SIZE = (200, 100)
CORNERS = np.array([[x, y, z] for z in (-1.0, 1.0) for y in (-1.0, 1.0) for x in (-1.0, 1.0)])


def perspective(eye: float = 6.0) -> Projection:
    """The view from (0, 0, eye) down the z axis, 60 degrees high, twice as wide."""
    near, far, t = 0.1, 100.0, np.tan(np.radians(30))
    projection = np.array(
        [
            [1 / (2 * t), 0, 0, 0],
            [0, 1 / t, 0, 0],
            [0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)],
            [0, 0, -1, 0],
        ]
    )
    view = np.eye(4)
    view[2, 3] = -eye
    return Projection(projection @ view, SIZE)


def test_pixels_count_from_the_upper_left() -> None:
    places = perspective().pixels([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    assert places[0] == pytest.approx((100, 50))
    assert places[1][0] > 100
    assert places[2][1] < 50


def test_points_behind_the_eye_have_no_pixel() -> None:
    assert np.isnan(perspective().pixels([(0, 0, 9)])).all()


def test_the_ray_through_a_points_pixel_goes_through_the_point() -> None:
    view, point = perspective(), np.array([0.7, -0.4, 1.1])
    start, along = view.ray(tuple(view.pixels(point)[0]))
    assert np.linalg.norm(np.cross(point - start, along)) < 1e-6


def test_a_pixel_of_the_world_is_a_pixel_on_the_screen() -> None:
    view, point = perspective(), np.array([0.3, 0.2, 1.0])
    unit = view.world_per_pixel(point)
    a, b = view.pixels([point, point + np.array([unit, 0, 0])])
    assert np.linalg.norm(b - a) == pytest.approx(1, rel=1e-3)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_point_dragged_over_a_sphere_stays_under_the_pointer_and_on_its_side(side: float) -> None:
    view = perspective()
    drag = Arcball(view, (0, 0, 0), (0, 0, 2 * side))
    for pixel in ((100, 50), (108, 46), (115, 60)):
        point = 2 * drag.to(pixel)
        assert view.pixels(point)[0] == pytest.approx(pixel, abs=1e-6)
        assert np.sign(point[2]) == side


def test_a_drag_around_the_edge_of_the_sphere_goes_on_behind_it() -> None:
    view = perspective()
    drag = Arcball(view, (0, 0, 0), (0, 0, 2.0))
    edge = drag.to((190, 50))
    assert abs(edge[1]) < 1e-9
    assert edge[0] > 0.9
    assert view.pixels(2 * edge)[0][1] == pytest.approx(50)
    behind = drag.to((110, 50))
    assert behind[2] < 0


def test_a_sphere_behind_the_eye_is_left_where_it_is() -> None:
    drag = Arcball(perspective(), (0, 0, 30), (0, 1, 30))
    assert drag.to((10, 90)) == pytest.approx((0, 1, 0))


def test_a_push_across_the_view_keeps_the_plane_under_the_pointer() -> None:
    view = perspective()
    at = tuple(view.pixels((0, 0, 0))[0])
    push = PlanePush(view, (0, 0, 0), (1, 0, 0), CORNERS, at)
    origin = push.to((at[0] + 7, at[1] + 30))
    assert origin[1:] == pytest.approx((0, 0))
    assert view.pixels(origin)[0][0] == pytest.approx(at[0] + 7, abs=0.05)


def test_a_plane_seen_face_on_is_pushed_away_by_dragging_up() -> None:
    for normal in ((0, 0, 1), (0, 0, -1)):
        push = PlanePush(perspective(), (0, 0, 0), normal, CORNERS, (100, 50))
        assert push.to((100, 45))[2] < -0.1
        assert push.to((100, 55))[2] > 0.1


def test_a_plane_cannot_be_pushed_out_of_its_box() -> None:
    push = PlanePush(perspective(), (0.2, 0, 0), (1, 0, 0), CORNERS, (100, 50))
    assert 0.99 < push.to((1000, 50))[0] < 1.0
    assert -1.0 < push.to((-1000, 50))[0] < -0.99


def test_a_sphere_in_view_keeps_its_margin_wherever_the_light_is() -> None:
    view = perspective()
    radius = radius_in_view(view, (0, 0, 0), 10)
    directions = np.random.default_rng(1).normal(size=(200, 3))
    points = radius * directions / np.linalg.norm(directions, axis=1, keepdims=True)
    pixels = view.pixels(points)
    rim = np.minimum(pixels, np.array(SIZE) - pixels).min(axis=0)
    assert rim.min() > 5
    assert rim[1] < 20


def test_a_sphere_beside_the_picture_still_has_a_size() -> None:
    assert radius_in_view(perspective(), (50, 0, 0), 10) > 0


def test_the_distance_to_a_segment_counts_its_ends() -> None:
    a, b = np.array([0.0, 0.0]), np.array([10.0, 0.0])
    assert distance_to_segment((5, 3), a, b) == 3
    assert distance_to_segment((13, 4), a, b) == 5
    assert distance_to_segment((1, 1), a, np.array([np.nan, 0])) == np.inf
