"""Files that are larger than the memory that is free."""

from __future__ import annotations

import numpy as np
import pytest
import tifffile

from tests.unit.io.writers import itk, scalars
from volviz.errors import LoadError
from volviz.io import load, memory

ARRAY = scalars((20, 40, 50), "uint16")


@pytest.fixture
def little_memory(monkeypatch, tmp_path):
    (tmp_path / "meminfo").write_text("MemTotal: 99999 kB\nMemAvailable:      60 kB\nSwapFree: 10 kB\n")
    monkeypatch.setattr(memory, "MEMINFO", tmp_path / "meminfo")
    monkeypatch.setattr(memory, "CGROUP", tmp_path / "nowhere")


@pytest.mark.parametrize("suffix", [".nii", ".nii.gz", ".nrrd", ".mha", ".npy", ".tif"])
def test_a_file_that_does_not_fit_is_refused_with_both_numbers(tmp_path, little_memory, suffix):
    path = tmp_path / f"v{suffix}"
    if suffix == ".npy":
        np.save(path, ARRAY)
    elif suffix == ".tif":
        tifffile.imwrite(path, ARRAY, photometric="minisblack")
    else:
        itk(path, ARRAY)
    with pytest.raises(
        LoadError, match=r"^v[.\w]+: it needs 7\.45e-05 GiB of memory and 6\.68e-05 GiB are free"
    ):
        load(path)


def test_of_a_series_the_time_point_alone_must_fit(tmp_path, little_memory):
    np.save(tmp_path / "v.npy", scalars((4, 10, 40, 50), "uint16"))
    assert load(tmp_path / "v.npy").array.nbytes == 40_000


@pytest.mark.parametrize(("limit", "free"), [("3000000", 1_000_000), ("max", 71_680), ("50000", 0)])
def test_a_container_may_have_less_than_its_machine(monkeypatch, tmp_path, little_memory, limit, free):
    (tmp_path / "memory.max").write_text(limit + "\n")
    (tmp_path / "memory.current").write_text("2000000\n")
    monkeypatch.setattr(memory, "CGROUP", tmp_path)
    assert memory.free_bytes() == min(free, 71_680)


def test_a_system_that_does_not_tell_refuses_nothing(monkeypatch, tmp_path):
    monkeypatch.setattr(memory, "MEMINFO", tmp_path / "nowhere")
    assert memory.free_bytes() is None
    np.save(tmp_path / "v.npy", ARRAY)
    np.testing.assert_array_equal(load(tmp_path / "v.npy").array, ARRAY)
