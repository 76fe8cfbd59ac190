"""What a volume takes, and what it gives."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from volviz import Volume
from volviz.errors import InputError


def test_the_scalars_as_drawn_are_the_array_itself_where_all_are_finite() -> None:
    whole = Volume(np.arange(27, dtype=np.int16).reshape(3, 3, 3))
    real = Volume(np.arange(27.0).reshape(3, 3, 3))
    assert whole.finite_array is whole.array
    assert real.finite_array is real.array


def test_the_scalars_as_drawn_have_the_lowest_value_where_there_is_none() -> None:
    array = np.arange(5.0, 32.0, dtype=np.float32).reshape(3, 3, 3)
    array[0, 0, 1], array[1, 1, 1], array[2, 2, 2] = np.nan, np.inf, -np.inf
    volume = Volume(array)
    expected = np.where(np.isfinite(array), array, 5.0)
    np.testing.assert_array_equal(volume.finite_array, expected)
    assert volume.finite_array.dtype == np.float32
    assert np.isnan(volume.array[0, 0, 1])
    with pytest.raises(ValueError, match="read-only"):
        volume.finite_array[0, 0, 0] = 1.0


def test_a_volume_without_any_number_is_drawn_as_zeros() -> None:
    volume = Volume(np.full((2, 3, 4), np.nan))
    assert volume.range == (0.0, 0.0)
    assert not volume.finite_array.any()


@pytest.mark.parametrize(
    ("array", "geometry", "words"),
    [
        (np.zeros((3, 3)), {}, "three-dimensional"),
        (np.zeros((1, 3, 3)), {}, "at least 2 voxels"),
        (np.zeros((2, 2, 2), complex), {}, "complex"),
        (np.zeros((2, 2, 2)), {"spacing": (1.0, 0.0, 1.0)}, "greater than 0"),
        (np.zeros((2, 2, 2)), {"spacing": (1.0, 1.0)}, "three finite numbers"),
        (np.zeros((2, 2, 2)), {"origin": (0.0, np.inf, 0.0)}, "finite"),
        (np.zeros((2, 2, 2)), {"direction": 2 * np.eye(3)}, "unit length"),
        (np.zeros((2, 2, 2)), {"direction": np.eye(2)}, "3 x 3"),
        (np.zeros((2, 2, 2)), {"direction": np.full((3, 3), np.nan)}, "direction"),
    ],
)
def test_what_is_no_volume_is_refused_in_words(array: Any, geometry: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        Volume(array, **geometry)


def test_masked_values_count_as_the_lowest() -> None:
    array = np.arange(10, 37).reshape(3, 3, 3)
    assert Volume(np.ma.masked_less(array, 20)).array.min() == 20
    assert not Volume(np.ma.masked_less(array, 100)).array.any()


def test_long_doubles_become_doubles():
    array = np.arange(8, dtype=np.longdouble).reshape(2, 2, 2) + np.longdouble("0.1")
    volume = Volume(array)
    assert volume.array.dtype == np.float64
    np.testing.assert_array_equal(volume.array, array.astype(np.float64))
