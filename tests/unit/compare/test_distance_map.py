"""Distance of one surface to another: against VTK's own, against closed forms, its sign and its end."""

from __future__ import annotations

import numpy as np
import pytest

from volviz.compare.distance_map import distance_map, distance_maps
from volviz.compare.surface_distance import surface_distance
from volviz.errors import Cancelled, InputError
from volviz.kernels.marching import marching_cubes

Mesh = tuple[np.ndarray, np.ndarray]
TETRAHEDRON = (
    np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float),
    np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]),
)


def lumps(seed: int, method: str = "lorensen") -> Mesh:
    """A closed surface with several parts, in an anisotropic lattice."""
    array = np.pad(np.random.default_rng(seed).random((9, 10, 11)), 1)
    return marching_cubes(array, 0.55, method=method, spacing=(0.5, 1.0, 2.0), origin=(100.0, -3.0, 5.0))[:2]


def sphere(radius: float) -> Mesh:
    axis = np.linspace(-1, 1, 40)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    step = (axis[1] - axis[0],) * 3
    return marching_cubes(radius - np.sqrt(x * x + y * y + z * z), 0.0, spacing=step, origin=(-1, -1, -1))[:2]


def vtk_distances(points: np.ndarray, mesh: Mesh) -> np.ndarray:
    """Signed distances by vtkImplicitPolyDataDistance."""
    from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance

    from volviz.meshes.polydata import polydata

    implicit = vtkImplicitPolyDataDistance()
    implicit.SetInput(polydata(mesh[0].astype(float), mesh[1]))
    return np.array([implicit.EvaluateFunction(*p) for p in points])


def middles(mesh: Mesh) -> np.ndarray:
    return mesh[0].astype(float)[mesh[1]].mean(axis=1)


def test_signed_distances_are_those_of_vtk():
    mesh, other = sphere(0.55), lumps(1)
    mesh = (mesh[0] * 4 + np.array([102.0, 1.0, 14.0]), mesh[1])
    found = distance_map(mesh, other)
    assert found.is_signed
    assert (found.at_vertices > 0).any()
    assert (found.at_vertices < 0).any()
    chosen = slice(None, None, 7)
    assert found.at_vertices[chosen] == pytest.approx(vtk_distances(mesh[0][chosen], other), abs=2e-5)
    assert found.at_middles[chosen] == pytest.approx(vtk_distances(middles(mesh)[chosen], other), abs=2e-5)


def test_of_two_concentric_spheres_the_larger_one_lies_outside():
    small, large = sphere(0.5), sphere(0.8)
    outward, inward = distance_maps(large, small)
    assert outward.at_vertices == pytest.approx(0.3, abs=3e-3)
    assert inward.at_middles == pytest.approx(-0.3, abs=3e-3)
    assert outward.maximum == pytest.approx(0.3, abs=3e-3)
    assert inward.mean == pytest.approx(0.3, abs=2e-3)


def test_the_figures_are_those_of_the_distance_of_both_surfaces():
    first, second = lumps(2), lumps(2, "tetrahedra")
    maps = distance_maps(first, second)
    metrics = surface_distance(first, second)
    assert (maps[0].maximum, maps[1].maximum) == pytest.approx((metrics.forward, metrics.backward), abs=1e-6)
    assert (maps[0].mean, maps[1].mean) == pytest.approx(
        (metrics.forward_mean, metrics.backward_mean), abs=1e-6
    )
    assert (maps[0].rms, maps[1].rms) == pytest.approx((metrics.forward_rms, metrics.backward_rms), abs=1e-6)


def test_middles_tell_of_a_surface_through_the_same_vertices():
    # every vertex of marching cubes is one of marching tetrahedra too
    cubes, tetrahedra = lumps(2), lumps(2, "tetrahedra")
    found = distance_map(cubes, tetrahedra, signed=False)
    assert np.abs(found.at_vertices).max() < 1e-6
    assert found.at_middles.max() > 0.05


@pytest.mark.parametrize(
    ("point", "distance"),
    [
        ((0.2, 0.2, -0.5), 0.5),
        ((0.2, 0.2, 0.1), -0.1),
        ((-0.3, 0.5, -0.4), 0.5),
        ((-1.0, -2.0, -2.0), 3.0),
        ((3.0, 0.0, 0.0), 2.0),
    ],
)
def test_beside_faces_edges_and_corners_the_sign_is_that_of_the_inside(point, distance):
    speck = (np.array(point) + 1e-9 * TETRAHEDRON[0], TETRAHEDRON[1])
    assert distance_map(speck, TETRAHEDRON).at_vertices[0] == pytest.approx(distance, abs=1e-6)


def test_vertices_of_triangles_that_are_not_joined_do_not_spoil_the_sign():
    loose = (TETRAHEDRON[0][TETRAHEDRON[1]].reshape(-1, 3), np.arange(12).reshape(-1, 3))
    points = np.random.default_rng(0).uniform(-1, 2, (200, 3))
    mesh = (points, np.arange(198).reshape(-1, 3))
    assert np.array_equal(distance_map(mesh, loose).at_vertices, distance_map(mesh, TETRAHEDRON).at_vertices)


def test_without_an_agreed_outside_there_is_no_sign_on_either_side():
    turned = TETRAHEDRON[1].copy()
    turned[0] = turned[0, ::-1]
    strange = (TETRAHEDRON[0], turned)
    inside = (0.2 + 0.1 * TETRAHEDRON[0], TETRAHEDRON[1])
    assert not distance_map(inside, strange).is_signed
    assert distance_map(strange, inside).is_signed
    maps = distance_maps(strange, inside)
    assert not any(each.is_signed for each in maps)
    assert all((each.at_vertices >= 0).all() for each in maps)


def test_progress_rises_to_the_end_and_a_cancelled_map_raises():
    first, second = lumps(2), lumps(3)
    told: list[float] = []
    distance_maps(first, second, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0
    with pytest.raises(Cancelled):
        distance_maps(first, second, cancel=lambda: len(told) > 0)


def test_a_mesh_without_triangles_has_no_distance():
    with pytest.raises(InputError, match="without triangles"):
        distance_map(TETRAHEDRON, (np.empty((0, 3)), np.empty((0, 3), int)))
