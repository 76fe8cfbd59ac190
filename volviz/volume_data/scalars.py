"""Scalars of a volume as texels: format, mapping to fractions of the range, reduced levels; NumPy only.

Shaders see scalars as fractions of `Volume.bulk_range`, 0..1 unless there are outliers. Eight-bit textures are used
only where the GPU filters them precisely (`volviz.custom_gl.gpu.context.Gpu.filters_bytes_precisely`): software
rasterisers filter them to 8 bits, which ruins gradients and isosurfaces.
"""

from __future__ import annotations

import weakref
from dataclasses import dataclass
from threading import Lock
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from volviz.kernels.brick_gradients import brick_gradient_bounds
from volviz.kernels.bricks import brick_min_max
from volviz.kernels.threads import map_ranges
from volviz.volume_data.volume import Volume

Format = Literal["u1", "u2", "f4"]

BRICK = 8

#: Largest fraction of the range that an outlier has as a texel: differences of two stay within 32-bit floats.
FARTHEST = 1e30

#: Levels of detail beside the full one, and the shortest edge in texels that a level may have.
COARSE_LEVELS = 3
MIN_LEVEL_EDGE = 8


@dataclass(frozen=True)
class TextureData:
    """What is uploaded for a volume.

    Attributes
    ----------
    data : ndarray of shape (Z, Y, X), uint8, uint16 or float32
        Texels, C-contiguous.
    scale, offset : float
        Fraction of the bulk's range = texel (normalised to 0..1 for integers) x scale + offset.
    factor : tuple of 3 ints
        Voxels per texel along (x, y, z); above 1 when the volume did not fit.
    """

    data: npt.NDArray[Any]
    scale: float
    offset: float
    factor: tuple[int, int, int] = (1, 1, 1)

    @property
    def format(self) -> Format:
        """Kind of texel."""
        kinds: dict[str, Format] = {"uint8": "u1", "uint16": "u2", "float32": "f4"}
        return kinds[self.data.dtype.name]

    @property
    def index_to_texture(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Scale and offset (x, y, z) from continuous voxel index to texture coordinate."""
        covered = np.array(self.data.shape[::-1], float) * self.factor
        return 1.0 / covered, 0.5 / covered


@dataclass(frozen=True)
class Bricks:
    """Bounds of every brick of a volume, in data units, float32, shape (b_z, b_y, b_x)."""

    low: npt.NDArray[np.float32]
    high: npt.NDArray[np.float32]


_lock = Lock()
_levels: weakref.WeakKeyDictionary[Volume, dict[tuple[Format, int, int], tuple[TextureData, ...]]] = (
    weakref.WeakKeyDictionary()
)
_bricks: weakref.WeakKeyDictionary[Volume, Bricks] = weakref.WeakKeyDictionary()
_texels: weakref.WeakKeyDictionary[Volume, dict[tuple[Format, int, int], TextureData]] = (
    weakref.WeakKeyDictionary()
)
_gradients: weakref.WeakKeyDictionary[Volume, Bricks] = weakref.WeakKeyDictionary()

#: One volume is prepared at a time: the kernels take all processors, and several windows may ask for the same one.
_preparing = Lock()


def bricks_of(volume: Volume) -> Bricks:
    """Min-max bricks of a volume, made once; call it on a worker first for large data."""
    with _lock:
        known = _bricks.get(volume)
    if known is None:
        low, high = brick_min_max(volume.array, BRICK, lowest=volume.range[0])
        if volume.array.dtype.itemsize > 2 and volume.array.dtype != np.float32:
            # float32 cannot hold every value of these types: rounded outwards, the bounds still hold
            low = np.nextafter(low, np.float32(-np.inf))
            high = np.nextafter(high, np.float32(np.inf))
        known = Bricks(low, high)
        with _lock:
            _bricks[volume] = known
    return known


def gradient_bricks_of(volume: Volume) -> Bricks:
    """Bounds of the gradient magnitude in every brick, data units per world unit; made once.

    They hold for central differences over at most a voxel to either side. Half a second for 512^3 voxels.
    """
    with _lock:
        known = _gradients.get(volume)
    if known is None:
        low, high = brick_gradient_bounds(volume.array, BRICK, spacing=volume.spacing, lowest=volume.range[0])
        # a sheared lattice stretches gradients differently along different directions
        stretch = np.linalg.svd(
            np.linalg.inv(volume.index_to_world[:3, :3]).T * np.asarray(volume.spacing), compute_uv=False
        )
        known = Bricks(
            (low * stretch[-1] * (1 - 1e-6)).astype(np.float32),
            (high * stretch[0] * (1 + 1e-6)).astype(np.float32),
        )
        with _lock:
            _gradients[volume] = known
    return known


def known_gradient_bricks(volume: Volume) -> Bricks | None:
    """`gradient_bricks_of` where that has been asked for before."""
    with _lock:
        return _gradients.get(volume)


def choose_format(
    dtype: np.dtype[Any], voxels: int, *, precise_bytes: bool, software: bool, interpolates: bool = False
) -> Format:
    """Texel format for scalars of a type.

    Graphics cards get the smallest format that loses nothing, and so do shaders that interpolate by themselves.
    Software rasterisers filter float32 fastest, as long as memory allows it.
    """
    if dtype.kind == "f" or dtype.itemsize > 2:
        return "f4"
    if software and not interpolates and voxels <= 2**28:
        return "f4"
    if dtype == np.uint8 and (precise_bytes or interpolates):
        return "u1"
    return "u2"


def texture_data_of(volume: Volume, kind: Format, max_edge: int, max_bytes: int) -> TextureData:
    """Texels of a volume, made once per format and limit; call it on a worker first for large data.

    Parameters
    ----------
    volume : Volume
        The data.
    kind : {"u1", "u2", "f4"}
        Format from `choose_format`.
    max_edge : int
        Largest number of texels along an axis.
    max_bytes : int
        Largest number of bytes of all texels; beyond it the volume is reduced by averaging whole blocks.
    """
    key = (kind, max_edge, max_bytes)
    with _lock:
        known = _texels.setdefault(volume, {}).get(key)
    if known is None:
        known = _make_texels(volume, kind, reduction(volume.array.shape, kind, max_edge, max_bytes))
        with _lock:
            _texels.setdefault(volume, {})[key] = known
    return known


def coarser(texels: TextureData) -> TextureData:
    """The next level of detail: means over blocks of 2 x 2 x 2 texels, the last one repeated where odd."""
    data = texels.data
    shape = tuple(-(-n // 2) for n in data.shape)
    out = np.empty(shape, data.dtype)

    whole = data.dtype.kind != "f"
    # sums of eight whole numbers, and of eight floats
    kind = {"uint8": np.uint16, "uint16": np.uint32}.get(data.dtype.name, np.float32)

    def pairs(array: npt.NDArray[Any], axis: int) -> npt.NDArray[Any]:
        even = array[::2] if axis == 0 else array[:, ::2]
        odd = array[1::2] if axis == 0 else array[:, 1::2]
        total = even.copy()
        if axis == 0:
            total[: len(odd)] += odd
            total[len(odd) :] *= 2
        else:
            total[:, : odd.shape[1]] += odd
            total[:, odd.shape[1] :] *= 2
        return total

    def fill(start: int, stop: int) -> None:
        for z in range(start, stop):
            plane = data[2 * z].astype(kind)
            plane += data[min(2 * z + 1, len(data) - 1)]
            total = pairs(pairs(plane, 0), 1)
            # halves are rounded to even numbers
            out[z] = total + 3 + (total >> 3 & 1) >> 3 if whole else total * np.float32(0.125)

    map_ranges(fill, len(out))
    x, y, z = texels.factor
    return TextureData(out, texels.scale, texels.offset, (2 * x, 2 * y, 2 * z))


def levels_of(volume: Volume, kind: Format, max_edge: int, max_bytes: int) -> tuple[TextureData, ...]:
    """Levels of detail of a volume, finest first: each has half as many texels along each axis."""
    key = (kind, max_edge, max_bytes)
    with _lock:
        known = _levels.setdefault(volume, {}).get(key)
    if known is None:
        levels = [texture_data_of(volume, *key)]
        while len(levels) <= COARSE_LEVELS and min(levels[-1].data.shape) >= 2 * MIN_LEVEL_EDGE:
            levels.append(coarser(levels[-1]))
        known = tuple(levels)
        with _lock:
            _levels.setdefault(volume, {})[key] = known
    return known


def held_bytes(volume: Volume) -> int:
    """Bytes of the values of a volume and of all texels that have been made of them."""
    with _lock:
        known = [*_levels.get(volume, {}).values(), *((one,) for one in _texels.get(volume, {}).values())]
    arrays = {id(texels.data): texels.data.nbytes for levels in known for texels in levels}
    return sum({**arrays, id(volume.array): volume.array.nbytes}.values())


def is_prepared(volume: Volume, kind: Format, max_edge: int, max_bytes: int) -> bool:
    """Whether bricks and all levels of a volume are made."""
    with _lock:
        return (kind, max_edge, max_bytes) in _levels.get(volume, {}) and volume in _bricks


def prepare(volume: Volume, kind: Format, max_edge: int, max_bytes: int) -> bool:
    """Make bricks and all levels of a volume, for a thread that nobody waits for; returns True."""
    with _preparing:
        bricks_of(volume)
        levels_of(volume, kind, max_edge, max_bytes)
    return True


def reduction(shape: tuple[int, ...], kind: Format, max_edge: int, max_bytes: int) -> tuple[int, int, int]:
    """Voxels per texel along (x, y, z) that make a volume of shape (Z, Y, X) fit."""
    size = {"u1": 1, "u2": 2, "f4": 4}[kind]
    factor = [max(1, -(-n // max_edge)) for n in shape[::-1]]
    counts = list(shape[::-1])
    while size * np.prod([-(-n // f) for n, f in zip(counts, factor, strict=True)], dtype=float) > max_bytes:
        # reduce the axis with most texels left, so that texels stay as cubic as the voxels are
        axis = int(np.argmax([n / f for n, f in zip(counts, factor, strict=True)]))
        factor[axis] += 1
    return factor[0], factor[1], factor[2]


def _make_texels(volume: Volume, kind: Format, factor: tuple[int, int, int]) -> TextureData:
    low, high = volume.bulk_range
    span = high - low if high > low else 1.0
    same = {"u1": "uint8", "u2": "uint16"}.get(kind, "")
    if factor == (1, 1, 1) and volume.array.dtype.name == same and low == volume.range[0]:
        # the values themselves, counted from the lowest one
        texels = volume.array if low == 0 else volume.array - volume.array.dtype.type(low)
        return TextureData(texels, np.iinfo(volume.array.dtype).max / span, 0.0, factor)
    # what is not finite counts as the lowest value
    array, lowest, missing = volume.array, low, (volume.range[0] - low) / span
    if factor != (1, 1, 1):
        array, lowest = _block_means(array, factor, low, volume.range[0]), 0.0
    # what lies beyond the range of the bulk may lie very far
    farthest = max(high - volume.range[0], volume.range[1] - low) / span
    out = np.empty(array.shape, {"u1": np.uint8, "u2": np.uint16, "f4": np.float32}[kind])
    # bytes are spread over all of 0..65535 by 257, without rounding
    spread = 257 if kind == "u2" and volume.array.dtype == np.uint8 else 1
    scale = {"u1": 255.0, "u2": 65535.0 / spread, "f4": 1.0}[kind] / (1.0 if kind == "f4" else span)
    # the lowest value becomes 0 exactly: below it nothing may be lost to rounding
    wide = array.dtype.itemsize > 4 or (array.dtype.kind in "iu" and array.dtype.itemsize == 4)
    # nor may the range be larger or smaller than 32-bit floats are
    wide = wide or not 1e-30 < span < 1e38 or not farthest * max(span, 1.0) < 1e38

    def fill(start: int, stop: int) -> None:
        for z in range(start, stop):
            above = np.subtract(array[z], lowest, dtype=np.float64 if wide else np.float32)
            if kind == "f4":
                above /= span
                if array.dtype.kind == "f":
                    above[~np.isfinite(array[z])] = missing
                if not farthest < FARTHEST:
                    np.clip(above, -FARTHEST, FARTHEST, out=above)
                out[z] = above
            else:
                out[z] = np.rint(above * spread)

    map_ranges(fill, len(out))
    return TextureData(out, scale, 0.0, factor)


def _block_means(
    array: npt.NDArray[Any], factor: tuple[int, int, int], lowest: float, missing: float
) -> npt.NDArray[np.float32]:
    """Means over blocks of voxels, above `lowest`, with `missing` for what is not finite.

    A last, partial block is filled by repeating the edge.
    """
    fx, fy, fz = factor
    z, y, x = array.shape
    shape = (-(-z // fz), -(-y // fy), -(-x // fx))
    out = np.empty(shape, np.float32)
    pad = ((0, 0), (0, shape[1] * fy - y), (0, shape[2] * fx - x))
    for k in range(shape[0]):
        block = array[np.minimum(np.arange(k * fz, (k + 1) * fz), z - 1)].astype(np.float64)
        if array.dtype.kind == "f":
            block[~np.isfinite(block)] = missing
        block -= lowest
        block = np.pad(block, pad, mode="edge")
        out[k] = block.reshape(fz, shape[1], fy, shape[2], fx).mean(axis=(0, 2, 4))
    return out
