"""The axes of the plot as plain values."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from volviz.model.ticks import round_values, value_text
from volviz_ui.transfer_editor.axes import OpacityAxis, ValueAxis

value = st.floats(-1e5, 1e5, allow_nan=False)
axes = st.builds(
    lambda low, span, logarithmic: ValueAxis.of_range(low, low + span, logarithmic=logarithmic),
    value, st.floats(1e-2, 1e5), st.booleans(),
)  # fmt: skip


@given(axes, st.floats(-0.5, 1.5))
def test_a_position_and_its_value_belong_together(axis, fraction) -> None:
    assert axis.fraction(axis.value(fraction)) == pytest.approx(fraction, abs=1e-6)
    assert axis.values(np.array([fraction]))[0] == pytest.approx(axis.value(fraction))
    assert axis.fractions(np.array([axis.value(fraction)]))[0] == pytest.approx(fraction, abs=1e-6)


@given(axes)
def test_values_rise_from_left_to_right(axis) -> None:
    assert (np.diff(axis.values(np.linspace(0, 1, 50))) > 0).all()
    assert axis.value(0.0) == pytest.approx(axis.low)
    assert axis.value(1.0) == pytest.approx(axis.high)


@given(axes, st.floats(0.1, 10), st.floats(0, 1))
def test_zooming_keeps_the_place_and_never_turns_the_window_over(axis, factor, at) -> None:
    zoomed = axis.zoomed(factor, at)
    assert zoomed.low < zoomed.high
    if factor > 1:
        assert zoomed.fraction(axis.value(at)) == pytest.approx(at, abs=1e-5)


@given(axes, st.lists(st.floats(-3, 3), max_size=6))
def test_the_window_never_loses_the_data(axis, moves) -> None:
    for move in moves:
        axis = axis.panned(move)
    span = axis.data_high - axis.data_low
    assert axis.low >= axis.data_low - 1.0001 * span
    assert axis.high <= axis.data_high + 1.0001 * span


@given(axes, st.integers(2, 20))
def test_ticks_lie_in_the_window_and_apart(axis, most) -> None:
    ticks = axis.ticks(most)
    assert ticks == sorted(ticks)
    assert len(ticks) <= 2 * most + 2
    for tick in ticks:
        assert -1e-6 <= axis.fraction(tick) <= 1 + 1e-6


def test_ticks_are_round_numbers() -> None:
    assert round_values(-1024, 3071, 8) == [-1000, 0, 1000, 2000, 3000]
    assert ValueAxis.of_range(0, 255).ticks(6) == [0, 50, 100, 150, 200, 250]
    assert set(ValueAxis.of_range(-1000, 1000, logarithmic=True).ticks(9)) >= {-1000, -100, 0, 100, 1000}


@given(st.floats(0, 1), st.booleans())
def test_opacities_and_heights_belong_together(opacity, fine) -> None:
    axis = OpacityAxis(fine)
    assert axis.opacity(axis.fraction(opacity)) == pytest.approx(opacity, abs=1e-9)
    assert axis.fractions(np.array([opacity]))[0] == pytest.approx(axis.fraction(opacity))


def test_values_have_as_many_digits_as_the_window_needs() -> None:
    assert value_text(143.0, 2500) == "143"
    assert value_text(0.12345, 1.0) == "0.123"
    assert value_text(-1024, 2000) == "-1024"
    assert value_text(3.2e-9, 1e-8) == "3.2e-09"
