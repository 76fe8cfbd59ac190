"""Transfer functions over value and gradient magnitude."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.unit.transfer.functions import unit
from volviz.errors import InputError
from volviz.model.transfer.automatic_2d import auto_regions
from volviz.model.transfer.function import TransferFunction
from volviz.model.transfer.function_2d import KINDS, Region, TransferFunction2D
from volviz.volume_data.volume import Volume

regions = st.builds(
    lambda kind, value, width, low, height, color, opacity, softness: Region(
        kind, value, width, low, low + height, color, opacity, softness
    ),
    st.sampled_from(KINDS), st.floats(-100, 100), st.floats(0.5, 50), st.floats(0, 20), st.floats(0.5, 30),
    st.tuples(unit, unit, unit), unit, unit,
)  # fmt: skip
functions = st.lists(regions, max_size=4).map(lambda found: TransferFunction2D(tuple(found)))
VALUES, GRADIENTS = np.linspace(-150, 150, 61), np.linspace(0, 60, 41)


@given(functions)
def test_colour_and_opacity_stay_within_0_and_1(function) -> None:
    rgba = function.evaluate(VALUES[None], GRADIENTS[:, None])
    assert rgba.shape == (41, 61, 4)
    assert rgba.min() >= 0.0
    assert rgba.max() <= 1.0 + 1e-12


@given(regions)
def test_a_region_is_fully_there_in_its_middle_and_gone_outside_its_box(region) -> None:
    top = (
        region.gradient_high
        if region.kind == "triangle"
        else (region.gradient_low + region.gradient_high) / 2
    )
    assert region.weight(region.value, top - 1e-9 * top) == pytest.approx(1.0)
    outside = [
        (region.value + 0.51 * region.width, top),
        (region.value - 0.51 * region.width, top),
        (region.value, region.gradient_high + 0.01),
        (region.value, region.gradient_low - 0.01),
    ]
    for value, gradient in outside:
        assert region.weight(value, gradient) == 0.0


@given(functions)
def test_a_table_is_the_function_at_the_texel_centres(function) -> None:
    table = function.bake((-10.0, 30.0), (0.0, 12.0), (9, 5))
    assert table.shape == (5, 9, 4)
    np.testing.assert_allclose(table[2, 3], function.evaluate(-10 + 3 / 8 * 40, 6.0), atol=1e-6)


@given(regions, regions)
def test_overlapping_regions_add_their_extinctions(a, b) -> None:
    both = TransferFunction2D((a, b)).evaluate(VALUES[None], GRADIENTS[:, None])[..., 3]
    one = TransferFunction2D((a,)).evaluate(VALUES[None], GRADIENTS[:, None])[..., 3]
    two = TransferFunction2D((b,)).evaluate(VALUES[None], GRADIENTS[:, None])[..., 3]
    np.testing.assert_allclose(1 - both, (1 - one) * (1 - two), atol=1e-12)


@given(functions)
def test_plain_data_give_back_an_equal_function_also_inside_a_transfer_function(function) -> None:
    assert TransferFunction2D.from_dict(json.loads(json.dumps(function.to_dict()))) == function
    whole = replace(TransferFunction.from_points([(0, (0, 0, 0, 0))]), by_gradient=function)
    assert TransferFunction.from_dict(json.loads(json.dumps(whole.to_dict()))) == whole


@given(functions, st.floats(0.25, 4), st.floats(-50, 50))
def test_shift_and_stretch_move_the_regions_with_the_curve(function, factor, offset) -> None:
    whole = replace(
        TransferFunction.from_points([(0, (0, 0, 0, 0)), (10, (1, 1, 1, 1))]), by_gradient=function
    )
    changed = whole.stretched(factor, 5.0).shifted(offset)
    for before, after in zip(function.regions, changed.by_gradient.regions, strict=True):
        assert after.value == pytest.approx(5.0 + (before.value - 5.0) * factor + offset)
        assert after.width == pytest.approx(before.width * factor)


def test_a_moved_region_stops_at_gradient_zero() -> None:
    region = Region("ellipse", 0.0, 2.0, 1.0, 3.0).moved(5.0, -4.0)
    assert (region.value, region.gradient_low, region.gradient_high) == (5.0, 0.0, 2.0)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"kind": "star"}, "one of"),
        ({"width": 0.0}, "width above 0"),
        ({"gradient_low": 5.0}, "low < high"),
        ({"opacity": 1.5}, "between 0 and 1"),
    ],
)
def test_unusable_regions_are_refused_in_words(changes, words) -> None:
    with pytest.raises(InputError, match=words):
        replace(Region("ellipse", 0.0, 2.0, 1.0, 3.0), **changes)


def test_automatic_regions_find_the_border_of_a_ball() -> None:
    axis = np.linspace(-1, 1, 60)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    radius = np.sqrt(x * x + y * y + z * z)
    values = 100 / (1 + np.exp((radius - 0.6) * 40)) + np.random.default_rng(1).normal(0, 0.5, radius.shape)
    volume = Volume(values, spacing=(2.0, 2.0, 2.0))
    function = auto_regions(volume)
    gradient = np.sqrt(sum(g**2 for g in np.gradient(values, 2.0)))
    opacity = function.evaluate(values, gradient)[..., 3]
    shell = np.abs(radius - 0.6) < 0.02
    inside = radius < 0.45
    assert opacity[shell].mean() > 0.1
    assert opacity[inside].mean() < 0.02
    assert opacity[radius > 0.75].mean() < 0.02


def test_data_without_borders_give_a_region_anyway() -> None:
    assert len(auto_regions(Volume(np.full((8, 8, 8), 3, np.uint8))).regions) == 1
