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


def cell_words(voxels: int) -> npt.NDArray[np.uint64]:
    """Words of a row in which the first voxel of every cell is set: all voxels but the last.

    Parameters
    ----------
    voxels : int
        Voxels in a row, at least 1.

    Returns
    -------
    ndarray of shape (words - 1,), uint64
    """
    cells = (1 << voxels - 1) - 1
    words = [cells >> 64 * w & 0xFFFF_FFFF_FFFF_FFFF for w in range(words_in_row(voxels) - 1)]
    return np.array(words, np.uint64)


@compiled
def crossings(bits: Array, near: Any, far: Any, sideways: Any, cells: Any) -> Any:
    """One word of the edges from one row to another that are crossed.

    Parameters
    ----------
    bits : ndarray of shape (Z * Y * words,), uint64
        See `mark_inside`, flat.
    near, far : int
        Positions of the words of the row where the edges start, and of the row where they end.
    sideways : int
        1 when the edges also go one voxel to the right, else 0.
    cells : uint64
        This word of `cell_words`.
    """
    if sideways == 0:
        return bits[np.uintp(near)] ^ bits[np.uintp(far)]
    return (bits[np.uintp(near)] ^ shifted(bits, np.uintp(far))) & cells


@compiled
def shifted(bits: Array, at: Any) -> Any:
    """A word of a row moved by one voxel to the left: bit x holds voxel x + 1; `bits` is flat."""
    return (bits[at] >> _ONE) | (bits[at + np.uintp(1)] << _LAST)


@compiled
def count_vertices(bits: Array, cells: Array, steps: Array, counts: Array, first: int, stop: int) -> None:
    """Count the crossed edges that start in each row of the planes first..stop-1.

    Parameters
    ----------
    bits : ndarray of shape (Z, Y, words), uint64
        See `mark_inside`.
    cells : ndarray of shape (words - 1,), uint64
        See `cell_words`.
    steps : ndarray of shape (K,), int64
        Kinds of edges, see `volviz.kernels.marching.cube`.
    counts : ndarray of shape (Z, K, Y), integers
        Written for these planes.
    first, stop : int
        Range of planes.
    """
    depth, height, words = bits.shape
    flat = bits.reshape(bits.size)
    for z in range(first, stop):
        for k in range(steps.size):
            dx, dy, dz = steps[k] & 1, steps[k] >> 1 & 1, steps[k] >> 2 & 1
            for y in range(height):
                total = _NONE
                if y + dy < height and z + dz < depth:
                    near, far = (z * height + y) * words, ((z + dz) * height + y + dy) * words
                    for w in range(words - 1):
                        total += bit_count(crossings(flat, near + w, far + w, dx, cells[w]))
                counts[z, k, y] = total


@compiled
def corner_words(bits: Array, at: Any, words: int, height: int) -> Any:
    """The words of the 8 corners of 64 cells, in the order of the corners.

    Parameters
    ----------
    bits : ndarray of shape (Z * Y * words,), uint64
        See `mark_inside`, flat.
    at : uintp
        Position of the word of corner 0.
    words, height : int
        Words in a row, rows in a plane.
    """
    at1, at2 = at + np.uintp(words), at + np.uintp(height * words)
    at3 = at2 + np.uintp(words)
    return (
        bits[at], shifted(bits, at), bits[at1], shifted(bits, at1),
        bits[at2], shifted(bits, at2), bits[at3], shifted(bits, at3),
    )  # fmt: skip


@compiled
def active_cells(c0: Any, c1: Any, c2: Any, c3: Any, c4: Any, c5: Any, c6: Any, c7: Any) -> Any:
    """Bits of the cells whose eight corners are neither all inside nor all outside."""
    some = c0 | c1 | c2 | c3 | c4 | c5 | c6 | c7
    return some & ~(c0 & c1 & c2 & c3 & c4 & c5 & c6 & c7)


@compiled
def list_active_cells(
    bits: Array,
    cells: Array,
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
    cells : ndarray of shape (words - 1,), uint64
        See `cell_words`.
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
    flat = bits.reshape(bits.size)
    position = np.uintp(0)
    for z in range(first, stop):
        for y in range(height - 1):
            row_start = position
            triangles = 0
            row = np.uintp((z * height + y) * words)
            for w in range(np.uintp(words - 1)):
                c0, c1, c2, c3, c4, c5, c6, c7 = corner_words(flat, row + w, words, height)
                active = active_cells(c0, c1, c2, c3, c4, c5, c6, c7) & cells[w]
                if active == _NONE:
                    continue
                case_numbers_64(c0, c1, c2, c3, c4, c5, c6, c7, cases)
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
