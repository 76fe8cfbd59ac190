"""Our images inside VTK's window: occlusion both ways, overlay, antialiasing, renderers, state, ends."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest

import volviz
from tests.render.scenes import POINTS, camera, function, volume
from volviz.custom_gl.offscreen import apply_camera
from volviz.custom_gl.vtk import handles_of
from volviz.custom_gl.vtk.vtk_imports import pyvista
from volviz.custom_gl.vtk.window_gpu import KEEP_MULTISAMPLING
from volviz.errors import RenderError, VolvizError

SIZE = (160, 120)


@contextmanager
def plotter(multi_samples: int = 0, shape: tuple[int, int] = (1, 1), **options: Any) -> Iterator[Any]:
    """An off-screen plotter that is closed at the end."""
    window = pyvista.Plotter(off_screen=True, window_size=SIZE, shape=shape, border=False, **options)
    window.render_window.SetMultiSamples(multi_samples)
    window.set_background("black")
    try:
        yield window
    finally:
        window.close()


def shot(window: Any) -> Any:
    """The window's image, (H, W, 3) float."""
    return window.screenshot(return_img=True)[..., :3].astype(float)


def opaque_function(of: volviz.Volume) -> volviz.TransferFunction:
    return function(
        of, [(0.0, (0, 1, 0, 0.0)), (0.3, (0, 1, 0, 0.0)), (0.35, (0, 1, 0, 0.9)), (1.0, (0, 1, 0, 0.9))]
    )


def place(window: Any, of: volviz.Volume) -> None:
    apply_camera(window.camera, camera(of))
    window.reset_camera_clipping_range()


def test_the_picture_in_the_window_is_the_picture_of_render() -> None:
    of = volume()
    with plotter() as window:
        handle = volviz.add_volume(window, of, transfer_function=function(of))
        place(window, of)
        in_window = shot(window)
        handle.remove()
    alone = volviz.render(
        of, transfer_function=function(of), size=SIZE, camera=camera(of), background="black"
    )
    assert alone[..., :3].max() > 50
    assert np.abs(in_window - alone[..., :3]).max() <= 2


@pytest.mark.parametrize("technique", ["raycast", "slicing"])
@pytest.mark.parametrize("multi_samples", [0, 4])
def test_opaque_meshes_and_the_volume_occlude_one_another(
    technique: str, multi_samples: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(KEEP_MULTISAMPLING, "1")
    of = volume()
    eye = np.array(camera(of).position)
    toward = (eye - of.center) / np.linalg.norm(eye - of.center)
    with plotter(multi_samples) as window:
        before = pyvista.Sphere(radius=3.0, center=np.array(of.center) + 24 * toward)
        window.add_mesh(before, color="red", lighting=False)
        behind = pyvista.Sphere(radius=3.0, center=np.array(of.center) - 26 * toward)
        mesh = window.add_mesh(behind, color="blue", lighting=False)
        handle = volviz.add_volume(window, of, technique, transfer_function=opaque_function(of))
        place(window, of)
        image = shot(window)
        middle = image[SIZE[1] // 2, SIZE[0] // 2]
        assert middle[0] > 200, "the sphere in front of the volume is hidden"
        assert middle[1] < 30, "the volume shines through the sphere in front of it"
        window.remove_actor("nothing")
        # without the front sphere the volume hides the one behind
        window.clear_actors()
        handle.remove()
        handle = volviz.add_volume(window, of, technique, transfer_function=opaque_function(of))
        window.add_actor(mesh)
        place(window, of)
        middle = shot(window)[SIZE[1] // 2, SIZE[0] // 2]
        assert middle[1] > 150, "the volume does not hide the sphere behind it"
        assert middle[2] < 60
        handle.remove()


def test_a_plane_through_the_volume_cuts_the_picture_where_it_lies() -> None:
    of = volume()
    with plotter() as window:
        window.add_mesh(
            pyvista.Plane(center=of.center, direction=(0.2, 1.0, 0.1), i_size=60, j_size=60),
            color="white",
            lighting=False,
        )
        handle = volviz.add_volume(window, of, transfer_function=opaque_function(of))
        place(window, of)
        cut = shot(window)
        handle.update(clip_planes=((of.center, (-0.2, -1.0, -0.1)),))
        window.render()
        clipped = shot(window)
        handle.remove()
    # what lies behind the plane is hidden by it: clipping it away changes nothing
    assert np.abs(cut - clipped).mean() < 1.0
    assert (cut[..., 1] > cut[..., 0] + 40).mean() > 0.01


def test_overlay_text_lies_on_top_of_the_volume() -> None:
    of = volume()
    with plotter() as window:
        handle = volviz.add_volume(window, of, transfer_function=opaque_function(of))
        window.add_text("XXXXXXXX", position=(40, 50), font_size=24, color="red")
        place(window, of)
        image = shot(window)
        handle.remove()
    assert ((image[..., 0] > 200) & (image[..., 1] < 60)).sum() > 200


def test_vtk_draws_the_same_with_an_invisible_volume_and_after_its_removal() -> None:
    of = volume()
    invisible = function(of, [(0.0, (1, 1, 1, 0.0)), (1.0, (1, 1, 1, 0.0))])
    with plotter() as window:
        window.add_mesh(pyvista.Sphere(radius=9.0, center=of.center), color="orange", smooth_shading=True)
        window.add_mesh(pyvista.Cube(center=(30, 5, 5), x_length=9), color="white", opacity=0.5)
        window.add_axes()
        place(window, of)
        without = shot(window)
        handle = volviz.add_volume(window, of, transfer_function=invisible, shading=True)
        place(window, of)
        with_volume = shot(window)
        handle.remove()
        place(window, of)
        after = shot(window)
    assert np.abs(with_volume - without).max() <= 1
    assert np.array_equal(after, without)


def test_two_renderers_of_one_window_show_two_volumes() -> None:
    of = volume()
    with plotter(shape=(1, 2)) as window:
        handles = []
        for column, technique in enumerate(("raycast", "slicing")):
            window.subplot(0, column)
            handles.append(volviz.add_volume(window, of, technique, transfer_function=function(of)))
            place(window, of)
        image = shot(window)
        for handle in handles:
            handle.remove()
    left, right = image[:, : SIZE[0] // 2], image[:, SIZE[0] // 2 :]
    assert left.max() > 50
    assert np.abs(left - right).mean() < 1.0


def test_a_resized_window_shows_the_picture_at_the_new_size() -> None:
    of = volume()
    with plotter() as window:
        handle = volviz.add_volume(window, of, transfer_function=function(of))
        place(window, of)
        shot(window)
        window.window_size = (220, 100)
        window.render()
        resized = shot(window)
        handle.remove()
    exact = volviz.render(
        of, transfer_function=function(of), size=(220, 100), camera=camera(of), background="black"
    )
    assert resized.shape == (100, 220, 3)
    assert np.abs(resized - exact[..., :3]).max() <= 2


def test_an_unchanged_picture_is_not_drawn_again() -> None:
    of = volume()
    with plotter() as window:
        handle = volviz.add_volume(window, of, transfer_function=function(of))
        place(window, of)
        shot(window)
        drawn: list[Any] = []
        handle.on_status.append(drawn.append)
        for _ in range(5):
            window.render()
        assert not drawn
        window.camera.Azimuth(3)
        window.render()
        assert len(drawn) == 1
        handle.remove()


def test_a_moved_mesh_uncovers_the_volume() -> None:
    of = volume()
    eye = np.array(camera(of).position)
    toward = (eye - of.center) / np.linalg.norm(eye - of.center)
    with plotter() as window:
        actor = window.add_mesh(
            pyvista.Sphere(radius=4.0, center=np.array(of.center) + 24 * toward), color="red", lighting=False
        )
        handle = volviz.add_volume(window, of, transfer_function=opaque_function(of))
        place(window, of)
        assert shot(window)[60, 80, 0] > 200
        actor.SetPosition(200, 0, 0)
        window.render()
        moved = shot(window)[60, 80]
        handle.remove()
    assert moved[0] < 60
    assert moved[1] > 100


def test_ambient_occlusion_is_refused_in_words_and_a_lost_pass_is_restored() -> None:
    of = volume()
    with plotter() as window:
        handle = volviz.add_volume(window, of, transfer_function=function(of))
        place(window, of)
        window.renderer.SetPass(None)
        assert shot(window).max() > 50, "the picture has vanished with its pass"
        handle.remove()
    with plotter() as window:
        window.enable_eye_dome_lighting()
        with pytest.raises(RenderError, match="eye-dome lighting"):
            volviz.add_volume(window, of, transfer_function=function(of))


def test_what_stands_for_the_volume_in_vtk_has_its_bounds_and_no_faces_to_shade() -> None:
    of = volume()
    with plotter() as window:
        handle = volviz.add_volume(window, of)
        (actor,) = window.renderer.GetActors()
        mapper = actor.GetMapper()
        mapper.Update()
        assert mapper.GetInput().GetNumberOfPolys() == 0
        np.testing.assert_allclose(actor.GetBounds(), of.bounds, atol=1e-6)
        handle.remove()


def test_bounds_and_camera_reset_see_the_volume() -> None:
    of = volume(spacing=(1.0, 2.0, 3.0), origin=(100.0, 0.0, -50.0))
    with plotter() as window:
        handle = volviz.add_volume(window, of, transfer_function=function(of))
        assert np.allclose(window.renderer.ComputeVisiblePropBounds(), of.bounds, atol=1e-3)
        handle.update(crop=(0, 10, 0, 10, 0, 10))
        assert window.renderer.ComputeVisiblePropBounds()[1] == pytest.approx(110.0, abs=1e-3)
        handle.remove()


def test_unusable_values_change_nothing() -> None:
    of = volume()
    with plotter() as window:
        handle = volviz.add_volume(window, of, transfer_function=function(of))
        before = handle.settings
        for values in ({"step": -1}, {"stepp": 1}, {"technique": "raycasting"}, {"crop": (5, 1, 0, 1, 0, 1)}):
            with pytest.raises(VolvizError):
                handle.update(**values)
        assert handle.settings is before
        handle.remove()


def test_a_window_that_is_closed_first_is_no_trouble() -> None:
    of = volume()
    with plotter() as window:
        handle = volviz.add_volume(window, of, transfer_function=function(of))
        place(window, of)
        shot(window)
    handle.remove()
    handle.remove()


def test_closing_a_plotter_lets_go_of_its_volumes() -> None:
    of = volume()
    with plotter() as window:
        handle = volviz.add_volume(window, of, transfer_function=function(of))
        place(window, of)
        shot(window)
        renderer = window.renderer
        assert list(handles_of(renderer)) == [handle]
    assert not handles_of(renderer)


def test_two_volumes_in_one_window_refine_in_turn_without_mixing() -> None:
    of = volume()
    with plotter(shape=(1, 2)) as window:
        handles = []
        for column, azimuth in enumerate((10.0, 80.0)):
            window.subplot(0, column)
            handles.append(volviz.add_volume(window, of, transfer_function=function(of)))
            apply_camera(window.camera, camera(of, azimuth))
            window.reset_camera_clipping_range()
        shot(window)
        alone = [handle.read_image() for handle in handles]
        for handle in handles:
            handle.invalidate()
        ready = [False, False]
        while not all(ready):
            ready = [handle.refine(budget=0.0) for handle in handles]
        in_turn = [handle.read_image() for handle in handles]
        for handle in handles:
            handle.remove()
    for a, b in zip(alone, in_turn, strict=True):
        assert np.abs(a - b).max() <= 1 / 255


def test_a_relative_function_follows_the_volume() -> None:
    of = volume(np.float32)
    larger = volviz.Volume(of.array * 1000)
    relative = volviz.TransferFunction.from_points(POINTS, domain="relative")
    with plotter() as window:
        handle = volviz.add_volume(window, of, transfer_function=relative)
        handle.update(volume=larger)
        assert handle.transfer_function.points[-1].value == pytest.approx(larger.range[1])
        handle.remove()


def test_a_tiled_export_is_the_large_picture() -> None:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkRenderingCore import vtkWindowToImageFilter

    of = volume()
    with plotter() as window:
        handle = volviz.add_volume(window, of, transfer_function=function(of))
        place(window, of)
        shot(window)
        grab = vtkWindowToImageFilter()
        grab.SetInput(window.render_window)
        grab.SetScale(2)
        grab.ReadFrontBufferOff()
        grab.Update()
        width, height, _ = grab.GetOutput().GetDimensions()
        tiled = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).reshape(height, width, -1)[
            ::-1, :, :3
        ]
        handle.remove()
    exact = volviz.render(
        of, transfer_function=function(of), size=(width, height), camera=camera(of), background="black"
    )
    assert (width, height) == (320, 240)
    assert np.abs(tiled.astype(float) - exact[..., :3]).mean() < 1.0


@pytest.mark.parametrize("first", ["mesh", "volume"])
def test_a_translucent_mesh_is_drawn_on_the_side_of_the_volume_where_it_lies(first: str) -> None:
    of = volume()
    eye = np.array(camera(of).position)
    toward = (eye - of.center) / np.linalg.norm(eye - of.center)
    sphere = pyvista.Sphere(radius=4.0, center=np.array(of.center) + 24 * toward)
    look = {"color": "red", "opacity": 0.5, "lighting": False}
    with plotter() as window:
        if first == "mesh":
            actor = window.add_mesh(sphere, **look)
        handle = volviz.add_volume(window, of, transfer_function=opaque_function(of))
        if first == "volume":
            actor = window.add_mesh(sphere, **look)
        place(window, of)
        in_front = shot(window)[SIZE[1] // 2, SIZE[0] // 2]
        actor.SetPosition(*(-50 * toward))
        window.reset_camera_clipping_range()
        window.render()
        behind = shot(window)[SIZE[1] // 2, SIZE[0] // 2]
        handle.remove()
    assert in_front[0] > 100, "the translucent sphere in front does not tint the volume"
    assert behind[0] < 40, "the translucent sphere behind shines through the opaque volume"
    assert behind[1] > 150


def ball(center: tuple[float, float, float]) -> volviz.Volume:
    """A ball of radius 8 in a lattice of 24 voxels around a point in space."""
    grid = np.arange(24) - 11.5
    z, y, x = np.meshgrid(grid, grid, grid, indexing="ij")
    distance = np.sqrt(x**2 + y**2 + z**2).astype(np.float32)
    return volviz.Volume(-distance, origin=tuple(c - 11.5 for c in center))


@pytest.mark.parametrize("first", [0, 1])
@pytest.mark.parametrize("technique", ["isosurface", "marching_cubes"])
def test_surfaces_of_two_volumes_cut_one_another(technique: str, first: int) -> None:
    """Two balls that overlap across the view: left of the middle the left one is in front, and so on.

    Seen along the line of their centres' bisecting plane, each pixel shows the ball whose surface is nearer.
    """
    places = [(-4.0, 0.0, 1.0), (4.0, 0.0, -1.0)]
    colors = [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
    with plotter() as window:
        for number in (first, 1 - first):
            of = ball(places[number])
            own: dict[str, Any] = (
                {"isovalues": (-8.0,), "colors": (colors[number],)}
                if technique == "isosurface"
                else {"isovalue": -8.0, "color_by": "color", "color": colors[number]}
            )
            volviz.add_volume(window, of, technique, **own)
        window.camera_position = [(0, 0, 60), (0, 0, 0), (0, 1, 0)]
        window.camera.parallel_projection = True
        window.camera.parallel_scale = 12.0
        window.reset_camera_clipping_range()
        image = shot(window)
    rows, columns = np.mgrid[0 : SIZE[1], 0 : SIZE[0]]
    x = (columns + 0.5 - SIZE[0] / 2) * 24.0 / SIZE[1]
    y = -(rows + 0.5 - SIZE[1] / 2) * 24.0 / SIZE[1]
    heights = []
    for cx, cy, cz in places:
        inside = 64.0 - (x - cx) ** 2 - (y - cy) ** 2
        heights.append(np.where(inside > 0, cz + np.sqrt(np.maximum(inside, 0)), -np.inf))
    red, blue = heights
    clear = np.abs(np.where(np.isfinite(red), red, -99) - np.where(np.isfinite(blue), blue, -99)) > 0.3
    seen = np.isfinite(red) | np.isfinite(blue)
    rim = np.abs(np.hypot(x - places[0][0], y) - 8) < 0.5
    rim |= np.abs(np.hypot(x - places[1][0], y) - 8) < 0.5
    judged = clear & seen & ~rim
    assert judged.sum() > 3000
    shows_red = image[..., 0] > image[..., 2]
    assert (shows_red[judged] == (red > blue)[judged]).mean() == 1.0
