"""Meshes of volumes far from the world's origin, in geographic coordinates say, keep their shape and their place."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import volviz
from volviz.kernels.mesh_metrics import enclosed_volume
from volviz.meshes.files import save_mesh
from volviz.meshes.polydata import mesh_area_volume
from volviz.meshes.reading import read_triangles

FAR = (5e5, 5.4e6, 100.0)


def ball(origin: tuple[float, float, float]) -> volviz.Volume:
    z, y, x = np.mgrid[-1:1:16j, -1:1:16j, -1:1:16j]
    return volviz.Volume((1 - np.sqrt(x * x + y * y + z * z)).astype(np.float32), (0.05,) * 3, origin)


@pytest.mark.parametrize("method", ["lorensen", "topological", "tetrahedra"])
def test_vertices_far_away_are_those_near_the_origin_moved(method: str) -> None:
    near, far = ball((0.0, 0.0, 0.0)), ball(FAR)
    v0, f0, n0 = volviz.marching_cubes(near.array, 0.3, spacing=near.spacing, method=method, clean=True)
    v1, f1, n1 = volviz.marching_cubes(
        far.array, 0.3, spacing=far.spacing, origin=far.origin, method=method, clean=True
    )
    assert v0.dtype == np.float32
    assert v1.dtype == np.float64
    assert np.array_equal(f0, f1)
    np.testing.assert_allclose(v1 - FAR, v0, atol=2e-9)
    np.testing.assert_allclose(n0, n1, atol=1e-5)


def test_filters_keep_it_too() -> None:
    volumes = [
        mesh_area_volume(volviz.extract_isosurface(ball(o), 0.3, smooth=10, decimate=0.4))[1]
        for o in ((0.0, 0.0, 0.0), FAR)
    ]
    assert volumes[1] == pytest.approx(volumes[0], rel=1e-4)


@pytest.mark.parametrize("ending", [".stl", ".ply", ".glb", ".obj", ".vtp"])
def test_files_keep_the_shape_and_say_where_they_moved_it(ending: str, tmp_path: Path) -> None:
    mesh = volviz.extract_isosurface(ball(FAR), 0.3)
    path = tmp_path / f"far{ending}"
    note = save_mesh(mesh, path)
    if ending == ".glb":
        assert "(500000, 5400000, 100)" in note
        return
    vertices, faces = read_triangles(str(path))[:2]
    assert enclosed_volume(vertices, faces) == pytest.approx(mesh_area_volume(mesh)[1], rel=1e-4)
    low = np.asarray(vertices).min(axis=0)
    if ending in (".obj", ".vtp"):
        assert not note
        np.testing.assert_allclose(low, mesh.points.min(axis=0), atol=1e-4)
    else:
        assert "(500000, 5400000, 100)" in note
        np.testing.assert_allclose(low + FAR, mesh.points.min(axis=0), atol=1e-4)
    assert not save_mesh(volviz.extract_isosurface(ball((0.0, 0.0, 0.0)), 0.3), path)
