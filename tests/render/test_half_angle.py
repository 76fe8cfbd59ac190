"""Half-angle slicing against a shadow ray per sample, and where shadows must fall."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import pyvista

import volviz
from tests.render.scenes import LEFT_HANDED, OBLIQUE, camera, function, image, inside, matrices, psnr, volume
from volviz.custom_gl.offscreen import apply_camera
from volviz.custom_gl.techniques.half_angle.blocks import Visible, block_polygons, grown_box
from volviz.custom_gl.techniques.half_angle.light_path import choose_slicing, light_matrix, rays_from, unit
from volviz.custom_gl.techniques.half_angle.technique import INEXACT, INSIDE
from volviz.kernels.slices import box_distance_range, crop_corners, slab_centres, slice_polygons
from volviz.model.transfer.function import table_size
from volviz.reference.shadows import reference_shadows

if TYPE_CHECKING:
    import numpy.typing as npt

KAPPA = (0.3, 0.6, 1.0)
AMBIENT = 0.2
MAX_ERROR, MEAN_ERROR = 2 / 255, 0.5 / 255

#: Directions to the light, as the camera of `scenes` sees it.
LIGHTS = {
    "front": (-0.6, -1.0, 0.5),
    "beside": (1.0, 0.1, 0.2),
    "behind": (0.3, 1.0, 0.4),
    "above": (0.0, 0.0, 1.0),
}


def light_at(of: volviz.Volume, direction: Any, radii: float = 3.0) -> tuple[float, float, float]:
    """A place in a direction from the centre, in radii of the volume."""
    radius = float(np.linalg.norm(of.extent)) / 2
    x, y, z = np.array(of.center) + radii * radius * np.asarray(direction) / np.linalg.norm(direction)
    return float(x), float(y), float(z)


def ours_and_exact(
    of: volviz.Volume,
    transfer: volviz.TransferFunction,
    view: volviz.Camera,
    light: tuple[float, float, float],
    *,
    size: tuple[int, int] = (64, 64),
    step: float = 0.4,
    kappa: tuple[float, float, float] = KAPPA,
    **values: Any,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Our image and that of the oracle, premultiplied."""
    ours = image(
        of, transfer, view, size=size, technique_id="half_angle", step=step, light_position=light,
        attenuation_color=kappa, ambient=AMBIENT, **values,
    )  # fmt: skip
    view_matrix, projection = matrices(of, view, size)
    entries = table_size(of.range, of.array.dtype.kind in "iu")
    exact = reference_shadows(
        of.array, of.spacing, of.origin, of.direction, table=transfer.bake(of.range, entries),
        value_range=of.range, view=view_matrix, projection=projection, size=size,
        step_world=0.3 * min(of.spacing), light_position=light, kappa=kappa, ambient=AMBIENT,
        crop=values.get("crop"), clip_planes=values.get("clip_planes", ()),
        density_threshold=values.get("density_threshold", 0.0),
    )  # fmt: skip
    assert exact[..., 3].max() > 0.1, "the scene is empty and proves nothing"
    return ours, exact


def assert_like_the_oracle(*scene: Any, **values: Any) -> None:
    ours, exact = ours_and_exact(*scene, **values)
    assert np.abs(ours - exact).max() <= MAX_ERROR
    assert np.abs(ours - exact).mean() <= MEAN_ERROR


def balls(shape: tuple[int, int, int], *centers_radii_values: Any) -> npt.NDArray[np.float32]:
    """Float32 field (Z, Y, X) of balls (centre x, y, z; radius; value) with edges one voxel wide."""
    z, y, x = np.indices(shape).astype(float)
    field = np.zeros(shape)
    for (cx, cy, cz), radius, value in centers_radii_values:
        distance = np.sqrt((x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2)
        field = np.maximum(field, value * np.clip(radius - distance + 0.5, 0, 1))
    return field.astype(np.float32)


# ------------------------------------------------------------ the oracle


@pytest.mark.parametrize("direction", LIGHTS.values(), ids=LIGHTS)
def test_light_from_any_side_draws_what_a_shadow_ray_per_sample_draws(direction: Any) -> None:
    of = volume(spacing=(0.9, 1.1, 1.4))
    assert_like_the_oracle(of, function(of), camera(of), light_at(of, direction))


def test_three_scenes_reach_far_more_than_35_decibels_at_the_default_step() -> None:
    hard = [
        (0.0, (0.2, 0.3, 0.9, 0.0)),
        (0.3, (0.2, 0.5, 0.9, 0.0)),
        (0.35, (0.9, 0.8, 0.7, 0.6)),
        (1.0, (1, 1, 1, 0.9)),
    ]
    field = balls((30, 34, 38), ((12, 15, 8), 6, 1.0), ((24, 18, 20), 7, 0.6), ((28, 8, 15), 5, 0.9))
    three_balls = volviz.Volume(field)
    scenes = [
        (volume(spacing=(0.9, 1.1, 1.4)), None, LIGHTS["front"]),
        (volume(np.float32), hard, LIGHTS["beside"]),
        (three_balls, hard, (2.0, -1.0, 1.0)),
    ]
    for of, points, direction in scenes:
        ours, exact = ours_and_exact(of, function(of, points), camera(of), light_at(of, direction), step=0.5)
        assert psnr(ours, exact) >= 40


@pytest.mark.parametrize("direction", [OBLIQUE, LEFT_HANDED], ids=["oblique", "left-handed"])
def test_direction_and_origin_draw_what_the_oracle_draws(direction: Any) -> None:
    of = volume(spacing=(0.8, 1.0, 1.7), origin=(-200.0, 300.0, 70.0), direction=direction)
    assert_like_the_oracle(of, function(of), camera(of), light_at(of, LIGHTS["front"]))


def test_parallel_projection_draws_what_the_oracle_draws() -> None:
    of = volume()
    assert_like_the_oracle(of, function(of), camera(of, parallel=True), light_at(of, LIGHTS["beside"]))


def test_a_camera_inside_the_volume_draws_what_the_oracle_draws() -> None:
    of = volume()
    assert_like_the_oracle(of, function(of), inside(of), light_at(of, (2, -2, 1)))


def test_a_headlight_draws_what_the_oracle_draws_with_a_light_at_the_eye() -> None:
    of = volume()
    for view in (camera(of), inside(of)):
        assert_like_the_oracle(of, function(of), view, view.position, headlight=True)


def test_crop_box_and_clip_planes_draw_what_the_oracle_draws() -> None:
    of = volume()
    light = light_at(of, LIGHTS["front"])
    assert_like_the_oracle(of, function(of), camera(of), light, crop=(4.5, 25.0, 0.0, 20.25, 3.0, 26.0))
    planes = ((of.center, (1.0, 0.3, 0.2)), (of.center, (0.0, -1.0, 0.4)))
    assert_like_the_oracle(of, function(of), camera(of), light, clip_planes=planes)


def test_a_density_threshold_draws_what_the_oracle_draws() -> None:
    of = volume(np.float32)
    ours, exact = ours_and_exact(
        of, function(of), camera(of), light_at(of, LIGHTS["front"]), step=0.2, density_threshold=0.55
    )
    # the threshold is a jump: a sample that lies on it by rounding counts or does not
    assert np.abs(ours - exact).mean() <= MEAN_ERROR
    assert psnr(ours, exact) >= 35


def test_a_light_close_to_the_box_draws_what_the_oracle_draws() -> None:
    of = volume()
    assert_like_the_oracle(of, function(of), camera(of), light_at(of, (2, -2, 1), radii=1.0))


def test_the_picture_converges_with_the_second_order() -> None:
    of = volume(np.float32)
    smooth = function(of, [(0.0, (1, 1, 1, 0.0)), (1.0, (1, 0.2, 0.1, 0.25))])
    light = light_at(of, LIGHTS["beside"])
    values = {"light_position": light, "technique_id": "half_angle", "light_buffer_size": 256}
    exact = image(of, smooth, camera(of), step=0.1, **values)
    steps = (2.0, 1.0, 0.5)
    errors = [np.abs(image(of, smooth, camera(of), step=step, **values) - exact).mean() for step in steps]
    assert float(np.polyfit(np.log(steps), np.log(errors), 1)[0]) == pytest.approx(2.0, abs=0.3)


def test_a_homogeneous_box_has_beer_lambert_alpha_for_every_ray() -> None:
    of = volviz.Volume(np.full((20, 24, 28), 7, np.uint8), spacing=(1.0, 1.3, 0.8))
    transfer = volviz.TransferFunction.from_points([(0, (1, 1, 1, 0.04)), (9, (1, 1, 1, 0.04))])
    for step in (0.5, 1.7):
        ours, exact = ours_and_exact(of, transfer, camera(of), light_at(of, LIGHTS["front"]), step=step)
        assert np.abs(ours - exact)[..., 3].max() <= 1 / 255


# ------------------------------------------------------------ where shadows fall

WALL = [(0.0, (1, 1, 1, 0.0)), (0.3, (1, 1, 1, 0.0)), (0.35, (1, 1, 1, 0.6)), (1.0, (1, 1, 1, 0.95))]


def ball_before_a_wall() -> volviz.Volume:
    """A ball of radius 4 at (16, 10, 20) and a wall that fills y >= 30."""
    field = balls((40, 34, 40), ((16, 10, 20), 4, 1.0))
    field[:, 30:] = 1.0
    return volviz.Volume(field)


def test_the_shadow_of_a_ball_falls_on_the_wall_where_geometry_says() -> None:
    of = ball_before_a_wall()
    light = np.array([2.0, -40.0, 26.0])
    view = volviz.Camera((20, -200, 20), (20, 30, 20), (0, 0, 1), parallel=True, parallel_scale=20)
    size = (200, 200)
    values = {"size": size, "technique_id": "half_angle", "light_position": tuple(light), "ambient": 0.0}
    lit = image(of, function(of, WALL), view, crop=(0, 39, 28, 33, 0, 39), **values)[..., 0]
    shadowed = image(of, function(of, WALL), view, **values)[..., 0]
    dark = np.where(lit > 0.2, 1 - shadowed / np.maximum(lit, 1e-6), 0.0)
    rows, columns = np.indices(dark.shape)
    # parallel view along +y: columns run along +x, rows along -z
    x, z = (columns + 0.5) / 5, 40 - (rows + 0.5) / 5
    ball = np.array([16.0, 10.0, 20.0])
    beside = np.hypot(x - ball[0], z - ball[2]) > 5.0
    weight = np.where(beside, np.clip(dark, 0, 1), 0.0)
    weight[weight < 0.3] = 0.0
    # the light's rays through the ball's edge, where they meet the wall's face y = 29.7
    t = (29.7 - light[1]) / (ball[1] - light[1])
    hit = light + t * (ball - light)
    assert np.hypot(hit[0] - ball[0], hit[2] - ball[2]) > 4.0, "the shadow would hide behind the ball"
    outside = np.hypot(x - hit[0], z - hit[2]) > 1.25 * t * 4.2
    assert weight.sum() > 100
    assert weight[outside].sum() < 0.02 * weight.sum()
    expected = beside & (np.hypot(x - hit[0], z - hit[2]) < 0.8 * t * 4.0)
    assert dark[expected].mean() > 0.8


def test_balls_of_different_opacity_absorb_differently_and_attenuation_colours_their_shadows() -> None:
    field = balls((40, 34, 60), ((15, 10, 20), 5, 0.6), ((45, 10, 20), 5, 0.9))
    field[:, 30:] = 0.25
    of = volviz.Volume(field)
    points = [
        (0.0, (1, 1, 1, 0.0)), (0.2, (1, 1, 1, 0.5)), (0.3, (1, 1, 1, 0.5)), (0.5, (1, 1, 1, 0.03)),
        (0.75, (1, 1, 1, 0.03)), (0.8, (1, 1, 1, 0.2)), (1.0, (1, 1, 1, 0.2)),
    ]  # fmt: skip
    view = volviz.Camera((30, -200, 20), (30, 30, 20), (0, 0, 1), parallel=True, parallel_scale=20)
    # light from above: the shadows fall below the balls, where the eye sees the wall
    values = {"size": (300, 200), "technique_id": "half_angle", "light_position": (30.0, -60.0, 90.0)}
    ours = image(of, function(of, points), view, attenuation_color=(0.2, 0.6, 1.0), ambient=0.0, **values)
    row = int((40 - 6.0) * 5)
    thin, thick, free = (ours[row, int(x * 5), :3] for x in (12.0, 48.0, 30.0))
    assert np.all(thin < 0.95 * free)
    assert np.all(thick < 0.9 * thin)
    for shadow in (thin, thick):
        weakened = shadow / free
        assert weakened[0] > weakened[1] + 0.02 > weakened[2] + 0.04


def test_matter_tints_the_light_that_passes_through_it() -> None:
    of = ball_before_a_wall()
    red = [(0.0, (1, 0, 0, 0.0)), (0.3, (1, 0, 0, 0.0)), (0.35, (1, 0, 0, 0.3)), (1.0, (1, 0, 0, 0.3))]
    values = {"technique_id": "half_angle", "light_position": (2.0, -40.0, 26.0)}
    values |= {"attenuation_color": (1.0, 1.0, 1.0), "step": 0.25}
    view = camera(of)
    plain = image(of, function(of, red), view, **values)
    tinted = image(of, function(of, red), view, material_tint=1.0, **values)
    unlit = image(of, function(of, red), view, technique_id="raycast", early_termination=1.0, step=0.25)
    # red light passes red matter without loss
    assert np.abs(tinted - unlit)[..., 0].mean() < 1 / 255
    assert tinted[..., 0].mean() > 1.3 * plain[..., 0].mean()


def test_nothing_jumps_where_the_order_of_slices_flips() -> None:
    of = volume()
    view = camera(of)
    forward = np.array(view.direction)
    side = unit(np.cross(forward, view.view_up))
    images = []
    for degrees in (89.9, 90.1):
        angle = np.radians(degrees)
        light = light_at(of, -np.cos(angle) * forward + np.sin(angle) * side)
        values = {"technique_id": "half_angle", "light_position": light, "size": (128, 128)}
        images.append(image(of, function(of), view, **values))
    assert np.abs(images[0] - images[1]).mean() < 0.2 / 255
    assert np.abs(images[0] - images[1]).max() < 3 / 255


def test_scattering_softens_shadows_and_keeps_alpha() -> None:
    of = ball_before_a_wall()
    values = {"technique_id": "half_angle", "light_position": (2.0, -40.0, 26.0), "size": (128, 128)}
    hard, soft = (image(of, function(of, WALL), camera(of), scattering=s, **values) for s in (0.0, 1.0))
    assert np.array_equal(hard[..., 3], soft[..., 3])
    assert np.abs(hard - soft).max() > 0.1
    assert abs(hard[..., :3].mean() - soft[..., :3].mean()) < 0.05


def test_the_classic_blend_shows_another_picture() -> None:
    of = ball_before_a_wall()
    values = {"technique_id": "half_angle", "light_position": (2.0, -40.0, 26.0)}
    values["attenuation_color"] = (0.1, 0.2, 0.3)
    transfer = function(of, WALL)
    ours, classic = (image(of, transfer, camera(of), light_blend=b, **values) for b in ("attenuate", "over"))
    assert np.array_equal(ours[..., 3], classic[..., 3])
    assert np.abs(ours - classic).mean() > 0.01


# ------------------------------------------------------------ machinery


def test_the_light_buffer_is_white_around_the_volume_and_dark_behind_it() -> None:
    of = ball_before_a_wall()
    values = {"technique_id": "half_angle", "light_position": (20.0, -80.0, 20.0), "display": "light_buffer"}
    shown = image(of, function(of, WALL), camera(of), size=(80, 64), attenuation_color=(1, 1, 1), **values)
    square = shown[:, 8:72]
    assert np.array_equal(shown[:, :7, 3], np.zeros((64, 7)))
    assert np.all(square[0, :, :3] == 1.0)
    assert np.all(square[30:34, 30:34, :3] < 0.05)


def test_slices_are_shown_one_after_the_other_from_the_light() -> None:
    of = volume()
    values = {"technique_id": "half_angle", "light_position": light_at(of, LIGHTS["front"]), "slices": 24}
    images = [image(of, function(of), camera(of), slices_shown=n, **values) for n in (6, 12, 18, 24)]
    alphas = [shown[..., 3].mean() for shown in images]
    assert alphas == sorted(set(alphas))
    assert np.array_equal(images[-1], image(of, function(of), camera(of), **values))


def window_with(of: volviz.Volume, view: volviz.Camera, **values: Any) -> tuple[Any, Any]:
    """A plotter of 96 x 96 pixels with a volume in it, and its handle."""
    plotter = pyvista.Plotter(off_screen=True, window_size=(96, 96))
    plotter.render_window.SetMultiSamples(0)
    handle = volviz.add_volume(plotter, of, "half_angle", transfer_function=function(of, WALL), **values)
    apply_camera(plotter.camera, view)
    plotter.reset_camera_clipping_range()
    plotter.show(auto_close=False, interactive=False)
    handle.raise_error()
    return plotter, handle


def test_a_light_inside_the_volume_is_said_in_words_and_drawn_as_a_headlight() -> None:
    of = ball_before_a_wall()
    view = camera(of)
    plotter, handle = window_with(of, view, light_position=of.center)
    try:
        assert handle._runner.technique.notice == INSIDE
        from_inside = handle.read_image()
        handle.update(headlight=True)
        plotter.render()
        handle.raise_error()
        assert handle._runner.technique.notice == ""
        assert np.array_equal(from_inside, handle.read_image())
    finally:
        handle.remove()
        plotter.close()


def test_an_opaque_mesh_hides_what_lies_behind_it() -> None:
    of = ball_before_a_wall()
    view = volviz.Camera((20, -100, 20), (20, 30, 20), (0, 0, 1))
    plotter, handle = window_with(of, view)
    try:
        free = handle.read_image()
        mesh = pyvista.Plane(center=(20, 20, 20), direction=(0, 1, 0), i_size=30, j_size=30)
        plane = plotter.add_mesh(mesh)
        plotter.render()
        handle.raise_error()
        hidden = handle.read_image()
        plotter.remove_actor(plane)
    finally:
        handle.remove()
        plotter.close()
    # before the plane only the ball is left, unchanged; the wall behind it is gone
    middle = slice(44, 52)
    assert free[middle, middle, 3].min() > 0.9
    ball = np.abs(free[..., 3] - hidden[..., 3]) < 1e-3
    assert hidden[50, 44, 3] > 0.5
    assert ball[50, 44]
    assert hidden[40, 55, 3] == 0.0


def test_moving_light_and_camera_compiles_and_uploads_nothing() -> None:
    of = ball_before_a_wall()
    plotter, handle = window_with(of, camera(of))
    try:
        gpu = handle._gpu.gpu
        before = gpu.programs.compiled, gpu.uploads
        for position in (light_at(of, (1, 1, 1)), light_at(of, (-1, -2, 0)), of.center):
            handle.update(light_position=position, attenuation_color=(0.2, 0.3, 0.4), ambient=0.1, slices=40)
            plotter.camera.Azimuth(20)
            plotter.render()
            handle.raise_error()
        assert (gpu.programs.compiled, gpu.uploads) == before
    finally:
        handle.remove()
        plotter.close()


# ------------------------------------------------------------ arithmetic

CORNERS = np.array([[c & 1, c >> 1 & 1, c >> 2 & 1] for c in range(8)], float) * (4.0, 3.0, 2.0)


@pytest.mark.parametrize("seed", range(8))
def test_the_light_sees_the_whole_box_and_fills_its_buffer(seed: int) -> None:
    random = np.random.default_rng(seed)
    direction = unit(random.normal(size=3))
    place = CORNERS.mean(axis=0) + random.uniform(2.8, 30) * direction
    for light in (np.append(place, 1.0), np.append(direction, 0.0)):
        clip = np.c_[CORNERS, np.ones(8)] @ light_matrix(light, CORNERS, 512).T
        assert np.all(clip[:, 3] > 0)
        flat = np.abs(clip[:, :2] / clip[:, 3:]).max(axis=0)
        assert flat == pytest.approx([1 - 4 / 512] * 2)


def test_the_blocks_of_a_slice_tile_it_without_gap_or_overlap() -> None:
    of = volume(spacing=(0.8, 1.0, 1.7), origin=(-20.0, 30.0, 7.0), direction=OBLIQUE)
    random = np.random.default_rng(4)
    box = (0.0, 34.0, 2.5, 31.0, 0.0, 26.0)
    visible = Visible(box, np.ones((4, 4, 5), bool))
    margin = np.array([0.5, 0.6, 0.7])
    for _ in range(10):
        normal = unit(random.normal(size=3))
        low, high = box_distance_range(of.corners, normal)
        distances = slab_centres(low, high, 12)
        vertices, sides, first = block_polygons(of, visible, margin, 16, normal, distances)
        whole = crop_corners(of.index_to_world, grown_box(visible, margin), of.dimensions)
        for s in range(12):
            parts = sum(area(vertices[p, : sides[p]]) for p in range(first[s], first[s + 1]))
            polygon, count = slice_polygons(whole, normal, distances[s : s + 1])
            assert parts == pytest.approx(area(polygon[0, : count[0]]))


def area(polygon: npt.NDArray[np.float64]) -> float:
    """Area of a planar, convex polygon of shape (n, 3); 0 without vertices."""
    if len(polygon) == 0:
        return 0.0
    fans = np.cross(polygon[1:-1] - polygon[0], polygon[2:] - polygon[0])
    return float(np.linalg.norm(fans.sum(axis=0))) / 2


def test_leaving_out_invisible_blocks_changes_nothing() -> None:
    of = volviz.Volume(balls((70, 90, 80), ((20, 25, 15), 8, 1.0), ((60, 70, 55), 9, 0.7)))
    shown = [
        (0.0, (0, 0, 0.4, 1e-5)),
        (0.3, (0.1, 0.3, 1, 1e-5)),
        (0.7, (1, 0.8, 0.1, 0.15)),
        (1.0, (1, 0.2, 0.1, 0.5)),
    ]
    hidden = [(v, (*c[:3], 0.0 if c[3] == 1e-5 else c[3])) for v, c in shown]
    values = {"technique_id": "half_angle", "light_position": light_at(of, (1, -2, 1)), "size": (160, 160)}
    skipping = image(of, function(of, hidden), camera(of), **values)
    drawing = image(of, function(of, shown), camera(of), **values)
    assert skipping[..., 3].max() > 0.5
    # light buffers fitted to different boxes differ a little where shadows have edges
    assert np.abs(skipping - drawing)[..., 3].max() <= 1 / 255
    assert np.abs(skipping - drawing).mean() <= 0.2 / 255


def test_every_ray_of_eye_and_light_meets_the_slices_in_order() -> None:
    random = np.random.default_rng(5)
    center = CORNERS.mean(axis=0)
    for _ in range(100):
        directions = (unit(random.normal(size=3)) for _ in range(2))
        eye, light = (np.append(center + random.uniform(4, 20) * d, 1.0) for d in directions)
        view = unit(center - eye[:3])
        rays = rays_from(eye, CORNERS)
        slicing = choose_slicing(view, light, rays, CORNERS)
        assert slicing.exact, INEXACT
        assert np.all(rays_from(light, CORNERS) @ slicing.half_vector < 0)
        assert np.all((rays @ slicing.half_vector < 0) == slicing.front_to_back)
