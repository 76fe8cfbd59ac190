"""VTK's props while something moves: less is drawn, and all of it again at rest."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import pyvista

import volviz
from tests.render.scenes import Requests, blobs, camera, function, psnr, volume
from volviz.custom_gl.offscreen import apply_camera
from volviz.custom_gl.techniques.vtk_point_gaussian import technique as points
from volviz.custom_gl.vtk.frame_scheduling import FULL
from volviz.custom_gl.vtk_props import mesh_props

SIZE = (96, 80)


def shown(technique: str, of: volviz.Volume, **values: Any) -> tuple[Any, Any]:
    """A plotter with a volume and a frame scheduler, complete."""
    plotter = pyvista.Plotter(off_screen=True, window_size=SIZE)
    plotter.render_window.SetMultiSamples(0)
    handle = volviz.add_volume(
        plotter, of, technique, transfer_function=function(of), pacer=Requests(), **values
    )
    apply_camera(plotter.camera, camera(of))
    plotter.reset_camera_clipping_range()
    plotter.show(auto_close=False, interactive=False)
    while not handle.refine(budget=0.05):
        pass
    plotter.render()
    handle.raise_error()
    return plotter, handle


@pytest.mark.parametrize("technique", [ident for ident in volviz.techniques() if ident.startswith("vtk_")])
def test_a_gesture_shows_less_and_rest_shows_all(technique: str) -> None:
    of = volume()
    plotter, handle = shown(technique, of)
    try:
        full = handle.read_image()
        handle.begin_interaction()
        # as if a full image took a second
        handle._cost.observe(FULL, 1.0)
        plotter.camera.Azimuth(10)
        plotter.render()
        handle.raise_error()
        assert handle.status.resolution < 1.0
        assert not handle.status.complete
        plotter.camera.Azimuth(-10)
        handle.end_interaction()
        while not handle.refine(budget=0.05):
            pass
        assert handle.status.complete
        assert np.abs(handle.read_image() - full).max() <= 1 / 255
    finally:
        plotter.close()


def test_a_mesh_of_many_triangles_moves_as_a_coarser_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mesh_props, "MOVING_TRIANGLES", 800)
    monkeypatch.setattr(mesh_props, "MOVING_TRIANGLES_HARDWARE", 800)
    of = volviz.Volume(blobs())
    plotter, handle = shown("vtk_flying_edges", of, specular=0.0)
    try:
        full = handle.read_image()
        prop = handle._runner.technique._technique
        many = prop.mapper.GetInput().GetNumberOfCells()
        assert many > 1600
        handle.begin_interaction()
        handle._cost.observe(FULL, 1.0)
        handle.update(color=(0.2, 0.4, 0.9))
        plotter.render()
        handle.wait()
        plotter.render()
        assert 0 < prop.mapper.GetInput().GetNumberOfCells() < 0.5 * many
        handle.end_interaction()
        handle.update(color=(0.87, 0.79, 0.65))
        while not handle.refine(budget=0.05):
            pass
        assert prop.mapper.GetInput().GetNumberOfCells() == many
        assert np.abs(handle.read_image() - full).max() <= 1 / 255
    finally:
        plotter.close()


def test_fewer_and_larger_splats_move(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(points, "MOVING_SPLATS", 300)
    monkeypatch.setattr(points, "MOVING_SPLATS_HARDWARE", 300)
    of = volume()
    plotter, handle = shown("vtk_point_gaussian", of)
    try:
        full = handle.read_image()
        prop = handle._runner.technique._technique
        handle.begin_interaction()
        handle._cost.observe(FULL, 1.0)
        plotter.camera.Azimuth(10)
        plotter.render()
        assert prop.mapper.GetInput().GetNumberOfPoints() == 300
        handle.end_interaction()
        plotter.camera.Azimuth(-10)
        while not handle.refine(budget=0.05):
            pass
        assert prop.mapper.GetInput().GetNumberOfPoints() > 600
        assert psnr(handle.read_image(), full) > 60
    finally:
        plotter.close()
