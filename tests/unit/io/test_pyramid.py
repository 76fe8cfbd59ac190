"""`volviz pyramid`: several resolutions block by block, gone on with after a kill, the same bytes in any case."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import volviz
from volviz.cli import main
from volviz.errors import Cancelled, InputError
from volviz.io.writers import streamed_pyramid
from volviz.io.writers.streamed_pyramid import write_pyramid
from volviz.kernels.halving import halved, most_frequent
from volviz.volume_data.array_source import ArraySource


@pytest.fixture(autouse=True)
def small_blocks(monkeypatch):
    monkeypatch.setattr(streamed_pyramid, "BLOCK", 128)
    monkeypatch.setattr(streamed_pyramid, "BLOCK_ABOVE", 64)


def values() -> np.ndarray:
    z, y, x = np.ogrid[:70, :130, :270]
    return ((x * 3 + y * 5 + z * 7) % 251).astype(np.uint8)


class Counting(ArraySource):
    """Counts the boxes that are read."""

    def read_volume(self, request):
        self.boxes = [*getattr(self, "boxes", []), request.box]
        return super().read_volume(request)


def files(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def test_levels_are_means_of_the_whole_and_lie_where_they_belong(tmp_path):
    source = Counting(values(), spacing=(1.0, 2.0, 2.0), origin=(5.0, 0.0, 0.0))
    write_pyramid(source, tmp_path / "p.ome.zarr", workers=2)
    # the type is found in a corner, and nothing is read as a whole
    assert all(box is not None for box in source.boxes)
    written = volviz.open(tmp_path / "p.ome.zarr")
    # x first, whose voxels are half as long
    assert [level.dimensions for level in written.levels] == [(270, 130, 70), (135, 130, 70), (68, 65, 35)]
    assert written.levels[1].origin == (5.5, 0.0, 0.0)
    expected = values()
    np.testing.assert_array_equal(written.read(0).array, expected)
    for level, step in ((1, (1, 1, 2)), (2, (2, 2, 2))):
        expected = halved(expected, step, is_labels=False)
        np.testing.assert_array_equal(written.read(level).array, expected)


def test_labels_keep_the_most_frequent_value():
    block = np.array([[[3, 7], [7, 3]], [[9, 9], [7, 3]]], np.uint16)
    assert most_frequent(block, (2, 2, 2)).item() == 3
    array = np.random.default_rng(0).integers(0, 3, (5, 4, 7))
    found = most_frequent(array, (2, 2, 1))
    assert found.shape == (3, 2, 7)
    column = array[2:4, 2:4, 5].ravel()
    counts = np.bincount(column)
    assert found[1, 1, 5] == counts.argmax()


def test_a_pyramid_of_labels_holds_no_new_labels(tmp_path):
    labels = np.where(values() > 100, 7, 1000).astype(np.uint16)
    source = ArraySource(labels, is_labels=True)
    write_pyramid(source, tmp_path / "l.zarr")
    written = volviz.open(tmp_path / "l.zarr")
    assert written.is_labels
    np.testing.assert_array_equal(written.read(1).array, most_frequent(labels, (2, 2, 2)))


def test_all_time_points_and_channels_are_written(tmp_path):
    array = np.random.default_rng(1).integers(0, 99, (2, 2, 10, 12, 140)).astype(np.uint8)
    write_pyramid(ArraySource(array, "tczyx", times=(0.0, 2.0)), tmp_path / "five.zarr")
    written = volviz.open(tmp_path / "five.zarr")
    assert written.sizes == {"t": 2, "c": 2, "z": 10, "y": 12, "x": 140}
    np.testing.assert_array_equal(written.read(0, 1, 1).array, array[1, 1])


def test_a_stopped_pyramid_goes_on_and_has_the_same_bytes(tmp_path):
    write_pyramid(ArraySource(values(), name="v"), tmp_path / "whole.zarr", workers=1)
    source = Counting(values(), name="v")
    told: list[float] = []

    def stop_soon() -> bool:
        return len(told) > 2

    with pytest.raises(Cancelled):
        write_pyramid(
            source, tmp_path / "again.zarr", workers=1, cancel=stop_soon, progress=lambda f, _: told.append(f)
        )
    assert not (tmp_path / "again.zarr").exists()
    before = len(source.boxes)
    write_pyramid(source, tmp_path / "again.zarr", workers=2)
    # one box for the type, the others were not read before
    assert len(set(source.boxes[1:before]) & set(source.boxes[before + 1 :])) <= 1
    assert files(tmp_path / "again.zarr") == files(tmp_path / "whole.zarr")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["again.zarr", "whole.zarr"]


def test_a_killed_pyramid_goes_on(tmp_path):
    np.save(tmp_path / "v.npy", values())
    script = (
        "import os, volviz\n"
        "from volviz.io.writers import streamed_pyramid as s\n"
        "s.BLOCK, s.BLOCK_ABOVE = 128, 64\n"
        "told = []\n"
        "def progress(f, words):\n"
        "    told.append(f)\n"
        "    if len(told) == 4: os.kill(os.getpid(), 9)\n"
        "s.write_pyramid(volviz.open('v.npy'), 'v.zarr', workers=2, progress=progress)\n"
    )
    killed = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, env=os.environ, check=False)
    assert killed.returncode == -9
    done = (tmp_path / ".v.zarr.unfinished" / "volviz-done.txt").read_text().splitlines()
    assert len(done) == 4
    write_pyramid(volviz.open(tmp_path / "v.npy"), tmp_path / "v.zarr")
    np.testing.assert_array_equal(volviz.load(tmp_path / "v.zarr", level=0).array, values())
    assert not (tmp_path / ".v.zarr.unfinished").exists()


def test_the_command_writes_what_opens_at_the_level_that_fits(tmp_path, monkeypatch, capsys):
    np.save(tmp_path / "v.npy", values())
    monkeypatch.chdir(tmp_path)
    assert main(["pyramid", "v.npy", "v.ome.zarr", "--memory", "64MiB"]) == 0
    assert volviz.open("v.ome.zarr").levels[1].dimensions == (135, 65, 35)
    assert main(["pyramid", "v.npy", "v.ome.zarr"]) == 2
    assert "exists already" in capsys.readouterr().err
    with pytest.raises(InputError, match=r"ends in \.zarr"):
        write_pyramid(ArraySource(values()), "v.tif")
