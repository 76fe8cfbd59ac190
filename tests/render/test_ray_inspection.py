"""What the ray inspector says against the pixel that the technique has drawn."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.render.scenes import SIZE, camera, function, image, inside, volume
from volviz.custom_gl.arguments import spec_of
from volviz.custom_gl.registry import techniques
from volviz.model.render_spec import View
from volviz.model.transfer.function_2d import Region, TransferFunction2D
from volviz.ray_inspection import RayInspection, inspect_ray

LIMIT = 2 / 255
RAMP = [(0.0, (0.2, 0.2, 0.6, 0.15)), (0.3, (0.2, 1.0, 0.4, 0.5)), (1.0, (1.0, 0.2, 0.1, 0.9))]
PIXELS = [(x, y) for x in range(4, 64, 9) for y in range(6, 64, 9)]


def inspected(of: Any, technique_id: str, pixel: Any, view: Any, transfer: Any, values: Any) -> RayInspection:
    spec = spec_of(of, technique_id, transfer_function=transfer, **values)
    light = replace(spec.light, headlight=not {"light_position", "light_beside_eye"} & values.keys())
    return inspect_ray(replace(spec, light=light), View(view, SIZE), pixel)


def assert_pixels_agree(technique_id: str, of: Any, view: Any, points: Any = None, **values: Any) -> None:
    transfer = function(of, points)
    drawn = image(of, transfer, view, technique_id=technique_id, **values)
    covered = 0
    for x, y in PIXELS:
        inspection = inspected(of, technique_id, (x, y), view, transfer, values)
        assert inspection.exact
        assert np.abs(np.minimum(inspection.profile.color, 1.0) - np.minimum(drawn[y, x], 1.0)).max() <= LIMIT
        covered += drawn[y, x, 3] > 0.1
    assert covered >= 5


@pytest.mark.parametrize("technique_id", ["raycast", "two_pass_raycast", "slicing"])
@pytest.mark.parametrize(
    "values",
    [
        {},
        {"step": 1.3, "first_sample": 0.2},
        {"shading": True},
        {"crop": (4.5, 25.0, 0.0, 20.25, 3.0, 26.0), "gradient_opacity": 0.8},
        {"clip_planes": (((15.3, 4.0, 18.2), (0.1, 1.0, 0.2)),)},
        {"mode": "maximum"},
        {"mode": "average"},
        {"mode": "additive"},
        {"mode": "attenuated_maximum"},
    ],
    ids=lambda values: "-".join(map(str, values)),
)
def test_the_accumulated_colour_is_the_pixel(technique_id: str, values: dict[str, Any]) -> None:
    of = volume(np.float32, spacing=(0.9, 1.1, 1.4))
    points = RAMP if values.get("mode") in ("maximum", "average", "attenuated_maximum") else None
    assert_pixels_agree(technique_id, of, camera(of), points, **values)


@pytest.mark.parametrize(
    "values", [{"jitter": True}, {"preintegrated": True, "step": 1.5}, {"first_sample": 1.0}]
)
def test_jitter_and_preintegration_are_followed(values: dict[str, Any]) -> None:
    of = volume()
    assert_pixels_agree("raycast", of, camera(of), **values)


def test_a_camera_inside_and_a_placed_light_are_followed() -> None:
    of = volume()
    assert_pixels_agree("raycast", of, inside(of))
    x, y, z = of.center
    assert_pixels_agree(
        "raycast", of, camera(of, parallel=True), shading=True, light_position=(x - 60.0, y - 20.0, z + 50.0)
    )
    assert_pixels_agree("raycast", of, camera(of), shading=True, light_beside_eye=True)


@pytest.mark.parametrize("place", [camera, inside])
def test_the_first_and_the_last_slice_of_a_ray_are_followed_up_to_its_ends(place: Any) -> None:
    # not empty at the border, and few slices: one that stands for too little or too much is seen
    of = volume(np.float32)
    points = [(0.0, (0.2, 0.2, 0.6, 0.03)), (1.0, (1.0, 0.2, 0.1, 0.2))]
    plane = ((of.center, (0.1, 1.0, 0.2)),) if place is camera else ()
    assert_pixels_agree("slicing", of, place(of), points, slices=16, clip_planes=plane)


def test_jittered_slices_are_followed() -> None:
    of = volume()
    assert_pixels_agree("slicing", of, camera(of), jitter=True)


def test_techniques_that_sample_no_rays_say_so_and_show_where_their_surfaces_are() -> None:
    of = volume(np.float32)
    found = inspected(of, "isosurface", (32, 32), camera(of), function(of), {"isovalues": (0.5,)})
    assert not found.exact
    values, places = found.profile.values, found.profile.distances
    inside_it = values >= 0.5
    assert inside_it.any()
    # every change of side between two samples has its crossing between them
    sides = np.flatnonzero(inside_it[1:] != inside_it[:-1])
    assert len(found.crossings) == len(sides) > 0
    for side, crossing in zip(sides, found.crossings, strict=True):
        assert places[side] <= crossing.distance <= places[side + 1]


@pytest.mark.parametrize("technique_id", ["raycast", "slicing"])
@pytest.mark.parametrize("mode", ["composite", "additive"])
def test_regions_over_value_and_gradient_are_followed(technique_id: str, mode: str) -> None:
    of = volume(np.float32, spacing=(0.9, 1.1, 1.4))
    low, high = of.range
    steep = 0.25 * (high - low)
    regions = TransferFunction2D(
        (
            Region("rectangle", 0.6, 0.7, 0.0, steep, (1.0, 0.4, 0.1), 0.2),
            Region("ellipse", 0.3, 0.4, 0.0, steep, (0.2, 0.5, 1.0), 0.1),
        )
    )
    transfer = replace(function(of), by_gradient=regions, opacity=0.8)
    view, covered = camera(of), 0
    values = {"mode": mode}
    drawn = image(of, transfer, view, technique_id=technique_id, **values)
    for x, y in PIXELS:
        found = inspected(of, technique_id, (x, y), view, transfer, values)
        assert np.abs(np.minimum(found.profile.color, 1.0) - np.minimum(drawn[y, x], 1.0)).max() <= LIMIT
        covered += drawn[y, x, 3] > 0.1
    assert covered >= 5


def test_every_technique_can_be_inspected() -> None:
    of = volume()
    for technique_id in techniques():
        found = inspected(of, technique_id, (32, 32), camera(of), function(of), {})
        assert len(found.profile.values) > 10
        assert found.ends in ("box", "opacity")
    assert inspected(of, "reference", (32, 32), camera(of), function(of), {}).exact
