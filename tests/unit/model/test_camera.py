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
