"""Between the passes: cells whose case alone does not say what to draw."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.kernels.compiled import compiled
from volviz.kernels.marching.bits import lowest_bit
from volviz.kernels.marching.rows import active_cells, corner_words
from volviz.kernels.marching.trilinear import (
    INSIDE_TUNNEL,
    NO_TUNNEL,
    OUTSIDE_TUNNEL,
    inside_connection,
    joined_faces,
)

Array = npt.NDArray[Any]

_ONE = np.uint64(1)
_NONE = np.uint64(0)


@compiled
def decide_configurations(
    slab: Array,
    mask: Array,
    slab_first: int,
    bits: Array,
    cells: Array,
    isovalue: float,
    cases: Array,
    first_row: Array,
    ambiguous: Array,
    inside_regions: Array,
    hidden: int,
    configurations: Array,
    first: int,
    stop: int,
) -> None:
    """Turn the cases of the active cells of some planes into configurations.

    Parameters
    ----------
    slab : ndarray of shape (planes, Y, X)
        C-contiguous scalars; it holds the planes first to stop.
    mask : ndarray of shape (planes, Y, X), bool, or (0, 0, 0)
        Only cells with all corners set are drawn; empty: all are.
    slab_first : int
        Plane of the volume that is the first of `slab` and `mask`.
    bits : ndarray of shape (Z, Y, words), uint64
        See `volviz.kernels.marching.rows.mark_inside`.
    cells : ndarray of shape (words - 1,), uint64
        See `volviz.kernels.marching.rows.cell_words`.
    isovalue : float
        In data units.
    cases : ndarray of shape (cells,), uint8
        Of the active cells of these planes, row after row.
    first_row, ambiguous, inside_regions : ndarrays
        See `volviz.kernels.marching.topology.TopologicalTables`; a `first_row` of only -1 decides nothing.
    hidden : int
        What to add to the case of a cell that is not drawn.
    configurations : ndarray of shape (cells,), uint16
        Written.
    first, stop : int
        Range of planes of cells.
    """
    height, words = bits.shape[1], bits.shape[2]
    flat = bits.reshape(bits.size)
    values = np.empty(8, np.float64)
    position = 0
    for z in range(first, stop):
        for y in range(height - 1):
            row = np.uintp((z * height + y) * words)
            for w in range(words - 1):
                c0, c1, c2, c3, c4, c5, c6, c7 = corner_words(flat, row + np.uintp(w), words, height)
                active = active_cells(c0, c1, c2, c3, c4, c5, c6, c7) & cells[w]
                while active != _NONE:
                    x = w * 64 + np.int64(lowest_bit(active))
                    active &= active - _ONE
                    case = cases[position]
                    configuration = np.int64(case)
                    if mask.size > 0 and not _is_whole(mask, z - slab_first, y, x):
                        configuration += hidden
                    elif first_row[case] >= 0:
                        for corner in range(8):
                            plane = z - slab_first + (corner >> 2)
                            value = slab[plane, y + (corner >> 1 & 1), x + (corner & 1)]
                            values[corner] = np.float64(value) - isovalue
                        start = first_row[case]
                        configuration = start + _decision(
                            values, case, ambiguous[case], inside_regions, start
                        )
                    configurations[position] = configuration
                    position += 1


@compiled
def _is_whole(mask: Array, z: int, y: int, x: Any) -> bool:
    """Tell whether all eight corners of a cell are set."""
    for k in range(2):
        for j in range(2):
            for i in range(2):
                if not mask[z + k, y + j, x + i]:
                    return False
    return True


@compiled
def _decision(values: Array, case: int, ambiguous: Array, inside_regions: Array, first_row: int) -> int:
    """Number of a configuration among those of its case: 3 * bits of joined faces + tunnel."""
    is_finite = True
    for corner in range(8):
        # Rounding of huge integers must not contradict the case.
        if case >> corner & 1:
            values[corner] = max(values[corner], 0.0)
        elif values[corner] >= 0:
            values[corner] = -np.finfo(np.float64).tiny
        is_finite = is_finite and np.abs(values[corner]) < np.inf
    joined = joined_faces(values)
    bits = 0
    for i in range(6):
        if ambiguous[i] >= 0 and joined >> ambiguous[i] & 1:
            bits |= 1 << i
    if not is_finite:
        return 3 * bits + NO_TUNNEL
    components, holes = inside_connection(values)
    if components < inside_regions[first_row + 3 * bits]:
        return 3 * bits + INSIDE_TUNNEL
    if holes > 0:
        return 3 * bits + OUTSIDE_TUNNEL
    return 3 * bits + NO_TUNNEL


@compiled
def count_triangles(
    configurations: Array,
    cell_counts: Array,
    triangle_count: Array,
    middle_count: Array,
    triangle_counts: Array,
    middle_counts: Array,
    first: int,
    stop: int,
) -> None:
    """Count triangles, and vertices in the middle of cells, of every row of cells of some planes.

    Parameters
    ----------
    configurations : ndarray of shape (cells,), uint16
        Of the active cells of these planes, row after row.
    cell_counts : ndarray of shape (Z - 1, Y - 1), integers
        Active cells of each row.
    triangle_count, middle_count : ndarrays of shape (N,)
        Of each configuration.
    triangle_counts, middle_counts : ndarrays of shape (Z - 1, Y - 1) and (Z, Y), integers
        Written for these planes.
    first, stop : int
        Range of planes of cells.
    """
    position = 0
    for z in range(first, stop):
        for y in range(cell_counts.shape[1]):
            triangles, middles = 0, 0
            for _ in range(cell_counts[z, y]):
                triangles += triangle_count[configurations[position]]
                middles += middle_count[configurations[position]]
                position += 1
            triangle_counts[z, y] = triangles
            middle_counts[z, y] = middles
