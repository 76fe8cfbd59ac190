"""Central differences of volumes, in world units.

Inside, the difference of both neighbours over two spacings; at the border, of the voxel and its one
neighbour over one spacing, as in `numpy.gradient`. An axis of one voxel has slope 0. NaN and infinities
count as `lowest`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.kernels.arrays import check_scalars, native_slab
from volviz.kernels.compiled import compiled
from volviz.kernels.threads import map_ranges

if TYPE_CHECKING:
    from collections.abc import Sequence

AnyArray = npt.NDArray[Any]
Float32Array = npt.NDArray[np.float32]
Float64Array = npt.NDArray[np.float64]


class GradientStatistics(NamedTuple):
    """Size of the gradients of a volume, data units per world unit."""

    maximum: float
    mean: float


def inverse_spacing(spacing: Sequence[float]) -> Float64Array:
    """1 / spacing along (x, y, z), checked."""
    values = np.asarray(spacing, np.float64)
    if values.shape != (3,) or not np.all(values > 0):
        raise InputError(f"spacing must be three numbers greater than 0 (x, y, z), got {spacing!r}.")
    return 1.0 / values


def gradient(
    array: AnyArray,
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    direction: npt.ArrayLike | None = None,
    *,
    lowest: float = 0.0,
) -> Float32Array:
    """World gradient at every voxel.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars of any real type, in data units.
    spacing : tuple of 3 floats
        Distance of voxel centres along (x, y, z), world units.
    direction : array_like of shape (3, 3), optional
        Columns are the world directions of the index axes; None = identity.
    lowest : float
        Value that NaN and infinities count as.

    Returns
    -------
    ndarray of shape (Z, Y, X, 3), float32
        Components along world (x, y, z), data units per world unit; points from low to high values.
    """
    check_scalars(array)
    scale = inverse_spacing(spacing)
    axes: Any = np.eye(3) if direction is None else np.asarray(direction, np.float64).reshape(3, 3)
    matrix = np.ascontiguousarray(axes * scale)
    result = np.empty((*array.shape, 3), np.float32)

    def fill(first: int, last: int) -> None:
        slab, offset = slab_with_neighbours(array, first, last)
        _fill_gradient(slab, offset, float(lowest), matrix, result[first:last])

    map_ranges(fill, array.shape[0])
    return result


def gradient_magnitude(
    array: AnyArray, spacing: Sequence[float] = (1.0, 1.0, 1.0), *, lowest: float = 0.0
) -> Float32Array:
    """Length of the world gradient at every voxel.

    Parameters
    ----------
    array, spacing, lowest
        As in `gradient`.

    Returns
    -------
    ndarray of shape (Z, Y, X), float32
        Data units per world unit.
    """
    check_scalars(array)
    scale = inverse_spacing(spacing)
    result = np.empty(array.shape, np.float32)

    def fill(first: int, last: int) -> None:
        slab, offset = slab_with_neighbours(array, first, last)
        for z in range(first, last):
            magnitude_plane(slab, z - first + offset, float(lowest), scale, result[z])

    map_ranges(fill, array.shape[0])
    return result


def gradient_statistics(
    array: AnyArray, spacing: Sequence[float] = (1.0, 1.0, 1.0), *, lowest: float = 0.0
) -> GradientStatistics:
    """Largest and mean gradient magnitude, without keeping the magnitudes.

    Parameters
    ----------
    array, spacing, lowest
        As in `gradient`.
    """
    check_scalars(array)
    scale = inverse_spacing(spacing)

    def scan(first: int, last: int) -> tuple[float, float]:
        slab, offset = slab_with_neighbours(array, first, last)
        plane = np.empty(array.shape[1:], np.float32)
        largest, total = 0.0, 0.0
        for z in range(last - first):
            magnitude_plane(slab, z + offset, float(lowest), scale, plane)
            largest = max(largest, float(plane.max()))
            total += float(plane.sum(dtype=np.float64))
        return largest, total

    pieces = map_ranges(scan, array.shape[0])
    return GradientStatistics(max(p[0] for p in pieces), sum(p[1] for p in pieces) / array.size)


def slab_with_neighbours(array: AnyArray, first: int, last: int) -> tuple[AnyArray, int]:
    """Planes ``first:last`` with their neighbours where there are any, and the place of `first` in them."""
    start = max(first - 1, 0)
    return native_slab(array, start, min(last + 1, array.shape[0])), first - start


@compiled
def _finite(value: Any, lowest: float) -> Any:
    v = np.float64(value)
    return v if v - v == 0 else lowest


@compiled
def slopes(slab: AnyArray, z: int, y: int, x: int, lowest: float) -> tuple[float, float, float]:
    """Differences per voxel along (i, j, k) at one voxel of a slab that holds its neighbours."""
    nz, ny, nx = slab.shape
    x0, x1 = max(x - 1, 0), min(x + 1, nx - 1)
    y0, y1 = max(y - 1, 0), min(y + 1, ny - 1)
    z0, z1 = max(z - 1, 0), min(z + 1, nz - 1)
    di = (_finite(slab[z, y, x1], lowest) - _finite(slab[z, y, x0], lowest)) / max(x1 - x0, 1)
    dj = (_finite(slab[z, y1, x], lowest) - _finite(slab[z, y0, x], lowest)) / max(y1 - y0, 1)
    dk = (_finite(slab[z1, y, x], lowest) - _finite(slab[z0, y, x], lowest)) / max(z1 - z0, 1)
    return di, dj, dk


@compiled
def _fill_gradient(
    slab: AnyArray, offset: int, lowest: float, matrix: Float64Array, result: Float32Array
) -> None:
    nz, ny, nx, _ = result.shape
    for z in range(nz):
        for y in range(ny):
            for x in range(nx):
                di, dj, dk = slopes(slab, z + offset, y, x, lowest)
                for axis in range(3):
                    result[z, y, x, axis] = matrix[axis, 0] * di + matrix[axis, 1] * dj + matrix[axis, 2] * dk


@compiled
def magnitude_plane(
    slab: AnyArray, z: int, lowest: float, inverse: Float64Array, plane: Float32Array
) -> None:
    """Gradient magnitudes of plane z of a slab that holds its neighbours, into `plane` of shape (Y, X)."""
    nz, ny, nx = slab.shape
    z0, z1 = max(z - 1, 0), min(z + 1, nz - 1)
    sx, sz = np.float32(inverse[0] / 2), np.float32(inverse[2] / max(z1 - z0, 1))
    low = np.float32(lowest)
    here = np.empty(nx, np.float32)
    for y in range(ny):
        y0, y1 = max(y - 1, 0), min(y + 1, ny - 1)
        sy = np.float32(inverse[1] / max(y1 - y0, 1))
        for x in range(nx):
            v = np.float32(slab[z, y, x])
            here[x] = v if v - v == 0 else low
            a, b = np.float32(slab[z, y0, x]), np.float32(slab[z, y1, x])
            c, d = np.float32(slab[z0, y, x]), np.float32(slab[z1, y, x])
            dy = ((b if b - b == 0 else low) - (a if a - a == 0 else low)) * sy
            dz = ((d if d - d == 0 else low) - (c if c - c == 0 else low)) * sz
            plane[y, x] = dy * dy + dz * dz
        for x in range(1, nx - 1):
            dx = (here[x + 1] - here[x - 1]) * sx
            plane[y, x] = np.sqrt(plane[y, x] + dx * dx)
        for x in (0, nx - 1):
            dx = (here[min(x + 1, nx - 1)] - here[max(x - 1, 0)]) * 2 * sx
            if nx > 1 or x == 0:
                plane[y, x] = np.sqrt(plane[y, x] + dx * dx)
            if nx == 1:
                break
