"""Our meshes against those of vtkMarchingCubes and vtkFlyingEdges3D, and known counts of real volumes."""

from __future__ import annotations

import gzip

import numpy as np
import pytest
from scipy.spatial import cKDTree

from volviz import Volume
from volviz.compare.vtk_contours import VTK_METHODS, vtk_contour
from volviz.kernels.marching import marching_cubes
from volviz.kernels.marching.cube import CUBE_EDGES, boundary_loops
from volviz.kernels.mesh_metrics import mesh_metrics

from .meshes import DTYPES, noise


def assert_same_vertices(ours, theirs, size):
    """The same set of points to 1e-5 voxel or 2 ulp."""
    assert (len(ours) == 0) == (len(theirs) == 0)
    if not len(ours):
        return
    allowed = max(1e-5, 2 * np.spacing(np.float32(size)))
    assert cKDTree(theirs).query(ours)[0].max() <= allowed * np.sqrt(3)
    assert cKDTree(ours).query(theirs)[0].max() <= allowed * np.sqrt(3)


#: Flying Edges subtracts 32 and 64-bit unsigned values without a sign, which misplaces vertices where values
#: fall.
WRONG_IN_VTK = {("vtkFlyingEdges3D", np.uint32), ("vtkFlyingEdges3D", np.uint64)}


@pytest.mark.parametrize(
    ("method", "dtype"), [(m, d) for m in VTK_METHODS for d in DTYPES if (m, d) not in WRONG_IN_VTK]
)
def test_random_fields_of_every_type_have_the_vertices_of_vtk(method, dtype):
    rng = np.random.default_rng(11)
    for trial in range(6):
        shape = tuple(rng.integers(2, 20, 3))
        array = noise(shape, dtype, seed=trial)
        for isovalue in (40.3, float(array.flat[0])):
            ours, _, _ = marching_cubes(array, isovalue)
            theirs, _ = vtk_contour(Volume(array), isovalue, method)
            assert_same_vertices(ours, theirs, max(shape))


@pytest.mark.parametrize("dtype", [np.uint32, np.uint64])
def test_flying_edges_misplaces_vertices_of_large_unsigned_types_and_we_do_not(dtype):
    array = noise((12, 12, 12), dtype)
    signed, _ = vtk_contour(Volume(array.astype(np.int64)), 40.3, "vtkFlyingEdges3D")
    ours, _, _ = marching_cubes(array, 40.3)
    assert_same_vertices(ours, signed, 12)
    theirs, _ = vtk_contour(Volume(array), 40.3, "vtkFlyingEdges3D")
    assert cKDTree(ours).query(theirs)[0].max() > 0.1


@pytest.mark.parametrize("method", VTK_METHODS)
def test_all_256_cases_have_the_vertices_and_the_polygons_of_vtk(method):
    middles = {tuple(edge.middle): number for number, edge in enumerate(CUBE_EDGES)}
    for case in range(256):
        array = np.array([case >> c & 1 for c in range(8)], np.float32).reshape(2, 2, 2)
        ours, faces, _ = marching_cubes(array, 0.5)
        points, triangles = vtk_contour(Volume(array), 0.5, method)
        assert_same_vertices(ours, points, 2)
        assert len(faces) == len(triangles)
        numbers = np.array([middles[tuple(map(float, p))] for p in points], int)
        sides = [(numbers[t[i]], numbers[t[(i + 1) % 3]]) for t in triangles for i in range(3)]
        rim = {side for side in sides if side[::-1] not in sides}
        assert rim == {
            (a, b) for loop in boundary_loops(case) for a, b in zip(loop, (*loop[1:], loop[0]), strict=True)
        }


def test_normals_are_those_of_flying_edges():
    array = noise((20, 21, 22), np.float32)
    ours, _, normals = marching_cubes(array, 40.3)
    theirs, _, other = vtk_contour(Volume(array), 40.3, "vtkFlyingEdges3D", with_normals=True)
    distance, nearest = cKDTree(theirs).query(ours)
    assert distance.max() < 1e-4
    # Where the interpolated gradient nearly vanishes, rounding decides on its direction.
    clear = np.linalg.norm(normals - other[nearest], axis=1)
    assert np.quantile(clear, 0.999) < 2e-5


def test_anisotropic_oblique_volumes_lie_where_vtk_puts_them():
    array = noise((8, 9, 10), np.int16)
    angle = np.deg2rad(25)
    direction = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    volume = Volume(array, (0.5, 1.5, 3.0), (10.0, -20.0, 30.0), direction)
    ours, _, _ = marching_cubes(
        array, 40.3, spacing=volume.spacing, origin=volume.origin, direction=volume.direction
    )
    for method in VTK_METHODS:
        assert_same_vertices(ours, vtk_contour(volume, 40.3, method)[0], 64)


def test_smooth_fields_have_the_area_and_volume_of_vtk():
    z, y, x = np.mgrid[0:40, 0:41, 0:42].astype(np.float32) / 40 - 0.5
    field = 0.4031 - np.sqrt(x * x + y * y + z * z)
    vertices, faces, _ = marching_cubes(field, 0.0)
    ours = mesh_metrics(vertices, faces)
    theirs = mesh_metrics(*vtk_contour(Volume(field), 0.0, "vtkMarchingCubes"))
    assert ours.faces == theirs.faces
    assert ours.area == pytest.approx(theirs.area, rel=1e-4)
    assert ours.volume == pytest.approx(theirs.volume, rel=1e-4)
    assert ours.euler_characteristic == theirs.euler_characteristic == 2


def test_the_buckyball_has_the_published_number_of_triangles(shared_data):
    """32^3 cells, padded by repeating the edge, isovalue 51, a corner marked when its value is below 51."""
    array = np.fromfile(shared_data / "marching" / "Bucky.raw", np.uint8).reshape(32, 32, 32)
    padded = np.pad(array, ((0, 1), (0, 1), (0, 1)), mode="edge")
    # Below 51 counts as inside there; 255 - value is inside at 255 - 50.5 and above.
    faces = marching_cubes(255 - padded, 255 - 50.5)[1]
    assert len(faces) == 14508


@pytest.mark.parametrize(
    ("name", "shape", "isovalue"),
    [("engine.nii.gz", (128, 256, 256), 80), ("bonsai.nii.gz", (256, 256, 256), 40)],
)
def test_real_volumes_have_the_vertices_of_vtk(shared_data, name, shape, isovalue):
    raw = gzip.decompress((shared_data / name).read_bytes())
    array = np.frombuffer(raw[-int(np.prod(shape)) :], np.uint8).reshape(shape)[20:90, 60:190, 60:190]
    for value in (isovalue, isovalue + 0.5):
        ours, faces, _ = marching_cubes(array, value)
        assert len(faces) > 10_000
        for method in VTK_METHODS:
            assert_same_vertices(ours, vtk_contour(Volume(array), value, method)[0], 256)
