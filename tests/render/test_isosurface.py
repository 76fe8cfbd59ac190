"""Ray-cast isosurfaces against the float64 oracle, closed forms and VTK's contours; depth and picking."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

import volviz
from tests.render.scenes import (
    LEFT_HANDED,
    OBLIQUE,
    SIZE,
    Shading,
    camera,
    function,
    inside,
    matrices,
    volume,
)
from volviz.custom_gl.gpu import resources
from volviz.custom_gl.offscreen import apply_camera
from volviz.custom_gl.picking import Sight
from volviz.custom_gl.registry import technique
from volviz.custom_gl.settings import common_settings
from volviz.custom_gl.technique import FrameCamera
from volviz.custom_gl.techniques.isosurface.technique import pick
from volviz.custom_gl.vtk.vtk_imports import pyvista
from volviz.errors import SettingError
from volviz.model.clipping import Clipping
from volviz.model.parameters import make_settings
from volviz.reference.isosurface import SurfaceImage, reference_isosurface
from volviz.reference.surface_pick import pixel_ray

MAX_ERROR, MEAN_ERROR = 2 / 255, 0.5 / 255
COLORS = ((0.8, 0.6, 0.4), (0.2, 0.9, 0.3), (0.3, 0.3, 1.0), (1.0, 0.1, 0.0))


def settings_of(of: volviz.Volume, **values: Any) -> Any:
    """Settings as `image` uses them: the middle of the range unless isovalues are given."""
    given = {"isovalues": (float(np.mean(of.range)),), "colors": COLORS} | values
    info = technique("isosurface")
    return make_settings(
        info.settings, {p.name: given[p.name] for p in info.parameters if p.name in given}, owner=""
    )


def image(of: volviz.Volume, view: volviz.Camera, *, size: Any = SIZE, **values: Any) -> Any:
    """Our image, premultiplied float64, (H, W, 4)."""
    given = {"isovalues": (float(np.mean(of.range)),), "colors": COLORS} | values
    straight = volviz.render(of, "isosurface", size=size, camera=view, dtype="float32", **given).astype(float)
    straight[..., :3] *= straight[..., 3:]
    return straight


def oracle(of: volviz.Volume, view: volviz.Camera, *, size: Any = SIZE, **values: Any) -> SurfaceImage:
    """The oracle's image for the same values; it takes more bisections than a setting allows."""
    bisections = values.get("bisections", 4)
    s = settings_of(of, **(values | {"bisections": min(bisections, 16)}))
    view_matrix, projection = matrices(of, view, size)
    count = len(s.isovalues)
    return reference_isosurface(
        of.array, of.spacing, of.origin, of.direction, isovalues=s.isovalues, colors=s.colors[:count],
        opacities=[s.opacities[min(i, len(s.opacities) - 1)] for i in range(count)],
        view=view_matrix, projection=projection, size=size, step_world=s.step * min(of.spacing),
        bisections=bisections, crop=values.get("crop"), clip_planes=values.get("clip_planes", ()),
        interpolation=s.interpolation,
        shading=Shading(
            s.ambient, s.diffuse, s.specular, s.shininess, values.get("light_position"), (1.0, 1.0, 1.0),
            s.gradient_delta,
        ),
    )  # fmt: skip


def assert_like_the_oracle(of: volviz.Volume, view: volviz.Camera, **values: Any) -> None:
    ours, exact = image(of, view, **values), oracle(of, view, **values).color
    assert (exact[..., 3] > 0).mean() > 0.03, "the scene is empty and proves nothing"
    assert np.abs(ours - exact).max() <= MAX_ERROR
    assert np.abs(ours - exact).mean() <= MEAN_ERROR


def positions(of: volviz.Volume, view: volviz.Camera, **values: Any) -> tuple[Any, Any]:
    """World points (H, W, 3) of the nearest surface, and where there is one."""
    shown = image(of, view, display="positions", **values)
    index = shown[..., :3] * of.dimensions - 0.5
    return index @ of.index_to_world[:3, :3].T + of.index_to_world[:3, 3], shown[..., 3] == 1


def sphere(count: int = 48, radius: float = 15.0, spacing: float = 0.8) -> volviz.Volume:
    """Distance from its middle, negated, float32: the isovalue -r is a sphere of radius r."""
    axis = (np.arange(count) - (count - 1) / 2) * spacing
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    low = -(count - 1) / 2 * spacing
    field = radius - np.sqrt(x**2 + y**2 + z**2)
    return volviz.Volume(field.astype(np.float32), (spacing,) * 3, (low, low, low))


# ---------------------------------------------------------------------- against the oracle


@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.uint16, np.float32])
def test_every_data_type_draws_what_the_oracle_draws(dtype: Any) -> None:
    of = volume(dtype, spacing=(0.9, 1.1, 1.4))
    assert_like_the_oracle(of, camera(of))


@pytest.mark.parametrize("direction", [OBLIQUE, LEFT_HANDED], ids=["oblique", "left-handed"])
@pytest.mark.parametrize("parallel", [False, True], ids=["perspective", "parallel"])
def test_directions_and_projections_draw_what_the_oracle_draws(direction: Any, parallel: bool) -> None:
    of = volume(np.float32, spacing=(0.8, 1.0, 1.7), origin=(-20.0, 30.0, 7.0), direction=direction)
    assert_like_the_oracle(of, camera(of, parallel=parallel))


def test_a_camera_inside_the_surface_sees_what_the_oracle_sees() -> None:
    of = volume(np.float32)
    assert_like_the_oracle(of, inside(of))


@pytest.mark.parametrize(
    "values",
    [
        {"isovalues": (0.3,), "opacities": (0.3,)},
        {"isovalues": (0.3, 0.5, 0.8), "opacities": (0.3, 0.5, 1.0)},
        {"isovalues": (0.8, 0.3, 0.5, 0.6), "opacities": (0.9, 0.3, 0.5, 0.2)},
        {"isovalues": (0.3, 0.8, 0.31, 0.5), "opacities": (0.4,), "step": 3.0},
        {"step": 4.0, "bisections": 0},
        {"step": 0.1, "bisections": 16},
        {"gradient_delta": 0.3},
        {"ambient": 0.1, "diffuse": 0.5, "specular": 1.0, "shininess": 250.0},
        {"light_position": (-40.0, -5.0, 70.0)},
        {"crop": (4.5, 25.0, 0.0, 20.25, 3.0, 26.0)},
    ],
    ids=["translucent", "three", "unsorted", "several in a step", "coarse", "fine", "delta", "material",
         "placed light", "crop"],
)  # fmt: skip
def test_every_setting_draws_what_the_oracle_draws(values: dict[str, Any]) -> None:
    of = volume(np.float32)
    assert_like_the_oracle(of, camera(of), **values)


def test_clip_planes_draw_what_the_oracle_draws() -> None:
    of = volume(np.float32)
    planes = ((of.center, (1.0, 0.3, 0.2)), (of.center, (0.0, -1.0, 0.4)))
    assert_like_the_oracle(of, camera(of), clip_planes=planes, isovalues=(0.3,))


def test_nearest_interpolation_finds_the_faces_of_voxels() -> None:
    of = volume(np.float32)
    exact = oracle(of, camera(of), interpolation="nearest", bisections=16)
    ours, hit = positions(of, camera(of), interpolation="nearest", bisections=16)
    both = hit & (exact.surface >= 0)
    assert (hit != (exact.surface >= 0)).mean() < 0.002
    distance = np.linalg.norm(ours - exact.position, axis=-1)[both]
    # a sample on the border of two voxels may fall on either side
    assert (distance < 0.01).mean() > 0.98


@pytest.mark.parametrize("step", [0.3, 1.0, 7.9])
def test_skipping_empty_bricks_changes_nothing(step: float, monkeypatch: pytest.MonkeyPatch) -> None:
    random = np.random.default_rng(4)
    field = np.zeros((57, 43, 66), np.float32)
    for z, y, x in zip(*(random.integers(0, n, 60) for n in field.shape), strict=True):
        field[z : z + 3, y : y + 2, x : x + 4] = 1.0
    of = volviz.Volume(field, spacing=(1.0, 0.7, 1.2))
    values = {"isovalues": (0.2, 0.6), "opacities": (0.5, 1.0), "step": step}
    skipping = image(of, camera(of), **values)
    monkeypatch.setattr(resources, "occupancy_for_isovalues", lambda low, *_: np.ones(low.shape, bool))
    marching = image(of, camera(of), **values)
    assert (marching[..., 3] > 0).mean() > 0.01
    assert np.abs(skipping - marching).max() < 1e-4


# ---------------------------------------------------------------------- closed forms


@pytest.mark.parametrize("parallel", [False, True], ids=["perspective", "parallel"])
def test_a_sphere_lies_within_a_tenth_of_a_voxel_with_normals_within_a_degree(parallel: bool) -> None:
    of = sphere()
    view = camera(of, parallel=parallel)
    points, hit = positions(of, view, isovalues=(0.0,))
    assert hit.mean() > 0.1
    radius = np.linalg.norm(points, axis=-1)[hit]
    assert np.abs(radius - 15.0).max() < 0.1 * 0.8
    normals = image(of, view, isovalues=(0.0,), display="normals")[..., :3][hit] * 2 - 1
    cosine = (normals * points[hit]).sum(axis=-1) / radius
    assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).max() < 1.0


def test_from_inside_a_sphere_every_ray_meets_its_wall() -> None:
    of = sphere()
    points, hit = positions(of, inside(of), isovalues=(0.0,))
    assert hit.all()
    assert np.abs(np.linalg.norm(points, axis=-1) - 15.0).max() < 0.1 * 0.8


def test_the_position_error_at_least_halves_with_each_bisection() -> None:
    of = volume(np.float32)
    view = camera(of)
    values = {"isovalues": (0.4,), "step": 4.0}
    exact = oracle(of, view, **values, bisections=50)
    hit = exact.surface >= 0
    assert hit.sum() > 200
    errors = []
    for bisections in range(6):
        points, found = positions(of, view, **values, bisections=bisections)
        distance = np.linalg.norm(points - exact.position, axis=-1)[hit & found]
        # point and surface lie in the same halved piece of ray
        assert distance.max() <= 4.0 / 2**bisections + 1e-3
        errors.append(distance.mean())
    for coarse, fine in itertools.pairwise(errors):
        assert fine <= 0.5 * coarse or fine < 1e-4


def test_rising_and_falling_crossings_are_both_seen() -> None:
    # two translucent walls of a slab, seen along its normal
    profile = np.maximum(0.0, 1.0 - np.abs(np.arange(33.0) - 16.0) / 6.0).astype(np.float32)
    of = volviz.Volume(np.broadcast_to(profile, (9, 9, 33)).copy())
    x, y, z = of.center
    view = volviz.Camera((x - 60, y, z), (x, y, z), parallel=True, parallel_scale=2.0)
    alpha = image(of, view, isovalues=(0.5,), opacities=(0.5,))[..., 3]
    assert np.abs(alpha - 0.75).max() < 1e-6


@pytest.mark.parametrize("levels", [(0, 1), (0, 40), (7, 57), (-1000, 3071), (0, 65535)])
def test_a_plateau_at_the_isovalue_is_not_torn(levels: tuple[int, int]) -> None:
    low, high = levels
    grid = np.indices((28, 28, 28)) - 13.5
    ball = (grid**2).sum(axis=0) < 10.0**2
    array = np.where(ball, high, low).astype(np.int32)
    of = volviz.Volume(array)
    points, hit = positions(of, camera(of), isovalues=(float(high),), step=0.3)
    radius = np.linalg.norm(points - np.array(of.center), axis=-1)
    disc = oracle(of, camera(of), isovalues=(high - 1e-4 * (high - low),), step=0.3)
    assert ((disc.surface >= 0) != hit).mean() < 0.003
    assert radius[hit].max() < 10.5
    assert radius[hit].min() > 8.0


@pytest.mark.parametrize("isovalue", [-5.0, 300.0, 1e30, -1e30])
def test_an_isovalue_outside_the_data_is_an_empty_picture(isovalue: float) -> None:
    of = volume()
    assert not image(of, camera(of), isovalues=(isovalue,)).any()


# ---------------------------------------------------------------------- looks


def test_each_isovalue_keeps_its_own_colour_in_whatever_order_they_are_given() -> None:
    of = sphere()
    red, green = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    forward = image(of, camera(of), isovalues=(0.0, 5.0), colors=(red, green), opacities=(0.4, 1.0))
    backward = image(of, camera(of), isovalues=(5.0, 0.0), colors=(green, red), opacities=(1.0, 0.4))
    assert np.abs(forward - backward).max() < 1e-6
    middle = forward[32, 32]
    assert middle[0] > 0.3
    assert middle[1] > 0.5
    assert middle[3] == pytest.approx(1.0, abs=1e-3)


def test_the_automatic_isovalue_lies_between_object_and_surroundings() -> None:
    random = np.random.default_rng(1)
    of = sphere()
    ball = np.where(of.array > 0, 900.0, 100.0) + random.normal(0.0, 30.0, of.array.shape)
    noisy = volviz.Volume(ball.astype(np.int16), of.spacing, of.origin)
    shown = volviz.render(noisy, "isosurface", camera=camera(noisy), size=SIZE)
    middle = image(noisy, camera(noisy), isovalues=(500.0,))
    assert ((shown[..., 3] > 0) != (middle[..., 3] > 0)).mean() < 0.03
    points, hit = positions(noisy, camera(noisy), isovalues=None)
    assert np.abs(np.linalg.norm(points, axis=-1)[hit] - 15.0).max() < 1.5 * 0.8


@pytest.mark.parametrize(
    "array",
    [
        np.full((9, 10, 11), 5, np.uint8),
        np.full((9, 10, 11), np.nan, np.float32),
        np.arange(990, dtype=np.uint16).reshape(9, 10, 11),
        (np.indices((9, 10, 11)).sum(axis=0) == 14).astype(np.uint8),
    ],
    ids=["constant", "no finite value", "ramp", "mask"],
)
def test_strange_data_are_drawn_without_an_error(array: Any) -> None:
    of = volviz.Volume(array)
    assert np.all(np.isfinite(volviz.render(of, "isosurface", size=(32, 24), dtype="float32")))


def test_the_classic_values_draw_a_grey_surface_at_40() -> None:
    of = volume()
    shown = volviz.render(of, "isosurface", classic=True, camera=camera(of), size=SIZE)
    surface = shown[..., 3] > 0
    assert 0.1 < surface.mean() < 0.9
    assert np.all(shown[..., 0] == shown[..., 1])
    assert np.all(shown[..., 1] == shown[..., 2])
    assert (surface == (image(of, camera(of), isovalues=(40.0,), step=1.0)[..., 3] > 0)).all()


def test_the_display_of_samples_shows_that_empty_bricks_cost_nothing() -> None:
    of = sphere(count=96, radius=6.0, spacing=1.0)
    samples = image(of, camera(of), isovalues=(0.0,), display="samples")[..., 0] * 255
    covered = image(of, camera(of), isovalues=(0.0,))[..., 3] > 0
    assert samples[covered].min() >= 1
    # a ray through the whole box would take about 190
    assert samples.mean() < 12


def test_more_than_four_isovalues_or_none_are_refused_in_words() -> None:
    of = volume()
    with pytest.raises(SettingError, match="1 to 4"):
        volviz.render(of, "isosurface", isovalues=(1, 2, 3, 4, 5))
    with pytest.raises(SettingError, match="1 to 4"):
        volviz.render(of, "isosurface", isovalues=())
    with pytest.raises(SettingError, match="at least one"):
        volviz.render(of, "isosurface", colors=())


# ---------------------------------------------------------------------- depth, meshes, VTK, picking


def shown_in_a_window(of: volviz.Volume, view: volviz.Camera, mesh: Any = None, **values: Any) -> Any:
    """Colours (H, W, 3) and window depth (H, W) of VTK's own buffers."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkFloatArray

    window = pyvista.Plotter(off_screen=True, window_size=SIZE)
    window.render_window.SetMultiSamples(0)
    window.set_background("black")
    if mesh is not None:
        window.add_mesh(mesh, color="blue", lighting=False)
    handle = volviz.add_volume(window, of, "isosurface", **values)
    apply_camera(window.camera, view)
    # the same range as without the mesh, so that depths compare
    window.renderer.SetNearClippingPlaneTolerance(0.001)
    window.renderer.ResetCameraClippingRange(*of.bounds)
    color = window.screenshot(return_img=True)[..., :3]
    handle.raise_error()
    buffer = vtkFloatArray()
    window.render_window.GetZbufferData(0, 0, SIZE[0] - 1, SIZE[1] - 1, buffer)
    depth = vtk_to_numpy(buffer).reshape(SIZE[1], SIZE[0])[::-1].copy()
    handle.remove()
    window.close()
    return color, depth


@pytest.mark.parametrize("parallel", [False, True], ids=["perspective", "parallel"])
def test_the_depth_of_the_surface_is_in_vtks_depth_buffer(parallel: bool) -> None:
    of = volume(np.float32, spacing=(0.9, 1.1, 1.4), direction=LEFT_HANDED)
    view = camera(of, parallel=parallel)
    _, depth = shown_in_a_window(of, view, isovalues=(0.4,))
    exact = oracle(of, view, isovalues=(0.4,)).depth
    assert (exact < 1).mean() > 0.05
    assert ((depth < 1) == (exact < 1)).all()
    # 24 bits of depth
    assert np.abs(depth - exact).max() < 1e-5


def test_a_mesh_intersects_the_surface_where_geometry_says() -> None:
    of = sphere()
    view = camera(of)
    normal = np.array([0.3, 1.0, 0.4]) / np.linalg.norm([0.3, 1.0, 0.4])
    mesh = pyvista.Plane(center=(0, 0, 0), direction=normal, i_size=90, j_size=90)
    color, _ = shown_in_a_window(of, view, mesh, isovalues=(0.0,), colors=((1.0, 0.0, 0.0),), ambient=1.0)
    points, hit = positions(of, view, isovalues=(0.0,))
    towards_the_eye = np.sign(np.dot(normal, view.position))
    height = (points @ normal) * towards_the_eye
    # a pixel beside the line of intersection may fall on either side
    clear = hit & (np.abs(height) > 0.3)
    surface = color[..., 0].astype(int) > color[..., 2].astype(int) + 50
    assert (clear & (height > 0)).sum() > 100
    assert (clear & (height < 0)).sum() > 100
    assert np.array_equal(surface[clear], height[clear] > 0)


def test_faint_surfaces_leave_no_depth_and_solid_ones_behind_them_do() -> None:
    of = sphere()
    _, depth = shown_in_a_window(of, camera(of), isovalues=(0.0,), opacities=(0.1,))
    assert np.all(depth == 1)
    _, depth = shown_in_a_window(of, camera(of), isovalues=(0.0, 8.0), opacities=(0.1, 1.0))
    exact = oracle(of, camera(of), isovalues=(8.0,)).depth
    assert ((depth < 1) == (exact < 1)).all()
    assert np.abs(depth - exact).max() < 1e-5


def test_points_lie_on_vtks_contour_of_the_same_value() -> None:
    from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance

    of = volume(np.float32, spacing=(0.9, 1.1, 1.4), origin=(5.0, -2.0, 1.0))
    image = pyvista.ImageData(dimensions=of.dimensions, spacing=of.spacing, origin=of.origin)
    image["values"] = of.array.ravel()
    contour = image.contour([0.4], scalars="values")
    points, hit = positions(of, camera(of), isovalues=(0.4,))
    distance = vtkImplicitPolyDataDistance()
    distance.SetInput(contour)
    error = np.array([distance.EvaluateFunction(p) for p in points[hit]])
    assert len(error) > 200
    # triangles are flat between the edges of the cells, the trilinear surface is not
    assert np.abs(error).max() < 0.1
    assert abs(error.mean()) < 0.01


def test_picking_returns_the_point_and_value_that_are_shown() -> None:
    of = volume(np.int16, spacing=(0.9, 1.1, 1.4), direction=OBLIQUE)
    view = camera(of)
    values = {
        "isovalues": (600.0, 1500.0),
        "opacities": (0.2, 1.0),
        "clip_planes": ((of.center, (0.2, 1.0, 0)),),
    }
    solid = dict(values, isovalues=(1500.0,), opacities=(1.0,))
    points, hit = positions(of, view, bisections=16, **solid)
    matrix, projection = matrices(of, view, SIZE)
    eye = FrameCamera(matrix, projection, np.array(view.position), np.array(view.direction), False)
    faint = image(of, view, **values)[..., 3] > 0
    assert hit.sum() > 40
    checked = 0
    for row in range(0, SIZE[1], 3):
        for column in range(0, SIZE[0], 3):
            ray = pixel_ray(eye.view, eye.projection, SIZE, (column, row))
            crop = Clipping().crop_within(of.dimensions)
            settings = settings_of(of, **values)
            sight = Sight(
                of, function(of), settings, common_settings(settings), ray, crop, values["clip_planes"],
                values["isovalues"],
            )  # fmt: skip
            found = pick(sight)
            if hit[row, column]:
                assert found is not None
                # the faint surface before it is looked through
                assert found.isovalue == 1500.0
                assert np.linalg.norm(np.subtract(found.position, points[row, column])) < 0.01
                assert found.value == pytest.approx(1500.0, abs=1.0)
                index = of.world_to_index[:3, :3] @ found.position + of.world_to_index[:3, 3]
                assert np.allclose(index, found.voxel, atol=0.5 + 1e-6)
                checked += 1
            elif faint[row, column]:
                assert found is not None
                assert found.isovalue == 600.0
            else:
                assert found is None
    assert checked > 5
