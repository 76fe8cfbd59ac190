"""Bricks by the slot of an atlas in which they lie: what is needed is read on threads, what was used last stays."""

from __future__ import annotations

import threading
import time
from collections import OrderedDict, deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import Cancelled, VolvizError
from volviz.tasks import BackgroundTask, Tasks
from volviz.volume_data.brick_cache.layout import Brick, BrickLayout
from volviz.volume_data.brick_cache.selection import needed_bricks

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.tasks import Cancel
    from volviz.volume_data.brick_cache.selection import BrickView
    from volviz.volume_data.description import Box

#: Bounds of the values are kept for so many parts of a brick along each axis.
PARTS = 4
#: Bricks that are read at the same time.
READERS = 3
#: A brick that cannot be read is tried so often, and again after so many seconds.
TRIES, TRY_AGAIN_SECONDS = 3, 10.0

Bounds = tuple["npt.NDArray[np.float32]", "npt.NDArray[np.float32]"]
Read = Callable[[int, "Box", "Cancel"], "npt.NDArray[Any]"]


@dataclass(frozen=True, eq=False)
class LoadedBrick:
    """What a thread has made of a brick.

    Attributes
    ----------
    texels : ndarray of shape (S, S, S)
        As the atlas takes them.
    low, high : ndarray of shape (PARTS, PARTS, PARTS)
        Bounds of what linear interpolation gives in parts of the brick, in data units.
    """

    brick: Brick
    texels: npt.NDArray[Any]
    low: npt.NDArray[np.float32]
    high: npt.NDArray[np.float32]


@dataclass(frozen=True)
class BrickStatus:
    """How much of what a view needs is there.

    Attributes
    ----------
    level : int
        The finest level that is needed.
    level_count : int
        Levels that the data has.
    needed, present : int
        Bricks.
    held_bytes : int
        Bytes of all bricks in the atlas.
    failed : int
        Bricks that cannot be read; coarser ones are seen in their place.
    limited : bool
        Finer bricks are missing because they would not fit.
    """

    level: int
    level_count: int
    needed: int
    present: int
    held_bytes: int
    failed: int = 0
    limited: bool = False

    @property
    def is_complete(self) -> bool:
        """Whether nothing is missing that can be read."""
        return self.present + self.failed >= self.needed


class BrickCache:
    """Which bricks lie in which slot of an atlas, and which are being read.

    One thread uses it; others read for it. The coarsest level stays for ever. A view is completed from coarse to fine:
    each level is asked for when what the one before it needs is there.

    Parameters
    ----------
    layout : BrickLayout
    read : callable(level, box, cancel) -> ndarray
        Values of a box of voxels, from any thread.
    prepare : callable(ndarray) -> ndarray
        Makes texels of the values of a brick, on the thread that has read them.
    slots : int
        Bricks that the atlas holds.
    level_count : int
        Levels that people know of; coarser ones are computed.
    arrived : callable(task)
        Called on a thread when a brick has been read.
    lowest : float
        What values count as that are not finite.
    """

    def __init__(
        self,
        layout: BrickLayout,
        read: Read,
        prepare: Callable[[npt.NDArray[Any]], npt.NDArray[Any]],
        slots: int,
        level_count: int,
        arrived: Callable[[BackgroundTask[Any]], None],
        *,
        lowest: float = 0.0,
    ) -> None:
        self.layout = layout
        self.slots = slots
        self._read = read
        self._prepare = prepare
        self._lowest = lowest
        self._level_count = level_count
        self._tasks = Tasks(self._on_read, threads=READERS)
        self._tell = arrived
        self._lock = threading.Lock()
        self._ready: deque[LoadedBrick] = deque()
        self._waiting: list[Brick] = []
        self._reading: set[Brick] = set()
        self._failed: dict[Brick, tuple[float, str]] = {}
        self._place: OrderedDict[Brick, int] = OrderedDict()
        self._bounds: dict[Brick, Bounds] = {}
        self._free = list(range(slots))[::-1]
        self._view: BrickView | None = None
        self._goal = layout.coarsest
        self._limited = False
        self._needed: list[Brick] = []
        self.base = layout.coarsest
        self.brick_bytes = 0

    # ------------------------------------------------------------------ what is needed

    def begin(self) -> None:
        """Ask for the coarsest level, before there is a view."""
        self._needed = self._coarsest
        self._ask()

    def look(self, view: BrickView) -> bool:
        """Ask for what a view needs; whether other bricks are to be shown than before."""
        before = self.base, self._needed
        if self._view is None or not self._view.is_same(view):
            self._view = view
            self._goal = self._finest_that_fits(view)
            self._go_to(max(self._goal, self.base))
            if sum(brick in self._place for brick in self._needed) < len(self._needed) // 2:
                self._go_to(self.layout.coarsest)
        while self.base > self._goal and self._is_there(self._needed):
            self._go_to(self.base - 1)
        self._ask()
        return before != (self.base, self._needed)

    def _finest_that_fits(self, view: BrickView) -> int:
        """The finest level whose bricks find room beside the coarsest level."""
        room = self.slots - self.layout.count(self.layout.coarsest)
        for base in range(self.layout.coarsest):
            needed = needed_bricks(self.layout, view, base, room)
            if needed is not None:
                self._limited = base > 0 and needed_bricks(self.layout, view, base - 1, 1 << 30) != needed
                return min((brick.level for brick in needed), default=base)
        self._limited = self.layout.coarsest > 0
        return self.layout.coarsest

    def _go_to(self, base: int) -> None:
        assert self._view is not None
        self.base = base
        room = self.slots - self.layout.count(self.layout.coarsest)
        needed = needed_bricks(self.layout, self._view, base, room) or []
        self._needed = self._coarsest + [brick for brick in needed if brick.level != self.layout.coarsest]

    @property
    def _coarsest(self) -> list[Brick]:
        nx, ny, nz = (int(n) for n in self.layout.counts[-1])
        return [Brick(self.layout.coarsest, x, y, z) for z in range(nz) for y in range(ny) for x in range(nx)]

    def _is_there(self, bricks: Sequence[Brick]) -> bool:
        return all(brick in self._place or brick in self._failed for brick in bricks)

    def _ask(self) -> None:
        """Have what is missing read, in the order in which it is needed."""
        now = time.monotonic()
        for brick, (when, _) in list(self._failed.items()):
            if now - when > TRY_AGAIN_SECONDS:
                del self._failed[brick]
        with self._lock:
            known = self._reading | {loaded.brick for loaded in self._ready}
            self._waiting = [
                brick
                for brick in self._needed
                if brick not in self._place and brick not in known and brick not in self._failed
            ][::-1]
        self._begin()

    # ------------------------------------------------------------------ reading

    def _begin(self) -> None:
        while True:
            with self._lock:
                if len(self._reading) >= READERS or not self._waiting:
                    return
                brick = self._waiting.pop()
                self._reading.add(brick)
            self._tasks.start(None, partial(self._load, brick))

    def _load(self, brick: Brick, _progress: object, cancel: Cancel) -> None:
        """Read a brick; on a thread."""
        try:
            for attempt in range(TRIES):
                try:
                    values = self._read(brick.level, self.layout.box(brick), cancel)
                    break
                except (VolvizError, OSError) as error:
                    if isinstance(error, Cancelled) or attempt == TRIES - 1:
                        raise
            values = self.layout.filled(brick, values)
            if values.dtype.kind == "f":
                values = np.where(np.isfinite(values), values, values.dtype.type(self._lowest))
            low, high = part_bounds(self.layout, brick, values)
            texels = np.ascontiguousarray(self._prepare(values))
            with self._lock:
                self._ready.append(LoadedBrick(brick, texels, low, high))
        except Cancelled:
            pass
        except Exception as error:  # noqa: BLE001 - a hole in the picture is told, the others are read
            self._failed[brick] = (time.monotonic(), str(error))
        finally:
            with self._lock:
                self._reading.discard(brick)

    def _on_read(self, task: BackgroundTask[Any]) -> None:
        self._begin()
        self._tell(task)

    # ------------------------------------------------------------------ slots

    def take(self) -> tuple[LoadedBrick, int] | None:
        """A brick that has been read, and the slot where it is to be put; None when there is none."""
        while True:
            with self._lock:
                if not self._ready:
                    return None
                loaded = self._ready.popleft()
            slot = self._slot()
            if slot is None:
                continue
            self._place[loaded.brick] = slot
            self._bounds[loaded.brick] = loaded.low, loaded.high
            self.brick_bytes = loaded.texels.nbytes
            return loaded, slot

    def _slot(self) -> int | None:
        """A free slot, or that of the brick that was used least recently and is not needed."""
        if self._free:
            return self._free.pop()
        needed = set(self._needed)
        for brick in self._place:
            if brick not in needed and brick.level != self.layout.coarsest:
                del self._bounds[brick]
                return self._place.pop(brick)
        return None

    def touch(self) -> None:
        """What is needed now has been used: it goes last."""
        for brick in self._needed:
            if brick in self._place:
                self._place.move_to_end(brick)

    @property
    def shown(self) -> list[tuple[Brick, int, Bounds]]:
        """Bricks that may be seen, with slots and bounds of their parts, from coarse to fine, as they are overlaid."""
        held = [(b, slot, self._bounds[b]) for b, slot in self._place.items() if b.level >= self.base]
        return sorted(held, key=lambda each: -each[0].level)

    @property
    def is_ready(self) -> bool:
        """Whether the coarsest level is there, so that there is something to see everywhere."""
        return sum(brick.level == self.layout.coarsest for brick in self._place) == self.layout.count(
            self.layout.coarsest
        )

    @property
    def is_idle(self) -> bool:
        """Whether nothing is being read and nothing waits to be put into the atlas."""
        with self._lock:
            return not self._reading and not self._ready and not self._waiting

    @property
    def status(self) -> BrickStatus:
        """How much of what the view needs is there."""
        present = sum(brick in self._place for brick in self._needed)
        failed = sum(brick in self._failed for brick in self._needed)
        # levels finer than the one that is being completed are still to come
        missing = 1 if self.base > self._goal else 0
        return BrickStatus(
            self._goal, max(self._level_count, self._goal + 1), len(self._needed) + missing, present,
            len(self._place) * self.brick_bytes, failed, self._limited,
        )  # fmt: skip

    @property
    def failure(self) -> str:
        """Why a brick that is needed cannot be read; empty when all can."""
        return next((self._failed[brick][1] for brick in self._needed if brick in self._failed), "")

    def wait(self, timeout: float | None = None) -> None:
        """Wait until what was asked for has been read: for scripts, never in an event loop."""
        self._tasks.wait(timeout)

    def close(self) -> None:
        """Stop reading."""
        with self._lock:
            self._waiting = []
        self._tasks.close()
        # whoever was told must not live on because of a brick that is still being read
        self._tell = _nobody


def _nobody(_task: BackgroundTask[Any]) -> None:
    """Whom a closed cache tells."""


def part_bounds(
    layout: BrickLayout, brick: Brick, values: npt.NDArray[Any]
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Bounds of what linear interpolation gives in parts of a brick, each of shape (PARTS, PARTS, PARTS)."""
    first = layout.first_voxel(brick)
    size = layout.cells[brick.level] * layout.edge
    begin = np.array(brick[1:]) * size * layout.scale[brick.level] + layout.offset[brick.level] - first
    length = size * layout.scale[brick.level] / PARTS
    low = high = values
    for axis, at in ((0, 2), (1, 1), (2, 0)):
        rows_low, rows_high = [], []
        for part in range(PARTS):
            start = max(int(np.floor(begin[at] + part * length[at])), 0)
            stop = min(int(np.floor(begin[at] + (part + 1) * length[at])) + 2, values.shape[axis])
            index = (slice(None),) * axis + (slice(start, stop),)
            rows_low.append(np.minimum.reduce(low[index], axis=axis))
            rows_high.append(np.maximum.reduce(high[index], axis=axis))
        low, high = np.stack(rows_low, axis), np.stack(rows_high, axis)
    # rounded outwards, where 32-bit floats do not hold them
    return (
        np.nextafter(low.astype(np.float32), np.float32(-np.inf)),
        np.nextafter(high.astype(np.float32), np.float32(np.inf)),
    )
