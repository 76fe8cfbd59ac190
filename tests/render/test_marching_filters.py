"""Parts, smoothing and decimation of the meshes in an image: the triangles that `extract_isosurface` gives."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest

import volviz
from tests.render.scenes import LEFT_HANDED, OBLIQUE, Requests, blobs
from tests.render.test_marching_interaction import complete, shown
from volviz.custom_gl.mesh_drawing import MeshRequest, world_triangles
from volviz.errors import Cancelled
from volviz.kernels.marching import marching_cubes
from volviz.kernels.mesh_metrics import mesh_metrics
from volviz.meshes.filters import filter_triangles
from volviz.meshes.polydata import extract_isosurface, triangle_arrays


def speckled(**geometry: Any) -> volviz.Volume:
    """Two blobs of different size, and single voxels."""
    z, y, x = np.indices((30, 32, 36)).astype(np.float32)
    field = np.maximum(
        9.0 - np.sqrt((x - 12) ** 2 + (y - 15) ** 2 + (z - 14) ** 2),
        4.0 - np.sqrt((x - 29) ** 2 + (y - 15) ** 2 + (z - 14) ** 2),
    )
    for place in ((2, 2, 2), (26, 28, 33), (3, 28, 4)):
        field[place] = 1.0
    return volviz.Volume(field, **geometry)


GEOMETRIES = [
    {},
    {"spacing": (0.5, 1.0, 2.0), "origin": (1000.0, -2000.0, 500.0), "direction": OBLIQUE},
    {"spacing": (1.0, 2.0, 0.7), "direction": LEFT_HANDED},
]


@pytest.mark.parametrize("geometry", GEOMETRIES, ids=["plain", "oblique", "left-handed"])
@pytest.mark.parametrize(
    ("settings", "keywords"),
    [
        ({}, {}),
        ({"parts": "largest"}, {"largest_part": True}),
        ({"parts": "large", "part_triangles": 100}, {"min_triangles": 100}),
        ({"smoothing": 15}, {"smooth": 15}),
        ({"parts": "largest", "smoothing": 10, "decimation": 0.6},
         {"largest_part": True, "smooth": 10, "decimate": 0.6}),
    ],
    ids=["plain", "largest", "large", "smooth", "all"],
)  # fmt: skip
def test_the_picture_shows_the_mesh_that_would_be_exported(
    settings: dict[str, Any], keywords: dict[str, Any], geometry: dict[str, Any]
) -> None:
    of = speckled(**geometry)
    with shown(of, isovalue=0.3, **settings) as (_, handle):
        handle.raise_error()
        vertices, faces, normals = world_triangles(handle.mesh)
    wanted = extract_isosurface(of, 0.3, **keywords)
    points, triangles = triangle_arrays(wanted)
    found, expected = mesh_metrics(vertices, faces), mesh_metrics(points, triangles)
    assert found.components == expected.components
    assert found.is_closed
    assert found.is_oriented
    assert found.area == pytest.approx(expected.area, rel=1e-3)
    assert found.volume == pytest.approx(expected.volume, rel=1e-3)
    assert found.faces == pytest.approx(expected.faces, rel=2e-3)
    assert found.volume > 0
    if "decimation" not in settings:
        assert np.abs(vertices - points).max() < 1e-3
        assert (np.einsum("ij,ij->i", normals, np.asarray(wanted.point_normals)) > 0.999).all()


def test_parts_are_counted_by_their_triangles() -> None:
    of = speckled()
    count = {}
    for settings in ({}, {"parts": "large", "part_triangles": 9}, {"parts": "largest"}):
        with shown(of, isovalue=0.3, **settings) as (_, handle):
            vertices, faces, _ = world_triangles(handle.mesh)
            count[settings.get("parts")] = mesh_metrics(vertices, faces).components
    assert count == {None: 5, "large": 2, "largest": 1}


def test_a_filter_that_leaves_nothing_shows_an_empty_picture() -> None:
    with shown(speckled(), isovalue=0.3, parts="large", part_triangles=10_000_000) as (_, handle):
        handle.raise_error()
        assert handle.mesh.triangles == 0
        assert not handle.read_image().any()


def test_smoothing_makes_a_mask_rounder() -> None:
    z, y, x = np.indices((28, 28, 28)) - 13.5
    ball = volviz.Volume(((x**2 + y**2 + z**2) < 100).astype(np.uint8))
    spread = []
    for smoothing in (0, 30):
        with shown(ball, isovalue=0.5, smoothing=smoothing) as (_, handle):
            vertices, _faces, _ = world_triangles(handle.mesh)
        spread.append(np.linalg.norm(vertices - ball.center, axis=1).std())
    assert spread[1] < 0.6 * spread[0]


def test_the_work_of_the_filters_is_reported_and_can_be_cancelled() -> None:
    vertices, faces, _ = marching_cubes(blobs((40, 40, 40), np.float32), 0.4)
    seen: list[float] = []
    filter_triangles(vertices, faces, smoothing=10, decimation=0.5, progress=seen.append)
    assert seen == sorted(seen)
    assert len(seen) > 5
    assert seen[-1] == pytest.approx(1.0)
    asked: list[int] = []

    def enough() -> bool:
        asked.append(1)
        return len(asked) > 4

    with pytest.raises(Cancelled):
        filter_triangles(vertices, faces, decimation=0.9, cancel=enough)
    cancelled = threading.Event()
    cancelled.set()
    with pytest.raises(Cancelled):
        extract_isosurface(speckled(), 0.3, smooth=3, cancel=cancelled.is_set)


def test_progress_of_an_extraction_with_filters_covers_both() -> None:
    seen: list[float] = []
    extract_isosurface(speckled(), 0.3, smooth=5, decimate=0.5, progress=seen.append)
    assert seen == sorted(seen)
    assert 0 < seen[0] <= 0.2
    assert seen[-1] == pytest.approx(1.0)


def test_a_stand_in_is_filtered_as_a_coarse_mesh_can_be() -> None:
    of = speckled()
    request = MeshRequest(
        of, 0.3, "lorensen", 2, largest_part=True, min_triangles=800, smoothing=5, decimation=0.7
    )
    coarse = request.coarser(4)
    assert (coarse.stride, coarse.min_triangles) == (8, 50)
    assert (coarse.smoothing, coarse.decimation, coarse.largest_part) == (5, 0.0, True)
    assert request.coarser(1) == request


def test_a_filtered_mesh_comes_from_a_worker_that_tells_how_far_it_is() -> None:
    of = volviz.Volume(blobs((60, 60, 60), np.float32))
    with shown(of, Requests(), isovalue=0.4) as (window, handle):
        complete(window, handle)
        whole = handle.mesh
        seen: list[Any] = []
        handle.on_status.append(lambda status: seen.append(status.waiting))
        handle.update(decimation=0.8)
        complete(window, handle)
        assert handle.mesh is not whole
        assert handle.mesh.triangles == pytest.approx(0.2 * whole.triangles, rel=0.05)
    told = [fraction for fraction in seen if fraction is not None]
    assert told
    assert all(0.0 <= fraction <= 1.0 for fraction in told)
    assert seen[-1] is None
