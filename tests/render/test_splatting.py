"""Splatting against a painter in NumPy, closed forms, and where its depth must lie."""

from __future__ import annotations

import dataclasses
import threading
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import pyvista

import volviz
from tests.render.scenes import LEFT_HANDED, OBLIQUE, blobs, camera, function, image, inside, matrices, volume
from volviz.custom_gl.offscreen import apply_camera
from volviz.custom_gl.techniques.splatting import store as store_module
from volviz.custom_gl.techniques.splatting.order import back_to_front
from volviz.custom_gl.techniques.splatting.store import SplatRequest, SplatStore
from volviz.kernels.splats import select_splats
from volviz.tasks import Tasks

if TYPE_CHECKING:
    import numpy.typing as npt

SIZE = (64, 64)
POINTS = [(0.0, (0.1, 0.2, 1.0, 0.3)), (0.5, (0.2, 0.9, 0.3, 0.3)), (1.0, (1.0, 0.3, 0.1, 0.3))]
MATERIAL = {"ambient": 0.25, "diffuse": 0.75, "specular": 0.25, "shininess": 30.0}


def painted(
    of: volviz.Volume,
    view: volviz.Camera,
    *,
    isovalue: float,
    splats_per_axis: int | None = None,
    splat_size: float = 1.5,
    size: tuple[int, int] = SIZE,
    crop: Any = None,
    clip_planes: Any = (),
    light: Any = None,
) -> npt.NDArray[np.float64]:
    """The image of opaque discs, painted one after the other in float64; premultiplied, (H, W, 4)."""
    splats = select_splats(
        of.array, isovalue, spacing=of.spacing, direction=of.direction, splats_per_axis=splats_per_axis,
        cull_interior=False, lowest=of.range[0],
    )  # fmt: skip
    indices = splats.positions.astype(float)
    world = indices @ of.index_to_world[:3, :3].T + of.index_to_world[:3, 3]
    shown = np.ones(len(indices), bool)
    if crop is not None:
        low, high = np.array(crop).reshape(3, 2).T
        shown &= np.all((indices >= low) & (indices <= high), axis=1)
    for origin, normal in clip_planes:
        shown &= (world - np.array(origin)) @ np.array(normal) >= 0
    view_matrix, projection = matrices(of, view, size)
    clip = np.c_[world, np.ones(len(world))] @ (projection @ view_matrix).T
    center = (clip[:, :2] / clip[:, 3:] * 0.5 + 0.5) * size
    depth = clip[:, 2] / clip[:, 3]
    steps = [max(n / splats_per_axis, 1.0) if splats_per_axis else 1.0 for n in of.dimensions]
    diameter = splat_size * max(np.array(steps) * of.spacing)
    radius = np.maximum(0.5 * diameter * projection[1, 1] * size[1] / 2 / clip[:, 3], 0.5)
    transfer = function(of, POINTS)
    low, high = of.range
    table = transfer.bake((low, high), 4096)
    fractions = (splats.values - low) / (high - low) * 4095
    colors = np.stack([np.interp(fractions, np.arange(4096), table[:, c]) for c in range(3)], axis=1)
    eye = np.array(view.position)
    if view.parallel:
        eye = np.array(of.center) - 1e6 * np.array(view.direction)
    to_eye = eye - world
    to_eye /= np.linalg.norm(to_eye, axis=1, keepdims=True)
    to_light = to_eye if light is None else np.array(light) - world
    to_light = to_light / np.linalg.norm(to_light, axis=1, keepdims=True)
    half = to_light + to_eye
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    diffuse = np.abs(np.sum(to_light * splats.normals, axis=1))
    highlight = np.abs(np.sum(half * splats.normals, axis=1)) ** MATERIAL["shininess"]
    lit = colors * (MATERIAL["ambient"] + MATERIAL["diffuse"] * diffuse)[:, None]
    lit += MATERIAL["specular"] * highlight[:, None]
    flat = np.all(splats.normals == 0, axis=1)
    lit[flat] = colors[flat]
    image = np.zeros((size[1], size[0], 4))
    nearest = np.ones((size[1], size[0]))
    rows, columns = np.indices(nearest.shape)
    for n in np.flatnonzero(shown):
        inside_disc = np.hypot(columns + 0.5 - center[n, 0], rows + 0.5 - center[n, 1]) <= max(
            radius[n], 0.75
        )
        square = (np.abs(columns + 0.5 - center[n, 0]) <= radius[n]) & (
            np.abs(rows + 0.5 - center[n, 1]) <= radius[n]
        )
        covered = inside_disc & square & (depth[n] < nearest)
        image[covered] = *lit[n], 1.0
        nearest[covered] = depth[n]
    return image[::-1]


def assert_like_the_painter(of: volviz.Volume, view: volviz.Camera, **values: Any) -> None:
    exact = painted(of, view, **values)
    light = values.pop("light", None)
    if light is not None:
        values["light_position"] = light
    ours = image(of, function(of, POINTS), view, technique_id="splatting", **({"blur_radius": 0.0} | values))
    assert exact[..., 3].mean() > 0.05, "the scene is empty and proves nothing"
    wrong = np.abs(ours - exact).max(axis=-1) > 2 / 255
    # a pixel whose centre lies on the edge of a disc by rounding may fall to either side
    assert wrong.mean() < 0.005
    assert np.abs(ours - exact)[~wrong].mean() <= 0.5 / 255


# ------------------------------------------------------------ opaque discs


@pytest.mark.parametrize("parallel", [False, True], ids=["perspective", "parallel"])
def test_every_voxel_above_the_isovalue_is_painted_as_a_lit_disc(parallel: bool) -> None:
    of = volume(spacing=(0.9, 1.1, 1.4))
    assert_like_the_painter(of, camera(of, parallel=parallel), isovalue=120.0)


def test_a_lattice_is_painted_with_larger_discs() -> None:
    of = volume()
    assert_like_the_painter(of, camera(of), isovalue=100.0, splats_per_axis=12, splat_size=0.8)


@pytest.mark.parametrize("dtype", [np.int16, np.uint16, np.float32])
def test_isovalues_are_in_data_units_of_every_type(dtype: Any) -> None:
    of = volume(dtype)
    low, high = of.range
    assert_like_the_painter(of, camera(of), isovalue=low + 0.45 * (high - low))


@pytest.mark.parametrize("direction", [OBLIQUE, LEFT_HANDED], ids=["oblique", "left-handed"])
def test_direction_and_origin_place_splats_and_normals(direction: Any) -> None:
    of = volume(spacing=(0.8, 1.0, 1.7), origin=(-20.0, 30.0, 7.0), direction=direction)
    x, y, z = of.center
    assert_like_the_painter(of, camera(of), isovalue=120.0, light=(x - 60.0, y - 20.0, z + 50.0))


def blurred(image: npt.NDArray[np.float64], sigma: float) -> npt.NDArray[np.float64]:
    """A Gaussian cut at three standard deviations; what lies beyond the image does not count."""
    taps = np.arange(-int(np.ceil(3 * sigma)), int(np.ceil(3 * sigma)) + 1)
    kernel = np.exp(-(taps**2) / (2 * sigma**2))
    for axis in (0, 1):
        total = np.convolve(np.ones(image.shape[axis]), kernel, "same")
        image = np.apply_along_axis(lambda line, t=total: np.convolve(line, kernel, "same") / t, axis, image)
    return image


@pytest.mark.parametrize("sigma", [0.6, 1.0, 2.82])
def test_the_blur_is_a_separable_gaussian_of_premultiplied_colours(sigma: float) -> None:
    of = volume()
    values = {"isovalue": 120.0, "technique_id": "splatting"}
    sharp = image(of, function(of, POINTS), camera(of), blur_radius=0.0, **values)
    ours = image(of, function(of, POINTS), camera(of), blur_radius=sigma, **values)
    assert 0.05 < sharp[..., 3].mean() < 0.95
    assert np.abs(ours - blurred(sharp, sigma)).max() < 1e-4


def test_the_background_does_not_bleed_into_the_blur() -> None:
    of = volume()
    straight = volviz.render(
        of, "splatting", transfer_function=function(of, [(0, (0.2, 0.6, 0.9, 1)), (1, (0.2, 0.6, 0.9, 1))]),
        size=(96, 96), camera=camera(of), dtype="float32", isovalue=120.0, blur_radius=3.0, shading=False,
    )  # fmt: skip
    edge = (straight[..., 3] > 0.02) & (straight[..., 3] < 0.98)
    assert edge.sum() > 100
    assert np.abs(straight[edge][:, :3] - (0.2, 0.6, 0.9)).max() < 1e-3


def test_crop_box_and_clip_planes_lay_bare_what_was_hidden() -> None:
    of = volume()
    assert_like_the_painter(of, camera(of), isovalue=100.0, crop=(4.5, 20.0, 0.0, 20.25, 3.0, 26.0))
    planes = ((of.center, (0.0, 1.0, 0.2)),)
    assert_like_the_painter(of, camera(of), isovalue=60.0, clip_planes=planes)


def test_the_classic_splats_are_light_red() -> None:
    of = volume()
    ours = image(of, function(of), camera(of), technique_id="splatting", classic=True, size=(96, 96))
    solid = ours[ours[..., 3] > 0.99]
    assert len(solid) > 100
    red, green, blue = solid[:, :3].mean(axis=0)
    assert red > green + 0.02
    assert green == pytest.approx(blue, abs=1e-6)


def test_the_display_of_splats_leaves_the_blur_out() -> None:
    of = volume()
    values = {"technique_id": "splatting", "isovalue": 120.0}
    shown = image(of, function(of), camera(of), display="splats", blur_radius=3.0, **values)
    sharp = image(of, function(of), camera(of), blur_radius=0.0, **values)
    assert np.array_equal(shown, sharp)


def test_an_isovalue_above_everything_draws_nothing() -> None:
    of = volume()
    assert not image(of, function(of), camera(of), technique_id="splatting", isovalue=255.0).any()


# ------------------------------------------------------------ Gaussians


def homogeneous(edge: int = 26, **geometry: Any) -> volviz.Volume:
    """A cube that holds one value, and so has one opacity."""
    return volviz.Volume(np.full((edge, edge, edge), 200, np.uint8), **geometry)


@pytest.mark.parametrize("splat_size", [1.5, 2.5])
@pytest.mark.parametrize("splats_per_axis", [None, 13])
def test_gaussians_of_a_homogeneous_cube_add_up_to_beer_lambert(
    splat_size: float, splats_per_axis: int | None
) -> None:
    of = homogeneous(spacing=(0.8, 0.8, 0.8))
    opacity = 0.05
    transfer = volviz.TransferFunction.from_points([(0, (1, 1, 1, opacity)), (255, (1, 1, 1, opacity))])
    x, y, z = of.center
    view = volviz.Camera((x, y - 100, z), of.center, (0, 0, 1), parallel=True, parallel_scale=5.0)
    ours = image(
        of, transfer, view, technique_id="splatting", footprint="gaussian", isovalue=100.0, shading=False,
        opacity_unit_distance=1.0, splat_size=splat_size, splats_per_axis=splats_per_axis,
    )  # fmt: skip
    # splats stand for whole voxels: 26 of them, not the 25 between their centres
    exact = 1 - (1 - opacity) ** (26 * 0.8)
    # the footprint is cut at 2.5 sigma, where 4.4 per cent of it are left
    assert ours[..., 3].mean() == pytest.approx(exact, abs=0.025)
    assert ours[..., 3].std() < 0.05
    assert np.allclose(ours[..., :3], ours[..., 3:], atol=1e-5)


def test_nearer_gaussians_are_painted_over_farther_ones_from_every_side() -> None:
    field = np.zeros((21, 21, 21), np.uint8)
    field[:, :, 4:8], field[:, :, 13:17] = 100, 200
    of = volviz.Volume(field)
    points = [
        (0, (0, 0, 0, 0)), (50, (0, 0, 0, 0)), (90, (1, 0, 0, 0.8)), (140, (1, 0, 0, 0.8)),
        (150, (0, 1, 0, 0.8)), (255, (0, 1, 0, 0.8)),
    ]  # fmt: skip
    transfer = volviz.TransferFunction.from_points(points)
    for parallel in (False, True):
        for sign, front in ((-1, 0), (1, 1)):
            view = volviz.Camera((10 + sign * 80, 14, 7), (10, 10, 10), (0, 0, 1), parallel=parallel)
            middle = image(
                of,
                transfer,
                view,
                technique_id="splatting",
                footprint="gaussian",
                isovalue=60.0,
                shading=False,
            )[28:36, 28:36]
            assert middle[..., front].min() > 0.9
            assert middle[..., 1 - front].max() < 0.1


def test_gaussians_look_like_the_ray_caster_on_smooth_data() -> None:
    of = volume(np.float32)
    points = [(0.0, (0.1, 0.3, 1.0, 0.0)), (0.2, (0.1, 0.3, 1.0, 0.0)), (1.0, (1.0, 0.4, 0.1, 0.15))]
    view = camera(of)
    splatted = image(
        of,
        function(of, points),
        view,
        technique_id="splatting",
        footprint="gaussian",
        isovalue=0.2,
        shading=False,
    )
    cast = image(of, function(of, points), view, early_termination=1.0)
    assert np.abs(splatted - cast).mean() < 3 / 255


def test_gaussians_are_ordered_by_their_distance_from_the_eye() -> None:
    random = np.random.default_rng(2)
    of = volume(spacing=(0.5, 1.0, 2.0), origin=(1e4, 2e4, -3e4), direction=OBLIQUE)
    indices = np.stack(np.meshgrid(*[np.arange(n) for n in of.dimensions]), axis=-1).reshape(-1, 3)
    indices = indices.astype(np.float32)
    world = indices @ of.index_to_world[:3, :3].T + of.index_to_world[:3, 3]
    for _ in range(5):
        x, y, z = random.uniform(-40, 40, 3) + of.center
        order = back_to_front(indices, (x, y, z, 1.0), of.index_to_world)
        distances = np.linalg.norm(world - (x, y, z), axis=1)[order]
        assert np.diff(distances).max() < 2e-3
        x, y, z = random.normal(size=3)
        order = back_to_front(indices, (x, y, z, 0.0), of.index_to_world)
        assert np.diff(world[order] @ (x, y, z)).min() > -4e-3
        assert sorted(order) == list(range(len(indices)))


# ------------------------------------------------------------ in a window


def window_with(of: volviz.Volume, view: volviz.Camera, **values: Any) -> tuple[Any, Any]:
    """A plotter of 96 x 96 pixels with a volume in it, and its handle."""
    plotter = pyvista.Plotter(off_screen=True, window_size=(96, 96))
    plotter.render_window.SetMultiSamples(0)
    handle = volviz.add_volume(plotter, of, "splatting", transfer_function=function(of, POINTS), **values)
    apply_camera(plotter.camera, view)
    plotter.reset_camera_clipping_range()
    plotter.show(auto_close=False, interactive=False)
    handle.raise_error()
    return plotter, handle


def test_quads_draw_the_same_picture_as_points() -> None:
    of = volume()
    for footprint in ("disc", "gaussian"):
        view = camera(of, view_angle=45.0)
        plotter, handle = window_with(of, view, isovalue=120.0, footprint=footprint)
        try:
            gpu = handle._gpu.gpu
            points = handle.read_image()
            assert not handle._runner.technique._layout.quads
            gpu.limits = dataclasses.replace(gpu.limits, max_point_size=1.0)
            handle.invalidate()
            plotter.render()
            handle.raise_error()
            assert handle._runner.technique._layout.quads
            quads = handle.read_image()
        finally:
            handle.remove()
            plotter.close()
        assert np.abs(points - quads).mean() < 0.3 / 255


def test_splats_whose_centre_is_outside_the_window_do_not_vanish() -> None:
    of = volume()
    whole = camera(of)
    values = {"technique_id": "splatting", "isovalue": 90.0, "blur_radius": 0.0, "splats_per_axis": 9}
    large = image(of, function(of), whole, size=(192, 192), **values)
    near = dataclasses.replace(whole, view_angle=float(np.degrees(2 * np.arctan(np.tan(np.radians(15)) / 3))))
    middle = image(of, function(of), near, size=(64, 64), **values)
    difference = np.abs(large[64:128, 64:128] - middle).max(axis=-1)
    assert (difference > 2 / 255).mean() < 0.01


def test_a_camera_among_the_splats_sees_them_in_every_direction() -> None:
    of = volviz.Volume(255 - blobs((30, 30, 30)))
    ours = image(of, function(of), inside(of), technique_id="splatting", isovalue=200.0)
    assert ours[..., 3].mean() > 0.9


def test_splats_and_opaque_meshes_hide_one_another() -> None:
    z, y, x = np.indices((31, 31, 31))
    ball = np.clip(12 - np.sqrt((x - 15) ** 2 + (y - 15) ** 2 + (z - 15) ** 2) + 0.5, 0, 1)
    of = volviz.Volume(ball.astype(np.float32))
    view = volviz.Camera((15, -70, 15), (15, 15, 15), (0, 0, 1))
    for footprint in ("disc", "gaussian"):
        plotter, handle = window_with(of, view, isovalue=0.5, footprint=footprint, opacity_unit_distance=6.0)
        try:
            mesh = pyvista.Plane(center=(15, 15, 15), direction=(0, 1, 0), i_size=60, j_size=60)
            before = handle.read_image()
            actor = plotter.add_mesh(mesh.translate((0, 2, 0)), color="red", lighting=False)
            plotter.render()
            handle.raise_error()
            # the plane cuts the ball behind its front: discs hide it, Gaussians do not
            through_the_middle = handle.read_image()
            plotter.remove_actor(actor, render=False)
            actor = plotter.add_mesh(mesh.translate((0, -14, 0)), color="red", lighting=False)
            plotter.render()
            handle.raise_error()
            hidden = handle.read_image()
            plotter.remove_actor(actor, render=False)
        finally:
            handle.remove()
            plotter.close()
        assert before[48, 48, 3] > 0.5
        assert hidden[48, 48, 3] == 0.0
        if footprint == "disc":
            assert np.array_equal(before[40:56, 40:56], through_the_middle[40:56, 40:56])
        else:
            assert 0.2 < through_the_middle[48, 48, 3] < before[48, 48, 3] - 0.05


def test_the_depth_of_splats_is_written_for_others() -> None:
    z, y, x = np.indices((31, 31, 31))
    ball = np.clip(12 - np.sqrt((x - 15) ** 2 + (y - 15) ** 2 + (z - 15) ** 2) + 0.5, 0, 1)
    of = volviz.Volume(ball.astype(np.float32))
    view = volviz.Camera((15, -70, 15), (15, 15, 15), (0, 0, 1))
    plotter, handle = window_with(of, view, isovalue=0.5)
    try:
        target = handle._image.target
        plotter.render_window.MakeCurrent()
        with handle._gpu.foreign():
            depth = np.frombuffer(target.depth.read(), np.float32).reshape(96, 96)
        middle = depth[48, 48]
        clip = matrices(of, view, (96, 96))
        # the nearest splat lies at y = 3 or 4
        expected = [(clip[1] @ clip[0] @ np.array([15, y_front, 15, 1.0]))[2:] for y_front in (3.0, 4.0)]
        low, high = (0.5 * z_clip / w_clip + 0.5 for z_clip, w_clip in expected)
        assert low - 1e-4 <= middle <= high + 1e-4
        assert depth[2, 2] == 1.0
    finally:
        handle.remove()
        plotter.close()


def test_cheap_settings_and_camera_moves_compile_and_upload_nothing() -> None:
    of = volume()
    plotter, handle = window_with(of, camera(of), isovalue=120.0)
    try:
        gpu = handle._gpu.gpu
        before = gpu.programs.compiled, gpu.uploads
        for step in range(3):
            handle.update(
                splat_size=1.0 + 0.1 * step, blur_radius=0.5 * step, ambient=0.1 * step, splat_color="classic"
            )
            plotter.camera.Azimuth(20)
            plotter.render()
            handle.raise_error()
        assert (gpu.programs.compiled, gpu.uploads) == before
    finally:
        handle.remove()
        plotter.close()


# ------------------------------------------------------------ off the thread of the window


def test_a_moving_picture_does_not_wait_for_a_new_selection(monkeypatch: pytest.MonkeyPatch) -> None:
    of, tasks = volume(), Tasks()
    first, second = (SplatRequest(of, isovalue, None, True, None) for isovalue in (100.0, 150.0))
    store = SplatStore("splats")
    assert store.get(tasks, first, may_follow=True) is None
    assert tasks.wait(20)
    old = store.get(tasks, first, may_follow=True)
    assert old is not None
    assert old.request is first
    may_go_on = threading.Event()
    select = store_module.pack

    def slow(request: SplatRequest) -> Any:
        assert may_go_on.wait(10)
        return select(request)

    monkeypatch.setattr(store_module, "pack", slow)
    assert store.get(tasks, second, may_follow=True) is old
    assert store.get(tasks, second, may_follow=False) is None
    may_go_on.set()
    assert tasks.wait(20)
    new = store.get(tasks, second, may_follow=True)
    assert new.request.isovalue == 150.0
    assert 0 < len(new.packed) < len(old.packed)
    store.clear()


def test_what_goes_wrong_in_the_background_is_raised_where_it_is_asked_for() -> None:
    tasks, store = Tasks(), SplatStore("splats")
    wrong = SplatRequest(volume(), float("nan"), None, True, None)
    store.get(tasks, wrong, may_follow=True)
    assert tasks.wait(20)
    with pytest.raises(volviz.VolvizError, match="isovalue"):
        store.get(tasks, wrong, may_follow=True)


def test_another_volume_is_waited_for() -> None:
    tasks, store = Tasks(), SplatStore("splats")
    request = (
        SplatRequest(volume(), 100.0, None, True, None),
        SplatRequest(volume(np.float32), 0.5, None, True, None),
    )
    for each in request:
        assert store.get(tasks, each, may_follow=True) is None
        assert tasks.wait(20)
        assert store.get(tasks, each, may_follow=True).request.volume is each.volume
