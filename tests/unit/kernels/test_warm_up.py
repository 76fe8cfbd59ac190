"""Kernels that have been warmed up have their machine code for the types that volumes have."""

from __future__ import annotations

import numpy as np
import pytest

import volviz
from volviz.errors import Cancelled
from volviz.kernels import slices, splats
from volviz.kernels.warm_up import COMMON, jobs, warm_up


def test_a_volume_meets_only_kernels_that_are_compiled_already() -> None:
    warm_up(["uint8"])
    compiled = len(slices._cut.signatures), len(splats._mark.signatures)
    assert min(compiled) >= 1
    volume = volviz.Volume(np.arange(4096).reshape(16, 16, 16).astype(np.uint8))
    corners = slices.crop_corners(volume.index_to_world, None, volume.dimensions)
    slices.slice_polygons(corners, (0.6, 0.0, 0.8), np.linspace(1, 10, 5))
    splats.select_splats(volume.array, 20.0)
    assert (len(slices._cut.signatures), len(splats._mark.signatures)) == compiled


def test_progress_rises_from_zero_and_names_the_work() -> None:
    told: list[tuple[float, str]] = []
    warm_up(["uint8"], report=lambda part, name: told.append((part, name)))
    parts = [part for part, _ in told]
    assert parts == sorted(parts)
    assert parts[0] == 0.0
    assert parts[-1] < 1.0
    assert "slices, uint8" in [name for _, name in told]


def test_warming_up_stops_when_nobody_wants_it_any_more() -> None:
    told: list[str] = []

    def report(_part: float, name: str) -> None:
        told.append(name)
        if len(told) == 2:
            raise Cancelled("The work was cancelled.")

    with pytest.raises(Cancelled):
        warm_up(["uint8"], report=report)
    assert len(told) == 2


@pytest.mark.parametrize("dtype", [*COMMON, "int8", "float64", "int64"])
def test_the_work_is_known_for_every_type_of_scalars(dtype: str) -> None:
    names = [name for name, _ in jobs(dtype)]
    assert len(set(names)) == len(names) >= 5
