"""Surfaces in the colours of given values: alike by our pass and by VTK, and only on the surface of these values."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import volviz
from tests.render import scenes
from tests.render.scenes import LEFT_HANDED, Requests, blobs, psnr
from tests.render.test_marching_interaction import SlowExtraction, complete
from volviz.compare.distance_colors import distance_colors, distance_table
from volviz.compare.distance_map import distance_maps
from volviz.compare.meshes import side_mesh
from volviz.custom_gl.mesh_drawing import technique as mesh_technique
from volviz.custom_gl.vtk.frame_scheduling import FULL
from volviz.custom_gl.vtk_props import mesh_props
from volviz.errors import InputError
from volviz.model.surface_values import SurfaceColors, SurfaceValues

SIZE = (120, 90)
COLORED = [ident for ident, info in volviz.techniques().items() if info.colors_surface]
#: From blue to red, without green.
BLUE_RED = np.stack([np.arange(256), np.zeros(256), np.arange(255, -1, -1)], axis=1).astype(np.uint8)


@pytest.fixture(scope="module")
def ball() -> volviz.Volume:
    """A ball of radius 8 about the middle of 25 x 23 x 21 voxels; its isovalue lies between the samples."""
    z, y, x = np.indices((21, 23, 25)) - np.array([10, 11, 12])[:, None, None, None]
    return volviz.Volume((20 - np.sqrt(x**2 + y**2 + z**2)).astype(np.float32), spacing=(1.0, 1.2, 0.9))


def shown(of: volviz.Volume, technique: str, pacer: Any = None) -> Any:
    """A window that shows a volume, and its handle."""
    own = {"isovalue": 12.03} if technique in COLORED else {}
    return scenes.shown(of, technique, SIZE, pacer=pacer, **own)


def image(window: Any, handle: Any) -> Any:
    window.render()
    handle.raise_error()
    return handle.read_image()


def values_along_x(of: volviz.Volume, technique: str, isovalue: float = 12.03) -> SurfaceValues:
    """The world's x as value."""
    mesh = side_mesh(of, technique, {"isovalue": isovalue})
    assert mesh is not None
    vertices, faces = mesh
    return SurfaceValues(vertices, faces, vertices[:, 0], vertices[faces].mean(axis=1)[:, 0])


def along_x(of: volviz.Volume, technique: str) -> SurfaceColors:
    low, high = of.bounds[:2]
    return SurfaceColors(values_along_x(of, technique), low, high, BLUE_RED)


def redness(pixels: Any) -> Any:
    """Red as a share of red and blue: light takes both alike away."""
    return pixels[:, 0] / (pixels[:, 0] + pixels[:, 2])


def test_the_four_mesh_techniques_take_colours() -> None:
    assert set(COLORED) == {"marching_cubes", "marching_tetrahedra", "vtk_marching_cubes", "vtk_flying_edges"}


@pytest.mark.parametrize("technique", COLORED)
@pytest.mark.parametrize("direction", [np.eye(3), LEFT_HANDED])
def test_the_colour_of_every_pixel_is_that_of_its_place(
    ball: volviz.Volume, technique: str, direction: Any
) -> None:
    of = volviz.Volume(ball.array, spacing=ball.spacing, origin=(40.0, -7.0, 3.0), direction=direction)
    low, high = of.bounds[:2]
    with shown(of, technique) as (window, handle):
        plain = image(window, handle)
        handle.color_surface(along_x(of, technique))
        found = image(window, handle)
        assert np.array_equal(found[..., 3] > 0, plain[..., 3] > 0)
        places = [
            ((row, column), handle.pick(column, row).position[0])
            for row in range(20, 70, 7)
            for column in range(30, 90, 7)
            if found[row, column, 3] == 1 and handle.pick(column, row) is not None
        ]
        handle.color_surface(None)
        assert np.array_equal(image(window, handle), plain)
    assert len(places) > 20
    pixels = np.array([found[place] for place, _ in places])
    expected = np.array([(x - low) / (high - low) for _, x in places])
    assert redness(pixels) == pytest.approx(expected, abs=0.03)


def test_ours_and_vtks_colours_look_alike(ball: volviz.Volume) -> None:
    images = []
    for technique in ("marching_cubes", "vtk_marching_cubes"):
        with shown(ball, technique) as (window, handle):
            handle.color_surface(along_x(ball, technique))
            images.append(image(window, handle))
    assert psnr(*images) > 40


@pytest.mark.parametrize("technique", COLORED)
def test_a_value_at_the_middles_of_triangles_is_seen(ball: volviz.Volume, technique: str) -> None:
    values = values_along_x(ball, technique)
    nothing, ones = np.zeros(len(values.vertices), np.float32), np.ones(len(values.faces), np.float32)
    spots = SurfaceValues(values.vertices, values.faces, nothing, ones)
    with shown(ball, technique) as (window, handle):
        handle.color_surface(SurfaceColors(spots, 0.0, 1.0, BLUE_RED))
        found = image(window, handle)
    share = redness(found[found[..., 3] == 1])
    # linear from 0 at the corners to 1 in the middle: a third over the area
    assert share.mean() == pytest.approx(1 / 3, abs=0.03)
    assert share.max() > 0.8


@pytest.mark.parametrize("technique", COLORED)
def test_colours_end_with_their_surface_and_stay_with_its_look(ball: volviz.Volume, technique: str) -> None:
    colors = along_x(ball, technique)
    with shown(ball, technique) as (window, handle):
        handle.color_surface(colors)
        red = image(window, handle)
        for changes in (
            {"color": (0.0, 1.0, 0.0)},
            {"crop": (2, 20, 0, 22, 0, 20)},
            {"light_position": (9, 9, 99)},
        ):
            handle.update(**changes)
            assert handle.surface_colors is colors
        handle.update(isovalue=12.5)
        assert handle.surface_colors is None
        handle.update(isovalue=12.03, crop=None, headlight=True)
        assert not np.allclose(image(window, handle), red, atol=0.1)
        handle.color_surface(colors)
        assert np.allclose(image(window, handle), red, atol=1e-6)
        handle.update(volume=volviz.Volume(ball.array + np.float32(0.5), spacing=ball.spacing))
        assert handle.surface_colors is None
        handle.update(volume=ball)
        handle.color_surface(colors)
        handle.update(technique="raycast")
        assert handle.surface_colors is None


@pytest.mark.parametrize("technique", ["vtk_marching_cubes", "vtk_flying_edges"])
def test_a_mesh_that_vtk_has_cut_keeps_the_colours_of_its_places(ball: volviz.Volume, technique: str) -> None:
    x, y, z = ball.center
    cuts = {"crop": (3, 21, 2, 20, 2, 18), "clip_planes": (((x, y, z), (0.6, 0.0, 0.8)),)}
    images = []
    for each in ("marching_cubes", technique):
        with shown(ball, each) as (window, handle):
            handle.update(**cuts)
            handle.color_surface(along_x(ball, each))
            images.append(image(window, handle))
    ours, theirs = images
    both = (ours[..., 3] == 1) & (theirs[..., 3] == 1)
    assert both.sum() > 300
    assert np.median(np.abs(ours - theirs)[both]) < 0.01


def test_no_colours_are_seen_while_another_surface_is_extracted(
    ball: volviz.Volume, monkeypatch: pytest.MonkeyPatch
) -> None:
    with shown(ball, "marching_cubes", Requests()) as (window, handle):
        handle.color_surface(along_x(ball, "marching_cubes"))
        complete(window, handle)
        assert np.ptp(window.screenshot(return_img=True)[..., 0]) > 100
        slow = SlowExtraction(monkeypatch)
        handle.update(isovalue=13.0)
        for _ in range(3):
            window.render()
            assert not handle.refine(0.01)
            assert np.ptp(window.screenshot(return_img=True), axis=(0, 1)).max() == 0
        slow.go.set()
        assert complete(window, handle)[..., 1].max() > 0.3


def test_what_draws_no_triangles_refuses_colours(ball: volviz.Volume) -> None:
    colors = along_x(ball, "marching_cubes")
    with shown(ball, "raycast") as (window, handle):
        before = image(window, handle)
        with pytest.raises(InputError, match="raycast draws no mesh"):
            handle.color_surface(colors)
        assert np.array_equal(image(window, handle), before)


@pytest.mark.parametrize("technique", COLORED)
def test_a_stand_in_is_coloured_while_the_camera_turns(
    ball: volviz.Volume, technique: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mesh_technique, "LOD_MESH_TRIANGLES", 600)
    monkeypatch.setattr(mesh_props, "MOVING_TRIANGLES", 600)
    with shown(ball, technique, Requests()) as (window, handle):
        handle.color_surface(along_x(ball, technique))
        full = complete(window, handle)
        handle.begin_interaction()
        handle._cost.observe(FULL, 1.0)
        for _ in range(200):
            window.camera.Azimuth(0.01)
            window.render()
            handle.raise_error()
            if not handle.status.complete and handle.status.waiting in (None, 1.0):
                break
        assert not handle.status.complete
        moving = handle._image.target.color.read()
        width, height = handle._image.target.size
        pixels = np.frombuffer(moving, np.float32).reshape(height, width, 4)
        seen = pixels[pixels[..., 3] == 1]
        assert len(seen) > 15
        assert redness(seen).mean() == pytest.approx(redness(full[full[..., 3] == 1]).mean(), abs=0.05)
        # pure red and blue, lit: the surface's own colour has green
        assert seen[:, 1].max() < 0.01
        handle.end_interaction()
        complete(window, handle)


def test_other_diagonals_show_between_vertices_that_are_the_same(ball: volviz.Volume) -> None:
    meshes = [side_mesh(ball, t, {"isovalue": 12.03}) for t in ("marching_cubes", "vtk_flying_edges")]
    colors = distance_colors(distance_maps(*meshes), ball.spacing)
    assert colors.are_vertices_same
    assert not colors.are_same
    assert 0 < colors.largest < 0.01


def test_equal_surfaces_are_pale_and_said_to_be_the_same(ball: volviz.Volume) -> None:
    meshes = [side_mesh(ball, t, {"isovalue": 12.03}) for t in ("vtk_marching_cubes", "vtk_flying_edges")]
    colors = distance_colors(distance_maps(*meshes), ball.spacing)
    assert colors.are_same
    with shown(ball, "marching_cubes") as (window, handle):
        handle.color_surface(colors.first)
        found = image(window, handle)
    seen = found[found[..., 3] == 1]
    assert np.abs(seen[:, 0] - seen[:, 2]).max() < 0.02


def test_the_top_of_the_colours_is_the_largest_distance_or_the_one_given() -> None:
    of = volviz.Volume(blobs((14, 15, 16), np.float32))
    meshes = [side_mesh(of, t, {"isovalue": 0.53}) for t in ("marching_cubes", "marching_tetrahedra")]
    maps = distance_maps(*meshes)
    colors = distance_colors(maps, of.spacing)
    assert not colors.are_same
    assert colors.limit == colors.largest == max(each.maximum for each in maps)
    assert (colors.first.low, colors.first.high) == (-colors.limit, colors.limit)
    given = distance_colors(distance_maps(*meshes, signed=False), of.spacing, 0.01)
    assert (given.second.low, given.second.high) == (0.0, 0.01)
    assert np.array_equal(given.second.table[0], distance_table(signed=True)[512])
    with pytest.raises(InputError, match="above 0"):
        distance_colors(maps, of.spacing, 0.0)
