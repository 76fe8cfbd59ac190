"""Figures of `volviz compare` against other programs' on what `volviz render` and `volviz isosurface` write."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

from tests.render.scenes import blobs
from volviz.cli import main

VIEW = ["--preset", "grey-classic", "--azimuth", "25", "--elevation", "10", "--size", "96x72"]


@pytest.fixture
def volume_file(tmp_path: Path) -> str:
    path = tmp_path / "smooth.npy"
    np.save(path, blobs((21, 23, 25)))
    return str(path)


def compared(volume_file: str, tmp_path: Path, *words: str) -> dict[str, Any]:
    output = tmp_path / "report.json"
    assert main(["compare", volume_file, *words, "--frames", "0", "-o", str(output)]) == 0
    found: dict[str, Any] = json.loads(output.read_text(encoding="utf-8"))
    return found


def exported(volume_file: str, path: Path, *words: str) -> np.ndarray:
    assert main(["render", volume_file, *words, *VIEW, "--background", "black", "-o", str(path)]) == 0
    return np.asarray(Image.open(path).convert("RGB"))


def test_figures_of_pictures_are_those_of_scikit_image_on_the_exported_files(
    volume_file: str, tmp_path: Path
) -> None:
    first = exported(volume_file, tmp_path / "a.png", "-t", "raycast", "--set", "step=0.5")
    second = exported(volume_file, tmp_path / "b.png", "-t", "slicing", "--set", "step=2")
    data = compared(volume_file, tmp_path, "-t", "raycast:step=0.5", "-t", "slicing:step=2", *VIEW)
    (pair,) = data["pairs"]
    assert pair["psnr"] == pytest.approx(peak_signal_noise_ratio(first, second), rel=1e-9)
    assert pair["ssim"] == pytest.approx(structural_similarity(first, second, channel_axis=-1), rel=1e-9)
    difference = np.abs(first.astype(int) - second)
    assert difference.max() > 0
    assert pair["max_difference"] == pytest.approx(difference.max(), abs=1e-9)
    assert pair["mean_difference"] == pytest.approx(difference.mean())
    assert pair["visible_share"] == pytest.approx((difference.max(axis=-1) > 2).mean())


def test_a_picture_against_itself_has_no_difference_at_all(volume_file: str, tmp_path: Path) -> None:
    data = compared(volume_file, tmp_path, "-t", "raycast", "-t", "raycast", *VIEW)
    (pair,) = data["pairs"]
    assert (pair["psnr"], pair["ssim"], pair["max_difference"], pair["mean_difference"]) == (
        None,
        1.0,
        0.0,
        0.0,
    )
    assert pair["visible_share"] == 0.0
    assert pair["shift"] == [0.0, 0.0]


def test_figures_of_meshes_are_those_of_trimesh_on_the_exported_files(
    volume_file: str, tmp_path: Path
) -> None:
    isovalue = "90.5"
    data = compared(
        volume_file,
        tmp_path,
        "-t",
        "marching_cubes",
        "-t",
        "marching_tetrahedra",
        "--isovalue",
        isovalue,
        *VIEW,
    )
    for side, method in zip(data["sides"], ("lorensen", "tetrahedra"), strict=True):
        path = tmp_path / f"{method}.ply"
        words = ["--isovalue", isovalue, "--method", method, "-o", str(path)]
        assert main(["isosurface", volume_file, *words]) == 0
        theirs = trimesh.load(path)
        theirs.merge_vertices()
        theirs.update_faces(theirs.area_faces > 0)
        ours = side["mesh"]
        assert ours["area"] == pytest.approx(theirs.area, rel=1e-5)
        assert abs(ours["volume"]) == pytest.approx(abs(theirs.volume), rel=1e-5)
        assert ours["euler_characteristic"] == theirs.euler_number
        assert ours["faces"] == len(theirs.faces)
        assert ours["boundary_edges"] == len(
            trimesh.grouping.group_rows(theirs.edges_sorted, require_count=1)
        )
