"""Bump mapping against the float64 oracle, the arithmetic of colours, closed forms and itself turned round."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkPolyDataTangents

import volviz
from tests.render.scenes import LEFT_HANDED, OBLIQUE, SIZE, blobs, camera, function, inside, matrices, volume
from volviz.custom_gl.offscreen import apply_camera
from volviz.custom_gl.techniques.bump_mapping.maps import pattern_normals
from volviz.custom_gl.techniques.bump_mapping.technique import RELIEF_VOXELS, bands
from volviz.custom_gl.vtk.vtk_imports import pyvista
from volviz.errors import LoadError, SettingError
from volviz.kernels.normal_maps import encoded
from volviz.kernels.tangents import vertex_tangents
from volviz.model.cut_plane import default_cut_plane
from volviz.model.transfer.function import table_size
from volviz.reference.isosurface import reference_isosurface
from volviz.reference.relief import Relief, reference_relief

MAX_ERROR, MEAN_ERROR = 2 / 255, 0.5 / 255
LEVEL = 1 / 255
#: Opacity of the transfer function from which on the surface is opaque, as in relief.frag.
SHOWN = 0.005

#: Shown everywhere, in colours that differ everywhere.
OPAQUE = [(0.0, (0.2, 0.3, 0.9, 0.2)), (0.5, (0.9, 0.9, 0.3, 0.5)), (1.0, (1.0, 0.3, 0.2, 1.0))]


def image(of: volviz.Volume, view: volviz.Camera, points: Any = OPAQUE, **values: Any) -> Any:
    """Our image, premultiplied float64, (H, W, 4)."""
    straight = volviz.render(
        of, "bump_mapping", transfer_function=function(of, points), size=values.pop("size", SIZE), camera=view,
        dtype="float32", **values,
    ).astype(np.float64)  # fmt: skip
    straight[..., :3] *= straight[..., 3:]
    return straight


def oracle(of: volviz.Volume, view: volviz.Camera, points: Any = OPAQUE, **values: Any) -> tuple[Any, Any]:
    """Colour and depth of the oracle for the same values."""
    strength = values.get("bump_strength", 1.0)
    default_origin, default_normal = default_cut_plane(of.corners)
    view_matrix, projection = matrices(of, view, SIZE)
    return reference_relief(
        of.array, of.spacing, of.origin, of.direction,
        plane=(values.get("plane_origin", default_origin), values.get("plane_normal", default_normal)),
        relief=Relief(
            strength * RELIEF_VOXELS * of.mean_spacing, values.get("ambient", 0.15), values.get("diffuse", 0.85),
            values.get("light_position"), values.get("light_color", (1.0, 1.0, 1.0)),
            values.get("gradient_delta", 1.0), SHOWN,
        ),
        table=function(of, points).bake(of.range, table_size(of.range, of.array.dtype.kind in "iu")),
        value_range=of.range, view=view_matrix, projection=projection, size=SIZE, crop=values.get("crop"),
        clip_planes=values.get("clip_planes", ()),
    )  # fmt: skip


def assert_like_the_oracle(
    of: volviz.Volume, view: volviz.Camera, points: Any = OPAQUE, **values: Any
) -> None:
    ours, (exact, _) = image(of, view, points, **values), oracle(of, view, points, **values)
    assert (exact[..., 3] > 0).mean() > 0.03, "the scene is empty and proves nothing"
    error = np.abs(ours - exact).max(axis=-1)
    # on the rim of the polygon the rasteriser decides, to a 256th of a pixel
    rim = (ours[..., 3] > 0) != (exact[..., 3] > 0)
    assert rim.sum() <= 2
    assert error[~rim].max() <= MAX_ERROR
    assert error[~rim].mean() <= MEAN_ERROR


def far_light(of: volviz.Volume) -> tuple[float, float, float]:
    """A place for the light to the upper left in front, off all axes."""
    x, y, z = of.center
    return x - 40.0, y - 60.0, z + 55.0


# ------------------------------------------------------------------------------------------------ the oracle


@pytest.mark.parametrize(
    "geometry",
    [
        {},
        {"spacing": (0.7, 1.3, 2.1)},
        {"spacing": (1.0, 1.2, 0.8), "direction": OBLIQUE, "origin": (-300.0, 40.0, 7.0)},
        {"spacing": (1.0, 1.2, 1.8), "direction": LEFT_HANDED},
        {"direction": [[1.0, 0.0, 0.0], [0.0, 1.0, np.sin(0.1)], [0.0, 0.0, np.cos(0.1)]]},
    ],
    ids=["plain", "anisotropic", "oblique", "left-handed", "sheared"],
)
def test_the_cut_is_that_of_the_oracle_in_every_geometry(geometry: dict[str, Any]) -> None:
    of = volume(**geometry)
    assert_like_the_oracle(of, camera(of), light_position=far_light(of))


@pytest.mark.parametrize("dtype", [np.int16, np.uint16, np.float32])
def test_every_kind_of_scalar_gives_the_same_relief(dtype: Any) -> None:
    of = volume(dtype)
    assert_like_the_oracle(of, camera(of), light_position=far_light(of))


@pytest.mark.parametrize("normalization", ["cube_map", "shader"])
@pytest.mark.parametrize("strength", [-2.0, 0.0, 3.0])
def test_heights_hollows_and_smooth_cuts(strength: float, normalization: str) -> None:
    of = volume()
    assert_like_the_oracle(
        of, camera(of), light_position=far_light(of), bump_strength=strength, normalization=normalization,
        ambient=0.05, diffuse=0.9, gradient_delta=2.0, light_color=(1.0, 0.8, 0.6),
    )  # fmt: skip


def test_a_headlight_lights_a_cut_that_is_seen_from_either_side() -> None:
    of = volume()
    for azimuth in (25.0, 205.0):
        assert_like_the_oracle(of, camera(of, azimuth), headlight=True)


def test_a_plane_of_any_orientation_through_any_point() -> None:
    of = volume(spacing=(1.0, 1.2, 0.8))
    for seed in range(4):
        random = np.random.default_rng(seed)
        origin = tuple(np.add(of.center, random.uniform(-4, 4, 3)))
        normal = tuple(random.normal(size=3))
        assert_like_the_oracle(
            of,
            camera(of, 90.0 * seed),
            plane_origin=origin,
            plane_normal=normal,
            light_position=far_light(of),
        )


def test_parallel_projection_and_a_camera_close_to_the_cut() -> None:
    of = volume()
    assert_like_the_oracle(of, camera(of, parallel=True), headlight=True)
    assert_like_the_oracle(of, camera(of, parallel=True), light_position=far_light(of))
    x, y, z = of.center
    near = volviz.Camera((x + 4.0, y - 6.0, z + 3.0), (x, y, z), (0.0, 0.0, 1.0), view_angle=60.0)
    assert_like_the_oracle(of, near, light_position=far_light(of))


def test_crop_box_clip_planes_and_transparent_places_cut_the_surface() -> None:
    of = volume()
    cut = {"crop": (4.0, 30.5, 2.0, 27.0, 5.0, 24.0), "clip_planes": [(of.center, (0.3, 0.2, 1.0))]}
    plane = {"plane_origin": of.center, "plane_normal": (0.2, -1.0, 0.3)}
    assert_like_the_oracle(of, camera(of), light_position=far_light(of), **cut, **plane)
    points = [(0.0, (0.1, 0.3, 1.0, 0.0)), (0.3, (0.2, 1.0, 0.4, 0.0)), (1.0, (1.0, 0.2, 0.1, 0.02))]
    assert_like_the_oracle(of, camera(of), points, light_position=far_light(of))
    shown = image(of, camera(of), points, cut_out=True)[..., 3]
    solid = image(of, camera(of), points, cut_out=False)[..., 3]
    assert set(np.unique(solid)) == {0.0, 1.0}
    assert 0.1 < (shown > 0).sum() / (solid > 0).sum() < 0.9


def test_a_density_threshold_leaves_out_what_lies_below() -> None:
    of = volume(np.float32)
    low, high = of.range
    value = image(of, camera(of), [(0.0, (0, 0, 0, 1)), (1.0, (1, 1, 1, 1))], display="color")
    kept = image(of, camera(of), [(0.0, (0, 0, 0, 1)), (1.0, (1, 1, 1, 1))], density_threshold=0.4)
    assert high > low
    clear = np.abs(value[..., 0] - 0.4) > 0.002
    assert np.array_equal((kept[..., 3] > 0)[clear], (value[..., 0] > 0.4)[clear])


def test_constant_data_give_a_smooth_surface() -> None:
    of = volviz.Volume(np.full((8, 9, 10), 3.0, np.float32))
    drawn = image(of, camera(of), ambient=0.0, diffuse=1.0, display="normals")
    seen = drawn[..., 3] > 0
    assert seen.mean() > 0.1
    assert np.allclose(drawn[seen], (0.5, 0.5, 1.0, 1.0), atol=1e-6)


# ------------------------------------------------------------------------------------------------ DOT3


def debug_views(of: volviz.Volume, *names: str, **values: Any) -> list[npt.NDArray[np.float64]]:
    """Images of several displays where the surface is seen, (pixels, 3) each."""
    drawn = [image(of, camera(of), cut_out=False, display=name, **values) for name in names]
    seen = drawn[0][..., 3] > 0
    return [part[seen][:, :3] for part in drawn]


@pytest.mark.parametrize("normalization", ["cube_map", "shader"])
@pytest.mark.parametrize("source", ["data", "bricks", "bumps"])
def test_dot3_is_the_product_of_the_encoded_colours(source: str, normalization: str) -> None:
    of = volume()
    values = {"normal_source": source, "normalization": normalization, "light_position": far_light(of)}
    n, light, product = debug_views(of, "normals", "light", "diffuse", encoding="bytes", **values)
    for colors in (n, light):
        assert np.abs(colors * 255 - np.rint(colors * 255)).max() < 1e-3, "colours are not bytes"
    expected = np.clip(4 * np.sum((n - 0.5) * (light - 0.5), axis=1), 0, 1)
    assert np.abs(product[:, 0] - expected).max() <= LEVEL
    exact = debug_views(of, "diffuse", encoding="float", **(values | {"normalization": "shader"}))[0][:, 0]
    assert np.abs(product[:, 0] - exact).max() <= 4 * LEVEL
    assert np.abs(product[:, 0] - exact).mean() <= LEVEL


@pytest.mark.parametrize("normalization", ["cube_map", "shader"])
def test_the_classic_encoding_is_decoded_its_own_way(normalization: str) -> None:
    of = volume()
    values = {"normal_source": "bricks", "normalization": normalization, "light_position": far_light(of)}
    n, light, product = debug_views(of, "normals", "light", "diffuse", encoding="bytes_classic", **values)
    decoded = [(255 * colors - 128) / 127 for colors in (n, light)]
    assert np.abs(product[:, 0] - np.clip(np.sum(decoded[0] * decoded[1], axis=1), 0, 1)).max() <= 1e-4
    exact = debug_views(of, "diffuse", encoding="float", **(values | {"normalization": "shader"}))[0][:, 0]
    assert np.abs(product[:, 0] - exact).max() <= 4 * LEVEL


def test_a_smooth_surface_has_the_well_known_blue_as_normal_map() -> None:
    of = volume()
    n = debug_views(of, "normals", encoding="bytes", bump_strength=0.0)[0]
    assert np.allclose(n * 255, (128, 128, 255), atol=1e-3)


def test_the_picture_is_colour_times_light() -> None:
    of = volume()
    values = {"light_position": far_light(of), "ambient": 0.0, "diffuse": 1.0}
    shown, color, light = debug_views(of, "image", "color", "diffuse", **values)
    assert np.abs(shown - color * light).max() < 1e-5


def test_two_passes_draw_the_same_picture() -> None:
    of = volume()
    points = [(0.0, (0.1, 0.3, 1.0, 0.0)), (0.3, (0.2, 1.0, 0.4, 0.0)), (1.0, (1.0, 0.2, 0.1, 0.02))]
    for surface in ("plane", "box", "both", "mesh"):
        for dot3 in ("rgb", "rgba"):
            values = {"surface": surface, "dot3": dot3, "light_position": far_light(of)}
            crop = {"crop": (8.0, 27.0, 6.0, 25.0, 5.0, 22.0)}
            once, twice = (
                image(of, camera(of), points, two_passes=two, **values, **crop) for two in (False, True)
            )
            assert once[..., 3].max() > 0.5
            assert np.abs(once - twice).max() < 1e-5, (surface, dot3)


def test_dot3_rgba_makes_the_light_the_opacity() -> None:
    of = volume()
    values = {"light_position": far_light(of), "ambient": 0.0, "diffuse": 1.0, "cut_out": False}
    light = image(of, camera(of), display="diffuse", **values)
    rgb = image(of, camera(of), **values)
    rgba = image(of, camera(of), dot3="rgba", **values)
    assert np.abs(rgba[..., 3] - light[..., 0]).max() < 1e-5
    # over black both are the same
    assert np.abs(rgba[..., :3] - rgb[..., :3]).max() < 1e-5


# ------------------------------------------------------------------------------------------------ cube map


def test_the_cube_map_gives_back_the_six_axes() -> None:
    of = volume()
    x, y, z = of.center
    view = volviz.Camera((x, y, z + 3.0), (x, y, z), (0.0, 1.0, 0.0), view_angle=2.0)
    far = 1e6
    # the plane faces +z with its upper side along +y: tangent space is the world
    plane = {"plane_origin": of.center, "plane_normal": (0.0, 0.0, 1.0), "plane_up": (0.0, 1.0, 0.0)}
    for axis in np.concatenate([np.eye(3), -np.eye(3)]):
        at = tuple(np.add(of.center, far * axis))
        for encoding in ("float", "bytes"):
            drawn = image(
                of, view, display="light", light_position=at, encoding=encoding, cut_out=False, **plane
            )
            assert np.abs(drawn[32, 32, :3] - (0.5 + 0.5 * axis)).max() <= LEVEL, (axis, encoding)


def test_cube_map_and_shader_agree_and_their_difference_is_on_show() -> None:
    of = volume()
    light = tuple(np.subtract(of.center, (3.0, 9.0, -2.0)))
    values = {"light_position": light, "cut_out": False, "plane_normal": (0.0, -1.0, 0.2)}
    cube, shader, difference = (
        image(of, camera(of), **(values | other))
        for other in ({"display": "light"}, {"display": "light", "normalization": "shader"}, {"display": "difference"})
    )  # fmt: skip
    # 32 times the difference of the vectors, whose colours differ by half as much
    assert np.abs(cube - shader).max() <= LEVEL
    assert np.abs(64 * np.abs(cube - shader)[..., :3] - difference[..., :3]).max() < 2e-3
    coarse = image(of, camera(of), display="difference", cube_map_size=4, **values)
    assert coarse[..., :3].mean() > 4 * difference[..., :3].mean() > 0


# ------------------------------------------------------------------------------------------------ turning


@pytest.mark.parametrize("source", ["bricks", "bumps"])
def test_plane_light_camera_and_volume_turned_together_give_the_same_picture(source: str) -> None:
    turn = Rotation.from_euler("zyx", (40.0, -25.0, 60.0), degrees=True).as_matrix()
    plain = volume(np.float32, spacing=(1.0, 1.2, 0.8))
    turned = volviz.Volume(blobs(dtype=np.float32), spacing=(1.0, 1.2, 0.8), direction=turn)
    view = camera(plain)
    normal = (0.3, -1.0, 0.25)
    images = []
    for of, matrix in ((plain, np.eye(3)), (turned, turn)):
        images.append(
            image(
                of, turned_camera(view, matrix), normal_source=source, plane_origin=tuple(matrix @ plain.center),
                plane_normal=tuple(matrix @ normal), light_position=tuple(matrix @ far_light(plain)),
                size=(160, 120),
            )
        )  # fmt: skip
    assert_same_image(*images)


def test_plane_light_and_camera_turned_within_the_same_volume_give_the_same_picture() -> None:
    of = volume(np.float32)
    x, y, z = of.center
    view = volviz.Camera((x, y, z + 5.0), (x + 0.5, y, z), (0.0, 1.0, 0.0), view_angle=60.0)
    normal, up, light = np.array([0.1, -0.2, 1.0]), np.array([0.0, 1.0, 0.3]), np.array([6.0, 7.0, 8.0])
    images = []
    for seed in range(3):
        matrix = Rotation.random(random_state=seed).as_matrix() if seed else np.eye(3)
        images.append(
            image(
                of, turned_camera(view, matrix, of.center), normal_source="bricks", color_source="flat",
                cut_out=False, plane_origin=of.center, plane_normal=tuple(matrix @ normal),
                plane_up=tuple(matrix @ up), light_position=tuple(of.center + matrix @ light), tile_size=4.0,
                size=(160, 120),
            )
        )  # fmt: skip
    assert (images[0][..., 3] == 1).all(), "the plane fills the picture"
    assert np.std(images[0][..., 0]) > 0.05
    for other in images[1:]:
        assert np.abs(other - images[0]).max() <= MAX_ERROR


def turned_camera(view: volviz.Camera, matrix: Any, about: Any = (0.0, 0.0, 0.0)) -> volviz.Camera:
    """The camera turned by a rotation about a point."""
    position, focus = (
        tuple(about + matrix @ np.subtract(p, about)) for p in (view.position, view.focal_point)
    )
    return replace(view, position=position, focal_point=focus, view_up=tuple(matrix @ view.view_up))


def assert_same_image(a: Any, b: Any) -> None:
    rim = (a[..., 3] > 0) != (b[..., 3] > 0)
    assert rim.sum() <= 4
    assert (a[..., 3] > 0).mean() > 0.1
    assert np.abs(a - b)[~rim].max() <= MAX_ERROR


# ------------------------------------------------------------------------------------------------ per vertex


def test_lighting_per_vertex_loses_what_lies_between_the_vertices() -> None:
    of = volume()
    values = {
        "light_position": far_light(of), "display": "diffuse", "cut_out": False, "normal_source": "bumps",
        "tile_size": 60.0,
    }  # fmt: skip
    exact = image(of, camera(of), **values)[..., 0]
    errors = [
        np.abs(image(of, camera(of), lighting="vertex", subdivisions=n, **values)[..., 0] - exact).mean()
        for n in (1, 8, 128)
    ]
    assert errors[0] > 4 * LEVEL
    assert errors[1] < 0.5 * errors[0]
    assert errors[2] < 0.1 * errors[0]


# ------------------------------------------------------------------------------------------------ normal maps


def test_an_image_of_the_bricks_looks_like_the_bricks(tmp_path: Path) -> None:
    of = volume()
    normals = pattern_normals("bricks")
    Image.fromarray(encoded(normals)[::-1]).save(tmp_path / "bricks.png")
    flipped = normals * (1.0, -1.0, 1.0)
    Image.fromarray(encoded(flipped)[::-1]).save(tmp_path / "down.png")
    values = {"light_position": far_light(of), "tile_size": 12.0}
    built_in = image(of, camera(of), normal_source="bricks", **values)
    values |= {"normal_source": "image"}
    read = image(of, camera(of), normal_image=str(tmp_path / "bricks.png"), **values)
    down = image(of, camera(of), normal_image=str(tmp_path / "down.png"), flip_green=True, **values)
    wrong = image(of, camera(of), normal_image=str(tmp_path / "down.png"), **values)
    assert np.abs(read - built_in).max() <= 3 * LEVEL
    assert np.abs(down - built_in).max() <= 3 * LEVEL
    assert np.abs(wrong - built_in).max() > 30 * LEVEL


def test_light_from_above_falls_on_the_upper_edges_of_bumps() -> None:
    of = volume()
    x, y, z = of.center
    view = volviz.Camera((x, y - 90.0, z), (x, y, z), (0.0, 0.0, 1.0), view_angle=20.0)
    drawn = image(
        of, view, normal_source="bumps", display="diffuse", cut_out=False, plane_origin=of.center,
        plane_normal=(0.0, -1.0, 0.0), tile_size=64.0, light_position=(x, y - 500.0, z + 500.0),
    )[..., 0]  # fmt: skip
    # the plane's origin is the corner of four tiles: the bumps around the middle of the image
    row, column = 32, 32
    reach = 8 / (90 * np.tan(np.radians(10)) / 32)
    bump = int(row - reach)
    right = int(column + reach)
    quarter = int(reach / 2)
    assert drawn[bump - quarter, right] > drawn[bump + quarter, right] + 0.1


def test_a_missing_image_or_a_direction_of_length_zero_is_refused_in_words() -> None:
    of = volume()
    with pytest.raises(LoadError, match="there is no file"):
        image(of, camera(of), normal_source="image", normal_image="/nowhere/map.png")
    with pytest.raises(SettingError, match="plane_normal is a direction"):
        image(of, camera(of), plane_normal=(0.0, 0.0, 0.0))


# ------------------------------------------------------------------------------------------------ light


def test_self_shadowing_keeps_slopes_dark_when_the_light_is_behind() -> None:
    of = volume()
    x, y, z = of.center
    behind = {
        "light_position": (x - 80.0, y + 9.0, z),
        "plane_normal": (0.0, -1.0, 0.0),
        "display": "diffuse",
    }
    plain = image(of, camera(of), normal_source="bumps", bump_strength=3.0, **behind)
    shadowed = image(of, camera(of), normal_source="bumps", bump_strength=3.0, self_shadowing=True, **behind)
    assert plain[..., 0].max() > 0.2
    assert shadowed[..., 0].max() == 0.0
    assert shadowed[..., 3].max() == 1.0


def test_a_smooth_plane_is_lit_by_the_cosine_of_the_angle() -> None:
    of = volume()
    x, y, z = of.center
    for degrees in (0.0, 30.0, 60.0, 85.0):
        a = np.radians(degrees)
        drawn = image(
            of, camera(of), bump_strength=0.0, display="diffuse", plane_normal=(0.0, -1.0, 0.0), cut_out=False,
            light_position=(x + 1e6 * np.sin(a), y - 1e6 * np.cos(a), z),
        )  # fmt: skip
        seen = drawn[..., 3] > 0
        assert np.abs(drawn[seen][:, 0] - np.cos(a)).max() < LEVEL


# ------------------------------------------------------------------------------------------------ box and mesh


def test_the_faces_of_the_box_cover_what_the_box_covers() -> None:
    of = volume(spacing=(1.0, 1.2, 0.8), direction=OBLIQUE)
    crop = (4.0, 30.0, 3.0, 25.0, 5.0, 22.0)
    box = image(of, camera(of), surface="box", cut_out=False, crop=crop)
    solid = function(of, [(0.0, (1, 1, 1, 0.99)), (1.0, (1, 1, 1, 0.99))])
    ray = volviz.render(
        of, "raycast", transfer_function=solid, size=SIZE, camera=camera(of), crop=crop, dtype="float32",
        opacity_unit_distance=1e-3,
    )[..., 3]  # fmt: skip
    assert ((box[..., 3] > 0) != (ray > 0.5)).sum() <= 6


def test_the_faces_are_seen_from_inside() -> None:
    of = volume()
    drawn = image(of, inside(of), surface="box", cut_out=False)
    assert (drawn[..., 3] == 1).all()
    assert drawn[..., :3].std() > 0.02


def rippled_volume(n: int = 48) -> tuple[volviz.Volume, float]:
    """A ball with ripples finer than a coarse mesh can show, and the isovalue of its surface."""
    z, y, x = np.meshgrid(*[np.arange(n) - (n - 1) / 2] * 3, indexing="ij")
    radius = np.sqrt(x**2 + y**2 + z**2)
    ripples = 0.6 * np.sin(0.9 * x) * np.sin(0.8 * y + 0.4 * z)
    return volviz.Volume((ripples - radius).astype(np.float32)), -0.32 * n


@pytest.mark.parametrize("stride", [2, 3, 4])
def test_the_data_give_a_coarse_mesh_the_normals_of_the_true_surface(stride: int) -> None:
    of, isovalue = rippled_volume()
    view, light, size = camera(of), np.array(far_light(of)), (160, 120)
    values = {
        "surface": "mesh", "isovalue": isovalue, "stride": stride, "display": "diffuse", "size": size,
        "light_position": tuple(light), "normalization": "shader",
    }  # fmt: skip
    view_matrix, projection = matrices(of, view, size)
    exact = reference_isosurface(
        of.array, isovalues=[isovalue], view=view_matrix, projection=projection, size=size, step_world=0.25
    )
    to_light = light - exact.position
    cosine = np.einsum("hwi,hwi->hw", exact.normal, to_light) / np.linalg.norm(to_light, axis=-1)
    baked = image(of, view, **values)
    smooth = image(of, view, bump_strength=0.0, **values)
    seen = np.isfinite(cosine) & (baked[..., 3] > 0)
    errors = [np.abs(drawn[..., 0] - np.clip(cosine, 0, 1))[seen].mean() for drawn in (baked, smooth)]
    assert seen.mean() > 0.1
    # a pixel of a coarse triangle shows a point a little beside the one its ray would hit
    assert errors[0] < 0.02 * stride
    assert errors[0] < 0.75 * errors[1]


def test_a_mesh_is_cropped_and_clipped() -> None:
    of, isovalue = rippled_volume(32)
    view = camera(of)
    values = {"surface": "mesh", "isovalue": isovalue, "normal_source": "bumps"}
    whole = image(of, view, **values)[..., 3]
    x, y, z = of.center
    clipped = image(of, view, clip_planes=[((x, y, z), (0.0, 0.0, 1.0))], **values)[..., 3]
    cropped = image(of, view, crop=(0, 31, 0, 31, 15.5, 31), **values)[..., 3]
    assert 0.35 < clipped.sum() / whole.sum() < 0.75
    assert np.array_equal(clipped, cropped)


def test_tangents_agree_with_those_of_vtk() -> None:
    latitude, longitude = np.meshgrid(np.linspace(-1.3, 1.3, 24), np.linspace(0.0, 6.0, 48), indexing="ij")
    grid = pyvista.StructuredGrid(
        np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)
    )
    mesh = grid.extract_surface(algorithm="dataset_surface").triangulate()
    points = np.asarray(mesh.points, float)
    uv = np.stack([np.arctan2(points[:, 1], points[:, 0]) % (2 * np.pi), np.arcsin(points[:, 2])], axis=1)
    mesh.point_data.active_normals = points
    mesh.active_texture_coordinates = uv
    made = vtkPolyDataTangents()
    made.SetInputData(mesh)
    made.Update()
    theirs = vtk_to_numpy(made.GetOutput().GetPointData().GetTangents()).astype(float)
    theirs -= points * np.einsum("vi,vi->v", theirs, points)[:, None]
    theirs /= np.linalg.norm(theirs, axis=1, keepdims=True)
    ours = vertex_tangents(points, points, mesh.regular_faces, uv)[:, :3]
    # VTK weights the triangles of a vertex by something else
    assert np.einsum("vi,vi->v", ours, theirs).min() > np.cos(np.radians(5))


# ------------------------------------------------------------------------------------------------ in VTK's scene


@contextmanager
def plotter() -> Iterator[Any]:
    """An off-screen plotter that is closed at the end."""
    made = pyvista.Plotter(off_screen=True, window_size=(160, 120))
    made.render_window.SetMultiSamples(0)
    made.set_background("black")
    try:
        yield made
    finally:
        made.close()


def test_meshes_of_vtk_and_the_cut_hide_one_another() -> None:
    with plotter() as window:
        of = volume()
        x, y, z = of.center
        # the plane y = middle, seen from -y; one ball before it, one behind, one half through it
        for offset, color in ((-8.0, "red"), (8.0, "lime"), (0.0, "blue")):
            ball = pyvista.Sphere(radius=3.0, center=(x + offset, y + offset, z))
            window.add_mesh(ball, color=color, lighting=False)
        handle = volviz.add_volume(
            window, of, "bump_mapping", color_source="flat", flat_color=(1.0, 1.0, 1.0), cut_out=False,
            plane_origin=of.center, plane_normal=(0.0, -1.0, 0.0), bump_strength=0.0,
        )  # fmt: skip
        apply_camera(
            window.camera, volviz.Camera((x, y - 90.0, z), (x, y, z), (0.0, 0.0, 1.0), view_angle=30.0)
        )
        window.reset_camera_clipping_range()
        window.show(auto_close=False)
        handle.raise_error()
        shown = window.screenshot(return_img=True)
        red, green, blue = (shown[..., i].astype(int) for i in range(3))
        assert ((red > 200) & (green < 50)).sum() > 100, "the ball in front is hidden"
        assert ((green > 200) & (red < 50)).sum() == 0, "the ball behind shines through"
        half = ((blue > 200) & (red < 50)).sum()
        front = ((red > 200) & (green < 50)).sum()
        assert 0.6 < half / front < 1.1, "a ball in the plane shows its front half, as wide as a whole one"
        depth = window.get_image_depth(fill_value=None)
        middle, corner = depth[85, 95], depth[2, 2]
        assert middle == pytest.approx(-90.0, abs=0.3), "the cut's depth is not in VTK's buffer"
        assert corner < -100
        handle.remove()


def test_a_moved_plane_compiles_and_uploads_nothing() -> None:
    with plotter() as window:
        of = volume()
        handle = volviz.add_volume(window, of, "bump_mapping", normal_source="bricks")
        window.show(auto_close=False)
        handle.update(plane_origin=of.center, plane_normal=(1.0, 0.0, 0.0))
        window.render()
        compiled, uploads = handle.gpu.programs.compiled, handle.gpu.uploads
        before = handle.read_image()
        handle.update(
            plane_origin=tuple(np.add(of.center, 3.0)), plane_normal=(1.0, 0.4, 0.0), bump_strength=2.0
        )
        window.render()
        handle.raise_error()
        assert (handle.gpu.programs.compiled, handle.gpu.uploads) == (compiled, uploads)
        assert np.abs(handle.read_image() - before).max() > 0.1
        handle.remove()


def test_bands_are_the_rows_of_tiles() -> None:
    tiles = ((64, 32, 256, 64), (320, 32, 100, 64), (64, 96, 256, 30), (320, 96, 100, 30))
    assert bands(tiles) == [(64, 32, 356, 64), (64, 96, 356, 30)]
    assert bands(()) == []
