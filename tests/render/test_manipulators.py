"""Handles in a plain plotter: drawn over the image, dragged by VTK's interactor, never in the way of the camera."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest

import volviz
from tests.render.scenes import camera, function, volume
from volviz.custom_gl.offscreen import apply_camera
from volviz.custom_gl.vtk.vtk_imports import pyvista, vtkActor2D

SIZE = (200, 150)
LEFT = ("LeftButtonPressEvent", "MouseMoveEvent", "LeftButtonReleaseEvent")


@contextmanager
def shown(technique: str, **values: Any) -> Iterator[tuple[Any, Any]]:
    """A plotter with a volume and its handles."""
    of = volume()
    window = pyvista.Plotter(off_screen=True, window_size=SIZE)
    window.render_window.SetMultiSamples(0)
    window.set_background("black")
    try:
        handle = volviz.add_volume(window, of, technique, transfer_function=function(of), **values)
        apply_camera(window.camera, camera(of))
        window.reset_camera_clipping_range()
        window.show(auto_close=False, interactive=False)
        handle.show_manipulators()
        yield window, handle
        handle.raise_error()
    finally:
        window.close()


def shot(window: Any) -> Any:
    window.render()
    return window.screenshot(return_img=True)[..., :3].astype(float)


def place_of(handle: Any, grip: str) -> tuple[int, int]:
    """The pixel in the middle of a manipulator, at which it can be held."""
    x, y = (round(v) for v in handle.manipulators.place(grip))
    assert handle.manipulators.part_at(x, y) == grip
    return x, y


def drag(window: Any, start: tuple[int, int], end: tuple[int, int]) -> None:
    """A left drag through VTK's interactor; pixels from the upper left."""
    interactor = window.iren.interactor
    for event, (x, y) in zip((*LEFT[:2], LEFT[1], LEFT[2]), (start, start, end, end), strict=True):
        interactor.SetEventInformation(x, SIZE[1] - y, 0, 0, "\0", 0, None)
        interactor.InvokeEvent(event)


def test_techniques_have_the_handles_that_they_declare() -> None:
    with shown("bump_mapping", headlight=False) as (_, handle):
        assert handle.manipulators.shown == ("light", "plane")
        handle.update(surface="box")
        assert handle.manipulators.shown == ("light",)
        handle.update(headlight=True)
        assert handle.manipulators.shown == ()
        handle.update(technique="half_angle", headlight=False)
        assert handle.manipulators.shown == ("light",)
        handle.update(technique="raycast")
        assert handle.manipulators.shown == ()


def test_handles_are_drawn_over_the_picture_and_leave_it_as_it_was() -> None:
    with shown("bump_mapping", headlight=False) as (window, handle):
        drawn = handle.status
        with_manipulators = shot(window)
        handle.show_manipulators(False)
        without = shot(window)
        assert 30 < (np.abs(with_manipulators - without).max(axis=-1) > 30).sum() < 4000
        # the volume itself was drawn once
        assert handle.status is drawn
        handle.show_manipulators()
        assert np.array_equal(shot(window), with_manipulators)


def test_dragging_the_knob_of_the_light_moves_it_around_the_volume() -> None:
    with shown("half_angle", headlight=False) as (window, handle):
        center = np.asarray(handle.volume.center)
        before = np.asarray(handle.light_position)
        view = window.camera.position
        x, y = place_of(handle, "light")
        drag(window, (x, y), (x + 60, y + 40))
        after = np.asarray(handle.light_position)
        assert np.linalg.norm(after - before) > 0.2 * np.linalg.norm(before - center)
        assert np.linalg.norm(after - center) == pytest.approx(np.linalg.norm(before - center))
        assert window.camera.position == view
        assert handle.manipulators.part_at(x + 60, y + 40) == "light"


def test_dragging_the_arrow_tilts_the_plane_and_its_knob_pushes_it() -> None:
    with shown("bump_mapping", headlight=True, plane_normal=(1.0, 0.2, 0.1)) as (window, handle):
        view = window.camera.position
        x, y = place_of(handle, "normal")
        drag(window, (x, y), (x - 10, y - 25))
        tilted = handle.settings
        assert np.linalg.norm(tilted.plane_normal) == pytest.approx(1)
        assert np.dot(tilted.plane_normal, (0.98, 0.19, 0.1)) < 0.97
        x, y = place_of(handle, "plane")
        drag(window, (x, y), (x + 20, y))
        pushed = handle.settings
        assert pushed.plane_normal == tilted.plane_normal
        way = np.subtract(pushed.plane_origin, tilted.plane_origin)
        assert np.linalg.norm(way) > 0
        assert np.linalg.norm(np.cross(way, pushed.plane_normal)) < 1e-9 * np.linalg.norm(way) + 1e-12
        assert window.camera.position == view


def test_a_drag_beside_the_handles_turns_the_camera() -> None:
    with shown("half_angle", headlight=False) as (window, handle):
        window.enable_trackball_style()
        before, light = window.camera.position, handle.light_position
        x, y = 100, 110
        assert handle.manipulators.part_at(x, y) is None
        drag(window, (x, y), (x + 30, y))
        assert window.camera.position != before
        assert handle.light_position == light


def test_handles_go_with_the_volume() -> None:
    with shown("bump_mapping", headlight=False) as (window, handle):
        handle.remove()
        assert handle.manipulators is None
        assert not any(isinstance(p, vtkActor2D) for p in window.renderer.GetViewProps())
        drag(window, (100, 75), (120, 75))
