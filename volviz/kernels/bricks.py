"""Min-max bricks: what is empty, and how far it is to the next brick that is not.

The volume is cut into bricks of 8^3 voxels or so: brick (b_z, b_y, b_x) owns the voxels ``8 b .. 8 b + 7``
along each axis. Its bounds are taken over these voxels *and one more on each side*. So they hold for every
trilinear or nearest sample whose brick is found as ``floor(p / 8)`` from the continuous voxel index p, and
also as ``floor((p + 0.5) / 8)`` from a texture coordinate times N; neighbouring bricks' intervals overlap.

A ray that stands in an empty brick with chessboard distance c may skip everything inside the cube of bricks
that reaches c - 1 bricks to each side of its own. Where an image needs two consecutive samples
(pre-integration, isosurface crossings), a segment may be skipped only when *both* its ends lie in empty
bricks; for steps no longer than a brick nothing between them is missed then, because the two intervals
overlap.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

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
BoolArray = npt.NDArray[np.bool_]

DEFAULT_BRICK = 8

#: Chessboard distances are kept in a byte; farther is the same as this far.
MAX_DISTANCE = 255

#: Grids up to this size (a volume of 512^3 in bricks of 8^3) are measured by NumPy, which needs nothing compiled.
FEW_BRICKS = 64**3


def brick_grid_shape(shape: Sequence[int], brick: int = DEFAULT_BRICK) -> tuple[int, int, int]:
    """Number of bricks (b_z, b_y, b_x) that cover a volume of `shape` (Z, Y, X)."""
    if brick < 1:
        raise InputError(f"brick must be at least 1 voxel, got {brick}.")
    z, y, x = ((int(n) + brick - 1) // brick for n in shape)
    return z, y, x


def brick_min_max(
    array: npt.NDArray[Any], brick: int = DEFAULT_BRICK, *, lowest: float | None = None
) -> tuple[Float32Array, Float32Array]:
    """Lowest and highest value in every brick, dilated by one voxel: what makes empty space known.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars of any real type and byte order, in data units. Never copied as a whole.
    brick : int, default: 8
        Edge of a brick in voxels, at least 1.
    lowest : float, optional
        Value that NaN and infinities count as: the lowest finite value of the volume (`FiniteRange.low`).
        Only looked at for floating-point arrays; default 0.

    Returns
    -------
    mins, maxs : ndarray of shape (b_z, b_y, b_x), float32
        Bounds over the brick's voxels and one more on each side, rounded to float32 like an R32F texture.

    Raises
    ------
    InputError
        Not a three-dimensional array of numbers, or `brick` below 1.
    """
    check_scalars(array)
    grid = brick_grid_shape(array.shape, brick)
    mins = np.empty(grid, np.float32)
    maxs = np.empty(grid, np.float32)
    depth = array.shape[0]
    floor = 0.0 if lowest is None else float(lowest)

    def fill(first: int, last: int) -> None:
        for b in range(first, last):
            slab = native_slab(array, max(b * brick - 1, 0), min((b + 1) * brick + 1, depth))
            low, high = slab.min(axis=0), slab.max(axis=0)
            if slab.dtype.kind == "f" and not (np.isfinite(low).all() and np.isfinite(high).all()):
                slab = np.where(np.isfinite(slab), slab, slab.dtype.type(floor))
                low, high = slab.min(axis=0), slab.max(axis=0)
            mins[b] = _reduced(_reduced(low, brick, np.minimum).T, brick, np.minimum).T
            maxs[b] = _reduced(_reduced(high, brick, np.maximum).T, brick, np.maximum).T

    map_ranges(fill, grid[0])
    return mins, maxs


def _reduced(rows: AnyArray, brick: int, extreme: Any) -> AnyArray:
    """Rows, shape (n, m), reduced to bricks of rows, each with one row more on either side."""
    starts = np.arange(0, len(rows), brick)
    whole = len(rows) // brick
    reduced = np.empty((len(starts), rows.shape[1]), rows.dtype)
    extreme.reduce(rows[: whole * brick].reshape(whole, brick, rows.shape[1]), axis=1, out=reduced[:whole])
    if whole < len(starts):
        extreme.reduce(rows[whole * brick :], axis=0, out=reduced[whole])
    inner = starts[1:]
    extreme(reduced[1:], rows[inner - 1], out=reduced[1:])
    extreme(reduced[:-1], rows[inner], out=reduced[:-1])
    return reduced


def visible_prefix(opacity: npt.ArrayLike) -> npt.NDArray[np.int64]:
    """Prefix counts of a baked opacity table, from which `occupancy` answers each brick in constant time.

    Parameters
    ----------
    opacity : array_like of shape (n,)
        Opacities of the table's entries; above 0 = visible. Fold in here whatever else makes a value
        invisible (a density threshold, say) by setting its entries to 0.

    Returns
    -------
    ndarray of shape (n + 1,), int64
        Element i counts the visible entries before i.
    """
    visible = np.asarray(opacity).reshape(-1) > 0
    if visible.size == 0:
        raise InputError("the opacity table is empty; give at least one entry.")
    return np.concatenate(([0], np.cumsum(visible, dtype=np.int64)))


def occupancy(
    mins: Float32Array, maxs: Float32Array, prefix: npt.NDArray[np.int64], value_range: tuple[float, float]
) -> BoolArray:
    """Which bricks hold anything visible under a transfer function.

    Parameters
    ----------
    mins, maxs : ndarray of shape (b_z, b_y, b_x), float32
        From `brick_min_max`, in data units.
    prefix : ndarray of shape (n + 1,), int64
        From `visible_prefix` of the baked table; entry i stands for the value ``lo + i (hi - lo) / (n - 1)``.
    value_range : (lo, hi)
        Data values of the table's first and last entry, lo <= hi; values outside use the end entries.

    Returns
    -------
    ndarray of shape (b_z, b_y, b_x), bool
        True when an entry that linear look-ups within [min, max] can touch, or one beside those, is
        visible. The extra entry covers rounding in a texture's own scale, so that nothing visible is ever
        called empty.
    """
    n = len(prefix) - 1
    low, high = value_range
    # halves: the range may be as wide as float64, and a bound of float32 infinite
    half = high / 2 - low / 2
    if half > 0:
        first = np.floor((mins.astype(np.float64) / 2 - low / 2) * ((n - 1) / half)) - 1
        last = np.ceil((maxs.astype(np.float64) / 2 - low / 2) * ((n - 1) / half)) + 1
    else:
        first, last = np.full(mins.shape, -1.0), np.full(maxs.shape, 1.0)
    first = np.clip(first, 0, n - 1).astype(np.int64)
    last = np.clip(last, 0, n - 1).astype(np.int64)
    return np.asarray(prefix[last + 1] > prefix[first])


def occupancy_for_isovalues(mins: Float32Array, maxs: Float32Array, isovalues: Sequence[float]) -> BoolArray:
    """Which bricks may be crossed by a surface of any of the isovalues.

    Parameters
    ----------
    mins, maxs : ndarray of shape (b_z, b_y, b_x), float32
        From `brick_min_max`, in data units.
    isovalues : sequence of floats
        In data units; none gives an empty image.

    Returns
    -------
    ndarray of shape (b_z, b_y, b_x), bool
        True when ``min <= isovalue <= max``, widened by the rounding of a 16-bit or float32 texture.
    """
    result = np.zeros(mins.shape, bool)
    if result.size == 0:
        return result
    span = float(maxs.max()) - float(mins.min())
    largest = max(abs(float(maxs.max())), abs(float(mins.min())))
    margin = span / 65535 + 4 * float(np.finfo(np.float32).eps) * largest
    for isovalue in isovalues:
        result |= (mins <= isovalue + margin) & (maxs >= isovalue - margin)
    return result


def chessboard_distance(occupied: BoolArray) -> npt.NDArray[np.uint8]:
    """How many bricks away the nearest occupied brick is: how far a ray may jump.

    Exact Chebyshev distance. Few bricks grow by one to all sides until nothing is left; many are visited in two
    raster passes over half of the 26 neighbours each (Rosenfeld and Pfaltz 1966), in compiled code.

    Parameters
    ----------
    occupied : ndarray of shape (b_z, b_y, b_x), bool
        From `occupancy` or `occupancy_for_isovalues`.

    Returns
    -------
    ndarray of the same shape, uint8
        0 for occupied bricks; 255 for 255 and more, and everywhere when no brick is occupied.
    """
    if occupied.size <= FEW_BRICKS:
        return _by_growing(np.asarray(occupied, bool))
    distance = np.where(occupied, 0, MAX_DISTANCE).astype(np.int32)
    padded = np.pad(distance, 1, constant_values=MAX_DISTANCE)
    _chessboard_passes(padded)
    return padded[1:-1, 1:-1, 1:-1].astype(np.uint8)


def _by_growing(occupied: BoolArray) -> npt.NDArray[np.uint8]:
    """`chessboard_distance` by growing what is occupied."""
    if not occupied.any():
        return np.full(occupied.shape, MAX_DISTANCE, np.uint8)
    # every round adds one wherever nothing has come yet; FEW_BRICKS may be a line longer than a byte can count
    distance = np.zeros(occupied.shape, np.uint16)
    reached = occupied
    while not reached.all():
        distance += ~reached
        for axis in range(3):
            low = (slice(None),) * axis + (slice(None, -1),)
            high = (slice(None),) * axis + (slice(1, None),)
            grown = reached.copy()
            grown[high] |= reached[low]
            grown[low] |= reached[high]
            reached = grown
    return np.minimum(distance, MAX_DISTANCE).astype(np.uint8)


@compiled
def _chessboard_passes(d: npt.NDArray[np.int32]) -> None:
    """Forward and backward pass, in place, over an array with a border of one."""
    nz, ny, nx = d.shape
    for z in range(1, nz - 1):
        for y in range(1, ny - 1):
            for x in range(1, nx - 1):
                best = d[z, y, x - 1]
                for i in range(-1, 2):
                    best = min(best, d[z, y - 1, x + i])
                    for j in range(-1, 2):
                        best = min(best, d[z - 1, y + j, x + i])
                d[z, y, x] = min(d[z, y, x], best + 1)
    for z in range(nz - 2, 0, -1):
        for y in range(ny - 2, 0, -1):
            for x in range(nx - 2, 0, -1):
                best = d[z, y, x + 1]
                for i in range(-1, 2):
                    best = min(best, d[z, y + 1, x + i])
                    for j in range(-1, 2):
                        best = min(best, d[z + 1, y + j, x + i])
                d[z, y, x] = min(d[z, y, x], best + 1)


def grow_occupancy(occupied: BoolArray, bricks: int = 1) -> BoolArray:
    """The occupied bricks and all within `bricks` of them (26 neighbours).

    Needed where a sample looks farther than one voxel beyond its brick (wide gradients, blur), and by
    renderers that would rather treat the neighbours of occupied bricks as occupied than look at both ends
    of a segment.
    """
    return chessboard_distance(occupied) <= bricks


def occupancy_elsewhere(
    occupied: BoolArray,
    matrix: npt.ArrayLike,
    shape: Sequence[int],
    first: Sequence[int] = (0, 0, 0),
    brick: int = DEFAULT_BRICK,
) -> BoolArray:
    """Bricks of another lattice that occupied ones may reach into.

    Parameters
    ----------
    occupied : ndarray of shape (b_z, b_y, b_x), bool
        Bricks of a lattice.
    matrix : array_like of shape (4, 4)
        From continuous voxel indices (i, j, k, 1) of that lattice to those of the other.
    shape : sequence of 3 ints
        Size (b_z, b_y, b_x) of the part of the other's grid of bricks that is asked for.
    first : sequence of 3 ints
        Its first brick along (x, y, z); negative before the first voxel.

    Returns
    -------
    ndarray of `shape`, bool
        Never too few.
    """
    to_other = np.asarray(matrix, np.float64)
    # a brick holds what is interpolated from its voxels: one voxel more on each side
    middle = np.argwhere(occupied)[:, ::-1] * brick + 0.5 * (brick - 1)
    center = middle @ to_other[:3, :3].T + to_other[:3, 3]
    reach = np.abs(to_other[:3, :3]).sum(axis=1) * 0.5 * (brick + 1)
    size = np.array(tuple(shape)[::-1])
    ends = [np.floor((center + sign * reach) / brick).astype(np.int64) - np.array(first) for sign in (-1, 1)]
    met = ((ends[1] >= 0) & (ends[0] < size)).all(axis=1)
    low, high = np.clip(ends[0][met], 0, size), np.clip(ends[1][met] + 1, 0, size)
    # counts of boxes as their eight corners, summed along each axis
    counts = np.zeros(size[::-1] + 1, np.int64)
    for corner in range(8):
        side = np.array([corner >> axis & 1 for axis in range(3)])
        i, j, k = np.where(side, high, low).T
        np.add.at(counts, (k, j, i), (-1) ** int(side.sum()))
    for axis in range(3):
        counts = counts.cumsum(axis=axis)
    return np.asarray(counts[:-1, :-1, :-1] > 0)
