"""Bounds of the gradient magnitude in every brick, for classification by value and gradient."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.kernels.arrays import check_scalars, native_slab
from volviz.kernels.bricks import DEFAULT_BRICK, brick_grid_shape
from volviz.kernels.compiled import compiled
from volviz.kernels.threads import map_ranges

if TYPE_CHECKING:
    from collections.abc import Sequence

AnyArray = npt.NDArray[Any]
BoolArray = npt.NDArray[np.bool_]
Float32Array = npt.NDArray[np.float32]

#: Voxels of reach on each side: one for the trilinear support, one for a central difference of at most a
#: voxel.
REACH = 2


def brick_gradient_bounds(
    array: AnyArray,
    brick: int = DEFAULT_BRICK,
    *,
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    lowest: float | None = None,
) -> tuple[Float32Array, Float32Array]:
    """Bounds of the gradient magnitude for every sample that a shader can take inside a brick.

    Central differences of the trilinear interpolant are means of its slopes, and these lie between the
    smallest and largest difference of neighbouring voxels. So the bounds hold for every ``gradient_delta``
    of at most one voxel and for gradient textures as well; they are wider than the extremes over the voxels
    alone.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars of any real type, in data units. Never copied as a whole.
    brick : int, default: 8
        Edge of a brick in voxels, as in `brick_min_max`.
    spacing : tuple of 3 floats
        Distance of voxel centres along (x, y, z) in world units.
    lowest : float, optional
        Value that NaN and infinities count as; default 0.

    Returns
    -------
    lows, highs : ndarray of shape (b_z, b_y, b_x), float32
        Bounds of ``|grad|`` in data units per world unit.
    """
    check_scalars(array)
    grid = brick_grid_shape(array.shape, brick)
    lows = np.empty(grid, np.float32)
    highs = np.empty(grid, np.float32)
    depth = array.shape[0]
    floor = 0.0 if lowest is None else float(lowest)
    inverse = 1.0 / np.asarray(spacing, np.float64)

    def fill(first: int, last: int) -> None:
        for b in range(first, last):
            z0 = max(b * brick - REACH, 0)
            z1 = min((b + 1) * brick + REACH, depth)
            at_border = z0 == 0 or z1 == depth
            slab = native_slab(array, z0, z1)
            _slab_gradient_bounds(slab, brick, floor, inverse, at_border, lows[b], highs[b])

    map_ranges(fill, grid[0])
    return lows, highs


def visible_plane_sums(opacity: npt.ArrayLike) -> npt.NDArray[np.int64]:
    """Counts of visible entries below and to the left, from which `occupancy_2d` answers each brick.

    Parameters
    ----------
    opacity : array_like of shape (rows, columns)
        Opacities of a table over value (columns) and gradient magnitude (rows); above 0 = visible.

    Returns
    -------
    ndarray of shape (rows + 1, columns + 1), int64
        Element (j, i) counts the visible entries before row j and column i (Crow 1984, summed-area table).
    """
    visible = np.asarray(opacity) > 0
    if visible.ndim != 2 or visible.size == 0:
        raise InputError(f"an opacity table over value and gradient has two axes, got shape {visible.shape}.")
    sums = np.zeros((visible.shape[0] + 1, visible.shape[1] + 1), np.int64)
    sums[1:, 1:] = visible.cumsum(axis=0, dtype=np.int64).cumsum(axis=1)
    return sums


def occupancy_2d(
    values: tuple[Float32Array, Float32Array],
    gradients: tuple[Float32Array, Float32Array] | None,
    sums: npt.NDArray[np.int64],
    value_range: tuple[float, float],
    gradient_range: tuple[float, float],
) -> BoolArray:
    """Which bricks hold anything visible under a transfer function of value and gradient magnitude.

    Parameters
    ----------
    values : (mins, maxs), ndarrays of shape (b_z, b_y, b_x), float32
        From `volviz.kernels.bricks.brick_min_max`, in data units.
    gradients : (lows, highs) of the same shapes, or None
        From `brick_gradient_bounds`; None: any gradient may be anywhere.
    sums : ndarray of shape (rows + 1, columns + 1), int64
        From `visible_plane_sums` of the table.
    value_range, gradient_range : (lo, hi), lo <= hi
        Of the table's first and last column and row; beyond them the end entries count.

    Returns
    -------
    ndarray of shape (b_z, b_y, b_x), bool
        True when an entry that linear look-ups within both intervals can touch, or one beside those, is
        visible: nothing visible is ever called empty.
    """
    rows, columns = (n - 1 for n in sums.shape)
    left, right = _entries_between(*values, columns, value_range)
    if gradients is None:
        below = np.zeros_like(left)
        above = np.full_like(left, rows)
    else:
        below, above = _entries_between(*gradients, rows, gradient_range)
    inside = sums[above, right] - sums[below, right] - sums[above, left] + sums[below, left]
    return np.asarray(inside > 0)


def _entries_between(
    low: Float32Array, high: Float32Array, count: int, limits: tuple[float, float]
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """First entry that look-ups in an interval may touch, and the one after the last, with one more each way."""
    scale = (count - 1) / (limits[1] - limits[0]) if limits[1] > limits[0] else 0.0
    first = np.floor((low.astype(np.float64) - limits[0]) * scale) - 1
    last = np.ceil((high.astype(np.float64) - limits[0]) * scale) + 1
    return (
        np.clip(first, 0, count - 1).astype(np.int64),
        np.clip(last, 0, count - 1).astype(np.int64) + 1,
    )


@compiled
def _slab_gradient_bounds(
    slab: AnyArray,
    brick: int,
    lowest: float,
    inverse: AnyArray,
    at_border: bool,
    lows: AnyArray,
    highs: AnyArray,
) -> None:
    """Bounds of one layer of bricks: differences are reduced over z for each column, then over y and x."""
    nz, ny, nx = slab.shape
    bounds = np.empty((6, ny, nx), np.float32)
    values = np.empty((2, ny + 1, nx + 1), np.float32)
    bounds[0::2] = np.inf
    bounds[1::2] = -np.inf
    for z in range(nz):
        here, above = values[z % 2], values[(z + 1) % 2]
        for y in range(ny):
            for x in range(nx):
                v = np.float32(slab[z, y, x])
                here[y, x] = v if v - v == 0 else np.float32(lowest)
            here[y, nx] = here[y, nx - 1]
        here[ny] = here[ny - 1]
        for y in range(ny):
            for x in range(nx):
                dx = here[y, x + 1] - here[y, x]
                dy = here[y + 1, x] - here[y, x]
                bounds[0, y, x] = min(bounds[0, y, x], dx)
                bounds[1, y, x] = max(bounds[1, y, x], dx)
                bounds[2, y, x] = min(bounds[2, y, x], dy)
                bounds[3, y, x] = max(bounds[3, y, x], dy)
        if z > 0:
            for y in range(ny):
                for x in range(nx):
                    dz = here[y, x] - above[y, x]
                    bounds[4, y, x] = min(bounds[4, y, x], dz)
                    bounds[5, y, x] = max(bounds[5, y, x], dz)
    by, bx = lows.shape
    extreme = np.empty(6, np.float64)
    for b in range(by):
        y0, y1 = max(b * brick - 2, 0), min((b + 1) * brick + 2, ny)
        for c in range(bx):
            x0, x1 = max(c * brick - 2, 0), min((c + 1) * brick + 2, nx)
            extreme[0::2] = np.inf
            extreme[1::2] = -np.inf
            for y in range(y0, y1):
                for x in range(x0, x1):
                    for i in range(0, 6, 2):
                        extreme[i] = min(extreme[i], bounds[i, y, x])
                        extreme[i + 1] = max(extreme[i + 1], bounds[i + 1, y, x])
            # beyond the border samples are clamped: the slope there is 0 along any axis
            border = at_border or y0 == 0 or x0 == 0 or y1 == ny or x1 == nx
            low, high = 0.0, 0.0
            for i in range(3):
                a, z_ = extreme[2 * i] * inverse[i], extreme[2 * i + 1] * inverse[i]
                high += max(abs(a), abs(z_)) ** 2
                if not border and (a > 0 or z_ < 0):
                    low += min(abs(a), abs(z_)) ** 2
            # rounding outwards: the bounds must hold after the conversion to float32
            lows[b, c] = np.sqrt(low) * (1 - 1e-6)
            highs[b, c] = np.sqrt(high) * (1 + 1e-6)
