"""Boxes at another level of resolution, and what the user allows a volume to take."""

from __future__ import annotations

import numpy as np
import pytest

import volviz
from volviz.errors import InputError, LoadError
from volviz.volume_data.boxes import between_levels, finest_box, voxels_around
from volviz.volume_data.budgets import budgets, parsed_bytes, set_budgets
from volviz.volume_data.description import Level

FINE = Level((160, 160, 160), (0.5, 0.5, 1.0), (3.0, 4.0, 5.0))
#: Made by averaging: half a voxel off.
COARSE = Level((80, 80, 160), (1.0, 1.0, 1.0), (3.25, 4.25, 5.0))


@pytest.fixture
def pyramid(tmp_path):
    """An OME-Zarr of two levels, 160^3 and 80^3, of a ramp along x."""
    values = np.broadcast_to(np.arange(160, dtype=np.uint8), (160, 160, 160))
    volviz.save(volviz.Volume(values, name="ramp"), tmp_path / "ramp.ome.zarr")
    return tmp_path / "ramp.ome.zarr"


@pytest.fixture
def allowed():
    """Budgets that end with the test."""
    before = budgets()
    yield set_budgets
    set_budgets(memory=before.memory, texture=before.texture)


def test_a_box_lies_in_the_same_place_at_every_level():
    extent = between_levels((10.0, 20.0, 30.0, 41.0, 5.0, 6.0), COARSE, FINE)
    np.testing.assert_allclose(extent, (20.5, 40.5, 60.5, 82.5, 5.0, 6.0), atol=1e-9)
    np.testing.assert_allclose(between_levels(extent, FINE, COARSE), (10, 20, 30, 41, 5, 6), atol=1e-9)


def test_the_voxels_around_a_box_stay_inside_and_are_at_least_two():
    assert voxels_around((20.5, 40.5, -3.0, 500.0, 5.0, 5.0), FINE) == (20, 42, 0, 160, 5, 7)
    assert voxels_around((158.7, 159.0, 0.0, 1.0, 159.0, 159.0), FINE) == (158, 160, 0, 2, 158, 160)


def test_a_box_is_read_at_the_finest_level_at_which_it_fits(pyramid, allowed):
    source = volviz.open(pyramid)
    whole, small = (0, 79, 0, 79, 0, 79), (10, 29, 10, 29, 10, 29)
    assert finest_box(source, whole, 1, None)[0] == 0
    assert finest_box(source, whole, 1, 4_000_000) == (1, (0, 80, 0, 80, 0, 80))
    assert finest_box(source, small, 1, 4_000_000) == (0, (20, 60, 20, 60, 20, 60))
    allowed(texture=1_000_000)
    assert finest_box(source, whole, 1, None)[0] == 1


def test_the_memory_budget_chooses_the_level_and_says_so(pyramid, allowed):
    allowed(memory=4 << 20)
    volume = volviz.load(pyramid)
    assert volume.dimensions == (80, 80, 80)
    (note,) = volume.metadata["notes"]
    assert note.startswith("Level 1 is shown, of 0 (finest) to 1")
    assert "memory budget is 0.00391 GiB" in note
    allowed(memory=2 << 20)
    with pytest.raises(LoadError, match=r"level 0 needs .* the memory budget is .*; read level 1"):
        volviz.load(pyramid, level=0)


@pytest.mark.parametrize(
    ("text", "count"),
    [("512MiB", 512 << 20), ("2 GB", 2 << 30), ("1.5g", 3 << 29), ("1048576", 1 << 20), ("3mb", 3 << 20)],
)
def test_amounts_of_memory_are_understood(text, count):
    assert parsed_bytes(text, "--memory-budget") == count


@pytest.mark.parametrize("text", ["", "much", "-1GiB", "1000", "0", "5 PB", "1e9"])
def test_other_amounts_are_refused_in_a_sentence(text):
    with pytest.raises(InputError, match=r"^--memory-budget takes an amount .* such as 512MiB or 2GiB, got"):
        parsed_bytes(text, "--memory-budget")
