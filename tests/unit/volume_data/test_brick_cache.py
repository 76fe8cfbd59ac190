"""Bricks of a volume that does not fit: how space is cut, which of them a view needs, how they come and go."""

from __future__ import annotations

import threading

import numpy as np
import pytest

from volviz.errors import LoadError
from volviz.volume_data.brick_cache.cache import PARTS, BrickCache, part_bounds
from volviz.volume_data.brick_cache.layout import Brick, BrickLayout
from volviz.volume_data.brick_cache.selection import BrickView, needed_bricks
from volviz.volume_data.description import Level
from volviz.volume_data.finer_levels import FinerLevels

#: Halved unevenly and half a voxel off, as averaging makes them; the last one is a third, and not aligned at all.
LEVELS = (
    Level((90, 64, 33)),
    Level((45, 32, 33), (2.0, 2.0, 1.0), (0.5, 0.5, 0.0)),
    Level((15, 11, 11), (6.0, 6.0, 3.0), (2.7, 2.4, 1.1)),
)


def ramp(level: Level) -> np.ndarray:
    """x + 100 y + 10000 z in the world: linear, so that interpolation at any level gives it exactly."""
    x, y, z = (
        o + s * np.arange(n) for o, s, n in zip(level.origin, level.spacing, level.dimensions, strict=True)
    )
    return x + 100.0 * y[:, None] + 10000.0 * z[:, None, None]


def interpolated(values: np.ndarray, index: np.ndarray) -> float:
    """Linear between the values around a continuous index (x, y, z)."""
    base = np.minimum(np.floor(index).astype(int), np.array(values.shape[::-1]) - 2)
    f = index - base
    total = 0.0
    for c in range(8):
        bits = np.array([c & 1, c >> 1 & 1, c >> 2])
        i, j, k = base + bits
        total += float(np.prod(np.where(bits, f, 1 - f))) * float(values[k, j, i])
    return total


def test_every_brick_of_every_level_holds_what_interpolation_in_its_cells_needs():
    layout = BrickLayout(LEVELS, 16)
    assert layout.counts.tolist() == [[6, 4, 2], [3, 2, 2], [1, 1, 1]]
    rng = np.random.default_rng(5)
    for number, level in enumerate(LEVELS):
        values = ramp(level)
        for x, y, z in np.ndindex(*layout.counts[number]):
            brick = Brick(number, x, y, z)
            i0, i1, j0, j1, k0, k1 = layout.box(brick)
            stored = layout.filled(brick, values[k0:k1, j0:j1, i0:i1])
            assert stored.shape == (layout.stored,) * 3
            size = layout.cells[number] * layout.edge
            for point in rng.uniform(np.array([x, y, z]) * size, (np.array([x, y, z]) + 1) * size, (20, 3)):
                index = point * layout.scale[number] + layout.offset[number]
                inside = (index >= 0).all() and (index <= np.array(level.dimensions) - 1).all()
                within = index - layout.first_voxel(brick)
                assert (within >= 0).all()
                assert (within <= layout.stored - 1).all()
                if inside:
                    world = point  # the finest level has its origin at 0 and voxels of 1
                    wanted = world @ (1.0, 100.0, 10000.0)
                    assert interpolated(stored, within) == pytest.approx(wanted, abs=1e-6)


def test_levels_that_are_turned_against_each_other_make_no_bricks():
    turned = Level((45, 32, 33), (2.0, 2.0, 1.0), direction=((0, 1, 0), (-1, 0, 0), (0, 0, 1)))
    with pytest.raises(ValueError, match="not parallel"):
        BrickLayout((LEVELS[0], turned), 16)
    assert not FinerLevels((LEVELS[0], turned), lambda *_: np.zeros(0), np.zeros((33, 64, 90)), 0).is_aligned


def test_coarser_levels_are_means_down_to_a_single_brick():
    values = np.random.default_rng(1).integers(0, 200, (33, 64, 90)).astype(np.uint8)
    finer = FinerLevels(LEVELS[:1], lambda *_: np.zeros(0), values, 0)
    assert [level.dimensions for level in finer.levels] == [
        (90, 64, 33),
        (45, 32, 17),
        (23, 16, 9),
        (12, 16, 9),
    ]
    assert finer.levels[1].origin == (0.5, 0.5, 0.5)
    block = values[4:6, 8:10, 6:8].astype(float).mean()
    assert finer.read(1, (3, 4, 4, 5, 2, 3))[0, 0, 0] == round(block)
    # the last voxel counts twice where a pair lacks one
    last = values[32, :2, :2].astype(float).mean()
    assert abs(finer.read(1, (0, 1, 0, 1, 16, 17))[0, 0, 0] - last) <= 0.5


def view(
    pixel: float, eye: tuple[float, float, float] = (45.0, 32.0, -100.0), **changes: object
) -> BrickView:
    """Along +z onto the levels, in parallel projection over 200 x 200 world units around the eye."""
    to_clip = np.array(
        [[0.01, 0, 0, -0.01 * eye[0]], [0, 0.01, 0, -0.01 * eye[1]], [0, 0, 0.005, 0.0], [0, 0, 0, 1.0]]
    )
    values: dict[str, object] = {
        "index_to_clip": to_clip, "eye": np.array(eye), "direction": np.array([0.0, 0.0, 1.0]),
        "index_to_world": np.eye(4), "pixel": pixel, "parallel": True,
        "crop": np.array([[0.0, 89.0], [0.0, 63.0], [0.0, 32.0]]),
    }  # fmt: skip
    return BrickView(**(values | changes))  # type: ignore[arg-type]


def test_bricks_are_divided_until_a_voxel_covers_at_most_a_pixel():
    layout = BrickLayout(LEVELS, 16)

    def levels(pixel: float, base: int = 0) -> set[int]:
        return {brick.level for brick in needed_bricks(layout, view(pixel), base, 1000)}

    assert levels(0.5) == {0}
    assert levels(2.0) == {1}
    assert levels(6.0) == {2}
    assert levels(0.5, base=1) == {1}
    assert len(needed_bricks(layout, view(0.5), 0, 1000)) == 6 * 4 * 2
    assert needed_bricks(layout, view(0.5), 0, 47) is None


def test_what_is_cropped_clipped_or_out_of_sight_is_not_needed():
    layout = BrickLayout(LEVELS, 16)

    def needed(**changes: object) -> set[Brick]:
        return set(needed_bricks(layout, view(0.5, **changes), 0, 1000))

    crop = np.array([[20.0, 30.0], [0.0, 63.0], [0.0, 10.0]])
    assert needed(crop=crop) == {Brick(0, 1, y, 0) for y in range(4)}
    plane = ((0.0, 40.0, 0.0), (0.0, 1.0, 0.0))
    assert {brick.y for brick in needed(planes=(plane,))} == {2, 3}
    far = needed(eye=(180.0, 32.0, -100.0))
    assert {brick.x for brick in far} == {4, 5}


def test_in_perspective_near_bricks_are_finer_and_come_first():
    layout = BrickLayout(LEVELS, 16)
    projection = np.array([[1.0, 0, 0, 0], [0, 1.0, 0, 0], [0, 0, 1.001, -1.0], [0, 0, 1.0, 0]])
    eye = np.array([45.0, 32.0, -20.0])
    moved = np.eye(4)
    moved[:3, 3] = -eye
    seen = view(0.07, tuple(eye), parallel=False, index_to_clip=projection @ moved)
    needed = needed_bricks(layout, seen, 0, 1000)
    assert {brick.level for brick in needed} == {0, 1}
    assert needed[0].level == 0
    assert max(brick.z for brick in needed if brick.level == 0) == 0


class Reader:
    """Reads the ramp; may fail, and counts what is asked of it."""

    def __init__(self) -> None:
        self.asked: list[Brick] = []
        self.failures = 0
        self.lock = threading.Lock()

    def __call__(self, level, box, _cancel):
        with self.lock:
            self.asked.append((level, box))
            if level == 0 and self.failures > 0:
                self.failures -= 1
                raise LoadError("ramp: a chunk is missing.")
        i0, i1, j0, j1, k0, k1 = box
        return ramp(LEVELS[level])[k0:k1, j0:j1, i0:i1]


def completed(cache: BrickCache, seen: BrickView) -> list[set[int]]:
    """Look until nothing is missing; the levels that were shown after each step."""
    shown = []
    for _ in range(50):
        cache.look(seen)
        cache.wait()
        while cache.take() is not None:
            pass
        cache.touch()
        shown.append({brick.level for brick, _, _ in cache.shown})
        if cache.status.is_complete:
            break
    return shown


@pytest.fixture
def reader() -> Reader:
    return Reader()


@pytest.fixture
def make(reader):
    """Makes caches of so many slots, and closes them."""
    made = []

    def cache(slots: int) -> BrickCache:
        layout = BrickLayout(LEVELS, 16)
        made.append(BrickCache(layout, reader, lambda v: v.astype(np.float32), slots, 3, lambda _task: None))
        return made[-1]

    yield cache
    for each in made:
        each.close()
        each.wait()


def test_a_view_is_completed_from_coarse_to_fine(make, reader):
    cache = make(100)
    seen = completed(cache, view(0.5))
    assert seen[0] == {2}
    assert 0 in seen[-1]
    assert cache.status.present == cache.status.needed == 48 + 1
    assert (cache.status.level, cache.status.failed, cache.status.limited) == (0, 0, False)
    levels = [level for level, _ in reader.asked]
    assert levels == sorted(levels, reverse=True)
    before = len(reader.asked)
    completed(cache, view(0.5))
    assert len(reader.asked) == before


def test_a_small_atlas_shows_a_coarser_level_and_forgets_what_was_used_first(make, reader):
    cache = make(20)
    completed(cache, view(0.5))
    assert cache.status.level == 1
    assert cache.status.limited
    assert cache.status.present == 12 + 1
    crop = np.array([[0.0, 40.0], [0.0, 40.0], [0.0, 15.0]])
    completed(cache, view(0.5, crop=crop))
    assert cache.status.level == 0
    assert not cache.status.limited
    places = [slot for _, slot, _ in cache.shown]
    assert len(set(places)) == len(places) <= 20
    # the coarsest level never leaves
    assert sum(brick.level == 2 for brick, _, _ in cache.shown) == 1


def test_reading_is_tried_again_and_what_cannot_be_read_is_a_hole_that_is_told(make, reader):
    cache = make(100)
    reader.failures = 2
    completed(cache, view(0.5))
    assert cache.status.failed == 0
    cache = make(100)
    reader.failures = 10**6
    completed(cache, view(0.5))
    assert cache.status.failed == 48
    assert cache.status.is_complete
    assert cache.failure == "ramp: a chunk is missing."
    assert {brick.level for brick, _, _ in cache.shown} == {1, 2}


def test_bounds_hold_for_interpolation_in_every_part_of_a_brick():
    layout = BrickLayout(LEVELS, 16)
    rng = np.random.default_rng(3)
    values = rng.normal(size=(layout.stored,) * 3)
    brick = Brick(1, 1, 0, 1)
    low, high = part_bounds(layout, brick, values)
    size = layout.cells[1] * layout.edge
    for point in rng.uniform(np.array(brick[1:]) * size, (np.array(brick[1:]) + 1) * size, (300, 3)):
        within = point * layout.scale[1] + layout.offset[1] - layout.first_voxel(brick)
        x, y, z = np.floor((point / size - brick[1:]) * PARTS).astype(int)
        assert low[z, y, x] <= interpolated(values, within) <= high[z, y, x]
