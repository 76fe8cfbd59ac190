"""Isosurfaces block by block: bit for bit the mesh of the whole volume."""

from __future__ import annotations

import numpy as np
import pytest

from volviz.cli import main
from volviz.errors import InputError
from volviz.kernels.marching import marching_cubes
from volviz.kernels.mesh_metrics import mesh_metrics
from volviz.meshes.blocks import isosurface_by_blocks
from volviz.meshes.extraction import extract_triangles
from volviz.volume_data.array_source import ArraySource
from volviz.volume_data.volume import Volume

#: Far away, unevenly spaced and mirrored.
FAR = {"spacing": (0.5, 1.0, 2.0), "origin": (1e6, 20.0, 3.0), "direction": np.diag([1.0, 1.0, -1.0])}


def noise(dtype: object) -> np.ndarray:
    values = np.random.default_rng(1).normal(size=(21, 27, 37)) * 40 + 100
    return values.clip(0, 200).astype(dtype)


@pytest.mark.parametrize("method", ["lorensen", "topological", "tetrahedra"])
@pytest.mark.parametrize(
    ("dtype", "geometry"), [(np.uint8, {}), (np.float32, FAR), (np.int16, {}), (np.float64, {})]
)
def test_the_mesh_is_that_of_the_whole_bit_for_bit(method, dtype, geometry):
    values = noise(dtype)
    wanted = marching_cubes(values, 100.0, method=method, **geometry)
    found = isosurface_by_blocks(ArraySource(values, **geometry), 100.0, method, block=12)
    for one, other in zip(found, wanted, strict=True):
        assert one.dtype == other.dtype
        np.testing.assert_array_equal(one, other)


def test_a_ball_across_blocks_is_closed():
    z, y, x = np.ogrid[:40, :40, :40]
    ball = 15.3 - np.sqrt((x - 19.5) ** 2 + (y - 19.5) ** 2 + (z - 19.5) ** 2)
    vertices, faces, _ = isosurface_by_blocks(ArraySource(ball), 0.0, block=8)
    metrics = mesh_metrics(vertices, faces)
    assert metrics.boundary_edges == 0
    assert metrics.euler_characteristic == 2


def test_what_is_not_finite_counts_as_the_lowest_value_of_all_blocks():
    values = noise(np.float32)
    values[3:6, 4:9, 10:20] = np.nan
    values[15, 3, 30] = -np.inf
    wanted = extract_triangles(Volume(values), 100.0)
    found = isosurface_by_blocks(ArraySource(values), 100.0, block=10)
    for one, other in zip(found, wanted, strict=True):
        np.testing.assert_array_equal(one, other)


def test_nothing_is_found_outside_the_range_and_tiny_blocks_are_refused():
    assert len(isosurface_by_blocks(ArraySource(noise(np.uint8)), 250.0, block=16).faces) == 0
    with pytest.raises(InputError, match="at least 8 cells"):
        isosurface_by_blocks(ArraySource(noise(np.uint8)), 100.0, block=4)


def test_the_command_writes_the_same_file_by_blocks(tmp_path, monkeypatch):
    np.save(tmp_path / "noise.npy", noise(np.uint8))
    monkeypatch.chdir(tmp_path)
    assert main(["isosurface", "noise.npy", "--isovalue", "100", "-o", "whole.ply"]) == 0
    assert main(["isosurface", "noise.npy", "--isovalue", "100", "--blocks", "16", "-o", "blocks.ply"]) == 0
    assert (tmp_path / "whole.ply").read_bytes() == (tmp_path / "blocks.ply").read_bytes()
    refused = [
        "isosurface",
        "noise.npy",
        "--isovalue",
        "100",
        "--blocks",
        "16",
        "--smooth",
        "3",
        "-o",
        "x.ply",
    ]
    assert main(refused) == 2


def test_a_mask_that_hides_the_last_cells_writes_no_triangle_too_many():
    values = np.random.default_rng(2).integers(0, 200, (40, 40, 70)).astype(np.uint8)
    mask = np.zeros(values.shape, bool)
    mask[:, :, :9] = True
    found = marching_cubes(values, 100.0, mask=mask)
    wanted = marching_cubes(values, 100.0, bounds=(0, 8, 0, 39, 0, 39))
    np.testing.assert_array_equal(found[0], wanted[0])
    np.testing.assert_array_equal(found[1], wanted[1])
