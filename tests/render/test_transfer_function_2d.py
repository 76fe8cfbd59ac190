"""Transfer functions over value and gradient magnitude, against the oracle."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import pyvista

import volviz
from tests.render.scenes import (
    LEFT_HANDED,
    OBLIQUE,
    camera,
    function,
    gradient_table,
    image,
    inside,
    matrices,
    oracle,
    volume,
)
from volviz.kernels.gradient import gradient_magnitude
from volviz.model.transfer.function_2d import Region, TransferFunction2D
from volviz.reference.shadows import reference_shadows

MAX_ERROR, MEAN_ERROR = 2 / 255, 0.5 / 255


def regions(of: volviz.Volume, *kinds: str, softness: float = 0.7) -> volviz.TransferFunction:
    """Overlapping regions of different colours where the volume has values and gradients."""
    low, high = of.range
    span = high - low
    top = float(np.quantile(gradient_magnitude(of.array, of.spacing), 0.98))
    shapes = {
        "rectangle": (
            "rectangle",
            low + 0.75 * span,
            0.3 * span,
            0.1 * top,
            1.0 * top,
            (1.0, 0.6, 0.2),
            0.25,
        ),
        "ellipse": ("ellipse", low + 0.4 * span, 0.35 * span, 0.3 * top, 1.3 * top, (0.2, 0.8, 0.4), 0.2),
        "triangle": ("triangle", low + 0.55 * span, 0.5 * span, 0.0, 3.0 * top, (0.3, 0.4, 1.0), 0.3),
    }
    chosen = tuple(Region(*shapes[kind], softness) for kind in kinds or tuple(shapes))
    return replace(function(of), by_gradient=TransferFunction2D(chosen))


def assert_like_the_oracle(
    of: volviz.Volume, transfer: volviz.TransferFunction, view: volviz.Camera, **values: Any
) -> None:
    ours = image(of, transfer, view, **values)
    exact = oracle(of, transfer, view, **values)
    assert exact[..., 3].max() > 0.1, "the scene is empty and proves nothing"
    assert np.abs(ours - exact).max() <= MAX_ERROR
    assert np.abs(ours - exact).mean() <= MEAN_ERROR


@pytest.mark.parametrize("technique", ["raycast", "two_pass_raycast"])
@pytest.mark.parametrize("kind", ["rectangle", "ellipse", "triangle"])
def test_each_kind_of_region_draws_what_the_oracle_draws(technique: str, kind: str) -> None:
    of = volume(spacing=(0.9, 1.1, 1.4))
    assert_like_the_oracle(of, regions(of, kind), camera(of), technique_id=technique)


@pytest.mark.parametrize("direction", [OBLIQUE, LEFT_HANDED], ids=["oblique", "left-handed"])
def test_gradients_are_those_of_the_world_whatever_the_lattice(direction: Any) -> None:
    of = volume(np.int16, spacing=(0.6, 1.0, 2.1), origin=(-20.0, 30.0, 7.0), direction=direction)
    assert_like_the_oracle(of, regions(of), camera(of))


@pytest.mark.parametrize(
    "values",
    [
        {"mode": "additive"},
        {"shading": True},
        {"gradient_opacity": 0.7},
        {"gradient_delta": 2.5},
        {"step": 0.9, "opacity_unit_distance": 2.0},
        {"density_threshold": 0.2},
        {"crop": (4.5, 25.0, 0.0, 20.25, 3.0, 26.0)},
    ],
    ids=lambda values: next(iter(values)),
)
def test_settings_act_on_regions_as_they_act_in_the_oracle(values: dict[str, Any]) -> None:
    of = volume(np.float32)
    assert_like_the_oracle(of, regions(of), camera(of), **values)


def test_a_camera_inside_and_overall_opacity_draw_what_the_oracle_draws() -> None:
    of = volume(np.float32)
    assert_like_the_oracle(of, replace(regions(of), opacity=0.5), inside(of))


def test_slicing_draws_what_ray_casting_draws() -> None:
    of = volume(np.float32, spacing=(0.9, 1.1, 1.4))
    for mode in ("composite", "additive"):
        values = {"mode": mode, "step": 0.2}
        view = camera(of, parallel=True)
        exact = image(of, regions(of), view, early_termination=1.0, **values)
        ours = image(of, regions(of), view, technique_id="slicing", **values)
        assert np.abs(ours - exact).mean() <= MEAN_ERROR
        assert np.quantile(np.abs(ours - exact), 0.999) <= 4 / 255


def test_half_angle_slices_cast_the_shadows_that_the_oracle_casts() -> None:
    of = volume(np.float32, spacing=(0.9, 1.1, 1.4))
    transfer, view, size = regions(of), camera(of), (64, 64)
    x, y, z = of.center
    light, kappa = (x - 40.0, y - 70.0, z + 40.0), (0.3, 0.6, 1.0)
    ours = image(
        of, transfer, view, technique_id="half_angle", step=0.4, light_position=light,
        attenuation_color=kappa, ambient=0.2,
    )  # fmt: skip
    view_matrix, projection = matrices(of, view, size)
    exact = reference_shadows(
        of.array, of.spacing, of.origin, of.direction, table=transfer.bake(of.range), value_range=of.range,
        view=view_matrix, projection=projection, size=size, step_world=0.3 * min(of.spacing),
        light_position=light, kappa=kappa, ambient=0.2, **gradient_table(of, transfer),
    )  # fmt: skip
    assert exact[..., 3].max() > 0.1
    assert np.abs(ours - exact).max() <= MAX_ERROR
    assert np.abs(ours - exact).mean() <= MEAN_ERROR


@pytest.mark.parametrize("softness", [0.0, 0.5])
@pytest.mark.parametrize("delta", [1.0, 6.0])
def test_empty_space_skipping_changes_nothing(softness: float, delta: float) -> None:
    of = volume(spacing=(0.7, 1.1, 1.5))
    thin = regions(of, "rectangle", softness=softness)
    # a veil over the whole plane makes every brick visible, and so switches skipping off
    low, high = of.range
    veil = Region("rectangle", (low + high) / 2, 4 * (high - low), 0.0, 1e6, (0.0, 0.0, 0.0), 1e-6, 0.0)
    # with the same extent of the table, so that both functions fall on the same texels
    nothing = replace(veil, opacity=0.0)
    images = [
        image(
            of,
            replace(thin, by_gradient=thin.by_gradient.with_region(other)),
            camera(of),
            gradient_delta=delta,
        )
        for other in (nothing, veil)
    ]
    assert images[0][..., 3].max() > 0.1
    assert np.abs(images[0] - images[1]).max() <= 1 / 255


def test_a_function_without_regions_shows_nothing() -> None:
    of = volume()
    empty = replace(function(of), by_gradient=TransferFunction2D())
    assert image(of, empty, camera(of)).max() == 0.0


def test_regions_that_are_switched_off_leave_the_curve() -> None:
    of = volume()
    transfer = regions(of)
    off = replace(transfer, by_gradient=replace(transfer.by_gradient, enabled=False))
    assert np.array_equal(image(of, off, camera(of)), image(of, function(of), camera(of)))


@pytest.mark.parametrize(
    ("technique", "values"),
    [
        ("raycast", {"mode": "maximum"}),
        ("slicing", {"mode": "average"}),
        ("splatting", {}),
        ("isosurface", {}),
    ],
)
def test_what_classifies_no_samples_draws_the_curve(technique: str, values: dict[str, Any]) -> None:
    of = volume()
    with_regions, without = (
        image(of, transfer, camera(of), technique_id=technique, **values)
        for transfer in (regions(of), function(of))
    )
    assert np.array_equal(with_regions, without)


def test_preintegration_does_not_touch_regions() -> None:
    of = volume()
    assert np.array_equal(
        image(of, regions(of), camera(of), preintegrated=True), image(of, regions(of), camera(of))
    )


def test_the_first_camera_frames_what_the_regions_show() -> None:
    field = np.zeros((40, 44, 48), np.float32)
    # a large block without contrast, and a small bright one
    field[4:36, 4:40, 4:20] = 0.5
    field[16:24, 16:24, 34:42] = 1.0
    of = volviz.Volume(field)
    small = Region("rectangle", 1.0, 0.6, 0.0, 2.0, (1.0, 1.0, 1.0), 0.5, 0.0)
    transfer = replace(function(of), by_gradient=TransferFunction2D((small,)))
    framed = volviz.render(of, transfer_function=transfer, size=(64, 64))[..., 3] > 10
    by_curve = volviz.render(of, transfer_function=function(of), size=(64, 64))[..., 3] > 10
    assert framed.any(axis=0).sum() > 40, "the small block fills the picture"
    assert by_curve.any(axis=0).sum() > 20
    ignored = volviz.render(of, transfer_function=transfer, size=(64, 64), mode="maximum")
    curve = volviz.render(of, transfer_function=function(of), size=(64, 64), mode="maximum")
    assert np.array_equal(ignored, curve)


def test_moving_a_region_compiles_nothing() -> None:
    of = volume()
    plotter = pyvista.Plotter(off_screen=True, window_size=(48, 48))
    transfer = regions(of)
    handle = volviz.add_volume(plotter, of, "raycast", transfer_function=transfer)
    plotter.show(auto_close=False, interactive=False)
    handle.raise_error()
    compiled = handle.gpu.programs.compiled
    before = handle.read_image()
    region = transfer.by_gradient.regions[0]
    handle.update(
        transfer_function=replace(
            transfer, by_gradient=transfer.by_gradient.with_changed_region(0, value=0.8 * region.value)
        )
    )
    plotter.render()
    handle.raise_error()
    assert np.abs(handle.read_image() - before).max() > 0.02
    assert handle.gpu.programs.compiled == compiled
    handle.update(preintegrated=True)
    plotter.render()
    assert "without pre-integration" in handle.notice
    plotter.close()
