"""What a light takes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from volviz import Light
from volviz.errors import InputError


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
