"""The transfer function as a value: order, limits, tables, plain data."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from tests.unit.transfer.functions import functions, point, unit, value
from volviz.errors import InputError
from volviz.model.transfer.function import MAX_TABLE, TransferFunction, table_size


@given(st.lists(point, min_size=1, max_size=12))
def test_points_are_always_sorted_and_equal_values_keep_their_order(points) -> None:
    function = TransferFunction.from_points(points)
    assert [p.value for p in function.points] == sorted(v for v, _ in points)
    for v in {v for v, _ in points}:
        assert [p.rgba for p in function.points if p.value == v] == [c for w, c in points if w == v]


@given(functions, st.lists(value, min_size=1, max_size=20))
def test_colour_and_opacity_stay_within_0_and_1(function, values) -> None:
    rgba = function.evaluate(values)
    assert rgba.shape == (len(values), 4)
    assert rgba.min() >= 0.0
    assert rgba.max() <= 1.0


@given(functions)
def test_the_function_passes_through_its_points_and_the_later_one_counts_at_a_jump(function) -> None:
    for v in {p.value for p in function.points}:
        last = [p for p in function.points if p.value == v][-1]
        np.testing.assert_allclose(function.evaluate([v])[0], last.rgba, atol=1e-12)


@given(functions, st.integers(2, 300), value, st.floats(0.5, 500))
def test_a_table_is_the_function_at_the_texel_centres(function, size, low, span) -> None:
    table = function.bake((low, low + span), size)
    values = [low + i / (size - 1) * span for i in range(size)]
    jumps = np.isin(np.round(values, 9), [p.value for p in function.points])
    expected = function.evaluate(values)
    np.testing.assert_allclose(table[~jumps], expected[~jumps], atol=1e-4)
    assert table.dtype == np.float32


@example(
    TransferFunction.from_points([(-0.25, (0, 0, 0, 0)), (-0.25, (0, 0, 0, 1)), (0, (0, 0, 0, 0))]),
    (-0.5, 1.0),
)
@given(functions, st.tuples(value, st.floats(0.5, 500)))
def test_clamped_look_up_in_the_narrow_range_gives_the_function_everywhere(function, data) -> None:
    low, high = data[0], data[0] + data[1]
    narrow = function.table_range((low, high))
    assert low <= narrow[0] < narrow[1] <= high
    values = np.linspace(low, high, 57)
    inner = np.clip(values, *narrow)
    away = ~np.isin(values, [p.value for p in function.points])
    np.testing.assert_allclose(function.evaluate(values)[away], function.evaluate(inner)[away], atol=1e-9)


@given(functions, unit)
def test_plain_data_give_back_an_equal_function(function, opacity) -> None:
    function = function.with_opacity(opacity)
    assert TransferFunction.from_dict(json.loads(json.dumps(function.to_dict()))) == function


@given(functions, value)
def test_an_added_point_leaves_the_curve_as_it_was(function, v) -> None:
    wider, index = function.with_point(v)
    assert wider.points[index].value == v
    probe = np.linspace(-120, 120, 97) + 0.01
    np.testing.assert_allclose(wider.evaluate(probe), function.evaluate(probe), atol=1e-9)
    assert wider.without_points([index]) == function


@given(functions, st.data())
def test_a_changed_point_never_passes_its_neighbours(function, data) -> None:
    index = data.draw(st.integers(0, len(function.points) - 1))
    changed = function.with_changed_point(index, value=data.draw(value), opacity=data.draw(unit))
    values = [p.value for p in changed.points]
    assert values == sorted(values)
    assert len(changed.points) == len(function.points)
    others = [i for i in range(len(values)) if i != index]
    assert [changed.points[i] for i in others] == [function.points[i] for i in others]


@given(functions, value, st.floats(0.125, 8), value)
def test_shift_and_stretch_are_undone_by_their_opposites(function, offset, factor, center) -> None:
    back = function.shifted(offset).shifted(-offset).stretched(factor, center).stretched(1 / factor, center)
    np.testing.assert_allclose([p.value for p in back.points], [p.value for p in function.points], atol=1e-6)


@given(functions, st.sets(st.integers(0, 20)))
def test_the_last_point_can_not_be_removed(function, drop) -> None:
    kept = [p for i, p in enumerate(function.points) if i not in drop]
    assert list(function.without_points(drop).points) == (kept or [function.points[0]])


def test_relative_functions_spread_over_the_range_of_the_data() -> None:
    function = TransferFunction.from_points([(0, (0, 0, 0, 0)), (0.5, (1, 0, 0, 0.5))], domain="relative")
    assert [p.value for p in function.resolved((100.0, 300.0)).points] == [100.0, 200.0]
    np.testing.assert_allclose(function.evaluate([200.0], (100.0, 300.0)), [[1, 0, 0, 0.5]])


def test_the_visible_range_holds_what_has_an_opacity() -> None:
    function = TransferFunction.from_points([(10, (1, 1, 1, 0)), (20, (1, 1, 1, 1)), (30, (1, 1, 1, 0))])
    low, high = function.visible_range((0.0, 100.0))
    assert low == pytest.approx(10, abs=0.05)
    assert high == pytest.approx(30, abs=0.05)
    assert function.with_opacity(0).visible_range((0.0, 100.0)) is None


def test_integer_data_have_a_whole_number_of_entries_a_value() -> None:
    assert (table_size((0, 255), True) - 1) % 255 == 0
    assert table_size((0.0, 255.0), False) == MAX_TABLE
    assert table_size((0, 65535), True) == MAX_TABLE


def label(value: float) -> list[tuple[float, tuple[float, ...]]]:
    clear, red = (0.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 1.0)
    return [(value - 0.5, clear), (value - 0.5, red), (value + 0.5, red), (value + 0.5, clear)]


def test_a_table_shows_every_feature_however_narrow() -> None:
    data = (0.0, 65535.0)
    alone = TransferFunction.from_points([(0, (0, 0, 0, 0)), *label(300), (65535, (0, 0, 0, 0))])
    two = TransferFunction.from_points([*label(300), *label(60000)])
    for function, shown in ((alone, (300,)), (two, (300, 60000))):
        low, high = function.table_range(data)
        texels = function.bake((low, high), function.table_size((low, high), integer=True))
        entries = np.rint((np.clip(np.arange(65536.0), low, high) - low) / (high - low) * (len(texels) - 1))
        assert tuple(np.flatnonzero(texels[entries.astype(int), 3] > 0.5)) == shown
    # steep edges alone are no reason for a longer table
    clear, dense = (0.0, 0.0, 0.0, 0.0), (1.0, 1.0, 1.0, 1.0)
    steps = TransferFunction.from_points([(0, clear), (9, clear), (9.001, dense), (65535, dense)])
    assert steps.table_size(data, integer=True) == MAX_TABLE


def test_a_table_of_4096_entries_is_baked_in_under_2_milliseconds() -> None:
    from timeit import repeat

    function = TransferFunction.from_points([(i, (0.1, 0.2, 0.3, i / 40)) for i in range(40)])
    assert min(repeat(lambda: function.bake((0.0, 40.0), MAX_TABLE), number=1, repeat=20)) < 2e-3


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([], "at least one"),
        ([(float("nan"), (0, 0, 0, 0))], "finite"),
        ([(0, (0, 0, 2, 0))], "between 0 and 1"),
        ([(0, (0, 0, 0))], "control point is"),
    ],
)
def test_unusable_points_are_refused_in_words(points, words) -> None:
    with pytest.raises(InputError, match=words):
        TransferFunction.from_points(points)
