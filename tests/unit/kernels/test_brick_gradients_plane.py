"""Occupancy by value and gradient: exact counts, and nothing visible is ever called empty."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from volviz.errors import InputError
from volviz.kernels.brick_gradients import brick_gradient_bounds, occupancy_2d, visible_plane_sums
from volviz.kernels.bricks import brick_min_max
from volviz.kernels.gradient import gradient_magnitude


def test_sums_count_the_visible_entries_below_and_to_the_left() -> None:
    opacity = np.random.default_rng(2).random((7, 11)) > 0.6
    sums = visible_plane_sums(opacity)
    for j, i in np.ndindex(sums.shape):
        assert sums[j, i] == opacity[:j, :i].sum()


def test_a_table_with_one_axis_is_refused_in_words() -> None:
    with pytest.raises(InputError, match="two axes"):
        visible_plane_sums(np.ones(5))


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10_000), width=st.floats(0.02, 0.5), height=st.floats(0.02, 0.5))
def test_bricks_with_a_visible_voxel_are_occupied_and_far_ones_are_not(seed, width, height) -> None:
    random = np.random.default_rng(seed)
    spacing = tuple(random.uniform(0.5, 2.0, 3))
    z, y, x = np.indices((19, 22, 25))
    field = np.sin(x * random.uniform(0.1, 0.5)) + np.cos(y * 0.3) * np.sin(z * random.uniform(0.1, 0.4))
    field = field.astype(np.float32)
    magnitude = gradient_magnitude(field, spacing)
    ranges = (float(field.min()), float(field.max())), (0.0, float(magnitude.max()))
    opacity = np.zeros((33, 65))
    j, i = int(random.integers(0, 33)), int(random.integers(0, 65))
    opacity[j : j + max(int(33 * height), 1), i : i + max(int(65 * width), 1)] = 0.5
    sums = visible_plane_sums(opacity)
    values = brick_min_max(field)
    by_both = occupancy_2d(values, brick_gradient_bounds(field, spacing=spacing), sums, *ranges)
    by_value = occupancy_2d(values, None, sums, *ranges)
    assert not np.any(by_both & ~by_value), "knowing more must not show more"
    column = np.rint((field - ranges[0][0]) / (ranges[0][1] - ranges[0][0]) * 64).astype(int)
    row = np.rint(magnitude / ranges[1][1] * 32).astype(int)
    visible = opacity[row, column] > 0
    for b in np.ndindex(by_both.shape):
        brick = tuple(slice(8 * n, 8 * n + 8) for n in b)
        assert by_both[b] or not visible[brick].any()


def test_a_flat_brick_is_empty_under_a_region_of_steep_places() -> None:
    field = np.zeros((24, 24, 24), np.float32)
    field[:, :, 16:] = 1.0
    opacity = np.zeros((64, 64))
    opacity[32:, :] = 1.0
    occupied = occupancy_2d(
        brick_min_max(field), brick_gradient_bounds(field), visible_plane_sums(opacity), (0, 1), (0, 1)
    )
    assert not occupied[:, :, 0].any()
    assert occupied[:, :, 1:].all()
