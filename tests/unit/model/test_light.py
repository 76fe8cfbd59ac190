"""What a light takes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from volviz import Camera, Light
from volviz.errors import InputError
from volviz.model.light import position_beside_eye


def test_arrays_become_plain_numbers_so_that_lights_can_be_compared() -> None:
    light = Light(position=np.array([1, 2, 3]), color=np.ones(3, np.float32))  # type: ignore[arg-type]
    assert light == Light(position=(1.0, 2.0, 3.0))


@pytest.mark.parametrize(
    "values",
    [
        {"position": (1.0, 2.0)},
        {"position": (1.0, np.nan, 2.0)},
        {"position": "above"},
        {"color": "red"},
        {"color": (2.0, 0.0, 0.0)},
        {"color": None},
    ],
)
def test_what_is_no_place_or_colour_is_refused_in_words(values: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="of a light"):
        Light(**values)


@pytest.mark.parametrize("azimuth", [0.0, 70.0, 180.0, 250.0])
def test_a_light_beside_the_eye_stays_at_its_upper_left_outside_of_the_box(azimuth: float) -> None:
    bounds = (10.0, 30.0, -5.0, 25.0, 0.0, 8.0)
    corners = np.array([[x, y, z] for x in bounds[:2] for y in bounds[2:4] for z in bounds[4:]])
    camera = Camera.fit(corners).turned(azimuth, 20.0)
    matrix, _ = camera.matrices(1.0, (1.0, 100.0))
    center = corners.mean(axis=0)
    right, up, back = matrix[:3, :3] @ (np.array(position_beside_eye(bounds, matrix)) - center)
    assert right < 0 < up < back
    assert np.linalg.norm((right, up, back)) > np.linalg.norm(corners - center, axis=1).max()
