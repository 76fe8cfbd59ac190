"""Splats: exactly the voxels of the definition, with and without bricks."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import binary_erosion
from scipy.spatial.transform import Rotation

from volviz.errors import InputError
from volviz.kernels.bricks import brick_min_max
from volviz.kernels.gradient import gradient
from volviz.kernels.splats import select_splats

SPACING = (0.7, 1.3, 2.1)


def blobs(shape, seed, dtype):
    rng = np.random.default_rng(seed)
    k, j, i = np.meshgrid(*[np.linspace(-1, 1, n) for n in shape], indexing="ij")
    field = np.zeros(shape)
    for _ in range(3):
        c = rng.uniform(-0.9, 0.9, 3)
        field += np.exp(-((i - c[0]) ** 2 + (j - c[1]) ** 2 + (k - c[2]) ** 2) / 0.2)
    return (field * 100 + rng.random(shape)).astype(dtype)


@settings(max_examples=60, deadline=None)
@given(
    shape=st.tuples(*[st.integers(2, 26)] * 3),
    seed=st.integers(0, 1000),
    dtype=st.sampled_from(["u1", "i2", "f4", ">i2"]),
    isovalue=st.floats(0, 150),
    cull=st.booleans(),
    brick=st.sampled_from([3, 8]),
)
def test_the_selection_is_that_of_the_definition(shape, seed, dtype, isovalue, cull, brick):
    array = blobs(shape, seed, dtype)
    splats = select_splats(array, isovalue, spacing=SPACING, cull_interior=cull, brick=brick)
    above = array.astype(float) > isovalue
    shown = above & ~binary_erosion(above, np.ones((3, 3, 3))) if cull else above
    at = np.argwhere(shown)
    np.testing.assert_array_equal(splats.positions, at[:, ::-1])
    np.testing.assert_array_equal(splats.values, array[shown].astype(np.float32))
    slopes = gradient(array, SPACING)[shown].astype(float)
    length = np.linalg.norm(slopes, axis=1, keepdims=True)
    expected = np.where(length > 0, -slopes / np.where(length > 0, length, 1), 0)
    np.testing.assert_allclose(splats.normals, expected, atol=1e-4)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 1000), per_axis=st.integers(1, 30), cull=st.booleans())
def test_a_lattice_selects_every_nth_voxel(seed, per_axis, cull):
    array = blobs((19, 24, 16), seed, "u1")
    splats = select_splats(array, 40, splats_per_axis=per_axis, cull_interior=cull)
    at = [[i * n // min(per_axis, n) for i in range(min(per_axis, n))] for n in array.shape]
    lattice = array[np.ix_(*at)] > 40
    shown = lattice & ~binary_erosion(lattice, np.ones((3, 3, 3))) if cull else lattice
    expected = [(at[2][x], at[1][y], at[0][z]) for z, y, x in np.argwhere(shown)]
    np.testing.assert_array_equal(splats.positions, np.array(expected).reshape(-1, 3))
    k, j, i = splats.positions.astype(int).T[::-1]
    np.testing.assert_array_equal(splats.values, array[k, j, i])
    full = gradient(array)[k, j, i].astype(float)
    length = np.linalg.norm(full, axis=1)
    np.testing.assert_allclose((splats.normals * full).sum(1), -length, atol=1e-3)


def test_given_bricks_change_nothing():
    array = blobs((30, 28, 33), 5, "i2")
    given_bricks = select_splats(array, 50, bricks=brick_min_max(array))
    for a, b in zip(given_bricks, select_splats(array, 50), strict=True):
        np.testing.assert_array_equal(a, b)


def test_the_isovalue_itself_is_not_selected():
    array = np.full((3, 3, 3), 40, np.uint8)
    array[1, 1, 1] = 41
    assert select_splats(array, 40).positions.tolist() == [[1, 1, 1]]
    assert len(select_splats(array, 41).values) == 0


def test_a_double_just_above_the_isovalue_is_not_lost_to_rounding():
    array = np.full((4, 4, 4), 0.1)
    array[2, 1, 3] = 0.1 + 1e-12
    assert select_splats(array, 0.1).positions.tolist() == [[3, 1, 2]]


def test_a_full_volume_keeps_its_faces_and_nothing_inside():
    splats = select_splats(np.ones((10, 11, 12)), 0.5)
    assert len(splats.values) == 10 * 11 * 12 - 8 * 9 * 10
    assert not splats.normals.any()


def test_nan_counts_as_the_lowest_value():
    array = np.ones((5, 5, 5))
    array[2, 2, 2] = np.nan
    assert len(select_splats(array, 0.5, cull_interior=False).values) == 124
    assert len(select_splats(array, 0.5).values) == 124  # the hole uncovers its 26 neighbours


@pytest.mark.parametrize("left_handed", [False, True])
def test_normals_are_world_directions_in_oblique_volumes(left_handed):
    axes = Rotation.random(random_state=3).as_matrix()
    if left_handed:
        axes[:, 0] *= -1
    k, j, i = np.mgrid[:20, :22, :24]
    world = np.stack([i - 12, j - 11, k - 10], -1) @ (axes * SPACING).T
    distance = np.linalg.norm(world, axis=-1)
    splats = select_splats((20.0 - distance).astype(np.float32), 14.0, spacing=SPACING, direction=axes)
    i, j, k = splats.positions.astype(int).T
    inner = (i > 0) & (i < 23) & (j > 0) & (j < 21) & (k > 0) & (k < 19) & (distance[k, j, i] > 3)
    assert inner.sum() > 100
    outward = world[k, j, i] / np.maximum(distance[k, j, i], 1e-9)[:, None]
    cosine = (splats.normals * outward).sum(1)[inner]
    assert cosine.min() > np.cos(np.radians(4))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"isovalue": float("nan")}, "isovalue"),
        ({"isovalue": 1, "splats_per_axis": 0}, "at least 1"),
        ({"isovalue": 1, "bricks": (np.zeros((2, 2, 2)), np.ones((2, 2, 2)))}, "do not fit"),
        ({"isovalue": 1, "spacing": (1, 1, 0)}, "spacing"),
    ],
)
def test_bad_arguments_are_refused_in_words(arguments, message):
    with pytest.raises(InputError, match=message):
        select_splats(np.zeros((4, 4, 4)), **arguments)


def test_a_new_isovalue_on_256_cubed_is_timed(benchmark):
    """`make bench` says how long it takes: 50 ms is what a slider bears."""
    k, j, i = np.ogrid[-128:128, -128:128, -128:128]
    ripple = 20 * np.sin(i / 9) * np.sin(j / 11) * np.sin(k / 13)
    array = np.clip(200 - np.sqrt(i * i + j * j + k * k) + ripple, 0, 255).astype(np.uint8)
    bricks = brick_min_max(array)
    selected = benchmark(lambda: select_splats(array, 95, bricks=bricks))
    assert 200_000 < len(selected.values) < 500_000
    assert np.all(selected.values > 95)
