"""Histograms: NumPy's counts exactly, in steps, and cancellable."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from volviz.errors import Cancelled, InputError
from volviz.kernels.gradient import gradient_magnitude
from volviz.kernels.histogram import (
    even_histogram,
    histogram,
    joint_histogram,
    progressive_histogram,
    progressive_joint_histogram,
)


@settings(max_examples=60, deadline=None)
@given(
    shape=st.tuples(*[st.integers(1, 14)] * 3),
    seed=st.integers(0, 1000),
    dtype=st.sampled_from(["u1", "i1", "u2", "i2", "i4", "u4", "f4", "f8", ">i2", ">f4"]),
    bins=st.integers(1, 300),
)
def test_counts_are_exactly_those_of_numpy(shape, seed, dtype, bins):
    array = (np.random.default_rng(seed).normal(size=shape) * 40 + 60).astype(dtype)
    counts, edges, done = histogram(array, bins)
    expected, expected_edges = np.histogram(array.astype(float), bins)
    np.testing.assert_array_equal(edges, expected_edges)
    np.testing.assert_array_equal(counts, expected)
    assert done == 1


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 1000), bins=st.integers(1, 100), dtype=st.sampled_from(["u1", "f4"]))
def test_values_outside_the_range_are_left_out(seed, bins, dtype):
    array = (np.random.default_rng(seed).random((5, 6, 7)) * 200).astype(dtype)
    counts = histogram(array, bins, (50, 120)).counts
    np.testing.assert_array_equal(counts, np.histogram(array.astype(float), bins, (50, 120))[0])


def test_values_on_the_edges_fall_where_numpy_puts_them():
    values = (np.arange(11) * 0.1).reshape(1, 1, -1)
    np.testing.assert_array_equal(histogram(values, 10, (0, 1)).counts, np.histogram(values, 10, (0, 1))[0])


def test_nan_and_infinities_are_left_out():
    array = np.array([[[1.0, np.nan, 2.0, np.inf, -np.inf, 3.0]]])
    assert histogram(array, 2).counts.tolist() == [1, 2]
    assert histogram(np.full((2, 2, 2), np.nan), 4).counts.sum() == 0


def test_a_constant_volume_fills_one_bin():
    result = histogram(np.full((3, 3, 3), 7), 5)
    assert result.counts.tolist() == [0, 0, 27, 0, 0]
    assert (result.edges[0], result.edges[-1]) == (6.5, 7.5)


def test_partial_results_rise_to_the_whole_and_keep_their_own_arrays():
    array = np.random.default_rng(3).integers(0, 255, (100, 8, 8), dtype=np.uint8)
    parts = list(progressive_histogram(array, 16))
    assert 10 <= len(parts) <= 16
    shares = [part.done for part in parts]
    assert shares == sorted(shares)
    assert shares[-1] == 1
    for part in parts:
        assert part.counts.sum() == round(part.done * array.size)


def test_the_first_partial_result_already_looks_like_the_last():
    ramp = np.broadcast_to(np.arange(256, dtype=np.uint8)[:, None, None], (256, 4, 4))
    parts = list(progressive_histogram(ramp, 4))
    share = parts[1].counts / parts[1].counts.sum()
    np.testing.assert_allclose(share, 0.25, atol=0.15)


def test_cancelling_stops_between_pieces():
    array = np.zeros((64, 4, 4), np.uint8)
    answers = iter([False, False, True])
    results = progressive_histogram(array, 4, cancel=lambda: next(answers))
    next(results)
    next(results)
    with pytest.raises(Cancelled):
        next(results)
    with pytest.raises(Cancelled):
        joint_histogram(array, cancel=lambda: True)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 1000), dtype=st.sampled_from(["u1", "i2", "f4"]))
def test_joint_counts_are_those_of_numpy(seed, dtype):
    spacing = (0.7, 1.3, 2.1)
    array = (np.random.default_rng(seed).random((9, 10, 11)) * 100).astype(dtype)
    magnitude = gradient_magnitude(array, spacing)
    result = joint_histogram(array, spacing, bins=(13, 7))
    expected, value_edges, gradient_edges = np.histogram2d(
        array.astype(float).ravel(),
        magnitude.astype(float).ravel(),
        (13, 7),
        [(float(array.min()), float(array.max())), (0, float(magnitude.max()))],
    )
    np.testing.assert_allclose(result.value_edges, value_edges)
    np.testing.assert_allclose(result.gradient_edges, gradient_edges)
    np.testing.assert_array_equal(result.counts, expected.T)


def test_partial_joint_histograms_end_with_the_whole():
    array = np.random.default_rng(3).random((40, 6, 7))
    *_, before, last = progressive_joint_histogram(array, bins=(8, 4))
    assert before.done < last.done == 1
    assert last.counts.sum() == array.size
    assert last.counts.shape == (4, 8)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [((0,), "at least 1 bin"), ((4, (2, 1)), "in order"), ((4, (0, float("inf"))), "finite")],
)
def test_bad_arguments_are_refused_in_words(arguments, message):
    with pytest.raises(InputError, match=message):
        histogram(np.zeros((2, 2, 2)), *arguments)


@pytest.mark.parametrize(
    ("low", "high"),
    [(0.3, 0.1 + 0.2), (2.0**60, 2.0**60 + 512), (-1.7e308, 1.7e308), (0.0, 5e-324), (2.0, 7.0)],
)
def test_ranges_that_numpy_refuses_are_counted_as_well(low, high):
    values = np.array([low, low, high])
    counts, edges = even_histogram(values, 64, low, high)
    assert (counts[0], counts[-1], counts.sum()) == (2, 1, 3)
    assert (edges[0], edges[-1]) == (low, high)
    assert np.all(np.isfinite(edges))
    assert np.all(np.diff(edges / 4) >= 0)
    weighted, _ = even_histogram(values, 64, low, high, np.array([0.5, 0.25, 4.0]))
    assert (weighted[0], weighted[-1]) == (0.75, 4.0)
