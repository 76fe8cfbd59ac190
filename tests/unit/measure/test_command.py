"""``volviz measure``: the same numbers as in Python, as JSON and as a table."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import numpy as np
import pytest

import volviz
from volviz import measure
from volviz.cli import main
from volviz.volume_data.volume import Volume


@pytest.fixture(scope="module")
def volume() -> Volume:
    z, y, x = np.mgrid[:16, :16, :16].astype(np.float32)
    ball = 100 - 10 * np.sqrt((x - 8) ** 2 + (y - 7) ** 2 + (z - 8) ** 2)
    return Volume(ball.astype(np.float32), (0.5, 0.5, 1.0), (-10.0, 3.0, -4.0), np.diag([-1.0, 1.0, 1.0]))


@pytest.fixture(scope="module")
def path(volume: Volume, tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("measure") / "ball.nrrd"
    volviz.save(volume, path)
    return str(path)


def told(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(["measure", *arguments]) == 0
    return capsys.readouterr().out


def test_points_in_the_world_and_in_voxels_give_the_same(volume: Volume, path: str, capsys) -> None:
    world = json.loads(told(capsys, "distance", path, "(-11,5,-2)", "(-13,5,2)"))
    voxels = json.loads(told(capsys, "distance", path, "(2,4,2)", "(6,4,6)", "--voxels"))
    assert world == voxels
    expected = measure.distance((-11, 5, -2), (-13, 5, 2), volume)
    assert world[0]["values"]["Distance"] == expected.to_dict()
    rows = list(csv.DictReader(io.StringIO(told(
        capsys, "polygon", path, "(-11,4,4)", "(-14,4,4)", "(-14,8,4)", "(-11,8,4)", "--format", "csv"
    ))))  # fmt: skip
    assert [row["quantity"] for row in rows][:3] == ["Area", "Perimeter", "Mean in ball"]
    assert float(rows[0]["value"]) == pytest.approx(12.0)


def test_volumes_and_profiles_are_those_of_the_library(
    volume: Volume, path: str, tmp_path: Path, capsys
) -> None:
    found = json.loads(told(capsys, "isosurface", path, "--isovalue", "50"))["Volume"]
    assert found["value"] == pytest.approx(measure.isosurface_volume(volume, 50.0).value)
    table = tmp_path / "line.csv"
    assert told(capsys, "profile", path, "(-11,5,-2)", "(-13,5,2)", "-o", str(table)) == ""
    assert table.read_text() == measure.profile((-11, 5, -2), (-13, 5, 2), volviz.load(path)).to_csv()
    threshold = told(capsys, "threshold", path, "--low", "50", "--crop", "0,8,0,15,0,15", "--format", "csv")
    assert float(threshold.splitlines()[1].split(",")[1]) == pytest.approx(
        measure.threshold_volume(volume, 50.0, crop=(0, 8, 0, 15, 0, 15)).value
    )


def test_what_is_no_point_is_said(path: str, capsys) -> None:
    assert main(["measure", "angle", path, "(1,2,3)", "(1,2)", "(3,4,5)"]) == 2
    assert "points are written as (X,Y,Z)" in capsys.readouterr().err
    assert main(["measure", "angle", path, "(1,2,3)", "(1,2,4)"]) == 2
    assert "angle has 3 points, got 2" in capsys.readouterr().err
