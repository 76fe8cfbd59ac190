"""`VolumeHandle.pick`: the point that is seen, by the rule of each technique."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import volviz
from volviz.custom_gl.vtk.vtk_imports import pyvista
from volviz.model.transfer.function_2d import Region, TransferFunction2D

SIZE = (121, 91)
CENTRE = (60, 45)
EYE = np.array([0.0, -60.0, 0.0])


def ball(radius: float = 8.0) -> volviz.Volume:
    """Distance to the surface of a ball, positive inside, with a bright core; oblique spacing, centre at zero."""
    z, y, x = np.indices((25, 29, 33), float)
    spacing = np.array([0.9, 1.1, 1.2])
    r = np.sqrt(((x - 16) * 0.9) ** 2 + ((y - 14) * 1.1) ** 2 + ((z - 12) * 1.2) ** 2)
    field = 100.0 + 10.0 * (radius - r)
    origin = -np.array([16, 14, 12]) * spacing
    return volviz.Volume(field.astype(np.float32), spacing=tuple(spacing), origin=tuple(origin))


@contextmanager
def shown(technique: str, of: volviz.Volume, **values: Any) -> Iterator[Any]:
    function = volviz.TransferFunction.from_points(
        [(99.99, (1, 0.5, 0.2, 0.0)), (100.01, (1, 0.5, 0.2, 0.999))]
    )
    window = pyvista.Plotter(off_screen=True, window_size=SIZE)
    try:
        handle = volviz.add_volume(window, of, technique, transfer_function=function, **values)
        window.camera_position = [tuple(EYE), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
        window.reset_camera_clipping_range()
        yield handle
    finally:
        window.close()


@pytest.mark.parametrize(
    ("technique", "values", "isovalue"),
    [
        ("isosurface", {"isovalues": (100.0,)}, 100.0),
        ("isosurface", {"isovalues": (100.0, 140.0), "opacities": (0.3, 1.0)}, 140.0),
        ("marching_cubes", {"isovalue": 120.0}, 120.0),
        ("marching_tetrahedra", {"isovalue": 120.0}, 120.0),
        ("splatting", {"isovalue": 120.0}, 120.0),
        ("bump_mapping", {"surface": "mesh", "isovalue": 120.0}, 120.0),
    ],
)
def test_surfaces_are_picked_where_they_are(technique: str, values: Any, isovalue: float) -> None:
    with shown(technique, ball(), **values) as handle:
        picked = handle.pick(*CENTRE)
        assert picked is not None
        assert picked.isovalue == isovalue
        assert picked.value == pytest.approx(isovalue, abs=0.05)
        # the nearest point of the ball of that isovalue
        assert picked.position == pytest.approx((0, -(8 - (isovalue - 100) / 10), 0), abs=0.05)
        assert picked.voxel[0] == 16
        assert picked.voxel[2] == 12
        assert handle.pick(3, 3) is None


@pytest.mark.parametrize("technique", ["raycast", "two_pass_raycast", "slicing", "half_angle"])
def test_volumes_are_picked_at_the_first_visible_place(technique: str) -> None:
    with shown(technique, ball()) as handle:
        picked = handle.pick(*CENTRE)
        assert picked is not None
        assert picked.isovalue is None
        assert picked.position == pytest.approx((0, -8, 0), abs=0.6)
        assert handle.pick(3, 3) is None
        handle.update(crop=(0, 32, 14, 28, 0, 24))
        assert handle.pick(*CENTRE).position[1] == pytest.approx(0, abs=0.6)
        handle.update(crop=None, clip_planes=(((0, -3, 0), (0, 1, 0)),))
        assert handle.pick(*CENTRE).position[1] == pytest.approx(-3, abs=0.6)


@pytest.mark.parametrize("technique", ["raycast", "slicing"])
def test_with_regions_the_first_place_that_they_show_is_picked(technique: str) -> None:
    of = ball()
    # the gradient of the ball is 10 everywhere but in its middle
    with shown(technique, of) as handle:
        shell = Region(
            "rectangle", value=140.0, width=20.0, gradient_low=5.0, gradient_high=15.0, opacity=0.5
        )
        beyond = replace(shell, gradient_low=1000.0, gradient_high=2000.0)
        curve = handle.transfer_function
        handle.update(transfer_function=replace(curve, by_gradient=TransferFunction2D((shell,))))
        picked = handle.pick(*CENTRE)
        assert picked is not None
        assert picked.value == pytest.approx(140.0, abs=11.0)
        handle.update(transfer_function=replace(curve, by_gradient=TransferFunction2D((beyond,))))
        assert handle.pick(*CENTRE) is None


def test_in_the_mode_maximum_the_brightest_place_is_picked() -> None:
    with shown("raycast", ball(), mode="maximum") as handle:
        picked = handle.pick(*CENTRE)
        assert picked.position == pytest.approx((0, 0, 0), abs=0.6)
        assert picked.voxel == (16, 14, 12)


def test_the_cut_plane_is_picked_on_the_plane_and_not_where_it_is_cut_out() -> None:
    of = ball()
    with shown("bump_mapping", of, plane_origin=(0, 2, 0), plane_normal=(0.2, -1, 0)) as handle:
        picked = handle.pick(*CENTRE)
        assert np.dot(np.subtract(picked.position, (0, 2, 0)), (0.2, -1, 0)) == pytest.approx(0, abs=1e-9)
        x, y = 60 + 20, 45
        assert handle.pick(x, y) is None
        handle.update(cut_out=False)
        assert handle.pick(x, y) is not None
        handle.update(surface="both")
        assert handle.pick(*CENTRE).position[1] == pytest.approx(-14 * 1.1)


def test_a_pixel_is_picked_on_the_ray_through_its_centre() -> None:
    with shown("isosurface", ball(), isovalues=(100.0,)) as handle:
        camera = handle.renderer.GetActiveCamera()
        tangent = np.tan(np.radians(camera.GetViewAngle() / 2))
        column, row = 70, 38
        picked = handle.pick(column, row)
        offset = np.subtract(picked.position, EYE)
        per_pixel = 2 * tangent * offset[1] / SIZE[1]
        assert offset[0] == pytest.approx((column + 0.5 - SIZE[0] / 2) * per_pixel, abs=1e-6)
        assert offset[2] == pytest.approx(-(row + 0.5 - SIZE[1] / 2) * per_pixel, abs=1e-6)
