"""What graphics cards are given instead of software OpenGL's share, drawn by software that pretends to be one."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import volviz
from tests.render.scenes import camera, function, image, oracle, psnr, shown, volume
from volviz.custom_gl.gpu.context import PRETEND_HARDWARE
from volviz.custom_gl.gpu.resources import texel_limits
from volviz.custom_gl.vtk import frame_uniforms
from volviz.custom_gl.vtk.vtk_imports import pyvista
from volviz.model.render_spec import RenderSpec, View

SIZE = (48, 40)


@pytest.fixture(autouse=True)
def pretended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(PRETEND_HARDWARE, "1")


def test_the_switch_answers_for_the_driver(monkeypatch: pytest.MonkeyPatch) -> None:
    of = volume()
    with shown(of, "raycast", SIZE) as (window, handle):
        window.render()
        handle.raise_error()
        limits = handle.gpu.limits
        assert not limits.software
        assert not handle.gpu.programs.forwards_uniforms
        monkeypatch.delenv(PRETEND_HARDWARE)
        named = any(
            word in limits.renderer.lower() for word in ("llvmpipe", "softpipe", "swrast", "software")
        )
        assert limits.software == named


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.int16])
@pytest.mark.parametrize(
    ("technique", "values"),
    [
        ("raycast", {}),
        ("raycast", {"mode": "maximum"}),
        ("raycast", {"shading": True, "interpolation": "nearest"}),
        ("raycast", {"preintegrated": True}),
        ("two_pass_raycast", {"gradient_opacity": 0.5}),
        ("slicing", {"shading": True}),
    ],
)
def test_integers_in_textures_of_their_own_size_give_the_oracles_picture(
    dtype: Any, technique: str, values: dict[str, Any]
) -> None:
    of = volume(dtype, spacing=(1.0, 1.2, 0.9))
    transfer, view = function(of), camera(of)
    exact = oracle(of, transfer, view, size=SIZE, technique_id=technique, **values)
    drawn = image(of, transfer, view, size=SIZE, technique_id=technique, **values)
    assert psnr(drawn, exact) > 40


@pytest.mark.parametrize(
    ("dtype", "pretended_format", "software_format"),
    [(np.uint8, "u1", "u1"), (np.uint16, "u2", "u2"), (np.int16, "u2", "u2"), (np.float32, "f4", "f4")],
)
def test_textures_have_the_smallest_format_that_loses_nothing(
    dtype: Any, pretended_format: str, software_format: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    of = volume(dtype)
    with shown(of, "raycast", SIZE) as (window, handle):
        window.render()
        handle.raise_error()
        assert texel_limits(handle.gpu, of, alone=True)[0] == pretended_format
        monkeypatch.delenv(PRETEND_HARDWARE)
        if handle.gpu.limits.software:
            assert texel_limits(handle.gpu, of, alone=True)[0] == software_format
            # beside others in one texture OpenGL filters, which software does precisely with floats alone
            assert texel_limits(handle.gpu, of, alone=False)[0] == "f4"


def test_multisampling_stays() -> None:
    window = pyvista.Plotter(off_screen=True, window_size=SIZE)
    handle = None
    try:
        window.render_window.SetMultiSamples(4)
        handle = volviz.add_volume(window, volume(), "raycast")
        window.show(auto_close=False, interactive=False)
        handle.raise_error()
        assert window.render_window.GetMultiSamples() == 4
        # the volume is there over the samples of VTK's framebuffer
        assert np.count_nonzero(handle.read_image()[..., 3]) > 50
    finally:
        if handle is not None:
            handle.remove()
        window.close()


def test_full_data_are_read_while_something_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    of = volviz.Volume(np.zeros((96, 96, 96), np.float32) + np.arange(96, dtype=np.float32))
    with shown(of, "raycast", (24, 24)) as (window, handle):
        window.render()
        handle.raise_error()
        frame = SimpleNamespace(
            interactive=True, gpu=handle.gpu, common=SimpleNamespace(mipmaps=False, interpolation="linear"),
            volume=of, resources=SimpleNamespace(finest=0, coarsest=3), joint=None,
        )  # fmt: skip
        monkeypatch.setattr(frame_uniforms, "pixel_size", lambda _frame: 4.0)
        assert frame_uniforms.level_of_detail(frame) == 0
        monkeypatch.delenv(PRETEND_HARDWARE)
        assert frame_uniforms.level_of_detail(frame) == (2 if handle.gpu.limits.software else 0)


def test_frame_times_are_also_taken_by_the_clock_of_the_gpu() -> None:
    of = volume()
    with volviz.Renderer(size=SIZE) as renderer:
        renderer.render(of)
        assert not renderer.is_software
        spec = RenderSpec((volviz.ImageLayer(of, function(of)),))
        seconds, gpu_seconds = renderer.timed(spec, View(camera(of), SIZE))
    assert seconds > 0
    assert gpu_seconds is not None


@pytest.mark.parametrize("technique", ["raycast", "isosurface", "half_angle", "splatting", "marching_cubes"])
def test_pictures_are_those_of_software_opengl(technique: str, monkeypatch: pytest.MonkeyPatch) -> None:
    of = volume(np.float32, spacing=(1.0, 1.2, 0.9))
    transfer, view = function(of), camera(of)
    hardware = image(of, transfer, view, size=SIZE, technique_id=technique)
    monkeypatch.delenv(PRETEND_HARDWARE)
    software = image(of, transfer, view, size=SIZE, technique_id=technique)
    assert np.count_nonzero(software[..., 3]) > 50
    assert np.abs(hardware - software).max() < 1e-5
