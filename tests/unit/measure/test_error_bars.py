"""The true value lies within the 95 % bar: on bodies of known size, tilted, anisotropic and noisy."""

from __future__ import annotations

import numpy as np
import pytest

from tests.unit.measure.phantoms import (
    ball,
    box,
    direction,
    filled,
    inner_point,
    lattice,
    plate,
    smallest_extent,
    tube,
)
from volviz import measure
from volviz.volume_data.volume import Volume

CASES = 100
LOOKS = ("sharp", "averaged", "soft")
NOISE = (0.0, 3.0, 8.0)


def _held(found: list[tuple[float, measure.Measured]]) -> int:
    return sum(abs(measured.value - true) <= measured.error for true, measured in found)


def _body(n: int, rng: np.random.Generator, volume: Volume):
    """Balls, tubes and boxes in turn; every second box lies along the lattice."""
    center, reach = inner_point(volume, rng), smallest_extent(volume)
    kind = n % 4
    if kind == 0:
        return ball(center, rng.uniform(0.15, 0.35) * reach)
    if kind == 1:
        return tube(center, direction(rng)[0], rng.uniform(0.1, 0.2) * reach, rng.uniform(0.15, 0.25) * reach)
    frame = volume.direction if kind == 2 else direction(rng)
    return box(center, frame, rng.uniform(0.1, 0.22, 3) * reach)


def test_distances_across_balls_plates_and_tubes_lie_within_their_bars() -> None:
    rng, found = np.random.default_rng(20261201), []
    for n in range(CASES):
        volume = lattice(rng, 24)
        center, radius = inner_point(volume, rng), rng.uniform(0.1, 0.3) * smallest_extent(volume)
        axis = direction(rng)[0]
        if n % 3 == 0:
            depth, _ = ball(center, radius)
        elif n % 3 == 1:
            depth = plate(center, axis, radius)
        else:
            depth, _ = tube(center, np.linalg.svd(axis[None])[2][1], radius)
        values = filled(volume, depth, LOOKS[n % 3 - n // 3 % 3], NOISE[n // 9 % 3], rng)
        ends = [measure.isovalue_point(values, center, way, 50.0) for way in (axis, -axis)]
        found.append((2 * radius, measure.distance(*ends, values)))
    assert _held(found) >= 95
    # a bar that holds everything would say nothing
    assert np.median([measured.error / true for true, measured in found]) < 0.15


@pytest.mark.parametrize("way", ["isosurface", "labels", "threshold"])
def test_volumes_of_bodies_lie_within_their_bars(way: str) -> None:
    rng, found = np.random.default_rng(7), []
    for n in range(CASES):
        volume = lattice(rng, 24)
        depth, true = _body(n, rng, volume)
        noise = 0.0 if way == "labels" else NOISE[n // 4 % 3]
        values = filled(volume, depth, LOOKS[n // 12 % 3] if way != "labels" else "sharp", noise, rng)
        if way == "isosurface":
            measured = measure.isosurface_volume(values, 50.0)
        elif way == "threshold":
            measured = measure.threshold_volume(values, 50.0)
        else:
            labels = Volume(
                3 * (values.array > 50).astype(np.uint8), values.spacing, values.origin, values.direction
            )
            measured = measure.label_volumes(labels)[3]
        found.append((true, measured))
    assert _held(found) >= 95
    assert np.median([measured.error / true for true, measured in found]) < 0.25


def test_points_placed_by_hand_are_known_to_a_voxel() -> None:
    rng, found = np.random.default_rng(3), []
    for _ in range(CASES):
        volume = lattice(rng, 24)
        true = volume.index_to_world[:3, :3] @ rng.uniform(4, 20, (3, 3)) + volume.index_to_world[:3, 3:]
        index = np.rint(volume.world_to_index[:3, :3] @ true + volume.world_to_index[:3, 3:])
        placed = (volume.index_to_world[:3, :3] @ index + volume.index_to_world[:3, 3:]).T
        a, b, c = true.T
        found.append((measure.polyline(true.T).value, measure.polyline(placed, volume)))
        found.append((measure.angle(a, b, c).value, measure.angle(*placed, volume)))
        found.append((measure.area(true.T).value, measure.area(placed, volume)))
    assert _held(found) >= 0.95 * len(found)
