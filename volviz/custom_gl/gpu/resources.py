"""Textures of one volume in one context: scalars, transfer-function table, empty-space fields."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol

import moderngl
import numpy as np
import numpy.typing as npt

from volviz.custom_gl.gpu.context import Gpu, segment_texels
from volviz.custom_gl.gpu.corner_texels import CORNERS, empty_corners, holds_corners, with_neighbours
from volviz.custom_gl.shader_source import layer_name
from volviz.errors import RenderError
from volviz.kernels.brick_gradients import occupancy_2d, visible_plane_sums
from volviz.kernels.bricks import (
    chessboard_distance,
    grow_occupancy,
    occupancy,
    occupancy_for_isovalues,
    visible_prefix,
)
from volviz.model.transfer.function import MAX_TABLE, TransferFunction
from volviz.model.transfer.tables import Table, baked, plane_ranges, rows_of, table_entries
from volviz.tasks import LatestResult, Tasks
from volviz.volume_data.scalars import (
    BRICK,
    Bricks,
    TextureData,
    bricks_of,
    choose_format,
    gradient_bricks_of,
    known_gradient_bricks,
    levels_of,
    texture_data_of,
)
from volviz.volume_data.volume import Volume

if TYPE_CHECKING:
    from volviz.custom_gl.gpu.programs import Program

#: Bytes uploaded at once, so that the GUI thread is never held up for long.
SLAB_BYTES = 4 * 2**20
#: Volumes of at most so many voxels have the gradients of their bricks bounded on the calling thread: 20 ms.
SMALL_VOXELS = 2**20
PREINTEGRATED_SIZE = 512
PREINTEGRATED_SIZE_INTERACTIVE = 256


class ScalarPack(Protocol):
    """Scalars of several volumes in one texture."""

    @property
    def texture(self) -> Any:
        """Where they are, one component each."""


class SampledFrame(Protocol):
    """What of a `volviz.custom_gl.technique.Frame` decides which textures its rays need."""

    volume: Volume
    transfer_function: TransferFunction
    common: Any
    scene_depth: Any
    interactive: bool
    tasks: Tasks

    @property
    def step_world(self) -> float:
        """Distance between samples in world units."""


class VolumeResources:
    """Textures of a volume, made when first needed and keyed by the identity of what they come from.

    Parameters
    ----------
    gpu : Gpu
        Where they are.
    volume : Volume
        What they show.
    pack : ScalarPack, optional
        Holds the scalars together with those of other volumes of the lattice; there is one level of detail then.

    Attributes
    ----------
    scalars : moderngl.Texture3D
        Scalars, red channel, linear filter, clamped.
    texels : TextureData
        Mapping of texels to fractions of the data range and of voxels to texture coordinates.
    """

    def __init__(self, gpu: Gpu, volume: Volume, pack: ScalarPack | None = None) -> None:
        self.gpu = gpu
        self.volume = volume
        self._limits = texel_limits(gpu, volume, alone=pack is None)
        self.texels: TextureData = texture_data_of(volume, *self._limits)
        self._has_corners = pack is None and takes_corners(gpu, volume)
        self._uploaded = 0
        self._pack = pack
        #: Made when something is written into it: of a time point that passes, coarser levels alone are drawn.
        self.scalars: Any = None if pack is None else pack.texture
        self._levels: dict[int, tuple[TextureData, Any]] = {0: (self.texels, self.scalars)}
        self._tables: dict[str, tuple[Any, Any]] = {}
        self._distances: dict[str, tuple[Any, Any]] = {}
        self._last_table: tuple[Any, Table] | None = None
        self._gradients: LatestResult[Volume, Bricks] = LatestResult("gradients", cancels=False)

    # ------------------------------------------------------------------ scalars

    @property
    def fetch(self) -> str:
        """File of the hook that reads the scalars."""
        if not self._has_corners:
            return "fetch/texture.glsl"
        return "fetch/corners8.glsl" if self.texels.format == "u1" else "fetch/corners16.glsl"

    def _empty_scalars(self, texels: TextureData) -> Any:
        if self._has_corners:
            return empty_corners(self.gpu.gl, texels.data)
        return empty_scalars(self.gpu, texels, 1, self.volume.name)

    @property
    def voxel_scale(self) -> float:
        """Voxels of the volume that one of the finest level drawn is long: 1 unless finer ones are not there yet."""
        return 1.0

    @property
    def complete(self) -> bool:
        """Whether all scalars are on the GPU."""
        return self._pack is not None or self._uploaded >= len(self._levels[0][0].data)

    def upload(self, max_bytes: int | None = None) -> bool:
        """Upload further slabs of scalars, at least one; True when all are there.

        Parameters
        ----------
        max_bytes : int, optional
            Stop after about that many bytes; None uploads everything.
        """
        if not self.complete and self._levels[0][1] is None:
            full = self._levels[0][0]
            self._levels[0] = (full, self._empty_scalars(full))
        data, texture = self._levels[0][0].data, self._levels[0][1]
        plane = data[0].nbytes * (CORNERS if self._has_corners else 1)
        done = 0
        while not self.complete and (max_bytes is None or done < max_bytes):
            count = min(max(SLAB_BYTES // plane, 1), len(data) - self._uploaded)
            stop = self._uploaded + count
            slab = self._stored(data, self._uploaded, stop)
            x, y = data.shape[2], data.shape[1]
            texture.write(slab, viewport=(0, 0, self._uploaded, x, y, count), alignment=1)
            self._uploaded += count
            done += slab.nbytes
            self.gpu.uploads += 1
        return self.complete

    def _stored(self, data: npt.NDArray[Any], start: int, stop: int) -> npt.NDArray[Any]:
        """Planes as they are uploaded."""
        return with_neighbours(data, start, stop) if self._has_corners else data[start:stop]

    @property
    def full_factor(self) -> tuple[int, int, int]:
        """Voxels per texel along (x, y, z) at the finest level; above 1 when the volume did not fit."""
        return self._levels[0][0].factor

    @property
    def finest(self) -> int:
        """Number of the finest level of detail that can be drawn: the full one when all of it is uploaded."""
        return 0 if self.complete else min(1, self.coarsest)

    @property
    def coarsest(self) -> int:
        """Number of the coarsest level of detail."""
        if self._pack is not None:
            return 0
        return len(levels_of(self.volume, *self._limits)) - 1

    def select(self, level: int) -> None:
        """Let `texels` and `scalars` be those of a level of detail, 0 = full; coarser ones are small."""
        held = self._levels.get(level)
        if held is None:
            texels = levels_of(self.volume, *self._limits)[level]
            texture = self._empty_scalars(texels)
            texture.write(self._stored(texels.data, 0, len(texels.data)), alignment=1)
            self.gpu.uploads += 1
            held = self._levels[level] = (texels, texture)
        self.texels, self.scalars = held

    # ------------------------------------------------------------------ tables

    def table(
        self, transfer_function: TransferFunction, *, length: float | None = None, interactive: bool = False
    ) -> Any:
        """The baked transfer function as a texture (see `tables.Table`).

        Parameters
        ----------
        transfer_function : TransferFunction
            In data units.
        length : float, optional
            Opacities are those of segments of ray of that length, in unit distances; None is one unit distance.
        interactive : bool, default: False
            A smaller table where the function is one of value and gradient.
        """

        def make() -> Any:
            table = self._baked(transfer_function, interactive=interactive)
            texels = table.texels if length is None else table.per_length(length)
            if table.gradients is None:
                return self.gpu.segments_texture(Table.folded(segment_texels(texels)))
            return self.gpu.table_texture(texels)

        key = (transfer_function, length, interactive and transfer_function.by_gradient is not None)
        return self._cached(self._tables, "table" if length is None else "table per length", key, make)

    def preintegrated(self, transfer_function: TransferFunction, size: int, threshold: float) -> Any:
        """Premultiplied colour and opacity of segments one unit distance long, by their ends' scalars."""
        from volviz.kernels.preintegration import preintegration_table

        def make() -> Any:
            data_range = self._preintegration_range(transfer_function)
            table = transfer_function.bake(data_range, self._entries(transfer_function, data_range))
            table[: self._below(threshold, data_range, len(table)), 3] = 0.0
            return self.gpu.table_texture(preintegration_table(table, 1.0, size))

        return self._cached(self._tables, "preintegrated", (transfer_function, size, threshold), make)

    def _below(self, threshold: float, data_range: tuple[float, float], entries: int) -> int:
        """Number of entries of a table over a range that lie below a density threshold."""
        (low, high), (first, last) = self.volume.bulk_range, data_range
        share = (low + threshold * (high - low) - first) / (last - first) if last > first else 0.0
        return min(max(int(np.ceil(share * (entries - 1))), 0), entries) if threshold > 0 else 0

    def _baked(self, transfer_function: TransferFunction, *, interactive: bool = False) -> Table:
        """The table of a function; the last one is kept, since texture and empty space both come from it."""
        key = (transfer_function, interactive)
        if self._last_table is None or self._last_table[0] != key:
            self._last_table = (key, baked(transfer_function, self.volume, interactive=interactive))
        return self._last_table[1]

    def _entries(self, function: TransferFunction, data_range: tuple[float, float]) -> int:
        return function.table_size(data_range, integer=self.volume.array.dtype.kind in "iu")

    def folds_table(self, function: TransferFunction) -> bool:
        """Whether the table of a function takes several rows of its texture."""
        return function.by_gradient is None and rows_of(table_entries(function, self.volume)[0]) > 1

    def table_uniforms(self, transfer_function: TransferFunction, *, interactive: bool) -> dict[str, Any]:
        """Uniforms of ``glsl/classification.glsl`` that say where a value and a gradient lie in the table."""
        columns, rows = table_entries(transfer_function, self.volume, interactive=interactive)
        if transfer_function.by_gradient is None:
            data_range = transfer_function.table_range(self.volume.range)
            return {
                "u_table_map": self._lookup(data_range),
                "u_table_last": float(columns - 1),
                "u_table_segment": 1.0 / min(columns - 1, MAX_TABLE),
                "u_table_row": 1.0 / rows_of(columns - 1),
            }
        values, gradients = plane_ranges(transfer_function.by_gradient, self.volume)
        low, high = self.volume.bulk_range
        height = gradients[1] - gradients[0]
        return {
            "u_table_map": self._lookup(values),
            "u_table_last": float(columns - 1),
            "u_plane_map": ((high - low) / height, -gradients[0] / height),
            "u_plane_texels": ((columns - 1) / columns, (rows - 1) / rows, 0.5 / columns, 0.5 / rows),
        }

    def _lookup(self, data_range: tuple[float, float]) -> tuple[float, float]:
        """From fractions of the bulk's range to positions in a table: scale and offset."""
        (low, high), (first, last) = self.volume.bulk_range, data_range
        span = last - first if last > first else 1.0
        return (high - low) / span, (low - first) / span

    def _preintegration_range(self, transfer_function: TransferFunction) -> tuple[float, float]:
        """The whole range, so that segments that leave the table stay exact, unless outliers would waste it."""
        (low, high), (first, last) = self.volume.range, transfer_function.table_range(self.volume.range)
        return (first, last) if high - low > 8 * (last - first) else (low, high)

    # ------------------------------------------------------------------ empty space

    def visible_distance(self, frame: SampledFrame) -> Any:
        """Empty-space field for what the frame's transfer function shows (see `occupied`)."""
        margin = _margin(frame)

        def make() -> Any:
            occupied = self.occupied(frame)
            return self._distance_texture(grow_occupancy(occupied, margin) if margin else occupied)

        slot = f"visible, {max(self.texels.factor)} voxels a texel"
        return self._cached(self._distances, slot, (margin, *self.occupancy_key(frame)), make)

    def occupancy_key(self, frame: SampledFrame) -> tuple[Any, ...]:
        """Everything that `occupied` depends on; equal keys, equal bricks."""
        function = frame.transfer_function
        if function.by_gradient is None:
            return function, frame.common.density_threshold
        known = self._gradient_bricks(frame) is not None
        return (
            function,
            frame.common.density_threshold,
            frame.interactive,
            known,
            _bricks_of_differences(frame),
        )

    def occupied(self, frame: SampledFrame) -> npt.NDArray[np.bool_]:
        """Which bricks may hold anything visible, shape (b_z, b_y, b_x).

        Regions are looked at by value alone until the gradients of a large volume are known.
        """
        table = self._baked(frame.transfer_function, interactive=frame.interactive)
        opacity = table.opacity.copy()
        below = self._below(frame.common.density_threshold, table.values, opacity.shape[1])
        opacity[:, : max(below - 1, 0)] = 0.0
        bricks = bricks_of(self.volume)
        if table.gradients is None:
            return occupancy(bricks.low, bricks.high, visible_prefix(opacity[0]), table.values)
        gradients = self._gradient_bricks(frame)
        bounds = None if gradients is None else (gradients.low, gradients.high)
        reach = _bricks_of_differences(frame)
        if bounds is not None and reach:
            from scipy.ndimage import maximum_filter, minimum_filter

            size = 2 * reach + 1
            bounds = minimum_filter(bounds[0], size), maximum_filter(bounds[1], size)
        return occupancy_2d(
            (bricks.low, bricks.high), bounds, visible_plane_sums(opacity), table.values, table.gradients
        )

    def _gradient_bricks(self, frame: SampledFrame) -> Bricks | None:
        """Bounds of the gradients; None for a large volume until a task has found them."""
        volume = self.volume
        known = known_gradient_bricks(volume)
        if known is None and volume.array.size <= SMALL_VOXELS:
            known = gradient_bricks_of(volume)
        if known is None:
            known = self._gradients.get(
                frame.tasks, volume, lambda _progress, _cancel: gradient_bricks_of(volume)
            )
        return known

    def isovalue_distance(self, isovalues: Sequence[float]) -> Any:
        """Empty-space field for surfaces of these isovalues (data units)."""
        key = tuple(float(v) for v in isovalues)

        slot = f"isovalues, {max(self.texels.factor)} voxels a texel"
        return self._cached(self._distances, slot, key, lambda: self._distance_texture(self.crossed(key)))

    def crossed(self, isovalues: Sequence[float]) -> npt.NDArray[np.bool_]:
        """Bricks that surfaces of these isovalues (data units) may cross, shape (b_z, b_y, b_x)."""
        bricks = bricks_of(self.volume)
        return occupancy_for_isovalues(bricks.low, bricks.high, isovalues)

    def _distance_texture(self, occupied: Any) -> Any:
        return distance_texture(self.gpu, distance_codes(occupied, max(self.texels.factor)))

    @property
    def gradient_scale(self) -> float:
        """From this gradient on nothing is taken away: a quarter of the range per mean spacing."""
        return 0.25 / self.volume.mean_spacing

    # ------------------------------------------------------------------ binding

    def bind(
        self, program: Program, frame: SampledFrame, table_length: float | None = None, layer: int = 0
    ) -> None:
        """Bind every texture that the program asks for.

        Parameters
        ----------
        program : Program
            Whose samplers are meant.
        frame : SampledFrame
            What is drawn.
        table_length : float, optional
            Length of ray to which opacities of the table belong (see `table`).
        layer : int, default: 0
            In which this volume stands in the program (see `volviz.custom_gl.shader_source`).
        """

        def asked(name: str) -> bool:
            return layer_name(name, layer) in program.units

        program.use_texture("t_scalars", self.scalars, layer)
        if self._has_corners:
            z, y, x = self.texels.data.shape
            program.set({"u_texels": (x, y, z), "u_texel": (1.0 / x, 1.0 / y, 1.0 / z)}, layer)
        for name in ("t_segments", "t_table"):
            if asked(name):
                table = self.table(
                    frame.transfer_function, length=table_length, interactive=frame.interactive
                )
                program.use_texture(name, table, layer)
        if "t_scene_depth" in program.units:
            program.use_texture("t_scene_depth", frame.scene_depth)
        if asked("t_preintegrated"):
            size = PREINTEGRATED_SIZE_INTERACTIVE if frame.interactive else PREINTEGRATED_SIZE
            program.use_texture(
                "t_preintegrated",
                self.preintegrated(frame.transfer_function, size, frame.common.density_threshold),
                layer,
            )
            program.set(
                {
                    "u_preintegrated_map": ((size - 1) / size, 0.5 / size),
                    "u_preintegrated_range": self._lookup(
                        self._preintegration_range(frame.transfer_function)
                    ),
                },
                layer,
            )
        if asked("t_distance"):
            program.use_texture("t_distance", self.visible_distance(frame), layer)

    def brick_uniforms(self) -> dict[str, Any]:
        """Uniforms of ``glsl/empty_space.glsl``."""
        return brick_uniforms(self.texels, self.volume)

    def _cached(self, cache: dict[str, tuple[Any, Any]], slot: str, key: Any, make: Any) -> Any:
        """The texture in a slot, remade when the key is another object or value."""
        held = cache.get(slot)
        if held is not None and (held[0] is key or held[0] == key):
            return held[1]
        texture = make()
        if held is not None:
            held[1].release()
        cache[slot] = (key, texture)
        return texture

    def release(self) -> None:
        """Release all textures but those of a pack; the context must be current."""
        for _, texture in self._levels.values():
            if self._pack is None and texture is not None:
                texture.release()
        self._levels.clear()
        for cache in (self._tables, self._distances):
            for _, texture in cache.values():
                texture.release()
            cache.clear()


def brick_uniforms(texels: TextureData, volume: Volume) -> dict[str, Any]:
    """Uniforms of ``glsl/empty_space.glsl``."""
    scale, _ = texels.index_to_texture
    bricks = [-(-n // BRICK) for n in volume.dimensions]
    return {
        "u_bricks_per_texture": tuple(1.0 / (scale * BRICK)),
        "u_brick_offset": (-0.5 / BRICK,) * 3,
        "u_last_brick": tuple(n - 1.0 for n in bricks),
        "u_brick_edge": tuple(1.0 / n for n in bricks),
    }


def distance_codes(occupied: npt.NDArray[np.bool_], coarse: int = 1) -> npt.NDArray[np.float32]:
    """A field of empty space as ``glsl/empty_space.glsl`` reads it, shape (b_z, b_y, b_x).

    Parameters
    ----------
    occupied : ndarray of shape (b_z, b_y, b_x)
        Bricks that may be visible.
    coarse : int
        Voxels per texel.
    """
    if coarse > 1:
        # texels of a reduced volume mix voxels from farther away than the bricks' own margin
        occupied = grow_occupancy(occupied, -(-3 * coarse // (2 * BRICK)))
    empty = np.minimum(chessboard_distance(occupied), 127)
    visible = np.minimum(chessboard_distance(~occupied), 128) + 127
    # as floats: they need no unpacking where OpenGL is computed in software
    return np.where(occupied, visible, empty).astype(np.float32)


def empty_scalars(gpu: Gpu, texels: TextureData, components: int, name: str) -> Any:
    """A texture for scalars of so many volumes, to be filled."""
    z, y, x = texels.data.shape
    dtype = {"u1": "f1", "u2": "nu2", "f4": "f4"}[texels.format]
    texture = gpu.gl.texture3d((x, y, z), components, dtype=dtype, alignment=1)
    if gpu.gl.error == "GL_OUT_OF_MEMORY":
        texture.release()
        raise RenderError(
            f"{name}: the graphics memory has no room for {components * texels.data.nbytes / 2**20:.0f} MB; set "
            "VOLVIZ_TEXTURE_MB to less, and the volume is drawn coarser."
        )
    texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
    texture.repeat_x = texture.repeat_y = texture.repeat_z = False
    return texture


def distance_texture(gpu: Gpu, codes: npt.NDArray[np.float32]) -> Any:
    """A field of empty space as a texture."""
    z, y, x = codes.shape
    texture = gpu.gl.texture3d((x, y, z), 1, codes.tobytes(), alignment=1, dtype="f4")
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    texture.repeat_x = texture.repeat_y = texture.repeat_z = False
    gpu.uploads += 1
    return texture


def _bricks_of_differences(frame: SampledFrame) -> int:
    """Bricks that central differences reach beyond what the bounds of their own brick cover, one voxel."""
    delta: float = frame.common.gradient_delta
    return math.ceil(max(delta - 1.0, 0.0) / BRICK)


def _margin(frame: SampledFrame) -> int:
    """Bricks that empty space must keep away from what is visible: pre-integration looks at both ends of a step."""
    if not frame.common.preintegrated:
        return 0
    return math.ceil((frame.step_world / min(frame.volume.spacing) + 1.0) / BRICK)


def takes_corners(gpu: Gpu, volume: Volume) -> bool:
    """Whether a volume that is drawn alone has its values stored with their neighbours (`corner_texels`)."""
    dtype = volume.array.dtype
    if not gpu.limits.software or dtype.kind == "f":
        return False
    return holds_corners(volume.array.size, dtype.itemsize, gpu.max_texture_bytes)


def texel_limits(gpu: Gpu, volume: Volume, *, alone: bool) -> tuple[Any, int, int]:
    """Format and limits with which `texture_data_of` makes the texels that this GPU takes.

    Parameters
    ----------
    gpu : Gpu
    volume : Volume
    alone : bool
        It has a texture to itself.
    """
    kind = choose_format(
        volume.array.dtype,
        volume.array.size,
        precise_bytes=not gpu.limits.software and gpu.filters_bytes_precisely,
        software=gpu.limits.software,
        interpolates=alone and takes_corners(gpu, volume),
    )
    return kind, gpu.limits.max_3d_texture, gpu.max_texture_bytes
