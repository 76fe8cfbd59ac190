"""Figures of meshes against trimesh and against shapes with known answers."""

from __future__ import annotations

import numpy as np
import pytest

from volviz.compare.surface_distance import distances_to_surface, surface_distance
from volviz.errors import InputError
from volviz.kernels.marching import marching_cubes
from volviz.kernels.mesh_metrics import (
    edge_uses,
    enclosed_volume,
    euler_characteristic,
    mesh_metrics,
    surface_area,
)

CUBE = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
CUBE_FACES = np.array(
    [
        [0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
        [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5],
    ]
)  # fmt: skip


@pytest.fixture(scope="module")
def blob():
    """A closed random mesh of several parts with handles."""
    array = np.pad(np.random.default_rng(4).random((18, 17, 16)), 1)
    vertices, faces, _ = marching_cubes(array, 0.55, spacing=(0.5, 1.0, 2.0), origin=(100.0, -3.0, 5.0))
    return vertices, faces


def test_a_cube_has_area_6_volume_1_and_characteristic_2():
    metrics = mesh_metrics(CUBE, CUBE_FACES)
    assert metrics.area == pytest.approx(6)
    assert metrics.volume == pytest.approx(1)
    assert (metrics.vertices, metrics.edges, metrics.faces) == (8, 18, 12)
    assert metrics.euler_characteristic == euler_characteristic(CUBE_FACES) == 2
    assert metrics.components == 1
    assert metrics.is_closed
    assert metrics.is_oriented


def test_turning_all_triangles_over_makes_the_volume_negative():
    assert enclosed_volume(CUBE, CUBE_FACES[:, ::-1]) == pytest.approx(-1)


def test_a_hole_shows_as_boundary_and_a_turned_triangle_as_inconsistent():
    metrics = mesh_metrics(CUBE, CUBE_FACES[1:])
    assert metrics.boundary_edges == 3
    assert not metrics.is_closed
    turned = CUBE_FACES.copy()
    turned[0] = turned[0, ::-1]
    metrics = mesh_metrics(CUBE, turned)
    assert metrics.inconsistent_edges == 3
    assert metrics.is_closed
    assert not metrics.is_oriented


def test_two_cubes_at_one_edge_have_a_non_manifold_edge():
    other = CUBE + np.array([1, 1, 0])
    vertices = np.concatenate([CUBE, other])
    faces = np.concatenate([CUBE_FACES, CUBE_FACES + 8])
    _, merged = np.unique(vertices, axis=0, return_inverse=True)
    metrics = mesh_metrics(np.unique(vertices, axis=0), merged.reshape(-1)[faces])
    assert metrics.non_manifold_edges == 1
    assert metrics.components == 1
    assert mesh_metrics(vertices, faces).components == 2


def test_unused_vertices_do_not_count():
    assert mesh_metrics(np.concatenate([CUBE, [[9, 9, 9]]]), CUBE_FACES).euler_characteristic == 2


def test_an_empty_mesh_has_zeros():
    metrics = mesh_metrics(np.empty((0, 3)), np.empty((0, 3), int))
    assert (metrics.area, metrics.volume, metrics.euler_characteristic, metrics.components) == (0, 0, 0, 0)
    assert metrics.is_closed


def test_edges_are_sorted_and_balanced():
    edges, uses, balance = edge_uses(CUBE_FACES)
    assert np.array_equal(edges, np.unique(edges, axis=0))
    assert (uses == 2).all()
    assert (balance == 0).all()


def test_figures_agree_with_trimesh(blob):
    trimesh = pytest.importorskip("trimesh")
    vertices, faces = blob
    other = trimesh.Trimesh(vertices, faces, process=False)
    metrics = mesh_metrics(vertices, faces)
    assert metrics.area == pytest.approx(other.area, rel=1e-9)
    assert metrics.volume == pytest.approx(other.volume, rel=1e-9)
    assert metrics.euler_characteristic == other.euler_number
    assert metrics.edges == len(other.edges_unique)
    assert metrics.is_closed == other.is_watertight
    assert metrics.is_oriented == other.is_winding_consistent
    assert metrics.components == len(trimesh.graph.connected_components(other.face_adjacency))


def test_distances_to_triangles_agree_with_trimesh(blob):
    trimesh = pytest.importorskip("trimesh")
    vertices, faces = blob
    rng = np.random.default_rng(2)
    points = rng.uniform(vertices.min(axis=0) - 3, vertices.max(axis=0) + 3, (400, 3))
    corners = vertices.astype(float)[faces]
    # Every point against every triangle, by trimesh's own distance to one triangle each.
    wanted = np.array(
        [
            np.linalg.norm(
                trimesh.triangles.closest_point(corners, np.broadcast_to(p, (len(corners), 3))) - p, axis=1
            ).min()
            for p in points
        ]
    )
    assert np.allclose(distances_to_surface(points, vertices, faces), wanted, atol=1e-9)


def test_the_distance_of_two_concentric_spheres_is_the_difference_of_their_radii():
    axis = np.linspace(-1, 1, 60)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    radius = np.sqrt(x * x + y * y + z * z)
    step = (axis[1] - axis[0],) * 3
    inner = marching_cubes(0.5 - radius, 0.0, spacing=step)[:2]
    outer = marching_cubes(0.8 - radius, 0.0, spacing=step)[:2]
    found = surface_distance(inner, outer)
    assert found.hausdorff == pytest.approx(0.3, abs=2e-3)
    assert found.mean == pytest.approx(0.3, abs=2e-3)
    assert max(found.forward, found.backward) == found.hausdorff


def test_a_mesh_has_no_distance_to_itself_and_an_outlier_shows_in_one_direction(blob):
    vertices, faces = blob
    assert surface_distance(blob, blob).hausdorff == pytest.approx(0, abs=1e-8)
    far = np.concatenate([vertices, [[200, 0, 0], [200, 1, 0], [201, 0, 0]]])
    more = np.concatenate([faces, [[len(vertices), len(vertices) + 1, len(vertices) + 2]]])
    found = surface_distance((far, more), blob)
    assert found.forward > 50
    assert found.backward == pytest.approx(0, abs=1e-8)


def test_fewer_samples_give_nearly_the_same_mean_distance(blob):
    vertices, faces = blob
    moved = (vertices + np.array([0.1, 0.0, 0.0]), faces)
    all_samples = surface_distance(blob, moved)
    fewer = surface_distance(blob, moved, max_samples=5000)
    assert fewer.hausdorff <= all_samples.hausdorff
    assert fewer.mean == pytest.approx(all_samples.mean, rel=0.05)


@pytest.mark.parametrize(
    ("vertices", "faces"),
    [
        (np.zeros((3, 2)), np.array([[0, 1, 2]])),
        (np.zeros((3, 3)), np.array([[0, 1]])),
        (np.zeros((3, 3)), np.array([[0.0, 1.0, 2.0]])),
        (np.zeros((3, 3)), np.array([[0, 1, 3]])),
        (np.zeros((3, 3)), np.array([[0, 1, -1]])),
    ],
)
def test_arrays_that_are_no_mesh_are_refused(vertices, faces):
    with pytest.raises(InputError):
        mesh_metrics(vertices, faces)
    with pytest.raises(InputError):
        surface_area(vertices, faces)


def test_an_empty_mesh_has_no_distance(blob):
    with pytest.raises(InputError, match="without triangles"):
        surface_distance(blob, (np.empty((0, 3)), np.empty((0, 3), int)))
