"""`Plotter.set_scale` stretches volumes as it does meshes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import volviz
from volviz.custom_gl.vtk.vtk_imports import pyvista


def ball() -> volviz.Volume:
    z, y, x = np.mgrid[-1:1:20j, -1:1:20j, -1:1:20j]
    return volviz.Volume(np.clip(1 - np.sqrt(x * x + y * y + z * z), 0, 1).astype(np.float32))


def proportion(plotter: Any) -> float:
    """Height by width of what is seen."""
    plotter.view_xz()
    plotter.render()
    rows, columns = np.where(plotter.screenshot(None, return_img=True).astype(int).sum(-1) > 60)
    return float(np.ptp(rows) / np.ptp(columns))


@pytest.mark.parametrize(
    "technique", ["raycast", "isosurface", "marching_cubes", "vtk_gpu", "vtk_flying_edges"]
)
def test_a_volume_is_stretched_with_everything_else(technique: str) -> None:
    plotter = pyvista.Plotter(off_screen=True, window_size=(160, 160))
    plotter.background_color = "black"
    handle = volviz.add_volume(plotter, ball(), technique)
    plotter.set_scale(zscale=3)
    assert plotter.bounds == pytest.approx((0, 19, 0, 19, 0, 57))
    assert proportion(plotter) == pytest.approx(3.0, rel=0.05)
    picked = handle.pick(80, 80)
    assert picked is not None
    assert picked.position[2] == pytest.approx(3 * 9.5, abs=1.0)
    # a plane of the world cuts the stretched volume
    handle.update(clip_planes=(((0, 0, 28.5), (0, 0, 1)),))
    assert proportion(plotter) == pytest.approx(1.5, rel=0.07)
    handle.update(clip_planes=())
    plotter.set_scale(xscale=3)
    assert proportion(plotter) == pytest.approx(1.0, rel=0.05)
    plotter.scale = [1, 1, 1]
    assert handle.volume.spacing == (1.0, 1.0, 1.0)
    plotter.close()


def test_a_volume_that_comes_later_is_stretched_too() -> None:
    plotter = pyvista.Plotter(off_screen=True, window_size=(40, 40))
    plotter.set_scale(xscale=2)
    volviz.add_volume(plotter, ball(), "raycast")
    assert plotter.bounds == pytest.approx((0, 38, 0, 19, 0, 19))
    plotter.close()
