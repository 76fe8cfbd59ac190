"""Splats: the voxels above an isovalue, with their gradient normals, culled and found by bricks.

A voxel is selected when its value is *strictly* above the isovalue. For opaque splats only the shell
matters: a voxel whose 26 neighbours are all selected is hidden and left out. Beyond the border of the
volume nothing is selected, so the cut faces of an object keep their splats.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.kernels.arrays import check_scalars, native_slab
from volviz.kernels.bricks import DEFAULT_BRICK, brick_grid_shape, brick_min_max
from volviz.kernels.compiled import compiled
from volviz.kernels.gradient import inverse_spacing, slopes
from volviz.kernels.threads import map_ranges

if TYPE_CHECKING:
    from collections.abc import Sequence

AnyArray = npt.NDArray[Any]
Float32Array = npt.NDArray[np.float32]
BoolArray = npt.NDArray[np.bool_]


class Splats(NamedTuple):
    """Selected voxels, ordered by z, then y, then x.

    Attributes
    ----------
    positions : ndarray of shape (N, 3), float32
        Voxel indices (i, j, k): whole numbers, to be mapped to the world by the volume's matrix.
    normals : ndarray of shape (N, 3), float32
        Unit vectors in the world from high to low values, out of what is above the isovalue; (0, 0, 0)
        where the gradient is zero.
    values : ndarray of shape (N,), float64
        In data units; `lowest` where the volume has no finite value.
    """

    positions: Float32Array
    normals: Float32Array
    values: npt.NDArray[np.float64]


def select_splats(
    array: AnyArray,
    isovalue: float,
    *,
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    direction: npt.ArrayLike | None = None,
    splats_per_axis: int | None = None,
    cull_interior: bool = True,
    bricks: tuple[Float32Array, Float32Array] | None = None,
    brick: int = DEFAULT_BRICK,
    lowest: float = 0.0,
) -> Splats:
    """Voxels above an isovalue, with normals.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars of any real type, in data units. NaN and infinities count as `lowest`.
    isovalue : float
        In data units; voxels strictly above it are selected.
    spacing : tuple of 3 floats
        Distance of voxel centres along (x, y, z), world units; for the normals.
    direction : array_like of shape (3, 3), optional
        Columns are the world directions of the index axes; None = identity; for the normals.
    splats_per_axis : int, optional
        At most that many splats along each axis: voxel ``floor(i N / n)`` for i = 0 .. n - 1 (the classic
        lattice has 64, which is every fourth of 256). None = every voxel. Neighbours are then those on the
        lattice.
    cull_interior : bool, default: True
        Leave out voxels whose 26 neighbours are selected too. False for translucent splats.
    bricks : (mins, maxs), optional
        From `brick_min_max` with the same `brick` and `lowest`; made here when missing. Only used for every
        voxel.
    brick : int, default: 8
        Edge of a brick in voxels.
    lowest : float
        Lowest finite value of the volume.

    Returns
    -------
    Splats
        Empty when no voxel is above the isovalue.

    Raises
    ------
    InputError
        Not a volume, an isovalue that is not finite, fewer than 1 splat per axis, bricks of another volume.
    """
    check_scalars(array)
    if not np.isfinite(isovalue):
        raise InputError(f"isovalue must be a finite number, got {isovalue}.")
    scale = inverse_spacing(spacing)
    axes: Any = np.eye(3) if direction is None else np.asarray(direction, np.float64).reshape(3, 3)
    matrix = np.ascontiguousarray(axes * scale)
    if splats_per_axis is not None:
        if splats_per_axis < 1:
            raise InputError(f"splats_per_axis must be at least 1, got {splats_per_axis}.")
        return _on_lattice(array, float(isovalue), matrix, splats_per_axis, cull_interior, float(lowest))
    grid = brick_grid_shape(array.shape, brick)
    if bricks is None:
        bricks = brick_min_max(array, brick, lowest=lowest)
    if bricks[0].shape != grid or bricks[1].shape != grid:
        raise InputError(
            f"bricks of shape {bricks[0].shape} do not fit a volume of {grid} bricks; "
            "make them with brick_min_max."
        )
    return _every_voxel(array, float(isovalue), matrix, bricks, brick, cull_interior, float(lowest))


def _margin(isovalue: float) -> float:
    """Rounding of the bricks' float32 bounds, which may hide a double just above the isovalue."""
    return 2.0 * float(np.finfo(np.float32).eps) * abs(isovalue)


def _every_voxel(
    array: AnyArray,
    isovalue: float,
    matrix: npt.NDArray[np.float64],
    bricks: tuple[Float32Array, Float32Array],
    brick: int,
    cull: bool,
    lowest: float,
) -> Splats:
    """Layer of bricks by layer of bricks, on threads; layers and rows that hold nothing are passed over."""
    depth = array.shape[0]
    maxs = bricks[1]
    margin = _margin(isovalue)
    touched: BoolArray = np.any(maxs > isovalue - margin, axis=2, keepdims=True)[:, :, 0]

    def scan(first: int, last: int) -> list[Splats]:
        layers = []
        for b in range(first, last):
            if not touched[b].any():
                continue
            z0, z1 = b * brick, min((b + 1) * brick, depth)
            start = max(z0 - 1, 0)
            slab = native_slab(array, start, min(z1 + 1, depth))
            marks = np.zeros((z1 - z0, *slab.shape[1:]), np.uint8)
            count = _mark(slab, z0 - start, isovalue, lowest, cull, touched[b], brick, marks)
            splats = _empty(count)
            _fill(slab, z0 - start, start, marks, lowest, matrix, *splats)
            layers.append(splats)
        return layers

    layers = [layer for piece in map_ranges(scan, maxs.shape[0]) for layer in piece]
    if not layers:
        return _empty(0)
    return Splats(
        np.concatenate([layer.positions for layer in layers]),
        np.concatenate([layer.normals for layer in layers]),
        np.concatenate([layer.values for layer in layers]),
    )


def _empty(count: int) -> Splats:
    return Splats(
        np.empty((count, 3), np.float32), np.empty((count, 3), np.float32), np.empty(count, np.float64)
    )


@compiled
def _mark(
    slab: AnyArray,
    first: int,
    isovalue: float,
    lowest: float,
    cull: bool,
    touched: BoolArray,
    brick: int,
    marks: npt.NDArray[np.uint8],
) -> int:
    """Mark the voxels of one layer of bricks that become splats, and count them.

    `slab` holds the layer's planes from `first` on and their neighbours; it lacks a neighbour only at the
    border of the volume. A voxel is hidden when the selection, eroded along x, then y, then z, still holds
    it; rows at a time, so that the loops vectorise. Rows of bricks that are not `touched` hold nothing.
    """
    planes, ny, nx = marks.shape
    nz = slab.shape[0]
    inside = np.zeros((nz, ny, nx), np.uint8)
    eroded = np.zeros((nz, ny, nx), np.uint8)
    for z in range(nz):
        for y in range(ny):
            if not touched[y // brick]:
                continue
            for x in range(nx):
                v = np.float64(slab[z, y, x])
                inside[z, y, x] = (v if v - v == 0 else lowest) > isovalue
            if cull:
                for x in range(1, nx - 1):
                    eroded[z, y, x] = inside[z, y, x - 1] & inside[z, y, x] & inside[z, y, x + 1]
    count = 0
    hidden = np.zeros(nx, np.uint8)
    for p in range(planes):
        z = p + first
        for y in range(ny):
            if not touched[y // brick]:
                continue
            hidden[:] = 0
            if cull and 0 < z < nz - 1 and 0 < y < ny - 1:
                hidden[:] = 1
                for dz in range(-1, 2):
                    for dy in range(-1, 2):
                        for x in range(nx):
                            hidden[x] &= eroded[z + dz, y + dy, x]
            for x in range(nx):
                mark = inside[z, y, x] & (1 - hidden[x])
                marks[p, y, x] = mark
                count += mark
    return count


@compiled
def _fill(
    slab: AnyArray,
    first: int,
    start: int,
    marks: npt.NDArray[np.uint8],
    lowest: float,
    matrix: npt.NDArray[np.float64],
    positions: Float32Array,
    normals: Float32Array,
    values: npt.NDArray[np.float64],
) -> None:
    """Write the marked voxels in order of z, y, x."""
    planes, ny, nx = marks.shape
    n = 0
    for z in range(planes):
        for y in range(ny):
            for x in range(nx):
                if marks[z, y, x] == 0:
                    continue
                _write(slab, z + first, y, x, lowest, matrix, normals[n])
                positions[n, 0], positions[n, 1], positions[n, 2] = x, y, z + first + start
                v = np.float64(slab[z + first, y, x])
                values[n] = v if v - v == 0 else lowest
                n += 1


@compiled
def _write(
    slab: AnyArray,
    z: int,
    y: int,
    x: int,
    lowest: float,
    matrix: npt.NDArray[np.float64],
    normal: Float32Array,
) -> None:
    """Unit normal at one voxel, from high to low values."""
    di, dj, dk = slopes(slab, z, y, x, lowest)
    gx = matrix[0, 0] * di + matrix[0, 1] * dj + matrix[0, 2] * dk
    gy = matrix[1, 0] * di + matrix[1, 1] * dj + matrix[1, 2] * dk
    gz = matrix[2, 0] * di + matrix[2, 1] * dj + matrix[2, 2] * dk
    length = np.sqrt(gx * gx + gy * gy + gz * gz)
    factor = -1.0 / length if length > 0 else 0.0
    normal[0], normal[1], normal[2] = gx * factor, gy * factor, gz * factor


def _on_lattice(
    array: AnyArray,
    isovalue: float,
    matrix: npt.NDArray[np.float64],
    per_axis: int,
    cull: bool,
    lowest: float,
) -> Splats:
    """Every n-th voxel: few enough to need no bricks."""
    chosen = [np.arange(min(per_axis, n)) * n // min(per_axis, n) for n in array.shape]
    zs, ys, xs = chosen
    lattice = np.asarray(array[np.ix_(zs, ys, xs)], np.float64)
    lattice = np.where(np.isfinite(lattice), lattice, lowest)
    inside = lattice > isovalue
    shown = inside
    if cull:
        surrounded = np.pad(inside, 1)
        for axis in range(3):
            surrounded = surrounded & np.roll(surrounded, 1, axis) & np.roll(surrounded, -1, axis)
        shown = inside & ~surrounded[1:-1, 1:-1, 1:-1]
    at = np.argwhere(shown)
    splats = _empty(len(at))
    splats.positions[:] = np.stack([xs[at[:, 2]], ys[at[:, 1]], zs[at[:, 0]]], axis=1)
    splats.values[:] = lattice[shown]
    # normals come from the neighbouring voxels of the full volume, plane by plane
    for plane in np.unique(at[:, 0]):
        of_plane = np.flatnonzero(at[:, 0] == plane)
        z = int(zs[plane])
        start = max(z - 1, 0)
        slab = native_slab(array, start, min(z + 2, array.shape[0]))
        _normals_of_plane(
            slab, z - start, splats.positions[of_plane], of_plane, lowest, matrix, splats.normals
        )
    return splats


@compiled
def _normals_of_plane(
    slab: AnyArray,
    z: int,
    positions: Float32Array,
    rows: npt.NDArray[np.int64],
    lowest: float,
    matrix: npt.NDArray[np.float64],
    normals: Float32Array,
) -> None:
    for n in range(len(rows)):
        _write(slab, z, int(positions[n, 1]), int(positions[n, 0]), lowest, matrix, normals[rows[n]])
