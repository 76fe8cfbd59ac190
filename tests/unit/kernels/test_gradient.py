"""Gradients: NumPy's where it has one, exact on linear fields in oblique, anisotropic worlds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from volviz.errors import InputError
from volviz.kernels.gradient import gradient, gradient_magnitude, gradient_statistics

SPACING = (0.7, 1.3, 2.1)
shapes = st.tuples(*[st.integers(2, 12)] * 3)


def numpy_gradient(array):
    """World gradient (x, y, z) by NumPy."""
    return np.stack(np.gradient(array.astype(float), *SPACING[::-1])[::-1], axis=-1)


@settings(max_examples=30, deadline=None)
@given(shape=shapes, seed=st.integers(0, 1000), dtype=st.sampled_from(["u1", "i2", "f4", "f8", ">i2"]))
def test_gradients_are_those_of_numpy(shape, seed, dtype):
    array = (np.random.default_rng(seed).random(shape) * 200).astype(dtype)
    expected = numpy_gradient(array)
    np.testing.assert_allclose(gradient(array, SPACING), expected, rtol=1e-5, atol=1e-4)
    magnitude = np.linalg.norm(expected, axis=-1)
    np.testing.assert_allclose(gradient_magnitude(array, SPACING), magnitude, rtol=1e-5, atol=1e-4)
    statistics = gradient_statistics(array, SPACING)
    np.testing.assert_allclose(statistics, (magnitude.max(), magnitude.mean()), rtol=1e-5)


@pytest.mark.parametrize("left_handed", [False, True])
def test_a_linear_field_has_its_exact_world_gradient_everywhere(left_handed):
    axes = Rotation.random(random_state=3).as_matrix()
    if left_handed:
        axes[:, 2] *= -1
    k, j, i = np.mgrid[:6, :7, :8]
    world = np.stack([i, j, k], -1) @ (axes * SPACING).T
    slope = np.array([1.5, -2.0, 0.25])
    result = gradient(world @ slope, SPACING, axes)
    np.testing.assert_allclose(result, np.broadcast_to(slope, result.shape), atol=1e-5)


def test_volumes_one_voxel_thick_have_no_slope_across():
    array = np.arange(12.0).reshape(1, 3, 4)
    result = gradient(array)
    np.testing.assert_array_equal(result[..., 2], 0)
    np.testing.assert_allclose(gradient_magnitude(array), np.hypot(1, 4), rtol=1e-6)
    np.testing.assert_allclose(gradient_magnitude(array.reshape(3, 4, 1)), np.hypot(1, 4), rtol=1e-6)


def test_nan_and_infinities_count_as_the_lowest_value():
    array = np.random.default_rng(1).random((5, 6, 7))
    array[1, 2, 3], array[4, 5, 6], array[0, 0, 0] = np.nan, np.inf, -np.inf
    clean = np.where(np.isfinite(array), array, -2.0)
    np.testing.assert_array_equal(gradient(array, lowest=-2.0), gradient(clean))
    np.testing.assert_array_equal(gradient_magnitude(array, lowest=-2.0), gradient_magnitude(clean))


@pytest.mark.parametrize("spacing", [(1, 1), (1, 0, 1), (1, 1, float("nan"))])
def test_bad_spacing_is_refused_in_words(spacing):
    with pytest.raises(InputError, match="spacing"):
        gradient_magnitude(np.zeros((3, 3, 3)), spacing)
