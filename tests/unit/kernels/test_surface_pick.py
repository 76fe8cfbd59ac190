"""Picking a surface point: as the oracle of isosurfaces sees it, and in words when asked nonsense."""

from __future__ import annotations

import numpy as np
import pytest

from tests.unit.kernels.cameras import look_at, orthographic
from tests.unit.kernels.scenes import scene, smooth_field
from volviz.errors import InputError
from volviz.reference.isosurface import reference_isosurface
from volviz.reference.surface_pick import pixel_ray, surface_on_ray

RAMP = np.broadcast_to(np.arange(9.0), (9, 9, 9))


@pytest.mark.parametrize("interpolation", ["linear", "nearest"])
@pytest.mark.parametrize("left_handed", [False, True])
def test_the_picked_point_is_the_oracles_nearest_surface(interpolation, left_handed):
    field = smooth_field(2, (14, 16, 12))
    geometry, camera, matrix = scene(2, left_handed=left_handed)
    isovalues = [0.6, 0.7]
    image = reference_isosurface(
        field, **geometry, **camera, isovalues=isovalues, step_world=0.4, bisections=16,
        interpolation=interpolation,
    )  # fmt: skip
    width, height = camera["size"]
    hits = 0
    for row in range(height):
        for column in range(width):
            ray = pixel_ray(camera["view"], camera["projection"], camera["size"], (column, row))
            found = surface_on_ray(
                field, matrix, ray, isovalues=isovalues, step_world=0.4, interpolation=interpolation
            )
            assert (found is None) == (image.surface[row, column] < 0)
            if found is not None:
                hits += 1
                assert found.surface == image.surface[row, column]
                np.testing.assert_allclose(found.position, image.position[row, column], atol=1e-9)
                np.testing.assert_allclose(matrix[:3] @ (*found.voxel, 1), found.position, atol=1e-9)
                if interpolation == "linear":
                    assert found.value == pytest.approx(isovalues[found.surface], abs=1e-4)
    assert hits > 5


def ramp_ray():
    return pixel_ray(look_at((-30, 4, 4), (4, 4, 4)), orthographic(1), (1, 1), (0, 0))


@pytest.mark.parametrize(
    ("opacities", "expected"),
    [
        ((1.0, 1.0, 1.0), 0),
        ((0.2, 1.0, 1.0), 1),
        ((0.3, 0.3, 0.3), 1),
        ((0.0, 0.1, 0.1), 1),
        ((0.1, 0.1, 0.1), 0),
        ((0.0, 0.0, 0.0), None),
    ],
)
def test_the_surface_that_is_seen_is_picked(opacities, expected):
    found = surface_on_ray(
        RAMP, np.eye(4), ramp_ray(), isovalues=(2.5, 4.0, 6.25), opacities=opacities, step_world=0.7
    )
    assert (found.surface if found else None) == expected
    if found:
        np.testing.assert_allclose(found.position, ((2.5, 4.0, 6.25)[expected], 4, 4), atol=1e-9)


def test_crop_planes_and_geometry_in_front_hide_surfaces():
    common = {"isovalues": (2.5,), "step_world": 0.7}
    assert surface_on_ray(RAMP, np.eye(4), ramp_ray(), **common) is not None
    assert surface_on_ray(RAMP, np.eye(4), ramp_ray(), **common, crop=(3, 8, 0, 8, 0, 8)) is None
    plane = [((3.0, 0.0, 0.0), (1.0, 0.0, 0.0))]
    assert surface_on_ray(RAMP, np.eye(4), ramp_ray(), **common, clip_planes=plane) is None
    assert surface_on_ray(RAMP, np.eye(4), ramp_ray()._replace(length=31.0), **common) is None


def test_values_that_are_not_finite_count_as_the_lowest():
    holed = RAMP.copy()
    holed[:, :, 4:] = np.nan
    found = surface_on_ray(holed, np.eye(4), ramp_ray(), isovalues=(1.5,), step_world=0.7, lowest=0.0)
    assert found is not None
    np.testing.assert_allclose(found.position, (1.5, 4, 4), atol=1e-9)
    beyond = surface_on_ray(holed, np.eye(4), ramp_ray(), isovalues=(3.5,), step_world=0.7, lowest=0.0)
    assert beyond is None


def test_bad_arguments_are_refused_in_words():
    with pytest.raises(InputError, match="step above 0"):
        surface_on_ray(RAMP, np.eye(4), ramp_ray(), isovalues=(1.0,), step_world=0.0)
    with pytest.raises(InputError, match="one opacity per isovalue"):
        surface_on_ray(RAMP, np.eye(4), ramp_ray(), isovalues=(1.0,), opacities=(1, 1), step_world=1.0)
