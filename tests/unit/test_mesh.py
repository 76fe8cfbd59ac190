"""Isosurfaces as PolyData, and their way to files that other libraries read."""

from __future__ import annotations

import os
import sys

import numpy as np
import pytest

from volviz import Volume
from volviz.cli import main
from volviz.errors import Cancelled, InputError, VolvizError
from volviz.kernels.marching import marching_cubes
from volviz.kernels.mesh_metrics import mesh_metrics
from volviz.meshes.files import MESH_FORMATS, save_mesh
from volviz.meshes.polydata import extract_isosurface, mesh_area_volume, polydata, triangle_arrays

METHODS = ("lorensen", "topological", "tetrahedra")


def ball(n=24, **geometry):
    """Volume whose isovalue 0 is a sphere of radius 0.35 of its width, moved off the centre."""
    z, y, x = np.mgrid[0:n, 0:n, 0:n].astype(np.float32) / (n - 1) - 0.5
    return Volume(0.3512 - np.sqrt((x - 0.05) ** 2 + y * y + z * z), **geometry)


@pytest.fixture
def volume():
    angle = np.deg2rad(20)
    direction = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, -1]])
    return ball(spacing=(0.5, 1.0, 2.0), origin=(-10.0, 20.0, 30.0), direction=direction)


@pytest.mark.parametrize("method", METHODS)
def test_the_mesh_lies_in_the_world_and_faces_outward(volume, method):
    mesh = extract_isosurface(volume, 0.0, method=method)
    wanted, faces, normals = marching_cubes(
        volume.array,
        0.0,
        method=method,
        spacing=volume.spacing,
        origin=volume.origin,
        direction=volume.direction,
    )
    vertices, triangles = triangle_arrays(mesh)
    assert np.array_equal(vertices, wanted)
    assert np.array_equal(triangles, faces)
    assert np.array_equal(mesh.point_normals, normals)
    area, content = mesh_area_volume(mesh)
    voxel = np.prod(volume.spacing)
    assert content == pytest.approx(4 / 3 * np.pi * (0.3512 * 23) ** 3 * voxel, rel=0.02)
    assert area == pytest.approx(mesh.area, rel=1e-6)
    assert mesh.field_data["isovalue"][0] == 0.0
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    assert (low >= np.array(volume.bounds[::2])).all()
    assert (high <= np.array(volume.bounds[1::2])).all()


def test_arrays_are_shared_with_vtk_and_not_copied():
    vertices, faces, normals = marching_cubes(ball().array, 0.0)
    mesh = polydata(vertices, faces, normals)
    assert np.shares_memory(mesh.points, vertices)
    assert np.shares_memory(mesh.regular_faces, faces)
    assert np.shares_memory(mesh.point_normals, normals)
    assert mesh.n_cells == len(faces)


def test_an_isovalue_out_of_range_gives_an_empty_polydata(volume):
    mesh = extract_isosurface(volume, 99.0)
    assert mesh.n_cells == mesh.n_points == 0
    assert mesh_area_volume(mesh) == (0.0, 0.0)
    assert triangle_arrays(mesh)[1].shape == (0, 3)


def test_flat_normals_are_cell_normals(volume):
    mesh = extract_isosurface(volume, 0.0, normals="flat")
    assert mesh.cell_normals.shape == (mesh.n_cells, 3)
    assert mesh.GetPointData().GetNormals() is None
    assert extract_isosurface(volume, 0.0, normals=None).GetPointData().GetNormals() is None


def test_keywords_reach_the_kernel(volume):
    whole = extract_isosurface(volume, 0.0)
    assert extract_isosurface(volume, 0.0, stride=2).n_cells < whole.n_cells / 2
    assert extract_isosurface(volume, 0.0, bounds=(0, 11, 0, 23, 0, 23)).n_cells < whole.n_cells
    mask = np.zeros(volume.array.shape, bool)
    mask[:12] = True
    assert 0 < extract_isosurface(volume, 0.0, mask=mask).n_cells < whole.n_cells
    assert extract_isosurface(volume, 0.0, clean=True).n_cells <= whole.n_cells
    seen = []
    extract_isosurface(volume, 0.0, progress=seen.append)
    assert seen[-1] == 1.0
    with pytest.raises(Cancelled):
        extract_isosurface(volume, 0.0, cancel=lambda: True)


def test_small_parts_are_dropped():
    array = np.array(ball().array)
    array[1, 1, 1] = 1.0
    speckled = Volume(array)
    assert mesh_metrics(*triangle_arrays(extract_isosurface(speckled, 0.0))).components == 2
    for keywords in ({"largest_part": True}, {"min_triangles": 9}):
        mesh = extract_isosurface(speckled, 0.0, **keywords)
        assert mesh_metrics(*triangle_arrays(mesh)).components == 1
        assert mesh.point_normals.shape == (mesh.n_points, 3)


def test_smoothing_keeps_the_volume_and_the_triangles_of_a_rough_ball(volume):
    rough = Volume((volume.array > 0).astype(np.uint8), spacing=volume.spacing)
    plain = extract_isosurface(rough, 0.5)
    smooth = extract_isosurface(rough, 0.5, smooth=20)
    assert smooth.n_cells == plain.n_cells
    assert mesh_area_volume(smooth)[0] < 0.97 * mesh_area_volume(plain)[0]
    assert mesh_area_volume(smooth)[1] == pytest.approx(mesh_area_volume(plain)[1], rel=0.03)


def test_decimation_removes_the_wanted_share_and_normals_stay_outward(volume):
    plain = extract_isosurface(volume, 0.0)
    mesh = extract_isosurface(volume, 0.0, decimate=0.7)
    assert mesh.n_cells == pytest.approx(0.3 * plain.n_cells, rel=0.05)
    area, content = mesh_area_volume(mesh)
    assert content == pytest.approx(mesh_area_volume(plain)[1], rel=0.02)
    assert area > 0
    middle = mesh.points.mean(axis=0)
    assert (np.einsum("ij,ij->i", mesh.points - middle, mesh.point_normals) > 0).mean() > 0.98


@pytest.mark.parametrize("bounds", [None, (0, 1, 0, 1, 0, 1)], ids=["closed", "one triangle"])
@pytest.mark.parametrize("normals", ["gradient", "flat"])
def test_of_the_smallest_mesh_decimation_leaves_something(bounds, normals):
    array = np.zeros((3, 3, 3))
    array[1, 1, 1] = 1.0
    mesh = extract_isosurface(Volume(array), 0.5, decimate=0.99, bounds=bounds, normals=normals)
    assert mesh.n_cells == (4 if bounds is None else 1)
    assert mesh_area_volume(mesh)[0] > 0


@pytest.mark.parametrize(
    "keywords",
    [{"smooth": -1}, {"decimate": 1.0}, {"decimate": -0.1}, {"method": "best"}, {"min_triangles": -1}],
)
def test_wrong_arguments_are_refused(volume, keywords):
    with pytest.raises(InputError, match=next(iter(keywords))):
        extract_isosurface(volume, 0.0, **keywords)


@pytest.mark.parametrize("ending", MESH_FORMATS)
def test_a_written_file_is_read_back_by_another_library(volume, tmp_path, ending):
    mesh = extract_isosurface(volume, 0.0)
    path = tmp_path / f"ball{ending}"
    save_mesh(mesh, path)
    vertices, faces = _read(path)
    wanted, triangles = triangle_arrays(mesh)
    assert faces.shape == triangles.shape
    # Formats may renumber vertices: the triangles are compared as positions, in their orientation.
    assert np.allclose(_sorted(vertices[faces]), _sorted(wanted[triangles]), atol=2e-5)
    assert mesh_metrics(vertices, faces).volume == pytest.approx(mesh_area_volume(mesh)[1], rel=1e-5)


@pytest.mark.parametrize("ending", [".stl", ".ply", ".obj", ".vtp"])
def test_a_second_library_reads_the_same_triangles(volume, tmp_path, ending):
    mesh = extract_isosurface(volume, 0.0, stride=3)
    path = tmp_path / f"ball{ending}"
    save_mesh(mesh, path)
    if ending == ".vtp":
        # an XML file of VTK's: its header names all that is in it
        head = path.read_bytes()[:2000]
        assert f'NumberOfPolys="{mesh.n_cells}"'.encode() in head
        return
    meshio = pytest.importorskip("meshio")
    # meshio tells the type of a file on the terminal in some versions; only what it returns counts
    found = meshio.read(path)
    triangles = np.concatenate([block.data for block in found.cells if block.type == "triangle"])
    wanted, faces = triangle_arrays(mesh)
    assert np.allclose(_sorted(found.points[triangles]), _sorted(wanted[faces]), atol=2e-5)


def test_binary_gltf_is_one_file_and_smaller_than_text(volume, tmp_path):
    mesh = extract_isosurface(volume, 0.0)
    for ending in (".gltf", ".glb"):
        save_mesh(mesh, tmp_path / f"ball{ending}")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["ball.glb", "ball.gltf"]
    assert (tmp_path / "ball.glb").read_bytes()[:4] == b"glTF"
    assert (tmp_path / "ball.glb").stat().st_size < 0.8 * (tmp_path / "ball.gltf").stat().st_size


def test_a_left_handed_volume_is_written_facing_outward(tmp_path):
    mirrored = ball(16, spacing=(1.0, 2.0, 3.0), direction=np.diag([1.0, 1.0, -1.0]))
    for ending in MESH_FORMATS:
        path = tmp_path / f"ball{ending}"
        save_mesh(extract_isosurface(mirrored, 0.0), path)
        vertices, faces = _read(path)
        assert mesh_metrics(vertices, faces).volume > 0, ending
        assert vertices[:, 2].max() < 0, ending


def test_a_cancelled_file_leaves_the_old_one(volume, tmp_path):
    mesh = extract_isosurface(volume, 0.0)
    for ending in MESH_FORMATS:
        path = tmp_path / f"ball{ending}"
        path.write_bytes(b"precious")
        with pytest.raises(Cancelled):
            save_mesh(mesh, path, cancel=lambda: True)
        assert path.read_bytes() == b"precious"
    assert len(list(tmp_path.iterdir())) == len(MESH_FORMATS), "parts of files were left behind"


def test_an_existing_file_is_protected_on_request(volume, tmp_path):
    mesh = extract_isosurface(volume, 0.0)
    path = tmp_path / "ball.ply"
    path.write_bytes(b"precious")
    with pytest.raises(InputError, match="exists already"):
        save_mesh(mesh, path, overwrite=False)
    assert path.read_bytes() == b"precious"
    path.write_bytes(b"")
    save_mesh(mesh, path, overwrite=False)
    assert path.stat().st_size > 1000


def test_writing_tells_how_far_it_is(volume, tmp_path):
    seen = []
    save_mesh(extract_isosurface(volume, 0.0), tmp_path / "ball.vtp", progress=seen.append)
    assert seen[-1] == 1.0
    assert seen == sorted(seen)


def test_the_command_line_keeps_what_is_there_unless_told(volume, tmp_path, capsys):
    source, target = tmp_path / "ball.npy", tmp_path / "ball.glb"
    np.save(source, volume.array)
    target.write_bytes(b"precious")
    command = ["isosurface", str(source), "--isovalue", "0", "-o", str(target)]
    assert main(command) == 2
    assert "exists already" in capsys.readouterr().err
    assert target.read_bytes() == b"precious"
    assert main([*command, "--overwrite", "--largest-part", "--decimate", "0.5"]) == 0
    assert "triangles" in capsys.readouterr().out
    vertices, faces = _read(target)
    assert mesh_metrics(vertices, faces).volume > 0


def _read(path):
    if path.suffix == ".vtp":
        import pyvista

        mesh = pyvista.read(path)
        return np.asarray(mesh.points, float), np.asarray(mesh.regular_faces)
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.load(path, force="mesh", process=False)
    return np.asarray(mesh.vertices, float), np.asarray(mesh.faces)


def _sorted(triangles):
    """Each triangle turned to begin with its lowest corner, all in lexical order."""
    rounded = np.round(np.asarray(triangles, float), 4)
    turned = []
    for triangle in rounded.tolist():
        first = triangle.index(min(triangle))
        turned.append(triangle[first:] + triangle[:first])
    return np.array(sorted(turned))


def test_an_existing_file_is_replaced(volume, tmp_path):
    path = tmp_path / "ball.stl"
    path.write_bytes(b"x" * 10)
    save_mesh(extract_isosurface(volume, 0.0), path)
    assert path.stat().st_size > 1000


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere names are always text")
@pytest.mark.parametrize("ending", MESH_FORMATS)
def test_a_name_that_is_no_text_is_written(volume, tmp_path, ending):
    path = tmp_path / os.fsdecode(b"\xe9" + ending.encode())
    save_mesh(extract_isosurface(volume, 0.0), path)
    assert path.stat().st_size > 1000


def test_files_that_cannot_be_written_are_told_in_one_sentence(volume, tmp_path):
    mesh = extract_isosurface(volume, 0.0)
    with pytest.raises(InputError, match=r"\.stl"):
        save_mesh(mesh, tmp_path / "ball.step")
    with pytest.raises(VolvizError, match="does not exist"):
        save_mesh(mesh, tmp_path / "nowhere" / "ball.stl")
    with pytest.raises(InputError, match="empty"):
        save_mesh(extract_isosurface(volume, 99.0), tmp_path / "ball.stl")
    assert not (tmp_path / "ball.stl").exists()


def test_meshes_of_other_cells_are_refused():
    import pyvista

    quad = pyvista.PolyData(np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float), [4, 0, 1, 2, 3])
    with pytest.raises(InputError, match="triangulate"):
        mesh_area_volume(quad)
