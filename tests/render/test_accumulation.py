"""Images that follow the full one at rest: their mean is better, and everything else stays as it was."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
import pyvista

import volviz
from tests.render.scenes import Requests, camera, function, image, volume
from volviz.custom_gl.offscreen import apply_camera
from volviz.custom_gl.vtk.progressive import PHASES, SHOWN_AFTER, SUBPIXEL_JITTER, sample_phase

SIZE = (72, 64)


@contextmanager
def window(technique: str = "raycast", *, pacer: Requests | None = None, **values: Any) -> Iterator[Any]:
    """Plotter and handle of a volume with an edge in it."""
    of = volume(np.float32)
    plotter = pyvista.Plotter(off_screen=True, window_size=SIZE)
    plotter.render_window.SetMultiSamples(0)
    handle = volviz.add_volume(plotter, of, technique, transfer_function=function(of), pacer=pacer, **values)
    apply_camera(plotter.camera, camera(of))
    plotter.reset_camera_clipping_range()
    plotter.show(auto_close=False, interactive=False)
    try:
        yield plotter, handle
    finally:
        plotter.close()


def until_idle(plotter: Any, handle: Any, pacer: Requests) -> list[int]:
    """What an event loop does; numbers of images in the means that it showed."""
    shown = []
    for _ in range(400):
        asked = pacer.count
        plotter.render()
        handle.raise_error()
        shown.append(handle.status.samples)
        if pacer.count == asked:
            return shown
        while not handle.refine(budget=0.0):
            handle.raise_error()
    raise AssertionError("the window never comes to rest")


def test_places_and_phases_are_spread_evenly_about_the_middle() -> None:
    for n in SHOWN_AFTER:
        assert np.abs(np.mean(SUBPIXEL_JITTER[:n], axis=0)).max() < 1e-12
        assert abs(np.mean(PHASES[:n])) < 1e-12
    for axis in (0, 1):
        assert len({place[axis] for place in SUBPIXEL_JITTER}) == len(SUBPIXEL_JITTER)
    assert sorted([0.0, *PHASES]) == pytest.approx(np.arange(-4, 5) / 9.0)
    assert sample_phase(1.0, 3) == 1.0, "far ends are VTK's rule and stay"


@pytest.mark.parametrize("technique", ["raycast", "isosurface", "slicing"])
def test_the_mean_is_nearer_to_a_picture_of_many_rays_a_pixel(technique: str) -> None:
    pacer = Requests()
    of = volume(np.float32)
    fine = image(of, function(of), camera(of), size=(4 * SIZE[0], 4 * SIZE[1]), technique_id=technique)
    exact = fine.reshape(SIZE[1], 4, SIZE[0], 4, 4).mean(axis=(1, 3))
    with window(technique, pacer=pacer) as (plotter, handle):
        shown = until_idle(plotter, handle, pacer)
        first, mean = handle.read_image(), handle.read_image(averaged=True)
    assert shown[-1] == 9
    assert np.abs(mean - exact).mean() < 0.7 * np.abs(first - exact).mean()
    # the image that scripts read is the one without further ones
    plain = image(of, function(of), camera(of), size=SIZE, technique_id=technique)
    assert np.abs(first - plain).max() < 1e-5


def test_wood_grain_of_long_steps_fades() -> None:
    of = volume(np.float32)
    exact = image(of, function(of), camera(of), size=SIZE, step=0.1)
    pacer = Requests()
    with window(pacer=pacer, step=4.0) as (plotter, handle):
        until_idle(plotter, handle, pacer)
        first, mean = handle.read_image(), handle.read_image(averaged=True)
    assert np.abs(mean - exact).mean() < 0.6 * np.abs(first - exact).mean()


def test_the_first_full_picture_counts_as_complete_and_rest_is_rest() -> None:
    pacer = Requests()
    with window(pacer=pacer) as (plotter, handle):
        seen: list[Any] = []
        handle.on_status.append(seen.append)
        shown = until_idle(plotter, handle, pacer)
        # complete from the first full image on, while further ones are drawn
        first = next(i for i, status in enumerate(seen) if status.complete)
        assert all(status.complete for status in seen[first:])
        assert sorted(set(shown)) == [1, 3, 5, 9]
        count, drawn = pacer.count, len(seen)
        for _ in range(3):
            plotter.render()
            assert handle.refine(0.03)
        assert (pacer.count, len(seen)) == (count, drawn)


def test_a_change_begins_anew_and_a_gesture_waits() -> None:
    pacer = Requests()
    with window(pacer=pacer) as (plotter, handle):
        until_idle(plotter, handle, pacer)
        before = handle.read_image(averaged=True)
        handle.begin_interaction()
        plotter.camera.Azimuth(30)
        plotter.render()
        assert handle.status.samples == 1
        assert handle.refine(0.03), "nothing is drawn during a gesture"
        handle.end_interaction()
        until_idle(plotter, handle, pacer)
        turned = handle.read_image(averaged=True)
        assert np.abs(turned - before).max() > 0.05
        plotter.camera.Azimuth(-30)
        until_idle(plotter, handle, pacer)
        assert np.abs(handle.read_image(averaged=True) - before).max() < 2e-3


def test_an_interrupted_sum_goes_on_without_the_piece_that_was_given_up() -> None:
    pacer = Requests()
    with window("slicing", pacer=pacer) as (plotter, handle):
        until_idle(plotter, handle, pacer)
        whole = handle.read_image(averaged=True)
        handle.update(step=0.4)
        handle.update(step=0.5)
        plotter.render()
        while not handle.refine(budget=0.0):
            pass
        plotter.render()
        handle.refine(budget=0.0)
        # a click without a movement
        handle.begin_interaction()
        handle.end_interaction()
        until_idle(plotter, handle, pacer)
        assert handle.status.samples == 9
        assert np.abs(handle.read_image(averaged=True) - whole).max() < 1e-5


@pytest.mark.parametrize("reason", ["no pacer", "switched off"])
def test_no_further_pictures_without_an_event_loop_or_a_wish(reason: str) -> None:
    pacer = None if reason == "no pacer" else Requests()
    with window(pacer=pacer) as (plotter, handle):
        handle.accumulates = pacer is None
        if pacer is not None:
            until_idle(plotter, handle, pacer)
        plotter.render()
        assert handle.refine()
        assert handle.status.samples == 1
        assert np.array_equal(handle.read_image(), handle.read_image(averaged=True))


def test_pictures_that_take_long_are_not_repeated() -> None:
    pacer = Requests()
    with window(pacer=pacer) as (plotter, handle):
        handle._cost.observe = lambda level, seconds: None
        handle._cost._full_seconds = handle._cost._last_full_seconds = 2.0
        handle.update(step=0.45)
        assert set(until_idle(plotter, handle, pacer)) == {1}
