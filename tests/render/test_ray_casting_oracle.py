"""Single-pass ray casting against the float64 oracle, closed forms and its own order of convergence."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import volviz
from tests.render.scenes import LEFT_HANDED, OBLIQUE, blobs, camera, function, image, inside, oracle, volume

MODES = ("composite", "maximum", "minimum", "average", "additive", "attenuated_maximum")

MAX_ERROR, MEAN_ERROR = 2 / 255, 0.5 / 255


#: Visible everywhere, for the modes that classify one scalar of a ray.
RAMP = [(0.0, (0.2, 0.2, 0.6, 0.15)), (0.3, (0.2, 1.0, 0.4, 0.5)), (1.0, (1.0, 0.2, 0.1, 0.9))]


def assert_like_the_oracle(of: volviz.Volume, view: volviz.Camera, points: Any = None, **values: Any) -> None:
    transfer = function(of, points)
    ours, exact = image(of, transfer, view, **values), oracle(of, transfer, view, **values)
    difference = np.abs(ours - exact)
    assert exact[..., 3].max() > 0.1, "the scene is empty and proves nothing"
    assert difference.max() <= MAX_ERROR
    assert difference.mean() <= MEAN_ERROR


@pytest.mark.parametrize("mode", MODES)
def test_every_mode_draws_what_the_oracle_draws(mode: str) -> None:
    of = volume(spacing=(0.9, 1.1, 1.4))
    points = None if mode in ("composite", "additive") else RAMP
    assert_like_the_oracle(of, camera(of), points, mode=mode)


@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.uint16, np.int32, np.float32, np.float64])
def test_every_data_type_draws_what_the_oracle_draws(dtype: Any) -> None:
    of = volume(dtype)
    assert_like_the_oracle(of, camera(of))


@pytest.mark.parametrize("direction", [OBLIQUE, LEFT_HANDED], ids=["oblique", "left-handed"])
def test_direction_and_origin_draw_what_the_oracle_draws(direction: Any) -> None:
    of = volume(spacing=(0.8, 1.0, 1.7), origin=(-20.0, 30.0, 7.0), direction=direction)
    assert_like_the_oracle(of, camera(of))


def test_parallel_projection_draws_what_the_oracle_draws() -> None:
    of = volume()
    assert_like_the_oracle(of, camera(of, parallel=True))


def test_a_camera_inside_the_volume_draws_what_the_oracle_draws() -> None:
    of = volume()
    assert_like_the_oracle(of, inside(of))


def test_shading_with_a_headlight_draws_what_the_oracle_draws() -> None:
    of = volume(np.float32)
    assert_like_the_oracle(of, camera(of), shading=True)


def test_shading_with_a_placed_light_draws_what_the_oracle_draws() -> None:
    of = volume(np.float32)
    x, y, z = of.center
    assert_like_the_oracle(of, camera(of), shading=True, light_position=(x - 60.0, y - 20.0, z + 50.0))


def test_gradient_opacity_draws_what_the_oracle_draws() -> None:
    of = volume(np.float32)
    assert_like_the_oracle(of, camera(of), gradient_opacity=0.8)


def test_a_crop_box_draws_what_the_oracle_draws() -> None:
    of = volume()
    assert_like_the_oracle(of, camera(of), crop=(4.5, 25.0, 0.0, 20.25, 3.0, 26.0))


def test_clip_planes_draw_what_the_oracle_draws() -> None:
    of = volume()
    planes = ((of.center, (1.0, 0.3, 0.2)), (of.center, (0.0, -1.0, 0.4)))
    assert_like_the_oracle(of, camera(of), clip_planes=planes)


def test_nearest_interpolation_draws_what_the_oracle_draws() -> None:
    of = volume()
    view = camera(of)
    ours = image(of, function(of), view, interpolation="nearest")
    exact = oracle(of, function(of), view, interpolation="nearest")
    # a sample on the border of two voxels may fall on either side: few pixels, the mean holds
    assert np.abs(ours - exact).mean() <= MEAN_ERROR


def test_a_density_threshold_draws_what_the_oracle_draws() -> None:
    of = volume(np.float32)
    view = camera(of)
    values = {"density_threshold": 0.55}
    difference = np.abs(image(of, function(of), view, **values) - oracle(of, function(of), view, **values))
    # the threshold is a jump: a sample that lies on it by rounding counts or does not
    assert difference.mean() <= MEAN_ERROR
    assert np.quantile(difference, 0.99) <= MAX_ERROR


def test_preintegration_draws_what_the_oracle_draws() -> None:
    of = volume()
    assert_like_the_oracle(of, camera(of), preintegrated=True, step=1.5)


def test_far_end_samples_draw_what_the_oracle_draws() -> None:
    of = volume()
    assert_like_the_oracle(of, camera(of), first_sample=1.0, step=0.7)


@pytest.mark.parametrize("step", [0.25, 1.0, 1.7])
@pytest.mark.parametrize("parallel", [False, True])
def test_a_homogeneous_box_has_beer_lambert_alpha_for_every_ray(step: float, parallel: bool) -> None:
    of = volviz.Volume(np.full((20, 24, 28), 7, np.uint8), spacing=(1.0, 1.3, 0.8))
    opacity = 0.04
    transfer = volviz.TransferFunction.from_points([(0, (1, 1, 1, opacity)), (9, (1, 1, 1, opacity))])
    view = camera(of, parallel=parallel)
    values = {"step": step, "early_termination": 1.0, "opacity_unit_distance": 1.0}
    ours = image(of, transfer, view, **values)[..., 3]
    # the optical depth of a ray is its length: the oracle with one tiny step is exact here
    exact = oracle(of, transfer, view, **values)[..., 3]
    assert exact.max() > 0.5
    assert np.abs(ours - exact).max() <= 1 / 255


def test_the_density_of_the_picture_does_not_depend_on_the_step() -> None:
    of = volume(np.float32)
    view = camera(of)
    fine, coarse = (image(of, function(of), view, step=step) for step in (0.2, 1.0))
    assert np.abs(fine - coarse).mean() < 1 / 255


STEPS = (0.8, 0.4, 0.2)


def slope_of_error(of: volviz.Volume, transfer: volviz.TransferFunction, **values: Any) -> float:
    """Order of convergence of the image with the step."""
    view = camera(of)
    values = {"early_termination": 1.0} | values
    # both classifications have the same limit; tiny pre-integrated segments gather rounding in float32
    exact = image(of, transfer, view, step=0.025, **(values | {"preintegrated": False}))
    errors = [np.abs(image(of, transfer, view, step=step, **values) - exact).mean() for step in STEPS]
    return float(np.polyfit(np.log(STEPS), np.log(errors), 1)[0])


def test_a_continuous_transfer_function_converges_with_the_second_order() -> None:
    of = volume(np.float32)
    smooth = [(0.0, (1, 1, 1, 0.0)), (1.0, (1, 0.2, 0.1, 0.25))]
    assert slope_of_error(of, function(of, smooth)) == pytest.approx(2.0, abs=0.3)


def test_a_transfer_function_with_jumps_converges_with_the_first_order() -> None:
    of = volume(np.float32)
    jump = [
        (0.0, (1, 1, 1, 0.0)),
        (0.45, (1, 1, 1, 0.0)),
        (0.45, (1, 0.5, 0.1, 0.3)),
        (1.0, (1, 0.2, 0.1, 0.3)),
    ]
    assert slope_of_error(of, function(of, jump)) == pytest.approx(1.0, abs=0.3)


def test_preintegration_converges_with_the_second_order() -> None:
    of = volume(np.float32)
    smooth = [(0.0, (1, 1, 1, 0.0)), (1.0, (1, 0.2, 0.1, 0.25))]
    assert slope_of_error(of, function(of, smooth), preintegrated=True) == pytest.approx(2.0, abs=0.3)


def test_empty_space_skipping_changes_nothing() -> None:
    of = volume()
    view = camera(of)
    # a point of opacity 1e-5 at the lowest value makes every brick visible, and so switches skipping off
    shown = [(0.0, (0.0, 0.0, 0.4, 1e-5)), *[(v, c) for v, c in zip((0.25, 0.7, 1.0), (
        (0.1, 0.3, 1.0, 1e-5), (1.0, 0.8, 0.1, 0.15), (1.0, 0.2, 0.1, 0.5)), strict=True)]]  # fmt: skip
    hidden = [(v, (*c[:3], 0.0 if c[3] == 1e-5 else c[3])) for v, c in shown]
    skipping = image(of, function(of, hidden), view)
    marching = image(of, function(of, shown), view)
    assert np.abs(skipping - marching).max() <= 1 / 255


@pytest.mark.parametrize("technique", ["raycast", "slicing"])
def test_one_huge_outlier_changes_nothing_but_itself(technique: str) -> None:
    of = volume(np.float32)
    transfer = function(of)
    spoiled = of.array.copy()
    spoiled[0, 0, 0] = 1e9
    view = camera(of)
    plain = image(of, transfer, view, technique_id=technique)
    with_outlier = image(volviz.Volume(spoiled), transfer, view, technique_id=technique)
    changed = np.abs(plain - with_outlier).max(axis=-1) > 2 / 255
    # the outlier itself is a single voxel in a corner of the box
    assert changed.mean() < 0.02


def test_preintegration_survives_a_huge_outlier() -> None:
    of = volume(np.float32)
    spoiled = of.array.copy()
    spoiled[0, 0, 0] = 1e9
    view = camera(of)
    plain = image(of, function(of), view, preintegrated=True)
    with_outlier = image(volviz.Volume(spoiled), function(of), view, preintegrated=True)
    assert (np.abs(plain - with_outlier).max(axis=-1) > 2 / 255).mean() < 0.02


@pytest.mark.parametrize(
    "values", [{"step": 2.0}, {"step": 4.0, "jitter": True}, {"step": 2.0, "first_sample": 0.0}]
)
def test_skipping_loses_no_segment_of_a_thin_slab_with_preintegration(values: dict[str, Any]) -> None:
    data = np.zeros((64, 64, 64), np.uint8)
    data[33:35] = 200
    of = volviz.Volume(data)
    slab = [(0, (1, 1, 1, 0.0)), (60, (1, 1, 1, 0.0)), (200, (1, 0.6, 0.2, 0.7))]
    veil = [(0, (1, 1, 1, 1e-6)), *slab[1:]]
    view = camera(of)
    skipping, marching = (
        image(of, volviz.TransferFunction.from_points(points), view, preintegrated=True, **values)
        for points in (slab, veil)
    )
    assert marching[..., 3].max() > 0.3
    assert np.abs(skipping - marching).max() <= 1 / 255


@pytest.mark.parametrize("technique", ["raycast", "slicing", "two_pass_raycast"])
@pytest.mark.parametrize("dtype", [np.float64, np.int64])
def test_a_large_offset_of_the_values_changes_nothing(technique: str, dtype: Any) -> None:
    plain = volviz.Volume((blobs() // 8).astype(dtype))
    offset = volviz.Volume(plain.array + dtype(10**9))
    images = [image(of, function(of), camera(of), technique_id=technique, step=1.0) for of in (plain, offset)]
    assert np.abs(images[0] - images[1]).max() <= 2 / 255


def test_slices_far_from_the_origin_are_those_near_it() -> None:
    near, far = volume(), volume(origin=(1e6, -1e6, 1e6))
    images = [image(of, function(of), camera(of), technique_id="slicing", step=1.0) for of in (near, far)]
    assert np.abs(images[0] - images[1]).max() <= 3 / 255
