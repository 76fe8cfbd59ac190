"""Second pass, vertices: where the surface crosses the edges of the lattice, and the normals there."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.kernels.compiled import compiled
from volviz.kernels.marching.bits import bit_count, lowest_bit, subtract
from volviz.kernels.marching.rows import crossings

Array = npt.NDArray[Any]

_ONE = np.uint64(1)
_NONE = np.uint64(0)
_LOW = np.int64(0xFFFF_FFFF)

#: Crossings gathered before they are worked off together, as columns that fit into the first-level cache.
BATCH = 512
#: Rows whose crossings of all kinds are worked off before the next ones: their voxels, in the four planes that
#: gradients reach, shall stay in the first-level cache, as there are up to seven kinds.
CACHE_BYTES = 1 << 15
#: Fewer rows have too few crossings for the loops over columns.
FEWEST_ROWS = 8
#: Length of a column: a full batch and the crossings of one more word.
CAPACITY = np.uintp(BATCH + 72)
#: Where the columns begin: values at both ends, position and length along x and y, gradients at both ends.
#: The fraction of the crossing takes the place of the position when that is done with.
X_START, Y_START, X_LENGTH, Y_LENGTH = (np.uintp(c) * CAPACITY for c in (2, 3, 4, 5))
START_X, START_Y, START_Z, END_X, END_Y, END_Z = (np.uintp(c) * CAPACITY for c in range(6, 12))
FRACTION = X_START
COLUMNS = 12 * int(CAPACITY)


class Geometry(NamedTuple):
    """Where the samples lie, and what turns differences into normals.

    Attributes
    ----------
    coordinates : 3 ndarrays of float64
        Index coordinates of the samples along x, y, z.
    neighbours : 3 tuples of 3 ndarrays, along x, y, z
        Flat distance to the sample before (int64), to the one after (int64), and what turns their difference
        into a derivative (float32 or float64).
    to_world : ndarray of shape (3, 4), float64
        From index (i, j, k, 1) to world (x, y, z).
    to_normals : ndarray of shape (3, 3), the same type
        From index gradients to world, up to length, with the sign that points to lower values.
    directions : ndarray of shape (K, 3), the same type
        World directions of the kinds of edges, for places without a gradient.
    tiny : scalar of the the same type
        Gradients whose components are all smaller than this count as zero.
    """

    coordinates: tuple[Array, Array, Array]
    neighbours: tuple[tuple[Array, Array, Array], ...]
    to_world: Array
    to_normals: Array
    directions: Array
    tiny: Any


@compiled
def place_vertices(
    slab: Array,
    slab_first: int,
    bits: Array,
    cells: Array,
    isovalue: float,
    steps: Array,
    vertex_starts: Array,
    geometry: Geometry,
    columns: Array,
    raw: Array,
    vertices: Array,
    normals: Array,
    first: int,
    stop: int,
) -> None:
    """Write vertices, and normals unless `normals` is empty, of all edges that start in planes first..stop-1.

    Parameters
    ----------
    slab : ndarray of shape (planes, Y, X)
        C-contiguous scalars; it holds the planes first - 1 to stop + 1 as far as they exist.
    slab_first : int
        Plane of the volume that is the first of `slab`.
    bits : ndarray of shape (Z, Y, words), uint64
        See `volviz.kernels.marching.rows`.
    cells : ndarray of shape (words - 1,), uint64
        See `volviz.kernels.marching.rows.cell_words`.
    isovalue : float
        In data units.
    steps : ndarray of shape (K,), int64
        Kinds of edges.
    vertex_starts : ndarray of shape (Z, K, Y), integers
        Number of the first vertex of each row of edges.
    geometry : Geometry
        Where the samples lie; its type of float is that of `columns`.
    columns : ndarray of shape (COLUMNS,), float32 or float64
        Room to work in, whose type is used for gradients.
    raw : ndarray of shape (COLUMNS,)
        Room for values and differences as they come: int32 for scalars of up to 16 bits, else as `columns`.
    vertices, normals : ndarray of shape (3 V,), float32
        Written at the rows' places.
    first, stop : int
        Range of planes.
    """
    depth, height, words = bits.shape
    flat_bits = bits.reshape(bits.size)
    borders = _border_words(slab.shape[2], words - 1)
    xs, ys, zs = geometry.coordinates
    to_world = geometry.to_world
    places = np.empty(CAPACITY, np.int64)
    with_normals = normals.size > 0
    rows = max(FEWEST_ROWS, CACHE_BYTES // (4 * slab.shape[2] * slab.itemsize))
    for block in range((stop - first) * (-(-height // rows))):
        z, y_first = first + block // -(-height // rows), block % -(-height // rows) * rows
        for k in range(steps.size):
            dx, dy, dz = steps[k] & 1, steps[k] >> 1 & 1, steps[k] >> 2 & 1
            y_stop = min(y_first + rows, height - dy)
            if z + dz >= depth or y_first >= y_stop:
                continue
            number = vertex_starts[z, k, y_first]
            n = np.uintp(0)
            inside = True
            plane_inside = z > 0 and z + dz < depth - 2
            for y in range(y_first, y_stop):
                row_inside = plane_inside and y > 0 and y + dy < height - 2
                near, far = (z * height + y) * words, ((z + dz) * height + y + dy) * words
                for w in range(words - 1):
                    word = crossings(flat_bits, near + w, far + w, dx, cells[w])
                    n = _list_places(word, (y << 32) + w * 64, places, n)
                    inside = inside and row_inside and word & borders[w] == _NONE
                    if n >= BATCH or (y == y_stop - 1 and w == words - 2):
                        plane, length_z = z - slab_first, dz * (zs[z + dz] - zs[z])
                        if inside:
                            _gather_inside(slab, plane, dx, dy, dz, places, n, with_normals, raw)
                            _place_inside(places, n, xs, ys, dx, dy, raw, columns)
                        else:
                            _gather(slab, plane, dx, dy, dz, places, n, xs, ys, columns)
                        _interpolate(columns, n, isovalue, zs[z], length_z, to_world, vertices, number)
                        if with_normals:
                            neighbours = geometry.neighbours
                            if inside:
                                _weigh_inside(n, neighbours, raw, columns)
                            else:
                                _gather_gradients(
                                    slab, slab_first, z, dx, dy, dz, places, n, neighbours, columns
                                )
                            _interpolate_normals(columns, n, isovalue, geometry, k, normals, number)
                        number += np.int64(n)
                        n = np.uintp(0)
                        inside = True


@compiled
def _list_places(word: Any, left: Any, places: Array, n: Any) -> Any:
    """Append ``left + i`` for every set bit i of a word to the first `n` places; how many there are then.

    Two places are always written and only true ones counted, which spares branches nobody can predict.
    """
    end = n + np.uintp(bit_count(word))
    for i in range(np.uintp(2)):
        places[n + i] = left + np.int64(lowest_bit(word))
        word &= word - _ONE
    n += np.uintp(2)
    while word != _NONE:
        places[n] = left + np.int64(lowest_bit(word))
        word &= word - _ONE
        n += np.uintp(1)
    return end


@compiled
def _gather(
    slab: Array,
    z: int,
    dx: int,
    dy: int,
    dz: int,
    places: Array,
    n: Any,
    xs: Array,
    ys: Array,
    columns: Array,
) -> None:
    """Columns 0-5 of `n` crossings: values at both ends, x and y of the start, length along x and y."""
    flat = slab.reshape(slab.size)
    width = slab.shape[2]
    area = slab.shape[1] * width
    step = dx + dy * width + dz * area
    for i in range(np.uintp(n)):
        x, y = np.uintp(places[i] & _LOW), np.uintp(places[i] >> 32)
        a = np.uintp(z * area) + y * np.uintp(width) + x
        columns[i] = flat[a]
        columns[i + CAPACITY] = flat[a + np.uintp(step)]
        columns[i + X_START] = xs[x]
        columns[i + Y_START] = ys[y]
        columns[i + X_LENGTH] = xs[x + np.uintp(dx)] - xs[x]
        columns[i + Y_LENGTH] = ys[y + np.uintp(dy)] - ys[y]


@compiled
def _gather_gradients(
    slab: Array,
    slab_first: int,
    z: int,
    dx: int,
    dy: int,
    dz: int,
    places: Array,
    n: Any,
    neighbours: Any,
    columns: Array,
) -> None:
    """Columns 6-11 of `n` crossings: derivatives along x, y, z at the start, then at the end."""
    flat = slab.reshape(slab.size)
    width = slab.shape[2]
    plane, row = slab.shape[1] * width, width
    (low_x, high_x, weight_x), (low_y, high_y, weight_y), (low_z, high_z, weight_z) = neighbours
    for end in range(2):
        ex, ey, ez = np.uintp(end * dx), np.uintp(end * dy), z + end * dz
        below, above, weight = low_z[ez], high_z[ez], weight_z[ez]
        first = START_X if end == 0 else END_X
        for i in range(np.uintp(n)):
            x, y = np.uintp(places[i] & _LOW) + ex, np.uintp(places[i] >> 32) + ey
            a = (ez - slab_first) * plane + np.int64(y) * row + np.int64(x)
            columns[i + first] = difference(flat, a + low_x[x], a + high_x[x], weight_x[x])
            columns[i + first + CAPACITY] = difference(flat, a + low_y[y], a + high_y[y], weight_y[y])
            columns[i + first + np.uintp(2) * CAPACITY] = difference(flat, a + below, a + above, weight)


@compiled
def _border_words(width: int, words: int) -> Array:
    """Bits of the voxels of a row that have, or whose right neighbour has, not the usual neighbours in x."""
    borders = np.zeros(words, np.uint64)
    for x in range(width):
        if x == 0 or x >= width - 3:
            borders[x // 64] |= _ONE << np.uint64(x % 64)
    return borders


@compiled
def _gather_inside(
    slab: Array, z: int, dx: int, dy: int, dz: int, places: Array, n: Any, with_gradients: bool, raw: Array
) -> None:
    """Columns of `n` crossings far from all borders: values at both ends, differences along x, y, z at both.

    `z` is the plane in the slab. Nothing is converted and nothing weighted here: the loops that follow do that for
    many crossings at a time, while this one fetches voxel by voxel.
    """
    flat = slab.reshape(slab.size)
    row = np.uintp(slab.shape[2])
    plane = np.uintp(slab.shape[1]) * row
    one = np.uintp(1)
    begin = np.uintp(z) * plane
    step = np.uintp(dx) + np.uintp(dy) * row + np.uintp(dz) * plane
    like = raw[0]
    for i in range(np.uintp(n)):
        a = begin + np.uintp(places[i] >> 32) * row + np.uintp(places[i] & _LOW)
        raw[i] = flat[a]
        raw[i + CAPACITY] = flat[a + step]
        if with_gradients:
            b = a + step
            raw[i + START_X] = subtract(flat[a + one], flat[a - one], like)
            raw[i + START_Y] = subtract(flat[a + row], flat[a - row], like)
            raw[i + START_Z] = subtract(flat[a + plane], flat[a - plane], like)
            raw[i + END_X] = subtract(flat[b + one], flat[b - one], like)
            raw[i + END_Y] = subtract(flat[b + row], flat[b - row], like)
            raw[i + END_Z] = subtract(flat[b + plane], flat[b - plane], like)


@compiled
def _place_inside(
    places: Array, n: Any, xs: Array, ys: Array, dx: int, dy: int, raw: Array, columns: Array
) -> None:
    """Columns 0-5 of `n` crossings far from all borders, from what `_gather_inside` brought."""
    x_first, y_first, x_pitch, y_pitch = xs[0], ys[0], xs[1] - xs[0], ys[1] - ys[0]
    for i in range(np.uintp(n)):
        columns[i] = raw[i]
        columns[i + CAPACITY] = raw[i + CAPACITY]
        columns[i + X_START] = x_first + x_pitch * np.float64(places[i] & _LOW)
        columns[i + Y_START] = y_first + y_pitch * np.float64(places[i] >> 32)
        columns[i + X_LENGTH] = x_pitch * dx
        columns[i + Y_LENGTH] = y_pitch * dy


@compiled
def _weigh_inside(n: Any, neighbours: Any, raw: Array, columns: Array) -> None:
    """Columns 6-11 of `n` crossings far from all borders, from what `_gather_inside` brought.

    Any sample but the first and the last two has the same distances and weights as the second one.
    """
    weight_x, weight_y, weight_z = neighbours[0][2][1], neighbours[1][2][1], neighbours[2][2][1]
    real = type(weight_x)
    for i in range(np.uintp(n)):
        columns[i + START_X] = real(raw[i + START_X]) * weight_x
        columns[i + START_Y] = real(raw[i + START_Y]) * weight_y
        columns[i + START_Z] = real(raw[i + START_Z]) * weight_z
        columns[i + END_X] = real(raw[i + END_X]) * weight_x
        columns[i + END_Y] = real(raw[i + END_Y]) * weight_y
        columns[i + END_Z] = real(raw[i + END_Z]) * weight_z


@compiled
def difference(flat: Array, low: int, high: int, weight: Any) -> Any:
    """Weighted difference of two samples, computed in the type of the weight."""
    return subtract(flat[np.uintp(high)], flat[np.uintp(low)], weight) * weight


@compiled
def _interpolate(
    columns: Array,
    n: Any,
    isovalue: float,
    z: Any,
    length_z: Any,
    to_world: Array,
    vertices: Array,
    number: int,
) -> None:
    """Interpolate `n` crossings linearly and write world positions; column 2 then holds the fraction."""
    m = to_world
    m00, m01, m02, m03 = m[0, 0], m[0, 1], m[0, 2], m[0, 3]
    m10, m11, m12, m13 = m[1, 0], m[1, 1], m[1, 2], m[1, 3]
    m20, m21, m22, m23 = m[2, 0], m[2, 1], m[2, 2], m[2, 3]
    for i in range(np.uintp(n)):
        a, b = np.float64(columns[i]), np.float64(columns[i + CAPACITY])
        t = (isovalue - a) / (b - a)
        if not 0.0 <= t <= 1.0:
            # An end is NaN or infinite: the surface lies at the finite end, or in the middle when there is
            # none.
            lost_a, lost_b = not np.abs(a) < np.inf, not np.abs(b) < np.inf
            t = np.float64(0.5 if lost_a == lost_b else (1.0 if lost_a else 0.0))
        px = np.float64(columns[i + X_START]) + t * np.float64(columns[i + X_LENGTH])
        py = np.float64(columns[i + Y_START]) + t * np.float64(columns[i + Y_LENGTH])
        pz = z + t * length_z
        columns[i + FRACTION] = t
        out = np.uintp(3) * (np.uintp(number) + i)
        vertices[out] = m00 * px + m01 * py + m02 * pz + m03
        vertices[out + np.uintp(1)] = m10 * px + m11 * py + m12 * pz + m13
        vertices[out + np.uintp(2)] = m20 * px + m21 * py + m22 * pz + m23


@compiled
def _interpolate_normals(
    columns: Array,
    n: Any,
    isovalue: float,
    geometry: Geometry,
    k: int,
    normals: Array,
    number: int,
) -> None:
    """Interpolate `n` gradients by the fraction and write them as unit normals in world space.

    Where the gradient vanishes or is not finite, the normal is the direction of the edge from inside to
    outside.
    """
    m, edge, tiny = geometry.to_normals, geometry.directions[k], geometry.tiny
    m00, m01, m02 = m[0, 0], m[0, 1], m[0, 2]
    m10, m11, m12 = m[1, 0], m[1, 1], m[1, 2]
    m20, m21, m22 = m[2, 0], m[2, 1], m[2, 2]
    ex, ey, ez = edge[0], edge[1], edge[2]
    # of float64, and with it what follows: rounded at every step, normals would be off by twice their last place
    one = m00 * 0 + 1
    for i in range(np.uintp(n)):
        t = columns[i + FRACTION]
        gx, gy, gz = columns[i + START_X], columns[i + START_Y], columns[i + START_Z]
        gx += t * (columns[i + END_X] - gx)
        gy += t * (columns[i + END_Y] - gy)
        gz += t * (columns[i + END_Z] - gz)
        x = m00 * gx + m01 * gy + m02 * gz
        y = m10 * gx + m11 * gy + m12 * gz
        z = m20 * gx + m21 * gy + m22 * gz
        # Scaled by the largest component first, since squares leave the range of float32 early.
        largest = max(abs(x), abs(y), abs(z))
        usable = (tiny <= largest < np.inf) & (abs(x + y + z) < np.inf)
        sign = one if np.float64(columns[i]) >= isovalue else -one
        scale = one / largest
        x = x * scale if usable else ex * sign
        y = y * scale if usable else ey * sign
        z = z * scale if usable else ez * sign
        scale = one / np.sqrt(x * x + y * y + z * z)
        out = np.uintp(3) * (np.uintp(number) + i)
        normals[out] = x * scale
        normals[out + np.uintp(1)] = y * scale
        normals[out + np.uintp(2)] = z * scale
