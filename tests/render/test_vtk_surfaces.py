"""VTK's surfaces and splats behind the technique protocol, beside ours."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import pyvista

import volviz
from tests.render.scenes import LEFT_HANDED, OBLIQUE, camera, function, image, psnr, volume
from volviz.custom_gl.offscreen import apply_camera

SIZE = (96, 80)
GEOMETRY: dict[str, dict[str, Any]] = {
    "straight": {},
    "oblique": {"direction": OBLIQUE, "origin": (5.0, -3.0, 7.0), "spacing": (1.0, 1.2, 0.8)},
    "left-handed": {"direction": LEFT_HANDED, "origin": (5.0, -3.0, 7.0), "spacing": (1.0, 1.2, 0.8)},
}
#: Crop faces and planes, ten in all: more than VTK's polygon mapper takes.
MANY_CUTS: dict[str, Any] = {
    "crop": (5.3, 25.2, 3.0, 20.0, 4.0, 22.0),
    "clip_planes": (
        ((15.0, 15.0, 15.0), (1.0, 0.3, 0.2)),
        ((15.0, 15.0, 10.0), (0.0, 0.3, 0.9)),
        ((15.0, 22.0, 15.0), (0.0, -1.0, 0.0)),
        ((22.0, 15.0, 15.0), (-1.0, 0.1, 0.0)),
    ),
}
# highlights are Phong's there and Blinn's here
DULL = {"specular": 0.0}
PAIRS = [
    ("vtk_marching_cubes", "marching_cubes", DULL),
    ("vtk_flying_edges", "marching_cubes", DULL),
    ("vtk_isosurface", "isosurface", DULL),
]


@pytest.mark.parametrize("geometry", GEOMETRY)
@pytest.mark.parametrize(("theirs", "ours", "values"), PAIRS, ids=lambda value: str(value)[:20])
def test_vtks_surface_lies_where_ours_lies(
    theirs: str, ours: str, values: dict[str, Any], geometry: str
) -> None:
    of = volume(**GEOMETRY[geometry])
    view, transfer = camera(of), function(of)
    one = image(of, transfer, view, size=SIZE, technique_id=theirs, **values)
    other = image(of, transfer, view, size=SIZE, technique_id=ours, **values)
    # outlines differ by single pixels, where surfaces are seen edge-on; moved by a pixel, by 40 and more
    assert (np.abs(one[..., 3] - other[..., 3]) > 0.5).sum() <= 10
    both = (one[..., 3] > 0.99) & (other[..., 3] > 0.99)
    assert both.sum() > 200
    assert psnr(one[both], other[both]) > 35


@pytest.mark.parametrize(("theirs", "ours", "values"), PAIRS, ids=lambda value: str(value)[:20])
def test_many_cuts_at_once_take_the_same_away(theirs: str, ours: str, values: dict[str, Any]) -> None:
    of = volume()
    view, transfer = camera(of), function(of)
    one = image(of, transfer, view, size=SIZE, technique_id=theirs, **values, **MANY_CUTS)
    other = image(of, transfer, view, size=SIZE, technique_id=ours, **values, **MANY_CUTS)
    assert (other[..., 3] > 0.5).sum() > 100
    # the cropping region of VTK's ray caster leaves samples out, so surfaces end up to a step early
    assert (np.abs(one[..., 3] - other[..., 3]) > 0.5).mean() < 0.01


def test_a_light_beside_the_volume_lights_both_meshes_alike() -> None:
    of = volume()
    values: dict[str, Any] = {"light_position": (60.0, -40.0, 80.0), "light_color": (1.0, 0.5, 0.2), **DULL}
    one = image(of, function(of), camera(of), size=SIZE, technique_id="vtk_flying_edges", **values)
    other = image(of, function(of), camera(of), size=SIZE, technique_id="marching_cubes", **values)
    assert psnr(one, other) > 38


def test_a_stride_takes_the_same_voxels_also_of_a_mirrored_lattice() -> None:
    of = volume(**GEOMETRY["left-handed"])
    values: dict[str, Any] = {"stride": 3, "normals": "flat", **DULL}
    one = image(of, function(of), camera(of), size=SIZE, technique_id="vtk_flying_edges", **values)
    other = image(of, function(of), camera(of), size=SIZE, technique_id="marching_cubes", **values)
    assert (np.abs(one[..., 3] - other[..., 3]) > 0.5).sum() <= 12


@pytest.mark.parametrize("cuts", [{}, MANY_CUTS], ids=["whole", "many cuts"])
def test_discs_of_vtks_point_mapper_are_our_splats_without_blur_and_light(cuts: dict[str, Any]) -> None:
    of = volume()
    one = image(of, function(of), camera(of), size=SIZE, technique_id="vtk_point_gaussian", **cuts)
    other = image(
        of,
        function(of),
        camera(of),
        size=SIZE,
        technique_id="splatting",
        blur_radius=0.0,
        shading=False,
        **cuts,
    )
    # VTK cuts through the splats that a plane meets, ours takes them away whole
    shown = other[..., 3] > 0.5
    assert (np.abs(one[..., 3] - other[..., 3]) > 0.5).sum() <= 0.05 * shown.sum()
    both = shown & (one[..., 3] > 0.5)
    assert both.sum() > 200
    assert psnr(one[both], other[both]) > 30


def test_a_surface_of_vtk_is_cut_by_meshes_and_cuts_them() -> None:
    of = volume()
    x, y, z = of.center
    images = []
    for technique in ("vtk_flying_edges", "marching_cubes"):
        plotter = pyvista.Plotter(off_screen=True, window_size=SIZE)
        plotter.render_window.SetMultiSamples(0)
        try:
            plotter.background_color = "black"
            plotter.add_mesh(
                pyvista.Sphere(radius=7.0, center=(x + 4, y - 4, z)), color="red", lighting=False
            )
            volviz.add_volume(plotter, of, technique, transfer_function=function(of), **DULL)
            apply_camera(plotter.camera, camera(of))
            plotter.reset_camera_clipping_range()
            plotter.show(auto_close=False, interactive=False)
            images.append(plotter.screenshot(return_img=True)[..., :3] / 255.0)
        finally:
            plotter.close()
    red = (images[0][..., 0] > 0.9) & (images[0][..., 1] < 0.1)
    assert red.sum() > 20
    assert psnr(*images) > 28


def test_shadows_of_vtk_fall_where_ours_fall() -> None:
    # a slab between the light and a wall
    array = np.zeros((24, 24, 24), np.float32)
    array[6:18, 4:6, 6:18] = 1.0
    array[:, 18:20, :] = 0.6
    of = volviz.Volume(array)
    solid = volviz.TransferFunction.from_points(
        [(0.0, (1, 1, 1, 0)), (0.3, (1, 1, 1, 0)), (0.5, (1, 1, 1, 0.6)), (1, (1, 1, 1, 0.9))]
    )
    view = volviz.Camera((12.0, -30.0, 70.0), (12.0, 14.0, 12.0), (0.0, -1.0, 0.0))
    values: dict[str, Any] = {"size": SIZE, "light_position": (12.0, -60.0, 12.0)}
    lit = image(of, solid, view, technique_id="vtk_shadows", scattering=0.0, **values)
    shadowed = image(of, solid, view, technique_id="vtk_shadows", scattering=2.0, **values)
    ours = image(of, solid, view, technique_id="half_angle", **values)
    wall = lit[..., 0] > 0.5
    wall[: SIZE[1] // 2 - 6] = False
    theirs_dark, ours_dark = wall & (shadowed[..., 0] < 0.25), wall & (ours[..., 0] < 0.45)
    assert 0.15 < theirs_dark.sum() / wall.sum() < 0.6
    assert (theirs_dark & ours_dark).sum() > 0.8 * (theirs_dark | ours_dark).sum()


@pytest.mark.parametrize("geometry", GEOMETRY)
def test_a_normal_texture_of_vtk_gives_the_relief_of_our_bump_mapping(geometry: str) -> None:
    of = volume(**GEOMETRY[geometry])
    values: dict[str, Any] = {"size": SIZE, "bump_strength": 2.0, "light_position": (60.0, -40.0, 80.0)}
    one = image(of, function(of), camera(of), technique_id="vtk_normal_map", **values)
    other = image(of, function(of), camera(of), technique_id="bump_mapping", **values)
    flat = image(
        of, function(of), camera(of), technique_id="vtk_normal_map", **(values | {"bump_strength": 0.0})
    )
    assert psnr(one, other) > 40
    assert psnr(one, flat) < 35


def test_the_side_of_the_plane_that_faces_the_eye_is_lit() -> None:
    of = volume()
    behind = camera(of).turned(azimuth=180.0)
    one = image(of, function(of), behind, size=SIZE, technique_id="vtk_normal_map")
    other = image(of, function(of), behind, size=SIZE, technique_id="bump_mapping")
    assert psnr(one, other) > 40
