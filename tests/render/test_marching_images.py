"""Images of our meshes against VTK's of the same triangles, ray-cast isosurfaces and closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import volviz
from tests.render.scenes import LEFT_HANDED, OBLIQUE, blobs, camera, function, inside, psnr, volume
from volviz.custom_gl.offscreen import apply_camera
from volviz.custom_gl.vtk.vtk_imports import pyvista

SIZE = (160, 120)
TECHNIQUES = ("marching_cubes", "marching_tetrahedra")
METHOD = {"marching_cubes": "lorensen", "marching_tetrahedra": "tetrahedra"}
GEOMETRIES = [
    {"spacing": (0.9, 1.1, 1.4), "origin": (5.0, -2.0, 1.0)},
    {"spacing": (0.8, 1.0, 1.7), "origin": (-20.0, 30.0, 7.0), "direction": OBLIQUE},
    {"spacing": (0.8, 1.0, 1.7), "direction": LEFT_HANDED},
]
GEOMETRY_IDS = ["anisotropic", "oblique", "left-handed"]
COLOR = (0.8, 0.6, 0.4)
MATERIAL = {"ambient": 0.2, "diffuse": 0.7, "specular": 0.2, "shininess": 20.0}


def image(of: volviz.Volume, view: volviz.Camera, technique: str = "marching_cubes", **values: Any) -> Any:
    """Our image, premultiplied float64, (H, W, 4)."""
    given = {"size": SIZE} | values
    straight = volviz.render(of, technique, camera=view, dtype="float32", **given).astype(float)
    straight[..., :3] *= straight[..., 3:]
    return straight


def close(of: volviz.Volume, **changes: Any) -> volviz.Camera:
    """A camera that is filled by what lies in the middle of a volume."""
    return camera(of, view_angle=18.0, **changes)


def ray_cast(of: volviz.Volume, view: volviz.Camera, isovalue: float, **values: Any) -> Any:
    """The same surface by ray casting, finely sampled."""
    return image(
        of, view, "isosurface", isovalues=(isovalue,), colors=(COLOR,), step=0.1, bisections=10, **MATERIAL, **values
    )  # fmt: skip


def meshed(of: volviz.Volume, view: volviz.Camera, isovalue: float, technique: str, **values: Any) -> Any:
    """The surface as triangles, with the look of `ray_cast`."""
    return image(of, view, technique, **({"isovalue": isovalue, "color": COLOR} | MATERIAL | values))


def sphere(count: int = 48, radius: float = 15.0, spacing: float = 0.8) -> volviz.Volume:
    """Distance to its surface, positive inside, float32: the isovalue 0 is the sphere."""
    axis = (np.arange(count) - (count - 1) / 2) * spacing
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    low = -(count - 1) / 2 * spacing
    return volviz.Volume(
        (radius - np.sqrt(x**2 + y**2 + z**2)).astype(np.float32), (spacing,) * 3, (low, low, low)
    )


def in_vtk(
    of: volviz.Volume,
    view: volviz.Camera,
    *,
    mesh: Any = None,
    technique: str | None = None,
    extra: Any = None,
    **values: Any,
) -> tuple[Any, Any]:
    """Colours (H, W, 3), 0..1, and window depth (H, W) of VTK's own buffers, under one light at the eye."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkFloatArray

    window = pyvista.Plotter(off_screen=True, window_size=SIZE, lighting="none")
    window.render_window.SetMultiSamples(0)
    window.set_background("black")
    window.add_light(pyvista.Light(light_type="headlight"))
    handle = None
    if mesh is not None:
        window.add_mesh(
            mesh,
            color=COLOR,
            smooth_shading=False,
            interpolation="Phong",
            ambient=0.2,
            diffuse=0.7,
            specular=0.0,
        )
    if extra is not None:
        window.add_mesh(extra, color="blue", lighting=False)
    if technique is not None:
        handle = volviz.add_volume(window, of, technique, **values)
    apply_camera(window.camera, view)
    window.renderer.SetNearClippingPlaneTolerance(0.001)
    window.renderer.ResetCameraClippingRange(*of.bounds)
    color = window.screenshot(return_img=True)[..., :3] / 255
    buffer = vtkFloatArray()
    window.render_window.GetZbufferData(0, 0, SIZE[0] - 1, SIZE[1] - 1, buffer)
    depth = vtk_to_numpy(buffer).reshape(SIZE[1], SIZE[0])[::-1].copy()
    if handle is not None:
        handle.raise_error()
        handle.remove()
    window.close()
    return color, depth


def decoded(shown: Any) -> Any:
    """World normals (N, 3) of the covered pixels of an image coloured by the normal."""
    return shown[shown[..., 3] == 1][:, :3] * 2 - 1


# ---------------------------------------------------------------------- against VTK


@pytest.mark.parametrize("technique", TECHNIQUES)
@pytest.mark.parametrize("geometry", GEOMETRIES, ids=GEOMETRY_IDS)
def test_our_pass_draws_the_mesh_as_vtk_draws_it(technique: str, geometry: Any) -> None:
    of = volume(np.float32, **geometry)
    # parallel: VTK's light at the eye has parallel rays
    view = close(of, parallel=True)
    mesh = volviz.extract_isosurface(of, 0.4, METHOD[technique])
    theirs, their_depth = in_vtk(of, view, mesh=mesh)
    values = {"isovalue": 0.4, "color": COLOR, "ambient": 0.2, "diffuse": 0.7, "specular": 0.0}
    ours, our_depth = in_vtk(of, view, technique=technique, **values)
    covered = their_depth < 1
    assert covered.mean() > 0.1
    # pixels whose centre lies on an edge of the silhouette
    assert ((our_depth < 1) != covered).sum() <= 3
    both = covered & (our_depth < 1)
    error = np.abs(ours - theirs)[both].max(axis=1)
    assert np.quantile(error, 0.99) <= 1 / 255
    assert error.mean() < 0.5 / 255
    assert np.quantile(np.abs(our_depth - their_depth)[both], 0.99) < 1e-5


def test_a_mesh_of_vtk_intersects_the_surface_where_geometry_says() -> None:
    of = sphere()
    view = close(of)
    plane = pyvista.Plane(center=of.center, direction=(0.3, 1.0, 0.4), i_size=80, j_size=80)
    color, depth = in_vtk(
        of, view, technique="marching_cubes", extra=plane, isovalue=0.0, color=(1.0, 0.0, 0.0), ambient=1.0
    )
    _, of_plane = in_vtk(of, view, extra=plane)
    _, of_surface = in_vtk(of, view, technique="marching_cubes", isovalue=0.0)
    red, blue = color[..., 0] > 0.5, color[..., 2] > 0.5
    clear = np.abs(of_plane - of_surface) > 1e-5
    surface_in_front = (of_surface < of_plane) & clear
    plane_in_front = (of_plane < of_surface) & clear
    assert surface_in_front.sum() > 300
    assert plane_in_front.sum() > 300
    assert red[surface_in_front].all()
    assert (blue & ~red)[plane_in_front].all()
    assert np.abs(depth - np.minimum(of_plane, of_surface)).max() < 1e-5


# ---------------------------------------------------------------------- against the ray-cast surface


@pytest.mark.parametrize("technique", TECHNIQUES)
@pytest.mark.parametrize("geometry", GEOMETRIES, ids=GEOMETRY_IDS)
def test_the_mesh_lies_where_the_ray_cast_surface_lies(technique: str, geometry: Any) -> None:
    of = volume(np.float32, **geometry)
    view = close(of)
    exact = ray_cast(of, view, 0.4)
    assert (exact[..., 3] > 0).mean() > 0.1
    here = psnr(meshed(of, view, 0.4, technique), exact)
    assert here > 33
    for axis in range(3):
        for sign in (-0.25, 0.25):
            step = np.zeros(3)
            step[axis] = sign
            shift = of.index_to_world[:3, :3] @ step
            moved = volviz.Volume(of.array, of.spacing, tuple(np.add(of.origin, shift)), of.direction)
            assert psnr(meshed(moved, view, 0.4, technique), exact) < here - 1


@pytest.mark.parametrize("technique", TECHNIQUES)
@pytest.mark.parametrize("geometry", GEOMETRIES, ids=GEOMETRY_IDS)
def test_parallel_projection_shows_the_ray_cast_surface(technique: str, geometry: Any) -> None:
    of = volume(np.float32, **geometry)
    view = close(of, parallel=True)
    assert psnr(meshed(of, view, 0.4, technique), ray_cast(of, view, 0.4)) > 33


@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.uint16])
def test_every_data_type_gives_the_surface_of_the_same_value(dtype: Any) -> None:
    of = volume(dtype, spacing=(0.9, 1.1, 1.4))
    view = close(of)
    isovalue = float(of.range[0] + 0.4 * (of.range[1] - of.range[0]))
    # bytes have normals in steps, which both sides interpolate in their own way
    limit = 28 if dtype == np.uint8 else 33
    assert psnr(meshed(of, view, isovalue, "marching_cubes"), ray_cast(of, view, isovalue)) > limit


@pytest.mark.parametrize("technique", TECHNIQUES)
@pytest.mark.parametrize(
    "cut",
    [
        {"crop": (4.5, 25.0, 0.0, 20.25, 3.0, 14.5)},
        {"clip_planes": (((17.0, 15.0, 13.0), (1.0, 0.3, 0.2)), ((17.0, 15.0, 16.0), (0.0, -1.0, 0.4)))},
        {"crop": (0.0, 17.5, 0.0, 31.0, 0.0, 26.0), "clip_planes": (((17.0, 15.0, 13.0), (0.0, 0.0, -1.0)),)},
    ],
    ids=["crop", "two planes", "both"],
)
def test_crop_box_and_planes_cut_the_mesh_as_they_cut_rays(technique: str, cut: dict[str, Any]) -> None:
    of = volume(np.float32)
    view = close(of)
    exact, whole = ray_cast(of, view, 0.4, **cut), ray_cast(of, view, 0.4)
    ours = meshed(of, view, 0.4, technique, **cut)
    assert psnr(exact, whole) < 25, "nothing visible is cut"
    assert psnr(ours, exact) > 30
    assert ((ours[..., 3] > 0) != (exact[..., 3] > 0)).mean() < 0.005


def test_a_camera_inside_sees_the_walls_from_within() -> None:
    of = sphere()
    view = inside(of)
    ours = meshed(of, view, 0.0, "marching_cubes")
    assert np.all(ours[..., 3] == 1)
    assert psnr(ours, ray_cast(of, view, 0.0)) > 40


def test_a_placed_light_lights_both_techniques_alike() -> None:
    of = volume(np.float32)
    view = close(of)
    light = {"headlight": False, "light_position": (-40.0, -5.0, 70.0)}
    assert psnr(meshed(of, view, 0.4, "marching_cubes", **light), ray_cast(of, view, 0.4, **light)) > 33
    assert psnr(meshed(of, view, 0.4, "marching_cubes", **light), ray_cast(of, view, 0.4)) < 30


def test_the_picture_converges_to_the_ray_cast_surface_as_the_stride_falls() -> None:
    of = volviz.Volume(blobs((65, 65, 65), np.float32))
    view = close(of)
    exact = ray_cast(of, view, 0.4)
    error = [np.abs(meshed(of, view, 0.4, "marching_cubes", stride=s) - exact).mean() for s in (4, 2, 1)]
    assert error[0] > 2 * error[1] > 4 * error[2] > 0


# ---------------------------------------------------------------------- normals


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_a_sphere_has_radial_normals(technique: str) -> None:
    of = sphere()
    view = camera(of, parallel=True)
    shown = image(of, view, technique, isovalue=0.0, color_by="normal")
    points = image(of, view, "isosurface", isovalues=(0.0,), display="positions", step=0.1, bisections=12)
    both = (shown[..., 3] == 1) & (points[..., 3] == 1)
    index = points[both][:, :3] * of.dimensions - 0.5
    radial = index * of.spacing + of.origin
    radial /= np.linalg.norm(radial, axis=1, keepdims=True)
    normal = shown[both][:, :3] * 2 - 1
    # where the view grazes the surface, triangles and ray-cast points lie apart along the ray
    faced = np.abs(radial @ view.direction) > 0.2
    angle = np.degrees(np.arccos(np.clip((normal * radial).sum(axis=1), -1, 1)))[faced]
    assert len(angle) > 2000
    assert angle.max() < 1


@pytest.mark.parametrize("technique", TECHNIQUES)
@pytest.mark.parametrize("normals", ["gradient", "flat"])
@pytest.mark.parametrize("geometry", GEOMETRIES, ids=GEOMETRY_IDS)
@pytest.mark.parametrize("from_behind", [False, True])
def test_a_linear_field_has_the_normal_of_its_plane(
    technique: str, normals: str, geometry: Any, from_behind: bool
) -> None:
    z, y, x = np.meshgrid(*[np.arange(20.0)] * 3, indexing="ij")
    of = volviz.Volume((1.0 * x + 0.7 * y - 0.4 * z).astype(np.float32), **geometry)
    # of the falling gradient: lattice covectors go to the world by the transposed inverse
    expected = -np.linalg.inv(of.index_to_world[:3, :3]).T @ (1.0, 0.7, -0.4)
    expected /= np.linalg.norm(expected)
    eye = np.array(of.center) + (-60 if from_behind else 60) * np.add(expected, (0.3, 0.2, -0.1))
    view = volviz.Camera(tuple(eye), of.center, (0.0, 0.2, 1.0))
    shown = image(of, view, technique, isovalue=12.35, color_by="normal", normals=normals)
    found = decoded(shown)
    assert len(found) > 500
    assert np.abs(found - expected).max() < 2e-3


def test_facets_keep_their_normals_however_near_the_eye_is() -> None:
    of = volume(np.float32, origin=(4000.0, -3000.0, 5000.0))
    mesh = volviz.extract_isosurface(of, 0.4)
    start = int(np.argmax(mesh.points[:, 2]))
    point = mesh.points[start].astype(float)
    eye = (point[0] + 0.02, point[1] + 0.01, point[2] + 0.05)
    view = volviz.Camera(eye, tuple(point), (0.0, 1.0, 0.0))
    shown = image(of, view, isovalue=0.4, color_by="normal", normals="flat")
    found = decoded(shown)
    # a handful of triangles fills the view: all pixels of one have one normal
    groups = np.unique(np.round(found, 2), axis=0)
    assert len(found) > 5000
    assert 1 <= len(groups) < 30


def test_lighting_does_not_depend_on_the_unit_of_length() -> None:
    shown = []
    for unit in (1.0, 1e-6, 1e5):
        of = volviz.Volume(blobs(dtype=np.float32), (0.9 * unit, 1.1 * unit, 1.4 * unit))
        shown.append(meshed(of, camera(of), 0.4, "marching_cubes"))
    assert shown[0][..., :3].std() > 0.1
    assert np.abs(shown[1] - shown[0]).mean() < 0.5 / 255
    assert np.abs(shown[2] - shown[0]).mean() < 0.5 / 255


# ---------------------------------------------------------------------- looks


def test_the_transfer_function_colours_the_data_below_the_surface() -> None:
    of = sphere()
    points = [
        (-30.0, (0, 0, 0, 1)),
        (0.0, (0.2, 0.4, 0.9, 1)),
        (10.0, (0.9, 0.6, 0.1, 1)),
        (15.0, (1, 1, 1, 1)),
    ]
    transfer = volviz.TransferFunction.from_points(points)
    for depth, share in ((0.0, 0.0), (5.0, 0.4)):
        shown = image(
            of, camera(of), isovalue=0.0, color_by="transfer_function", color_depth=depth, ambient=1.0,
            diffuse=0.0, specular=0.0, transfer_function=transfer,
        )  # fmt: skip
        found = shown[shown[..., 3] == 1][:, :3]
        expected = (1 - share) * np.array(points[1][1][:3]) + share * np.array(points[2][1][:3])
        assert len(found) > 2000
        # spacing 0.8: five voxels are 4 world units, 0.4 of the way to the next colour
        assert np.abs(found - expected).max() < 2 / 255


def test_a_wireframe_lies_within_the_surface_and_is_seen_through() -> None:
    of = sphere(20, 6.0)
    view = camera(of)
    size = (480, 360)
    faces = image(of, view, isovalue=0.0, size=size)[..., 3] > 0
    lines = image(of, view, isovalue=0.0, size=size, wireframe=True)[..., 3] > 0
    coarse = image(of, view, isovalue=0.0, size=size, wireframe=True, stride=4)[..., 3] > 0
    around = np.pad(faces, 1)
    near = np.any([np.roll(around, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)], axis=0)[
        1:-1, 1:-1
    ]
    assert not (lines & ~near).any()
    assert 0.05 * faces.sum() < coarse.sum() < lines.sum() < 0.9 * faces.sum()


def test_an_isovalue_beyond_the_data_draws_nothing() -> None:
    of = volume(np.uint8)
    for isovalue in (-5.0, 300.0):
        assert not image(of, camera(of), isovalue=isovalue).any()


def test_the_automatic_isovalue_is_that_of_the_ray_cast_surface() -> None:
    from volviz.model.auto_isovalue import auto_isovalue

    of = volume(np.uint8)
    automatic = image(of, camera(of))
    assert np.array_equal(automatic, image(of, camera(of), isovalue=auto_isovalue(of)))


def test_both_methods_differ_where_a_cell_is_ambiguous() -> None:
    corners = np.zeros((4, 4, 4), np.float32)
    corners[1, 1, 1] = corners[2, 2, 2] = 1.0
    of = volviz.Volume(corners)
    classic = image(of, camera(of), isovalue=0.2, method="lorensen")
    joined = image(of, camera(of), isovalue=0.2, method="topological")
    assert (classic[..., 3] > 0).mean() > 0.02
    assert np.abs(classic - joined).max() > 0.1


def test_larger_volumes_are_drawn_in_blocks_without_a_seam() -> None:
    of = volviz.Volume(np.random.default_rng(4).random((33, 33, 33), np.float32))
    view = camera(of)
    from volviz.custom_gl.mesh_drawing import blocks

    faces = volviz.marching_cubes(of.array, 0.5)[1]
    assert len(faces) > 2 * blocks.BLOCK
    theirs, their_depth = in_vtk(of, view, mesh=volviz.extract_isosurface(of, 0.5))
    _, our_depth = in_vtk(of, view, technique="marching_cubes", isovalue=0.5)
    assert theirs.max() > 0.3
    assert ((our_depth < 1) != (their_depth < 1)).sum() <= 3
    assert np.mean(np.abs(our_depth - their_depth) < 1e-5) > 0.995


def test_the_light_of_the_function_is_not_needed() -> None:
    of = volume(np.float32)
    one = image(of, camera(of), isovalue=0.4)
    other = image(
        of, camera(of), isovalue=0.4, transfer_function=function(of, [(0, (1, 0, 0, 1)), (1, (1, 0, 0, 1))])
    )
    assert np.array_equal(one, other)
