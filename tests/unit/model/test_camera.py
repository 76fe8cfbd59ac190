"""What a camera takes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from volviz import Camera
from volviz.errors import InputError


def test_arrays_become_plain_numbers_so_that_cameras_can_be_compared() -> None:
    one = Camera(np.array([0, -5, 0]), np.zeros(3), [0, 0, 1])  # type: ignore[arg-type]
    assert one == Camera((0.0, -5.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    assert hash(one) == hash(Camera((0.0, -5.0, 0.0), (0.0, 0.0, 0.0)))
    assert Camera.coerce([np.array([0, -5, 0]), (0, 0, 0), (0, 0, 1)]) == one


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (((0, -5), (0, 0, 0)), "position of a camera"),
        (((0, -5, np.nan), (0, 0, 0)), "position of a camera"),
        (((0, -5, 0), "xyz"), "focal_point of a camera"),
        (((0, -5, 0), (0, 0, 0), None), "view_up of a camera"),
        (((0, -5, 0), (0, -5, 0)), "the same point"),
        (((0, -5, 0), (0, 0, 0), (0, 1, 0)), "along the view"),
        (((0, -5, 0), (0, 0, 0), (0, 0, 1), 180.0), "view_angle"),
        (((0, -5, 0), (0, 0, 0), (0, 0, 1), 30.0, True, 0.0), "parallel_scale"),
    ],
)
def test_what_is_no_camera_is_refused_in_words(values: tuple[Any, ...], words: str) -> None:
    with pytest.raises(InputError, match=words):
        Camera(*values)


@pytest.mark.parametrize("parallel", [False, True])
def test_matrices_put_the_focal_point_in_the_middle_and_the_planes_at_the_ends(parallel: bool) -> None:
    camera = Camera((3.0, -40.0, 5.0), (1.0, 2.0, 3.0), (0.1, 0.2, 1.0), 35.0, parallel)
    near, far = 10.0, 90.0
    view, projection = camera.matrices(1.5, (near, far))
    np.testing.assert_allclose(view[:3, :3] @ view[:3, :3].T, np.eye(3), atol=1e-12)
    eye, direction = np.array(camera.position), np.array(camera.direction)
    for distance, depth in ((near, -1.0), (far, 1.0)):
        clip = projection @ view @ np.append(eye + distance * direction, 1.0)
        np.testing.assert_allclose(clip[:3] / clip[3], (0.0, 0.0, depth), atol=1e-12)
    up = view[1, :3]
    top = np.append(np.array(camera.focal_point) + camera.scale * up, 1.0)
    clip = projection @ view @ top
    np.testing.assert_allclose(clip[:2] / clip[3], (0.0, 1.0), atol=1e-12)
    side = np.append(np.array(camera.focal_point) + 1.5 * camera.scale * view[0, :3], 1.0)
    clip = projection @ view @ side
    np.testing.assert_allclose(clip[:2] / clip[3], (1.0, 0.0), atol=1e-12)


def test_the_clipping_range_holds_the_points_and_stays_before_the_eye() -> None:
    points = np.array([[x, y, z] for x in (0.0, 9.0) for y in (0.0, 5.0) for z in (0.0, 7.0)])
    near, far = Camera((4.0, -30.0, 3.0), (4.0, 0.0, 3.0)).clipping_range(points)
    assert 0 < near < 30.0
    assert 35.0 < far < 60.0
    near, far = Camera((4.0, 2.0, 3.0), (4.0, 5.0, 3.0)).clipping_range(points)
    assert near == pytest.approx(far * 0.001)
    flat = np.array([[0.0, 10.0, 0.0], [5.0, 10.0, 5.0]])
    near, far = Camera((0.0, 0.0, 0.0), (0.0, 1.0, 0.0)).clipping_range(flat)
    assert near < 10.0 < far
