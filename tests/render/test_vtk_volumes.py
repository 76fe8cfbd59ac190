"""VTK's volume mappers behind the technique protocol: the same volume, in the same place, under the same cuts."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
import pyvista

import volviz
from tests.render.scenes import LEFT_HANDED, OBLIQUE, camera, function, image, psnr, volume
from volviz.custom_gl.offscreen import apply_camera

SIZE = (96, 80)
GEOMETRY = {
    "straight": {},
    "oblique": {"direction": OBLIQUE, "origin": (5.0, -3.0, 7.0), "spacing": (1.0, 1.2, 0.8)},
    "left-handed": {"direction": LEFT_HANDED, "origin": (5.0, -3.0, 7.0), "spacing": (1.0, 1.2, 0.8)},
}
CUTS: dict[str, dict[str, Any]] = {
    "whole": {},
    "crop": {"crop": (5.3, 25.2, 3.0, 20.0, 0.0, 26.0)},
    "plane": {"clip_planes": (((15.0, 15.0, 15.0), (1.0, 0.3, 0.2)),)},
    "shaded": {"shading": True},
}


def shift_of_the_best_match(a: Any, b: Any) -> tuple[int, int]:
    """By how many pixels `b` is moved against `a`, within three."""
    inner = slice(4, -4)
    errors = {
        (dy, dx): float(np.mean((np.roll(b, (dy, dx), (0, 1))[inner, inner] - a[inner, inner]) ** 2))
        for dy in range(-3, 4)
        for dx in range(-3, 4)
    }
    return min(errors, key=lambda shift: errors[shift])


@pytest.mark.parametrize("cut", CUTS)
@pytest.mark.parametrize("geometry", GEOMETRY)
def test_vtks_ray_caster_shows_what_ours_shows(geometry: str, cut: str) -> None:
    of = volume(**GEOMETRY[geometry])
    view, transfer = camera(of), function(of)
    theirs = image(of, transfer, view, size=SIZE, technique_id="vtk_gpu", **CUTS[cut])
    ours = image(of, transfer, view, size=SIZE, first_sample=1.0, **CUTS[cut])
    assert psnr(theirs, ours) > 45
    assert shift_of_the_best_match(theirs, ours) == (0, 0)


def test_vtk_agrees_with_a_window_of_its_own() -> None:
    from vtkmodules.vtkRenderingCore import vtkRenderer

    of = volume()
    view, transfer = camera(of), function(of)
    behind_protocol = image(of, transfer, view, size=SIZE, technique_id="vtk_gpu")
    plotter = pyvista.Plotter(off_screen=True, window_size=SIZE)
    try:
        plotter.render_window.SetMultiSamples(0)
        prop = _plain_vtk_volume(of, transfer)
        renderer: vtkRenderer = plotter.renderer
        renderer.AddVolume(prop)
        plotter.background_color = "black"
        apply_camera(plotter.camera, view)
        plotter.reset_camera_clipping_range()
        plain = plotter.screenshot(return_img=True)[..., :3] / 255.0
    finally:
        plotter.close()
    # half a level of rounding to bytes
    assert np.abs(plain - behind_protocol[..., :3]).max() < 0.6 / 255


def _plain_vtk_volume(of: volviz.Volume, transfer: volviz.TransferFunction) -> Any:
    from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
    from vtkmodules.vtkRenderingCore import vtkColorTransferFunction, vtkVolume, vtkVolumeProperty
    from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper

    from volviz.compare.vtk_contours import vtk_image

    mapper = vtkOpenGLGPUVolumeRayCastMapper()
    mapper.SetInputData(vtk_image(of))
    mapper.SetAutoAdjustSampleDistances(False)
    mapper.SetSampleDistance(0.5)
    mapper.SetUseJittering(False)
    colors, opacities = vtkColorTransferFunction(), vtkPiecewiseFunction()
    for point in transfer.points:
        colors.AddRGBPoint(point.value, *point.color)
        opacities.AddPoint(point.value, point.opacity)
    settings = vtkVolumeProperty()
    settings.SetColor(colors)
    settings.SetScalarOpacity(opacities)
    settings.SetInterpolationTypeToLinear()
    settings.ShadeOff()
    settings.SetScalarOpacityUnitDistance(1.0)
    prop = vtkVolume()
    prop.SetMapper(mapper)
    prop.SetProperty(settings)
    return prop


def test_one_handle_changes_between_ours_and_vtks_and_back() -> None:
    of = volume()
    plotter = pyvista.Plotter(off_screen=True, window_size=SIZE)
    plotter.render_window.SetMultiSamples(0)
    try:
        handle = volviz.add_volume(plotter, of, "raycast", transfer_function=function(of), first_sample=1.0)
        apply_camera(plotter.camera, camera(of))
        plotter.reset_camera_clipping_range()
        plotter.show(auto_close=False, interactive=False)
        first = handle.read_image()
        handle.update(technique="vtk_gpu", step=0.5)
        plotter.render()
        handle.raise_error()
        theirs = handle.read_image()
        assert handle.status.complete
        assert 45 < psnr(first, theirs) < 99
        handle.update(technique="raycast", first_sample=1.0)
        plotter.render()
        handle.raise_error()
        np.testing.assert_array_equal(handle.read_image(), first)
    finally:
        plotter.close()


@pytest.mark.parametrize("technique", ["vtk_gpu", "vtk_fixed_point"])
@pytest.mark.parametrize("parallel", [False, True])
def test_a_camera_inside_that_looks_away_from_the_middle_sees_what_ours_sees(
    technique: str, parallel: bool
) -> None:
    of = volume()
    x, y, z = of.center
    view = volviz.Camera(
        (x + 1.0, y + 1.0, z), (x + 4.0, y + 8.0, z + 2.0), (0.0, 0.0, 1.0), view_angle=60.0,
        parallel=parallel, parallel_scale=8.0,
    )  # fmt: skip
    theirs = image(of, function(of), view, size=SIZE, technique_id=technique)
    ours = image(of, function(of), view, size=SIZE, first_sample=1.0)
    assert ours[..., 3].mean() > 0.05
    assert psnr(theirs, ours) > 30


@pytest.mark.parametrize(("theirs", "level"), [("vtk_gpu", 40), ("vtk_fixed_point", 35)])
def test_opaque_meshes_hide_vtks_volume_and_are_hidden_by_it(theirs: str, level: float) -> None:
    of = volume()
    transfer = function(of)
    x, y, z = of.center
    images = []
    for technique, values in ((theirs, {}), ("raycast", {"first_sample": 1.0})):
        plotter = pyvista.Plotter(off_screen=True, window_size=SIZE)
        plotter.render_window.SetMultiSamples(0)
        try:
            plotter.add_mesh(
                pyvista.Sphere(radius=5.0, center=(x + 2, y - 3, z)), color="white", lighting=False
            )
            handle = volviz.add_volume(plotter, of, technique, transfer_function=transfer, **values)
            apply_camera(plotter.camera, camera(of))
            plotter.reset_camera_clipping_range()
            plotter.show(auto_close=False, interactive=False)
            handle.raise_error()
            images.append(handle.read_image())
        finally:
            plotter.close()
    free = image(of, transfer, camera(of), size=SIZE, technique_id=theirs)
    assert np.abs(images[0] - free).max() > 0.1
    assert psnr(images[0], images[1]) > level


def test_a_picture_of_twice_the_size_made_of_tiles_is_whole() -> None:
    of = volume()
    plotter = pyvista.Plotter(off_screen=True, window_size=SIZE)
    plotter.render_window.SetMultiSamples(0)
    try:
        volviz.add_volume(plotter, of, "vtk_gpu", transfer_function=function(of))
        plotter.background_color = "black"
        apply_camera(plotter.camera, camera(of))
        plotter.reset_camera_clipping_range()
        plotter.show(auto_close=False, interactive=False)
        twice = plotter.screenshot(return_img=True, scale=2).astype(float) / 255
    finally:
        plotter.close()
    size = (2 * SIZE[0], 2 * SIZE[1])
    whole = image(of, function(of), camera(of), size=size, technique_id="vtk_gpu")
    assert psnr(twice, whole[..., :3]) > 45


def test_a_jump_of_the_transfer_function_stays_a_jump() -> None:
    ramp = np.broadcast_to(np.linspace(0, 1, 33, dtype=np.float32), (17, 17, 33))
    of = volviz.Volume(ramp, name="ramp")
    jump = volviz.TransferFunction.from_points(
        [(0, (0, 0, 1, 0)), (0.5, (0, 0, 1, 0)), (0.5, (1, 0, 0, 1)), (1, (1, 0, 0, 1))]
    )
    view = dataclasses.replace(volviz.Camera.fit(of.corners), parallel=True)
    theirs = image(of, jump, view, size=SIZE, technique_id="vtk_gpu")
    covered = theirs[SIZE[1] // 2, :, 3]
    # a red half, an empty half, and at most one pixel between
    assert ((covered > 0.01) & (covered < 0.99)).sum() <= 1
    assert theirs[..., 2].max() < 0.01
    assert theirs[..., 0].max() > 0.99


def test_values_that_are_not_finite_and_long_integers_are_drawn() -> None:
    array = volume(np.float32).array.copy()
    array[0, 0, 0], array[1, 1, 1] = np.nan, np.inf
    of = volviz.Volume(array)
    shown = image(of, function(of), camera(of), size=SIZE, technique_id="vtk_gpu")
    plain = volume(np.float32)
    expected = image(plain, function(plain), camera(of), size=SIZE, technique_id="vtk_gpu")
    assert psnr(shown, expected) > 40
    wide = volviz.Volume(volume().array.astype(np.int64))
    shown = image(wide, function(wide), camera(wide), size=SIZE, technique_id="vtk_gpu")
    bytes_ = volume()
    expected = image(bytes_, function(bytes_), camera(wide), size=SIZE, technique_id="vtk_gpu")
    assert psnr(shown, expected) > 50


def test_a_volume_that_is_too_long_for_vtks_texture_is_refused_in_words(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from volviz.custom_gl.gpu.context import Gpu

    of = volume()
    made = Gpu.__init__

    def small(self: Gpu) -> None:
        made(self)
        self.limits = dataclasses.replace(self.limits, max_3d_texture=32)

    monkeypatch.setattr(Gpu, "__init__", small)
    with pytest.raises(volviz.VolvizError, match=r"at most 32 voxels .* this volume has 35"):
        image(of, function(of), camera(of), size=SIZE, technique_id="vtk_gpu")
