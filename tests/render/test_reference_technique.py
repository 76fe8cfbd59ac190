"""The reference as a technique, and who is nearer to it: our ray casters or VTK's."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
import pyvista

import volviz
from tests.render.scenes import LEFT_HANDED, OBLIQUE, Requests, camera, function, image, oracle, psnr, volume
from volviz.custom_gl.offscreen import apply_camera
from volviz.custom_gl.techniques.reference.computing import Image, OracleRequest, computed
from volviz.tasks import LatestResult, Tasks

SIZE = (96, 80)
GEOMETRY: dict[str, dict[str, Any]] = {
    "straight": {},
    "oblique": {"direction": OBLIQUE, "origin": (5.0, -3.0, 7.0), "spacing": (1.0, 1.2, 0.8)},
    "left-handed": {"direction": LEFT_HANDED, "origin": (5.0, -3.0, 7.0), "spacing": (1.0, 1.2, 0.8)},
}
#: What the rays of both are brought to.
LIKE_VTK = {"first_sample": 1.0, "step": 0.5}


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"mode": "maximum"},
        {"mode": "attenuated_maximum"},
        {"shading": True, "light_position": (60.0, -40.0, 80.0)},
        {"gradient_opacity": 0.7},
        {"preintegrated": True},
        {"crop": (5.3, 25.2, 3.0, 20.0, 0.0, 26.0), "clip_planes": (((15.0, 15.0, 15.0), (1.0, 0.3, 0.2)),)},
    ],
    ids=str,
)
def test_the_technique_shows_what_the_oracle_computes(values: dict[str, Any]) -> None:
    of = volume()
    shown = image(of, function(of), camera(of), size=(48, 40), technique_id="reference", **values)
    computed = oracle(of, function(of), camera(of), size=(48, 40), technique_id="reference", **values)
    # float32 and straight alpha in between
    assert np.abs(shown - computed).max() < 2e-3


@pytest.mark.parametrize("geometry", GEOMETRY)
def test_ours_is_at_least_as_close_to_the_reference_as_vtks(geometry: str) -> None:
    of = volume(**GEOMETRY[geometry])
    view, transfer = camera(of), function(of)
    truth = image(of, transfer, view, size=SIZE, technique_id="reference", **LIKE_VTK)
    theirs = image(of, transfer, view, size=SIZE, technique_id="vtk_gpu", step=0.5)
    for ours in ("raycast", "two_pass_raycast", "slicing"):
        shown = image(of, transfer, view, size=SIZE, technique_id=ours, **LIKE_VTK)
        assert psnr(shown, theirs) > 45, ours
        if ours != "slicing":
            # slices stand across the view, not across each ray: they sample at other places
            assert psnr(shown, truth) >= psnr(theirs, truth), ours


def test_fewer_rows_are_shown_as_blocks() -> None:
    of = volume()
    shown = image(of, function(of), camera(of), size=SIZE, technique_id="reference", resolution=20)
    blocks = shown.reshape(20, 4, 24, 4, 4)
    assert np.abs(blocks - blocks[:, :1, :, :1]).max() < 1e-6
    few = image(of, function(of), camera(of), size=(24, 20), technique_id="reference")
    assert np.abs(blocks[:, 0, :, 0] - few).max() < 1e-6


def test_a_window_goes_on_while_the_reference_is_computed() -> None:
    of = volume()
    plotter = pyvista.Plotter(off_screen=True, window_size=(240, 200))
    plotter.render_window.SetMultiSamples(0)
    pacer = Requests()
    try:
        handle = volviz.add_volume(
            plotter, of, "reference", transfer_function=function(of), pacer=pacer, step=0.1
        )
        apply_camera(plotter.camera, camera(of))
        plotter.reset_camera_clipping_range()
        plotter.show(auto_close=False, interactive=False)
        shares = []
        assert pacer.count
        assert not handle.status.complete
        end = time.perf_counter() + 60
        while not handle.refine(budget=0.01):
            shares.append(handle.status.waiting)
            assert time.perf_counter() < end
        handle.raise_error()
        assert handle.status.complete
        told = [share for share in shares if share is not None]
        assert len(told) > 1
        assert told == sorted(told)
    finally:
        plotter.close()


def request(of: volviz.Volume, **changes: Any) -> OracleRequest:
    from volviz.custom_gl.techniques.reference.settings import ReferenceSettings

    view = np.eye(4)
    view[2, 3] = -100.0
    values: dict[str, Any] = {
        "volume": of, "function": function(of), "settings": ReferenceSettings(), "view": tuple(view.ravel()),
        "projection": tuple(np.diag([0.05, 0.05, -0.01, 1.0]).ravel()), "size": (200, 200), "step": 0.01,
        "unit_distance": 1.0, "crop": (0, 34, 0, 31, 0, 26), "planes": (), "light": None,
        "light_color": (1.0, 1.0, 1.0),
    }  # fmt: skip
    return OracleRequest(**(values | changes))


def test_a_picture_that_is_no_longer_wanted_is_cancelled() -> None:
    of, tasks = volume(), Tasks()
    images: LatestResult[OracleRequest, Image] = LatestResult("reference")

    def get(wanted: OracleRequest) -> Image | None:
        return images.get(tasks, wanted, lambda progress, cancel: computed(wanted, progress, cancel))

    # some 10 seconds of work
    assert get(request(of, step=0.0005)) is None
    small = request(of, step=0.5, size=(8, 8))
    assert get(small) is None
    assert tasks.wait(60)
    found = get(small)
    assert found is not None
    assert found.shape == (8, 8, 4)
    assert tasks.progress == 1.0


def test_an_error_of_the_oracle_is_raised_where_the_picture_is_asked_for() -> None:
    with pytest.raises(volviz.VolvizError, match="step_world"):
        computed(request(volume(), step=0.0))
