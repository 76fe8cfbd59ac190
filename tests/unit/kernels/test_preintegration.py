"""Pre-integrated segments against brute-force integration."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.unit.kernels.scenes import colorful_table
from volviz.errors import InputError
from volviz.kernels.preintegration import MAX_OPACITY, extinction_sums, preintegration_table, segment_color


def by_quadrature(table, front, back, length, count=200_000):
    """The two integrals by the midpoint rule, from the definition (front and back in table entries)."""
    entries = np.arange(len(table))
    tau = -np.log(1 - np.minimum(table[:, 3], MAX_OPACITY))
    x = front + (np.arange(count) + 0.5) / count * (back - front)
    mean = np.interp(x, entries, tau).mean()
    colors = [np.interp(x, entries, tau * table[:, c]).mean() for c in range(3)]
    alpha = 1 - np.exp(-mean * length)
    return np.array([c / mean * alpha for c in colors] + [alpha]) if mean > 0 else np.zeros(4)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**5), length=st.floats(0.01, 20), entries=st.integers(2, 40))
def test_segments_equal_brute_force_integration(seed, length, entries):
    rng = np.random.default_rng(seed)
    table = rng.random((entries, 4))
    table[rng.random(entries) < 0.4, 3] = 0
    front, back = rng.random(2) * (entries - 1)
    got = segment_color(extinction_sums(table), front, back, length)
    np.testing.assert_allclose(got, by_quadrature(table, front, back, length), atol=2e-5)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**5), gap=st.floats(1e-9, 1e-2))
def test_nearly_equal_ends_lose_no_digits(seed, gap):
    table = colorful_table(512)
    front = np.random.default_rng(seed).random() * 510
    sums = extinction_sums(table)
    near = np.array(segment_color(sums, front, front + gap, 0.7))
    same = np.array(segment_color(sums, front + gap / 2, front + gap / 2, 0.7))
    np.testing.assert_allclose(near, same, rtol=1e-4, atol=1e-9)


def test_the_table_holds_the_segments_of_all_pairs():
    table = colorful_table(1024)
    result = preintegration_table(table, 0.8, 17)
    assert result.shape == (17, 17, 4)
    assert result.dtype == np.float32
    for f, b in [(0, 16), (3, 9), (9, 3), (12, 13), (5, 5)]:
        expected = by_quadrature(table, f / 16 * 1023, b / 16 * 1023, 0.8)
        np.testing.assert_allclose(result[f, b], expected, atol=1e-5)
    np.testing.assert_array_equal(result, result.swapaxes(0, 1))


def test_the_diagonal_is_plain_classification_with_corrected_opacity():
    table = colorful_table(256)
    result = preintegration_table(table, 2.5, 256)
    alpha = 1 - (1 - table[:, 3]) ** 2.5
    diagonal = result[np.arange(256), np.arange(256)]
    np.testing.assert_allclose(diagonal[:, 3], alpha, atol=1e-6)
    np.testing.assert_allclose(diagonal[:, :3], table[:, :3] * alpha[:, None], atol=1e-6)


def test_a_thin_opaque_peak_between_two_values_is_never_missed():
    table = np.zeros((1024, 4))
    table[500] = 1, 0.5, 0.25, 1
    result = preintegration_table(table, 100.0, 64)
    color = result[10, 50]
    assert color[3] > 0.5
    np.testing.assert_allclose(color[:3] / color[3], [1, 0.5, 0.25], rtol=1e-5)
    assert not result[:20, :20].any()


def test_all_values_are_finite_and_premultiplied_even_when_opaque():
    rng = np.random.default_rng(3)
    table = rng.random((300, 4))
    table[100:200, 3] = 1
    result = preintegration_table(table, 50.0, 128)
    assert np.all(np.isfinite(result))
    assert np.all(result[..., :3] <= result[..., 3:] + 1e-6)
    assert np.all((result[..., 3] >= 0) & (result[..., 3] <= 1))


def test_an_invisible_function_gives_an_empty_table():
    assert not preintegration_table(np.ones((8, 4)) * [1, 1, 1, 0], 1.0, 8).any()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((np.zeros((8, 3)), 1.0), "shape"),
        ((np.zeros((1, 4)), 1.0), "at least 2"),
        ((np.zeros((8, 4)), 0.0), "relative_length"),
        ((np.zeros((8, 4)), float("nan")), "relative_length"),
        ((np.zeros((8, 4)), 1.0, 1), "at least 2"),
        ((np.ones((8, 4)) * 2, 1.0), "between 0 and 1"),
    ],
)
def test_bad_arguments_are_refused_in_words(arguments, message):
    with pytest.raises(InputError, match=message):
        preintegration_table(*arguments)


def test_a_table_of_256_squared_is_timed(benchmark):
    """`make bench` says how long it takes: 10 ms is what dragging a control point bears."""
    made = benchmark(lambda: preintegration_table(colorful_table(1024), 1.0))
    assert made.shape == (256, 256, 4)
