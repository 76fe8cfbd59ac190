"""Two-pass ray casting: the image of single-pass ray casting, and what the first pass holds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import volviz
from tests.render.scenes import (
    LEFT_HANDED,
    OBLIQUE,
    SIZE,
    camera,
    function,
    image,
    inside,
    matrices,
    oracle,
    volume,
)
from volviz.custom_gl.offscreen import apply_camera
from volviz.custom_gl.vtk.vtk_imports import pyvista
from volviz.reference.rays import volume_rays

TWO_PASS = "two_pass_raycast"
MODES = ("composite", "maximum", "minimum", "average", "additive", "attenuated_maximum")
RAMP = [(0.0, (0.2, 0.2, 0.6, 0.15)), (0.3, (0.2, 1.0, 0.4, 0.5)), (1.0, (1.0, 0.2, 0.1, 0.9))]
MAX_ERROR, MEAN_ERROR = 2 / 255, 0.5 / 255
BOTH_ORDERS = pytest.mark.parametrize("reverse", [False, True], ids=["exits first", "entries first"])


def assert_like_raycast(of: volviz.Volume, view: volviz.Camera, points: Any = None, **values: Any) -> None:
    transfer = function(of, points)
    two_pass = image(of, transfer, view, technique_id=TWO_PASS, **values)
    values.pop("reverse", None)
    single = image(of, transfer, view, **values)
    assert single[..., 3].max() > 0.1, "the scene is empty and proves nothing"
    assert np.abs(two_pass - single).max() <= MAX_ERROR


def near_a_face(of: volviz.Volume, distance: float) -> volviz.Camera:
    """A camera before the middle of the box's lower x face, behind it for negative distances."""
    face = of.corners[[0, 2, 4, 6]].mean(axis=0)
    outward = (face - np.array(of.center)) / np.linalg.norm(face - np.array(of.center))
    position = tuple(float(c) for c in face + distance * outward)
    return volviz.Camera(position, of.center, tuple(of.direction[:, 2]), view_angle=80.0)


@BOTH_ORDERS
@pytest.mark.parametrize("mode", MODES)
def test_every_mode_is_that_of_ray_casting(mode: str, reverse: bool) -> None:
    of = volume(spacing=(0.9, 1.1, 1.4))
    points = None if mode in ("composite", "additive") else RAMP
    assert_like_raycast(of, camera(of), points, mode=mode, reverse=reverse)


def test_the_oracle_draws_the_same() -> None:
    of = volume(np.int16, spacing=(0.9, 1.1, 1.4))
    ours = image(of, function(of), camera(of), technique_id=TWO_PASS)
    exact = oracle(of, function(of), camera(of), technique_id=TWO_PASS)
    assert np.abs(ours - exact).max() <= MAX_ERROR
    assert np.abs(ours - exact).mean() <= MEAN_ERROR


@BOTH_ORDERS
@pytest.mark.parametrize("direction", [OBLIQUE, LEFT_HANDED], ids=["oblique", "left-handed"])
@pytest.mark.parametrize("parallel", [False, True], ids=["perspective", "parallel"])
def test_directions_and_projections_are_those_of_ray_casting(
    direction: Any, parallel: bool, reverse: bool
) -> None:
    of = volume(spacing=(0.8, 1.0, 1.7), origin=(-20.0, 30.0, 7.0), direction=direction)
    assert_like_raycast(of, camera(of, parallel=parallel), reverse=reverse)


@BOTH_ORDERS
def test_a_camera_inside_sees_what_ray_casting_sees(reverse: bool) -> None:
    of = volume(direction=LEFT_HANDED)
    assert_like_raycast(of, inside(of), RAMP, reverse=reverse)


@BOTH_ORDERS
@pytest.mark.parametrize("distance", [2.0, 0.05, -0.05])
def test_there_is_no_jump_when_the_camera_passes_through_a_face(distance: float, reverse: bool) -> None:
    of = volume(spacing=(0.9, 1.1, 1.4))
    assert_like_raycast(of, near_a_face(of, distance), RAMP, reverse=reverse)


@BOTH_ORDERS
def test_parallel_rays_that_begin_inside_are_those_of_ray_casting(reverse: bool) -> None:
    of = volume()
    view = replace(inside(of), parallel=True, parallel_scale=15.0)
    assert_like_raycast(of, view, RAMP, reverse=reverse)


@BOTH_ORDERS
@pytest.mark.parametrize(
    "values",
    [
        {"shading": True},
        {"gradient_opacity": 0.7},
        {"preintegrated": True, "step": 1.3},
        {"first_sample": 1.0},
        {"jitter": True},
        {"interpolation": "nearest"},
    ],
    ids=lambda values: next(iter(values)),
)
def test_every_way_of_sampling_is_that_of_ray_casting(values: dict[str, Any], reverse: bool) -> None:
    of = volume(np.float32)
    if values.get("interpolation") == "nearest":
        # samples on the border of two voxels may fall on either side
        ours = image(of, function(of), camera(of), technique_id=TWO_PASS, reverse=reverse, **values)
        single = image(of, function(of), camera(of), **values)
        assert np.abs(ours - single).mean() <= 0.1 * MEAN_ERROR
    else:
        assert_like_raycast(of, camera(of), reverse=reverse, **values)


@BOTH_ORDERS
def test_crop_box_and_clip_planes_cut_as_in_ray_casting(reverse: bool) -> None:
    of = volume()
    crop = (4.5, 25.0, 0.0, 20.25, 3.0, 26.0)
    planes = ((of.center, (1.0, 0.3, 0.2)), (of.center, (0.0, -1.0, 0.4)))
    assert_like_raycast(of, camera(of), RAMP, crop=crop, clip_planes=planes, reverse=reverse)
    x, y, z = of.center
    ahead = (((x, y + 3.0, z), (0.2, 1.0, 0.3)),)
    assert_like_raycast(of, inside(of), RAMP, crop=crop, clip_planes=ahead, reverse=reverse)


@BOTH_ORDERS
@pytest.mark.parametrize("parallel", [False, True], ids=["perspective", "parallel"])
def test_an_opaque_mesh_stops_rays_as_in_ray_casting(parallel: bool, reverse: bool) -> None:
    of = volume()
    shots = []
    for technique, values in (("raycast", {}), (TWO_PASS, {"reverse": reverse})):
        window = pyvista.Plotter(off_screen=True, window_size=(120, 100))
        window.render_window.SetMultiSamples(0)
        window.add_mesh(pyvista.Sphere(radius=9.0, center=of.center), color="red")
        handle = volviz.add_volume(window, of, technique, transfer_function=function(of), **values)
        apply_camera(window.camera, camera(of, parallel=parallel))
        window.reset_camera_clipping_range()
        shots.append(window.screenshot(return_img=True).astype(int))
        handle.raise_error()
        handle.remove()
        window.close()
    assert (shots[0][..., 0] > shots[0][..., 2] + 40).mean() > 0.02, "the mesh is not in view"
    assert np.abs(shots[0] - shots[1]).max() <= 2


@pytest.mark.parametrize("step", [0.25, 1.7])
def test_a_homogeneous_box_has_beer_lambert_alpha_for_every_ray(step: float) -> None:
    of = volviz.Volume(np.full((20, 24, 28), 7, np.uint8), spacing=(1.0, 1.3, 0.8))
    transfer = volviz.TransferFunction.from_points([(0, (1, 1, 1, 0.04)), (9, (1, 1, 1, 0.04))])
    values = {"step": step, "early_termination": 1.0, "opacity_unit_distance": 1.0}
    ours = image(of, transfer, camera(of), technique_id=TWO_PASS, **values)[..., 3]
    exact = oracle(of, transfer, camera(of), **values)[..., 3]
    assert exact.max() > 0.5
    # in the pixels along the silhouette the rasteriser decides whether a ray of next to no length is there
    assert np.abs(ours - exact).max() <= 1 / 255


@pytest.mark.parametrize("display", ["entry", "exit"])
@pytest.mark.parametrize("direction", [OBLIQUE, LEFT_HANDED], ids=["oblique", "left-handed"])
@BOTH_ORDERS
def test_the_displays_show_where_rays_enter_and_leave(display: str, direction: Any, reverse: bool) -> None:
    of = volume(spacing=(0.9, 1.1, 1.4), direction=direction)
    shown = image(of, function(of), camera(of), technique_id=TWO_PASS, display=display, reverse=reverse)
    view, projection = matrices(of, camera(of), SIZE)
    rays = volume_rays(of.array.shape, of.index_to_world, view=view, projection=projection, size=SIZE)
    hit = rays.exits > rays.entries
    assert hit.mean() > 0.2
    # along the silhouette the rasteriser decides
    assert ((shown[..., 3] == 1) != hit).mean() < 0.002
    assert np.all(shown[shown[..., 3] != 1] == 0)
    length = rays.entries if display == "entry" else rays.exits
    exact = rays.starts + length[..., np.newaxis] * rays.directions
    # texture coordinates: voxel i has its centre at (i + 0.5) / N
    world = (shown[..., :3] * of.dimensions - 0.5) @ of.index_to_world[:3, :3].T + of.index_to_world[:3, 3]
    inner = hit & (shown[..., 3] == 1)
    assert np.abs(world - exact)[inner].max() < 1e-3


def test_from_inside_the_entry_points_lie_on_the_near_plane() -> None:
    of = volume()
    shown = image(of, function(of), inside(of), technique_id=TWO_PASS, display="entry")
    assert np.all(shown[..., 3] == 1)
    world = (shown[..., :3] * of.dimensions - 0.5) @ of.index_to_world[:3, :3].T + of.index_to_world[:3, 3]
    distance = np.linalg.norm(world - np.array(of.center), axis=-1)
    assert distance.max() < 1.0


def test_half_float_positions_are_coarser_and_nothing_else() -> None:
    of = volume()
    view = camera(of)
    exact = image(of, function(of), view, technique_id=TWO_PASS, display="exit")
    coarse = image(of, function(of), view, technique_id=TWO_PASS, display="exit", half_float=True)
    error = np.abs(exact - coarse).max()
    assert 1e-5 < error <= 1 / 2048
    images = [image(of, function(of), view, technique_id=TWO_PASS, half_float=half) for half in (False, True)]
    assert np.abs(images[0] - images[1]).max() > 0
    assert np.abs(images[0] - images[1]).mean() < MEAN_ERROR


def test_the_first_pass_follows_the_size_of_the_window() -> None:
    of = volume()
    window = pyvista.Plotter(off_screen=True, window_size=SIZE)
    window.render_window.SetMultiSamples(0)
    handle = volviz.add_volume(window, of, TWO_PASS, transfer_function=function(of))
    apply_camera(window.camera, camera(of))
    window.reset_camera_clipping_range()
    window.show(auto_close=False, interactive=False)
    window.window_size = (90, 50)
    window.render()
    handle.raise_error()
    resized = handle.read_image()
    handle.remove()
    window.close()
    exact = image(of, function(of), camera(of), size=(90, 50))
    assert resized.shape == (50, 90, 4)
    assert np.abs(resized - exact).max() <= MAX_ERROR


def test_its_targets_go_when_another_technique_takes_over() -> None:
    of = volume()
    window = pyvista.Plotter(off_screen=True, window_size=SIZE)
    handle = volviz.add_volume(window, of, TWO_PASS, transfer_function=function(of))
    window.show(auto_close=False, interactive=False)
    targets = handle._gpu.gpu.targets._targets
    assert any("two_pass" in purpose for purpose in targets)
    handle.update(technique="raycast")
    window.render()
    assert not any("two_pass" in purpose for purpose in targets)
    handle.remove()
    window.close()


def test_the_classic_look_is_close_to_the_picture_of_today() -> None:
    of = volume()
    today = image(of, function(of), camera(of), technique_id=TWO_PASS)
    classic = image(of, function(of), camera(of), technique_id=TWO_PASS, classic=True)
    assert 0 < np.abs(today - classic).mean() < 4 / 255
