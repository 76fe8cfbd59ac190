"""Edits of several points at once: sorted, within limits, and undone by their opposites."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.unit.transfer.functions import functions, unit, value, with_indices
from volviz.errors import InputError
from volviz.model.transfer import edits
from volviz.model.transfer.channels import merged, simplified, split, with_moved_point, with_point, with_ramp
from volviz.model.transfer.function import TransferFunction
from volviz.model.transfer.shapes import with_shape

PROBE = np.linspace(-130, 130, 211) + 0.013


def is_sound(function: TransferFunction) -> bool:
    values = [p.value for p in function.points]
    return values == sorted(values) and all(0 <= c <= 1 for p in function.points for c in p.rgba)


@given(with_indices(), value, st.floats(-2, 2))
def test_a_moved_group_keeps_its_shape_and_the_order_of_the_points(chosen, dv, da) -> None:
    function, indices = chosen
    result = edits.moved(function, indices, dv, da)
    assert is_sound(result)
    moves = [result.points[i].value - function.points[i].value for i in indices]
    assert max(moves) - min(moves) < 1e-9
    others = set(range(len(function.points))) - set(indices)
    assert all(result.points[i] == function.points[i] for i in others)


@given(with_indices(), st.floats(-0.1, 0.1), st.floats(-0.01, 0.01))
def test_a_move_that_meets_no_limit_is_undone_by_its_opposite(chosen, dv, da) -> None:
    function, indices = chosen
    there = edits.moved(function, indices, dv, da)
    i = indices[0]
    free = (
        abs(there.points[i].value - function.points[i].value - dv) < 1e-9
        and abs(there.points[i].opacity - function.points[i].opacity - da) < 1e-9
    )
    back = edits.moved(there, indices, -dv, -da)
    if free:
        for a, b in zip(back.points, function.points, strict=True):
            assert (a.value, a.opacity) == pytest.approx((b.value, b.opacity), abs=1e-9)


@given(with_indices(), value)
def test_copies_are_added_and_the_originals_stay(chosen, offset) -> None:
    function, indices = chosen
    result, copies = edits.duplicated(function, indices, offset)
    assert is_sound(result)
    assert len(result.points) == len(function.points) + len(indices)
    assert [result.points[i].rgba for i in copies] == [function.points[i].rgba for i in indices]
    assert result.without_points(copies) == function


@given(with_indices(2), st.sampled_from(["left", "center", "right", "top", "middle", "bottom"]))
def test_aligned_points_agree_unless_others_stand_between(chosen, edge) -> None:
    function, indices = chosen
    result = edits.aligned(function, indices, edge)
    assert is_sound(result)
    if edge in ("top", "middle", "bottom"):
        assert len({result.points[i].opacity for i in indices}) == 1
    elif indices[-1] - indices[0] == len(indices) - 1:
        assert len({result.points[i].value for i in indices}) == 1


@given(with_indices(3))
def test_distributed_points_have_equal_distances(chosen) -> None:
    function, indices = chosen
    result, now = edits.distributed(function, indices)
    assert is_sound(result)
    gaps = np.diff([result.points[i].value for i in now])
    np.testing.assert_allclose(gaps, gaps.mean(), atol=1e-9)


@given(with_indices())
def test_flipping_twice_gives_back_the_function(chosen) -> None:
    function, indices = chosen
    once, now = edits.flipped(function, indices)
    assert is_sound(once)
    assert edits.inverted(edits.inverted(function, indices), indices).points == pytest.approx(
        function.points
    ) or is_sound(edits.inverted(function, indices))
    twice, _ = edits.flipped(once, now)
    values = sorted(p.value for p in function.points)
    np.testing.assert_allclose([p.value for p in twice.points], values, atol=1e-9)
    if len(set(values)) == len(values) and len({p.value for p in once.points}) == len(values):
        assert [p.rgba for p in twice.points] == [p.rgba for p in function.points]


@given(functions)
def test_a_flipped_function_is_the_mirror_image(function) -> None:
    mirrored, _ = edits.flipped(function, range(len(function.points)))
    total = function.points[0].value + function.points[-1].value
    values = [p.value for p in function.points]
    probe = PROBE[~np.isin(np.round(PROBE, 6), values)]
    np.testing.assert_allclose(mirrored.evaluate(total - probe), function.evaluate(probe), atol=1e-9)


@given(with_indices(), st.floats(0.125, 8))
def test_scaling_about_the_middle_is_undone_by_its_inverse(chosen, factor) -> None:
    function, indices = chosen
    there, now = edits.scaled(function, indices, value=factor)
    back, _ = edits.scaled(there, now, value=1 / factor)
    np.testing.assert_allclose(
        sorted(p.value for p in back.points), [p.value for p in function.points], atol=1e-9
    )


@given(functions, value, st.floats(0.1, 500))
def test_a_fitted_function_spans_the_range(function, low, span) -> None:
    result = edits.fitted(function, low, low + span)
    assert is_sound(result)
    assert result.points[0].value == pytest.approx(low)
    if function.points[0].value < function.points[-1].value:
        assert result.points[-1].value == pytest.approx(low + span)


@given(functions)
def test_lanes_put_together_again_are_the_same_function(function) -> None:
    colors, opacities = split(function)
    assert len(colors) <= len(function.points)
    again = merged(colors, opacities, function)
    np.testing.assert_allclose(again.evaluate(PROBE), function.evaluate(PROBE), atol=1e-9)
    for v in {p.value for p in function.points}:
        np.testing.assert_allclose(again.evaluate([v]), function.evaluate([v]), atol=1e-9)


@given(functions, st.data())
def test_a_moved_colour_leaves_the_opacities_alone(function, data) -> None:
    colors, opacities = split(function)
    index = data.draw(st.integers(0, len(colors) - 1))
    changed = merged(with_moved_point(colors, index, data.draw(value)), opacities, function)
    assert is_sound(changed)
    np.testing.assert_allclose(changed.evaluate(PROBE)[:, 3], function.evaluate(PROBE)[:, 3], atol=1e-9)


@given(functions, value)
def test_a_stop_more_looks_the_same(function, v) -> None:
    colors, opacities = split(function)
    wider, index = with_point(colors, v)
    assert wider[index].value == v
    again = merged(wider, opacities, function)
    np.testing.assert_allclose(again.evaluate(PROBE), function.evaluate(PROBE), atol=1e-9)


@given(functions, st.floats(0.001, 0.2))
def test_a_simplified_function_stays_within_the_tolerance(function, tolerance) -> None:
    simple = simplified(function, tolerance)
    assert len(simple.points) <= len(function.points)
    assert np.abs(simple.evaluate(PROBE) - function.evaluate(PROBE)).max() <= tolerance + 1e-9


@given(functions)
def test_a_ramp_changes_the_colours_and_not_the_opacities(function) -> None:
    changed = with_ramp(function, [(0, 0, 0), (1, 0.5, 0.25)])
    np.testing.assert_allclose(changed.evaluate(PROBE)[:, 3], function.evaluate(PROBE)[:, 3], atol=1e-9)
    np.testing.assert_allclose(changed.evaluate([-1e6])[0, :3], (0, 0, 0), atol=1e-9)
    np.testing.assert_allclose(changed.evaluate([1e6])[0, :3], (1, 0.5, 0.25), atol=1e-9)


@given(
    functions,
    st.sampled_from(["ramp", "tent", "gaussian", "box"]),
    value,
    st.integers(1, 400).map(lambda v: v / 4),
    unit,
)
def test_a_shape_is_put_on_top_of_the_curve(function, shape, center, width, height) -> None:
    result = with_shape(function, shape, center, width, height)
    assert is_sound(result)
    t = (PROBE - center) / (width / 2)
    profile = {
        "ramp": (t + 1) / 2,
        "tent": 1 - np.abs(t),
        "gaussian": np.exp(-0.5 * (3 * t) ** 2),
        "box": np.ones_like(t),
    }[shape]
    wanted = np.maximum(function.evaluate(PROBE)[:, 3], np.where(np.abs(t) <= 1, height * profile, 0))
    # a Gaussian is drawn by straight pieces
    np.testing.assert_allclose(
        result.evaluate(PROBE)[:, 3], wanted, atol=0.0045 if shape == "gaussian" else 1e-9
    )
    np.testing.assert_allclose(result.evaluate(PROBE)[:, :3], function.evaluate(PROBE)[:, :3], atol=1e-9)


def test_a_shape_brings_its_colour_and_leaves_the_others() -> None:
    grey = TransferFunction.from_points([(0, (0, 0, 0, 0)), (100, (1, 1, 1, 0))])
    result = with_shape(grey, "box", 50, 20, 0.5, (1, 0, 0))
    np.testing.assert_allclose(result.evaluate([50]), [[1, 0, 0, 0.5]])
    np.testing.assert_allclose(result.evaluate([20, 80]), [[0.2, 0.2, 0.2, 0], [0.8, 0.8, 0.8, 0]], atol=1e-9)


def test_unusable_requests_are_refused_in_words() -> None:
    function = TransferFunction.from_points([(0, (0, 0, 0, 0)), (1, (1, 1, 1, 1))])
    for call, words in [
        (lambda: edits.moved(function, [2], 1.0), "points 0 to 1"),
        (lambda: edits.scaled(function, [0], value=-1), "factors"),
        (lambda: edits.fitted(function, 1.0, 1.0), "different"),
        (lambda: edits.aligned(function, [0, 1], "up"), "aligned"),
        (lambda: with_shape(function, "star", 0, 1, 1), "star"),
        (lambda: with_shape(function, "box", 0, 0, 1), "width"),
        (lambda: with_ramp(function, [(1, 2, 3), (0, 0, 0)]), "between 0 and 1"),
    ]:
        with pytest.raises(InputError, match=words):
            call()
