"""First passes: which voxels are inside, as bits, and what there is to draw in every row of cells.

A row of voxels is a row of 64-bit words (bit = value >= isovalue), closed by one word of zeros, so that a row
can be shifted by one voxel. Everything else follows from these words: an edge is crossed where two words
differ, and a cell is active where its eight words neither all hold 0 nor all 1.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.kernels.compiled import compiled
from volviz.kernels.marching.bits import bit_count, case_numbers_64, lowest_bit, reaches_64

Array = npt.NDArray[Any]

_ONE = np.uint64(1)
_NONE = np.uint64(0)
_ALL = np.uint64(0xFFFF_FFFF_FFFF_FFFF)
_LAST = np.uint64(63)


def words_in_row(voxels: int) -> int:
    """Number of 64-bit words that hold a row of voxels, the closing word of zeros included."""
    return -(-voxels // 64) + 1


@compiled
def mark_inside(slab: Array, threshold: Any, bits: Array, first: int) -> None:
    """Set the bits of some planes.

    Parameters
    ----------
    slab : ndarray of shape (planes, Y, X)
        C-contiguous scalars.
    threshold : scalar of the slab's type
        A voxel is inside when its value is at least this; NaN is outside.
    bits : ndarray of shape (Z, Y, words), uint64
        Planes ``first`` to ``first + planes - 1`` are written.
    first : int
        Plane of `bits` that belongs to the first plane of `slab`.
    """
    planes, height, width = slab.shape
    flat = slab.reshape(slab.size)
    words = bits.shape[2]
    for z in range(planes):
        for y in range(height):
            start = (z * height + y) * width
            row = bits[first + z, y]
            for w in range(words - 1):
                left = start + w * 64
                here = min(64, width - w * 64)
                if left + 64 <= flat.size:
                    word = reaches_64(flat, np.uintp(left), threshold)
                    if here < 64:
                        word &= (_ONE << np.uint64(here)) - _ONE
                else:
                    word = _NONE
                    for i in range(here):
                        if flat[left + i] >= threshold:
                            word |= _ONE << np.uint64(i)
                row[w] = word
            row[words - 1] = _NONE


@compiled
def crossings(bits: Array, z: int, y: int, end_z: int, end_y: int, w: int, sideways: int, width: int) -> Any:
    """Word w of the edges from row (z, y) to row (end_z, end_y) that are crossed.

    Parameters
    ----------
    bits : ndarray of shape (Z, Y, words), uint64
        See `mark_inside`.
    z, y, end_z, end_y : int
        The rows where the edges start and end.
    w : int
        Which word.
    sideways : int
        1 when the edges also go one voxel to the right, else 0.
    width : int
        Voxels in a row.
    """
    if sideways == 0:
        return bits[z, y, w] ^ bits[end_z, end_y, w]
    return (bits[z, y, w] ^ shifted(bits, end_z, end_y, w)) & cells_of_word(w, width)


@compiled
def shifted(bits: Array, z: int, y: int, w: int) -> Any:
    """Word w of row (z, y) moved by one voxel to the left: bit x holds voxel x + 1."""
    return (bits[z, y, w] >> _ONE) | (bits[z, y, w + 1] << _LAST)


@compiled
def cells_of_word(w: int, width: int) -> Any:
    """Bits of word w that start a cell: all but the last voxel of the row and what follows it."""
    cells = width - 1 - w * 64
    if cells >= 64:
        return _ALL
    if cells <= 0:
        return _NONE
    return (_ONE << np.uint64(cells)) - _ONE


@compiled
def count_vertices(bits: Array, width: int, steps: Array, counts: Array, first: int, stop: int) -> None:
    """Count the crossed edges that start in each row of the planes first..stop-1.

    Parameters
    ----------
    bits : ndarray of shape (Z, Y, words), uint64
        See `mark_inside`.
    width : int
        Voxels in a row.
    steps : ndarray of shape (K,), int64
        Kinds of edges, see `volviz.kernels.marching.cube`.
    counts : ndarray of shape (Z, K, Y), integers
        Written for these planes.
    first, stop : int
        Range of planes.
    """
    depth, height, words = bits.shape
    for z in range(first, stop):
        for k in range(steps.size):
            dx, dy, dz = steps[k] & 1, steps[k] >> 1 & 1, steps[k] >> 2 & 1
            for y in range(height):
                total = _NONE
                if y + dy < height and z + dz < depth:
                    for w in range(words - 1):
                        total += bit_count(crossings(bits, z, y, z + dz, y + dy, w, dx, width))
                counts[z, k, y] = total


@compiled
def list_active_cells(
    bits: Array,
    width: int,
    triangle_count: Array,
    configurations: Array,
    cell_counts: Array,
    triangle_counts: Array,
    first: int,
    stop: int,
) -> int:
    """Write the case of every active cell, row after row, for the rows of cells of planes first..stop-1.

    Parameters
    ----------
    bits : ndarray of shape (Z, Y, words), uint64
        See `mark_inside`.
    width : int
        Voxels in a row.
    triangle_count : ndarray of shape (N,), uint8
        Triangles of each case.
    configurations : ndarray, uint8
        Room for all cells of these planes; the cases are written from its beginning.
    cell_counts, triangle_counts : ndarray of shape (Z - 1, Y - 1), integers
        Written for these planes: active cells and triangles of each row.
    first, stop : int
        Range of planes of cells.

    Returns
    -------
    int
        Number of active cells.
    """
    height, words = bits.shape[1], bits.shape[2]
    cases = np.zeros(65, np.uint8)
    position = np.uintp(0)
    for z in range(first, stop):
        for y in range(height - 1):
            row_start = position
            triangles = 0
            for w in range(words - 1):
                a, b = bits[z, y, w], bits[z, y + 1, w]
                c, d = bits[z + 1, y, w], bits[z + 1, y + 1, w]
                some, every = a | b | c | d, a & b & c & d
                a1, b1 = shifted(bits, z, y, w), shifted(bits, z, y + 1, w)
                c1, d1 = shifted(bits, z + 1, y, w), shifted(bits, z + 1, y + 1, w)
                active = (some | a1 | b1 | c1 | d1) & ~(every & a1 & b1 & c1 & d1) & cells_of_word(w, width)
                if active == _NONE:
                    continue
                case_numbers_64(a, a1, b, b1, c, c1, d, d1, cases)
                end = position + np.uintp(bit_count(active))
                while active != _NONE:
                    # Writing four always, and counting the true ones, spares branches that nobody can
                    # predict.
                    for i in range(np.uintp(4)):
                        configurations[position + i] = cases[lowest_bit(active)]
                        active &= active - _ONE
                    position += np.uintp(4)
                position = end
            for i in range(row_start, position):
                triangles += triangle_count[configurations[i]]
            cell_counts[z, y] = position - row_start
            triangle_counts[z, y] = triangles
    return int(position)
