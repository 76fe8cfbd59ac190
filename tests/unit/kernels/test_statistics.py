"""Range and percentiles: the same as NumPy's, without a copy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from volviz.kernels.statistics import finite_range, percentiles


@pytest.mark.parametrize("dtype", ["u1", "i1", "u2", "i2", "i4", "u4", "i8", "f4", "f8", ">i2", ">f8", "f2"])
def test_the_range_is_that_of_numpy_for_every_type(dtype):
    array = (np.random.default_rng(1).normal(size=(17, 13, 11)) * 40 + 50).astype(dtype)
    low, high, nonfinite = finite_range(array)
    assert (low, high, nonfinite) == (float(array.min()), float(array.max()), 0)
    assert finite_range(array.T)[:2] == (low, high)


@settings(max_examples=40, deadline=None)
@given(
    shape=st.tuples(*[st.integers(1, 12)] * 3),
    seed=st.integers(0, 1000),
    share=st.floats(0, 1),
    dtype=st.sampled_from(["f4", "f8"]),
)
def test_nonfinite_values_are_counted_and_never_become_the_range(shape, seed, share, dtype):
    rng = np.random.default_rng(seed)
    array = rng.normal(size=shape).astype(dtype)
    odd = rng.random(shape) < share
    array[odd] = rng.choice([np.nan, np.inf, -np.inf], size=int(odd.sum()))
    low, high, nonfinite = finite_range(array)
    assert nonfinite == odd.sum()
    finite = array[~odd]
    assert (low, high) == ((finite.min(), finite.max()) if finite.size else (0, 0))


def test_extreme_values_survive():
    array = np.array([[[np.finfo("f4").max, -np.finfo("f4").max]]], np.float32)
    assert finite_range(array) == (-float(np.finfo("f4").max), float(np.finfo("f4").max), 0)
    assert finite_range(np.array([[[2**63 - 1, -(2**63)]]])).low == -(2.0**63)


def test_bool_volumes_range_from_0_to_1():
    assert finite_range(np.array([[[True, False]]])) == (0.0, 1.0, 0)


def test_percentiles_agree_with_numpy_to_a_bin():
    values = np.random.default_rng(2).gamma(2.0, 50.0, 200_000)
    counts, edges = np.histogram(values, 4096)
    percent = np.array([0, 0.1, 1, 25, 50, 75, 99, 99.9, 100])
    width = edges[1] - edges[0]
    np.testing.assert_allclose(
        percentiles(counts, edges, percent), np.percentile(values, percent), atol=width
    )


def test_percentiles_skip_empty_bins_at_both_ends():
    result = percentiles([0, 0, 10, 0, 0, 30, 0], np.arange(8), [0, 12.5, 100])
    np.testing.assert_allclose(result, [2, 2.5, 6])


def test_an_empty_histogram_has_no_percentiles():
    assert np.isnan(percentiles([0, 0], [0, 1, 2], 50))
