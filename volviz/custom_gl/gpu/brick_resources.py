"""Textures of a volume that is drawn brick by brick: an atlas of bricks of several levels, and a table of pages."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np

from volviz.custom_gl.gpu.resources import (
    SampledFrame,
    VolumeResources,
    distance_codes,
    distance_texture,
    empty_scalars,
)
from volviz.kernels.bricks import grow_occupancy, occupancy, occupancy_for_isovalues, visible_prefix
from volviz.volume_data.brick_cache.cache import PARTS, BrickCache, BrickStatus
from volviz.volume_data.brick_cache.layout import BrickLayout
from volviz.volume_data.finer_levels import FinerLevels, levels_behind
from volviz.volume_data.scalars import TextureData, choose_format

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.custom_gl.gpu.context import Gpu
    from volviz.custom_gl.gpu.programs import Program
    from volviz.tasks import Done
    from volviz.volume_data.brick_cache.selection import BrickView
    from volviz.volume_data.scalars import Format
    from volviz.volume_data.volume import Volume

#: Edges of cells in voxels; the largest is taken of which the atlas holds enough.
EDGES = (64, 32, 16)
ENOUGH = 128
#: Volumes with no longer axis take no cells of 64 voxels.
LARGE = 4096
#: The field of empty space has parts of cells as long as it has no more entries.
MOST_PARTS = 2**21


class BrickResources(VolumeResources):
    """Textures of a volume that is too large for one texture, or for memory.

    Parameters
    ----------
    gpu : Gpu
    volume : Volume
        On the lattice of the finest level (`volviz.volume_data.large_volume.at_finest`).
    on_brick : callable
        Called on a thread when a brick has been read.
    """

    def __init__(self, gpu: Gpu, volume: Volume, on_brick: Done) -> None:
        # nothing of the volume itself is uploaded, so what the plain textures need is not made
        self.gpu = gpu
        self.volume = volume
        self._has_corners = False
        self._tables: dict[str, tuple[Any, Any]] = {}
        self._distances: dict[str, tuple[Any, Any]] = {}
        self._last_table = None
        finer = levels_behind(volume) or FinerLevels.of_memory(volume)
        dtype = volume.array.dtype
        kind = choose_format(
            dtype, gpu.max_texture_bytes // 4, software=gpu.limits.software,
            precise_bytes=not gpu.limits.software and gpu.filters_bytes_precisely,
        )  # fmt: skip
        self._mapping = _Mapping(volume, kind)
        self.layout, slots = _layout(gpu, finer, self._mapping.itemsize)
        self._grid = _slot_grid(slots, self.layout.stored, gpu.limits.max_3d_texture)
        shape = tuple(n * self.layout.stored for n in self._grid[::-1])
        atlas = TextureData(np.broadcast_to(self._mapping.zero, shape), 1.0, 0.0)
        self.scalars = empty_scalars(gpu, atlas, 1, volume.name)
        self.texels = TextureData(
            np.broadcast_to(self._mapping.zero, volume.dimensions[::-1]),
            self._mapping.scale,
            self._mapping.offset,
        )
        self.cache = BrickCache(
            self.layout, finer.read, self._mapping.texels, math.prod(self._grid), finer.stored_count, on_brick,
            lowest=volume.range[0],
        )  # fmt: skip
        #: Grows with every change of what is to be seen.
        self.revision = 0
        self._pages: Any = None
        self._scales = self._scale_texture()
        self._low = self._high = np.zeros((1, 1, 1), np.float32)
        self.cache.begin()

    # ------------------------------------------------------------------ what is there

    @property
    def fetch(self) -> str:
        """File of the hook that reads the scalars."""
        return "fetch/bricks.glsl"

    @property
    def complete(self) -> bool:
        """Whether there is something to see everywhere: the coarsest level."""
        return self.cache.is_ready and self._pages is not None

    def upload(self, max_bytes: int | None = None) -> bool:
        """Put bricks that have been read into the atlas; without a limit wait for the coarsest level."""
        while not self.complete:
            if max_bytes is None:
                self.cache.wait()
            self._put(math.inf if max_bytes is None else 0.0)
            if max_bytes is not None or self.cache.failure:
                break
        return self.complete

    @property
    def full_factor(self) -> tuple[int, int, int]:
        """One texel is one voxel, at whatever level."""
        return 1, 1, 1

    finest = coarsest = 0

    def select(self, level: int) -> None:
        """There is one level of detail: what the pages say."""

    @property
    def voxel_scale(self) -> float:
        """Voxels of the finest level that one of the finest level shown is long."""
        base = self.layout.levels[self.cache.base].spacing
        return max(min(base) / min(self.layout.levels[0].spacing), 1.0)

    @property
    def status(self) -> BrickStatus:
        """How much of what the view needs is there."""
        return self.cache.status

    @property
    def is_missing(self) -> bool:
        """Whether bricks that the view needs are still to come."""
        return not self.cache.status.is_complete

    def look(self, view: BrickView | None, seconds: float) -> bool:
        """Put what has been read into the atlas, and ask for what a view needs.

        Parameters
        ----------
        view : BrickView or None
            None while something moves: what would soon be out of sight is not asked for.
        seconds : float
            About how long it may take.

        Returns
        -------
        bool
            Whether everything that has been read is in the atlas.
        """
        changed = view is not None and self.cache.look(view)
        put = self._put(seconds, also=changed)
        if view is not None:
            # what has just come may have completed a level
            while self.cache.look(view):
                self._rebuild()
        return put

    def _put(self, seconds: float, *, also: bool = False) -> bool:
        end = time.perf_counter() + seconds
        changed, done = also, False
        while not done:
            taken = self.cache.take()
            if taken is None:
                done = True
                break
            loaded, slot = taken
            edge = self.layout.stored
            x, y, z = (edge * n for n in self._slot(slot))
            self.scalars.write(loaded.texels, viewport=(x, y, z, edge, edge, edge), alignment=1)
            self.gpu.uploads += 1
            changed = True
            if time.perf_counter() > end:
                break
        if changed and self.cache.is_ready:
            self._rebuild()
        return done

    def _slot(self, slot: int) -> tuple[int, int, int]:
        nx, ny, _ = self._grid
        return slot % nx, slot // nx % ny, slot // (nx * ny)

    # ------------------------------------------------------------------ pages

    def _rebuild(self) -> None:
        """Pages and bounds of what is to be seen now."""
        layout, base = self.layout, self.cache.base
        nx, ny, nz = (int(n) for n in layout.counts[base])
        pages = np.zeros((nz, ny, nx, 4), np.float32)
        parts = PARTS if nx * ny * nz * PARTS**3 <= MOST_PARTS else 1
        low = np.zeros((nz * parts, ny * parts, nx * parts), np.float32)
        high = low.copy()
        atlas = np.array(self._grid, float) * layout.stored
        for brick, slot, bounds in self.cache.shown:
            size = layout.cells[brick.level] // layout.cells[base]
            begin = np.array(brick[1:]) * size
            where = tuple(slice(int(b), int(b + s)) for b, s in zip(begin[::-1], size[::-1], strict=True))
            origin = np.array(self._slot(slot)) * layout.stored + 0.5
            shift = layout.offset[brick.level] - layout.first_voxel(brick)
            pages[where] = (*((origin + shift) / atlas), brick.level)
            finer = tuple(slice(parts * s.start, parts * s.stop) for s in where)
            for field, own, least in ((low, bounds[0], np.minimum), (high, bounds[1], np.maximum)):
                each = own if parts == PARTS else least.reduce(own, axis=(0, 1, 2)).reshape(1, 1, 1)
                target = field[finer]
                for axis in range(3):
                    each = np.repeat(each, size[2 - axis], axis)
                target[...] = each[tuple(slice(n) for n in target.shape)]
        self._low, self._high = low, high
        if self._pages is None or self._pages.size != (nx, ny, nz):
            self._release_pages()
            self._pages = self.gpu.gl.texture3d((nx, ny, nz), 4, pages.tobytes(), alignment=1, dtype="f4")
            self._pages.filter = (moderngl.NEAREST, moderngl.NEAREST)
            self._pages.repeat_x = self._pages.repeat_y = self._pages.repeat_z = False
        else:
            self._pages.write(pages.tobytes(), alignment=1)
        self.cache.touch()
        self.revision += 1

    def _scale_texture(self) -> Any:
        atlas = np.array(self._grid, float) * self.layout.stored
        rows = np.zeros((1, len(self.layout.scale), 4), np.float32)
        rows[0, :, :3] = self.layout.scale / atlas
        return self.gpu.table_texture(rows)

    # ------------------------------------------------------------------ empty space

    def occupied(self, frame: SampledFrame) -> npt.NDArray[np.bool_]:
        """Which parts of cells may hold anything visible, as far as their values alone say."""
        table = self._baked(frame.transfer_function, interactive=frame.interactive)
        opacity = table.opacity.max(axis=0)
        below = self._below(frame.common.density_threshold, table.values, len(opacity))
        opacity[: max(below - 1, 0)] = 0.0
        return occupancy(self._low, self._high, visible_prefix(opacity), table.values)

    def occupancy_key(self, frame: SampledFrame) -> tuple[Any, ...]:
        """Everything that `occupied` depends on."""
        return frame.transfer_function, frame.common.density_threshold, frame.interactive, self.revision

    def visible_distance(self, frame: SampledFrame) -> Any:
        """Empty-space field for what the frame's transfer function shows."""
        margin = 0
        if frame.common.preintegrated:
            margin = math.ceil((frame.step_world / min(frame.volume.spacing) + 1.0) / self._part.min())

        def make() -> Any:
            occupied = self.occupied(frame)
            occupied = grow_occupancy(occupied, margin) if margin else occupied
            return distance_texture(self.gpu, distance_codes(occupied))

        return self._cached(self._distances, "visible", (margin, *self.occupancy_key(frame)), make)

    def isovalue_distance(self, isovalues: Sequence[float]) -> Any:
        """Empty-space field for surfaces of these isovalues (data units)."""
        key = (*(float(v) for v in isovalues), self.revision)

        def make() -> Any:
            occupied = occupancy_for_isovalues(self._low, self._high, key[:-1])
            return distance_texture(self.gpu, distance_codes(occupied))

        return self._cached(self._distances, "isovalues", key, make)

    @property
    def _part(self) -> npt.NDArray[np.float64]:
        """Edges of the entries of the field of empty space, in voxels of the finest level along (x, y, z)."""
        cell = self.layout.cells[self.cache.base] * self.layout.edge
        return np.asarray(cell * self.layout.counts[self.cache.base] / np.array(self._low.shape[::-1]))

    def brick_uniforms(self) -> dict[str, Any]:
        """Uniforms of ``glsl/empty_space.glsl`` and of the pages."""
        voxels = np.array(self.volume.dimensions, float)
        cell = self.layout.cells[self.cache.base] * self.layout.edge
        cells, parts = self.layout.counts[self.cache.base], np.array(self._low.shape[::-1])
        return {
            "u_bricks_per_texture": tuple(voxels / self._part),
            "u_brick_offset": tuple(-0.5 / self._part),
            "u_last_brick": tuple(parts - 1.0),
            "u_brick_edge": tuple(1.0 / parts),
            "u_cells_per_voxel": tuple(1.0 / cell),
            "u_last_cell": tuple(cells - 1.0),
            "u_cell_edge": tuple(1.0 / cells),
            "u_level_edge": 1.0 / len(self.layout.levels),
        }

    def bind(
        self, program: Program, frame: SampledFrame, table_length: float | None = None, layer: int = 0
    ) -> None:
        """Bind every texture that the program asks for."""
        super().bind(program, frame, table_length, layer)
        program.use_texture("t_pages", self._pages, layer)
        program.use_texture("t_page_scales", self._scales, layer)

    # ------------------------------------------------------------------ the end

    def _release_pages(self) -> None:
        if self._pages is not None:
            self._pages.release()
            self._pages = None

    def release(self) -> None:
        """Stop reading and release all textures; the context must be current."""
        self.cache.close()
        self._release_pages()
        for texture in (self.scalars, self._scales):
            texture.release()
        for cached in (self._tables, self._distances):
            for _, texture in cached.values():
                texture.release()
            cached.clear()


class _Mapping:
    """From values to texels that lose nothing, and from those to fractions of the range of the bulk.

    Whole numbers are stored as they are, from the lowest that their type holds.
    """

    def __init__(self, volume: Volume, kind: Format) -> None:
        low, high = volume.bulk_range
        span = high - low if high > low else 1.0
        dtype = volume.array.dtype
        self.zero: npt.NDArray[Any] = np.zeros((), {"u1": np.uint8, "u2": np.uint16, "f4": np.float32}[kind])
        self._low, self._span, self._kind = low, span, kind
        self.scale, self.offset = 1.0, 0.0
        self.texels: Callable[[npt.NDArray[Any]], npt.NDArray[Any]] = self._fractions
        if kind != "f4":
            self._least = int(np.iinfo(dtype).min)
            # bytes are spread over all of 0..65535 by 257, without rounding
            self._spread = 257 if kind == "u2" and dtype.itemsize == 1 else 1
            most = 255.0 if kind == "u1" else 65535.0
            self.scale, self.offset = most / self._spread / span, (self._least - low) / span
            self.texels = self._whole

    @property
    def itemsize(self) -> int:
        """Bytes of a texel."""
        return int(self.zero.dtype.itemsize)

    def _fractions(self, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        return ((values.astype(np.float64) - self._low) / self._span).astype(np.float32)

    def _whole(self, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        return ((values.astype(np.int32) - self._least) * self._spread).astype(self.zero.dtype)


def _layout(gpu: Gpu, finer: FinerLevels, itemsize: int) -> tuple[BrickLayout, int]:
    """The bricks, and how many of them the budget of textures holds."""
    longest = max(finer.levels[0].dimensions)
    for edge in EDGES:
        if edge == EDGES[0] and longest <= LARGE:
            continue
        layout = BrickLayout(finer.levels, edge)
        slots = gpu.max_texture_bytes // (layout.stored**3 * itemsize)
        if slots >= ENOUGH or edge == EDGES[-1]:
            break
    everything = sum(layout.count(level) for level in range(len(layout.levels)))
    return layout, max(min(slots, everything), layout.count(layout.coarsest) + 1)


def _slot_grid(slots: int, stored: int, max_edge: int) -> tuple[int, int, int]:
    """Slots along (x, y, z) of the atlas: at most so many, within the largest edge of a texture."""
    most = max(max_edge // stored, 1)
    x = min(most, max(round(slots ** (1 / 3)), 1))
    y = min(most, max(math.isqrt(slots // x), 1))
    z = min(most, max(slots // (x * y), 1))
    return x, y, z
