"""`volviz bench`: what is measured, what is written, Ctrl+C."""

from __future__ import annotations

import csv
import json
import signal
from pathlib import Path

import numpy as np
import pytest

import volviz
from tests.render.scenes import POINTS, blobs
from volviz.cli import main
from volviz.commands.progress import ProgressLine
from volviz.compare.bench import BenchRun, resampled
from volviz.errors import InputError

WORDS = ["--sizes", "16", "--windows", "40x30", "--frames", "2"]


@pytest.fixture
def volume_file(tmp_path: Path) -> Path:
    path = tmp_path / "small.npy"
    np.save(path, blobs((17, 18, 19)))
    return path


def test_every_case_is_measured_and_written(
    volume_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "bench.json"
    words = ["--techniques", "raycast,slicing,splatting", "--steps", "1,2", *WORDS, "-o", str(output)]
    assert main(["bench", str(volume_file), *words]) == 0
    data = json.loads(output.read_text(encoding="utf-8"))
    assert data["complete"]
    found = [(r["technique"], r["step"]) for r in data["results"]]
    # splatting has no step to be varied
    assert found == [("raycast", 1), ("slicing", 1), ("splatting", 1), ("raycast", 2), ("slicing", 2)]
    assert all(len(r["frames"]) == 2 and r["first"] > 0 for r in data["results"])
    assert all(r["median"] == pytest.approx(np.median(r["frames"])) for r in data["results"])
    assert {(r["technique"], r["base"]) for r in data["ratios"]} == {
        ("slicing", "raycast"),
        ("splatting", "raycast"),
    }
    assert data["results"][0]["dimensions"] == [16, 15, 14]
    assert data["machine"]["graphics"]
    assert str(tmp_path) not in output.read_text(encoding="utf-8")
    told = capsys.readouterr()
    assert "16 x 15 x 14 voxels, 40 x 30 pixels, step 2" in told.out
    assert "x raycast" in told.out
    # no bar where nobody looks
    assert told.err == ""


def test_the_table_of_a_benchmark_can_be_read_as_csv(volume_file: Path, tmp_path: Path) -> None:
    output = tmp_path / "bench.csv"
    words = ["--techniques", "raycast,isosurface", "--steps", "1", *WORDS, "-o", str(output)]
    assert main(["bench", str(volume_file), *words]) == 0
    with output.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["technique"] for row in rows] == ["raycast", "isosurface"]
    assert float(rows[0]["median"]) > 0
    assert rows[1]["ratios"].endswith(" raycast")


def test_ctrl_c_keeps_what_has_been_measured(
    volume_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = tmp_path / "bench.json"
    shown: list[float] = []

    def press_after_some_frames(_line: ProgressLine, fraction: float, _words: str = "") -> None:
        shown.append(fraction)
        if len(shown) == 8:
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(ProgressLine, "show", press_after_some_frames)
    words = [
        "--techniques",
        "raycast",
        "--steps",
        "1,2",
        "--sizes",
        "16",
        "--windows",
        "40x30",
        "--frames",
        "4",
    ]
    # ignored where the tests run in the background of a shell
    before = signal.getsignal(signal.SIGINT)
    assert main(["bench", str(volume_file), *words, "-o", str(output)]) == 130
    data = json.loads(output.read_text(encoding="utf-8"))
    assert not data["complete"]
    assert [len(r["frames"]) for r in data["results"]] == [4]
    assert signal.getsignal(signal.SIGINT) is before


def test_a_resampled_volume_fills_the_same_box() -> None:
    z, y, x = np.mgrid[0:9, 0:11, 0:13].astype(np.float32)
    volume = volviz.Volume(x + 2 * y - z, spacing=(0.5, 1.0, 2.0), origin=(3.0, 4.0, 5.0))
    other = resampled(volume, 25)
    assert other.array.shape == (17, 21, 25)
    np.testing.assert_allclose(other.corners, volume.corners, atol=1e-6)
    # what is linear stays what it is
    k, j, i = np.mgrid[0:17, 0:21, 0:25]
    np.testing.assert_allclose(other.array, i * 12 / 24 + 2 * j * 10 / 20 - k * 8 / 16, atol=1e-5)
    assert resampled(volume, 13) is volume


def test_a_bar_is_drawn_on_a_terminal_only(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    import sys

    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with ProgressLine() as line:
        line.show(0.5, "half of it")
    drawn = capsys.readouterr().err
    assert "[############............]  50 % half of it" in drawn
    assert drawn.endswith("\x1b[K")


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (["--techniques", "nothing"], "nothing"),
        (["--techniques", ""], "technique"),
        (["--sizes", "5"], "sizes"),
        (["--sizes", "a"], "--sizes"),
        (["--windows", "10"], "--size"),
        (["--steps", "0"], "step"),
        (["--frames", "0"], "frame"),
        (["-o", "r.txt"], ".json"),
        (["-o", "no/folder.json"], "folder"),
    ],
)
def test_what_cannot_be_measured_is_refused_in_one_sentence(
    words: list[str], part: str, volume_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["bench", str(volume_file), *words]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert part in told


def test_a_benchmark_of_nothing_is_refused() -> None:
    volume = volviz.Volume(blobs((8, 8, 8)))
    with pytest.raises(InputError):
        BenchRun(volume, volviz.TransferFunction.from_points(POINTS), [], [16], [(40, 30)], [1.0])


def test_a_technique_that_is_too_slow_for_all_frames_says_so(
    volume_file: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("volviz.compare.bench.TECHNIQUE_SECONDS", 1e-9)
    assert main(["bench", str(volume_file), "--techniques", "raycast", "--steps", "1", *WORDS]) == 0
    assert capsys.readouterr().out.rstrip().endswith("1 of 2 frames")
