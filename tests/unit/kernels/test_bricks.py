"""Bricks: bounds that hold for every sample, occupancy that never hides anything, exact distances."""

from __future__ import annotations

from unittest import mock

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import distance_transform_cdt, map_coordinates

from volviz.errors import InputError
from volviz.kernels.brick_gradients import brick_gradient_bounds
from volviz.kernels.bricks import (
    brick_grid_shape,
    brick_min_max,
    chessboard_distance,
    grow_occupancy,
    occupancy,
    occupancy_elsewhere,
    occupancy_for_isovalues,
    visible_prefix,
)

shapes = st.tuples(*[st.integers(2, 21)] * 3)


def random_field(shape, dtype, seed):
    rng = np.random.default_rng(seed)
    if np.dtype(dtype).kind == "f":
        return rng.normal(size=shape).astype(dtype)
    info = np.iinfo(dtype)
    return rng.integers(max(info.min, -30000), min(info.max, 30000), size=shape, endpoint=True).astype(dtype)


def bounds_by_slicing(array, brick):
    """The definition, one brick after the other."""
    grid = brick_grid_shape(array.shape, brick)
    mins, maxs = np.empty(grid, np.float32), np.empty(grid, np.float32)
    for index in np.ndindex(grid):
        part = array[tuple(slice(max(b * brick - 1, 0), (b + 1) * brick + 1) for b in index)]
        mins[index], maxs[index] = part.min(), part.max()
    return mins, maxs


@pytest.mark.parametrize("dtype", ["u1", "i1", "u2", "i2", "i4", "i8", "f4", "f8", ">i2", ">f4", "f2"])
def test_bounds_equal_the_definition_for_every_type(dtype):
    array = (
        random_field((19, 25, 33), dtype, 1)
        if dtype != "f2"
        else random_field((19, 25, 33), "f4", 1).astype("f2")
    )
    mins, maxs = brick_min_max(array)
    expected = bounds_by_slicing(array, 8)
    np.testing.assert_array_equal(mins, expected[0])
    np.testing.assert_array_equal(maxs, expected[1])
    assert mins.dtype == maxs.dtype == np.float32


@settings(max_examples=40, deadline=None)
@given(shape=shapes, brick=st.integers(1, 9), seed=st.integers(0, 1000))
def test_bounds_equal_the_definition_for_every_shape_and_brick(shape, brick, seed):
    array = random_field(shape, "i2", seed)
    for got, expected in zip(brick_min_max(array, brick), bounds_by_slicing(array, brick), strict=True):
        np.testing.assert_array_equal(got, expected)


def test_strided_and_bool_arrays_need_no_preparation():
    array = random_field((20, 22, 24), "i2", 2)
    np.testing.assert_array_equal(brick_min_max(array.T)[0], bounds_by_slicing(array.T, 8)[0])
    mask = array > 0
    np.testing.assert_array_equal(brick_min_max(mask)[1], bounds_by_slicing(mask.astype(np.uint8), 8)[1])


def test_nan_and_infinities_count_as_the_lowest_value():
    array = random_field((12, 12, 12), "f4", 3)
    array[2, 3, 4], array[9, 9, 9], array[5, 5, 5] = np.nan, np.inf, -np.inf
    lowest = float(array[np.isfinite(array)].min())
    clean = np.where(np.isfinite(array), array, np.float32(lowest))
    mins, maxs = brick_min_max(array, lowest=lowest)
    expected = bounds_by_slicing(clean, 8)
    np.testing.assert_array_equal(mins, expected[0])
    np.testing.assert_array_equal(maxs, expected[1])


@settings(max_examples=30, deadline=None)
@given(shape=shapes, seed=st.integers(0, 1000))
def test_no_trilinear_sample_leaves_the_bounds_of_its_brick(shape, seed):
    array = random_field(shape, "f4", seed)
    mins, maxs = brick_min_max(array, 4)
    rng = np.random.default_rng(seed)
    points = rng.random((200, 3)) * (np.array(shape) - 1)
    values = map_coordinates(array.astype(float), points.T, order=1)
    for offset in (0.0, 0.5):
        bricks = tuple(np.floor((points + offset) / 4).astype(int).T)
        assert np.all(values >= mins[bricks] - 1e-6)
        assert np.all(values <= maxs[bricks] + 1e-6)


@settings(max_examples=30, deadline=None)
@given(shape=shapes, seed=st.integers(0, 1000), delta=st.floats(0.05, 1.0))
def test_no_gradient_leaves_the_bounds_of_its_brick(shape, seed, delta):
    spacing = (0.7, 1.3, 2.1)
    array = random_field(shape, "f4", seed)
    array[array < 0] *= 0.05
    array += 0.8 * np.arange(shape[2], dtype=np.float32) if seed % 2 else 0
    lows, highs = brick_gradient_bounds(array, 4, spacing=spacing)
    points = np.random.default_rng(seed).random((200, 3)) * (np.array(shape) - 1)
    gradient = np.zeros((200, 3))
    for axis in range(3):
        shift = np.zeros(3)
        shift[axis] = delta
        ends = [
            map_coordinates(array.astype(float), (points + s).T, order=1, mode="nearest")
            for s in (shift, -shift)
        ]
        gradient[:, axis] = (ends[0] - ends[1]) / (2 * delta * spacing[2 - axis])
    magnitude = np.linalg.norm(gradient, axis=1)
    bricks = tuple(np.floor(points / 4).astype(int).T)
    assert np.all(magnitude <= highs[bricks] + 1e-5)
    assert np.all(magnitude >= lows[bricks] - 1e-5)


def test_gradient_bounds_of_a_ramp_are_its_slope_away_from_the_border():
    ramp = np.broadcast_to(3.0 * np.arange(40, dtype=np.float32), (40, 40, 40))
    lows, highs = brick_gradient_bounds(ramp, 8, spacing=(2.0, 1.0, 1.0))
    np.testing.assert_allclose(lows[2, 2, 2], 1.5, rtol=1e-5)
    np.testing.assert_allclose(highs, 1.5, rtol=1e-5)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10_000), entries=st.integers(2, 300), width=st.integers(1, 40))
def test_occupancy_never_hides_a_visible_sample(seed, entries, width):
    rng = np.random.default_rng(seed)
    array = rng.normal(size=(9, 9, 9)).astype(np.float32)
    mins, maxs = brick_min_max(array, 4)
    lo, hi = -1.0, 1.5
    opacity = np.zeros(entries)
    start = rng.integers(0, entries)
    opacity[start : start + width] = rng.random()
    occupied = occupancy(mins, maxs, visible_prefix(opacity), (lo, hi))
    points = rng.random((300, 3)) * 8
    values = map_coordinates(array.astype(float), points.T, order=1)
    shown = np.interp(values, np.linspace(lo, hi, entries), opacity) > 0
    assert np.all(occupied[tuple(np.floor(points / 4).astype(int).T)] | ~shown)


def test_occupancy_is_widened_by_one_entry_and_no_more():
    opacity = np.zeros(11)
    opacity[5] = 1
    values = np.array([2.9, 3.1, 3.9, 5.0, 6.1, 6.9, 7.1], np.float32).reshape(1, 1, -1)
    # 5 is touched by look-ups in 4..6; one more entry on each side
    np.testing.assert_array_equal(
        occupancy(values, values, visible_prefix(opacity), (0, 10)).ravel(),
        [False, True, True, True, True, True, False],
    )


def test_a_constant_volume_uses_the_first_entry():
    flat = np.full((2, 2, 2), 7, np.float32)
    assert occupancy(flat, flat, visible_prefix([0.5, 0, 0, 0]), (7, 7)).all()
    assert not occupancy(flat, flat, visible_prefix([0, 0, 0, 0.5]), (7, 7)).any()


def test_isovalues_occupy_the_bricks_that_straddle_them():
    mins = np.array([[[0, 10, 20]]], np.float32)
    maxs = np.array([[[10, 20, 30]]], np.float32)
    assert occupancy_for_isovalues(mins, maxs, [5]).ravel().tolist() == [True, False, False]
    assert occupancy_for_isovalues(mins, maxs, [10]).ravel().tolist() == [True, True, False]
    assert occupancy_for_isovalues(mins, maxs, [5, 25]).ravel().tolist() == [True, False, True]
    assert not occupancy_for_isovalues(mins, maxs, []).any()


@settings(max_examples=50, deadline=None)
@given(shape=st.tuples(*[st.integers(1, 13)] * 3), seed=st.integers(0, 1000), share=st.floats(0.002, 0.3))
def test_chessboard_distance_is_exact(shape, seed, share):
    occupied = np.random.default_rng(seed).random(shape) < share
    got = chessboard_distance(occupied)
    with mock.patch("volviz.kernels.bricks.FEW_BRICKS", 0):
        np.testing.assert_array_equal(chessboard_distance(occupied), got)
    if not occupied.any():
        assert np.all(got == 255)
        return
    occupied_at = np.argwhere(occupied)
    all_at = np.argwhere(np.ones(shape, bool))
    exact = np.abs(all_at[:, None] - occupied_at[None]).max(-1).min(-1).reshape(shape)
    np.testing.assert_array_equal(got, exact)
    np.testing.assert_array_equal(got, distance_transform_cdt(~occupied, metric="chessboard"))


def test_chessboard_distance_saturates_at_255():
    line = np.zeros((1, 1, 400), bool)
    line[0, 0, 0] = True
    np.testing.assert_array_equal(chessboard_distance(line).ravel(), np.minimum(np.arange(400), 255))


def test_growing_adds_all_26_neighbours():
    occupied = np.zeros((5, 5, 5), bool)
    occupied[2, 2, 2] = True
    assert grow_occupancy(occupied).sum() == 27
    assert grow_occupancy(occupied, 2).all()


def test_bad_arguments_are_refused_in_words():
    with pytest.raises(InputError, match="three-dimensional"):
        brick_min_max(np.zeros((4, 4)))
    with pytest.raises(InputError, match="convert"):
        brick_min_max(np.zeros((4, 4, 4), complex))
    with pytest.raises(InputError, match="at least 1"):
        brick_min_max(np.zeros((4, 4, 4)), 0)
    with pytest.raises(InputError, match="empty"):
        visible_prefix([])


def test_bricks_of_256_cubed_are_timed(benchmark):
    """`make bench` says how long they take: 40 ms are not noticed while a volume opens."""
    array = np.random.default_rng(0).integers(0, 256, (256, 256, 256), dtype=np.uint8)
    low, high = benchmark(lambda: brick_min_max(array))
    assert (low.min(), high.max()) == (array.min(), array.max())


def test_distances_of_bricks_are_timed(benchmark):
    """`make bench` says how long they take: 10 ms is what a slider bears."""
    occupied = np.random.default_rng(0).random((32, 32, 32)) < 0.01
    distances = benchmark(lambda: chessboard_distance(occupied))
    np.testing.assert_array_equal(distances == 0, occupied)


@pytest.mark.parametrize("seed", range(3))
def test_bricks_of_a_lattice_cover_their_voxels_on_another(seed: int) -> None:
    random = np.random.default_rng(seed)
    occupied = random.uniform(size=(3, 4, 5)) < 0.15
    matrix = np.eye(4)
    matrix[:3, :3] = np.linalg.qr(random.normal(size=(3, 3)))[0] * random.uniform(0.6, 1.5, 3)
    matrix[:3, 3] = random.uniform(-10, 10, 3)
    first, shape = (-4, -3, -5), (12, 11, 13)
    found = occupancy_elsewhere(occupied, matrix, shape, first)
    assert 0.02 < found.mean() < 0.9
    # everything that is interpolated from an occupied brick
    for b_z, b_y, b_x in np.argwhere(occupied):
        inside = random.uniform(-1.0, 8.0, (200, 3)) + 8 * np.array([b_x, b_y, b_z])
        i, j, k = (np.floor((inside @ matrix[:3, :3].T + matrix[:3, 3]) / 8).astype(int) - first).T
        here = (i >= 0) & (j >= 0) & (k >= 0) & (i < shape[2]) & (j < shape[1]) & (k < shape[0])
        assert found[k[here], j[here], i[here]].all()
