"""Histograms of values, and of values against gradient magnitudes, in steps that can be shown and cancelled.

Bins are those of `numpy.histogram`: equally wide, closed on the left, the last one on both sides; values
outside the range are left out, and so are NaN and infinities. The planes of a volume are visited in a
scattered order, so that the first partial result already looks like the last.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.errors import Cancelled, InputError
from volviz.kernels.arrays import check_scalars, native_slab
from volviz.kernels.compiled import compiled
from volviz.kernels.gradient import (
    gradient_statistics,
    inverse_spacing,
    magnitude_plane,
    slab_with_neighbours,
)
from volviz.kernels.statistics import finite_range
from volviz.kernels.threads import map_ranges

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

AnyArray = npt.NDArray[Any]
Counts = npt.NDArray[np.int64]
Edges = npt.NDArray[np.float64]

#: Planes counted in one piece of work.
_PLANES = 4

#: Partial results that a whole volume gives at most.
_PARTS = 16


class Histogram(NamedTuple):
    """Voxels per value.

    Attributes
    ----------
    counts : ndarray of shape (bins,), int64
    edges : ndarray of shape (bins + 1,), float64
        Limits of the bins in data units.
    done : float
        Share of the volume that was counted, 0..1.
    """

    counts: Counts
    edges: Edges
    done: float


class JointHistogram(NamedTuple):
    """Voxels per value and gradient magnitude.

    Attributes
    ----------
    counts : ndarray of shape (gradient bins, value bins), int64
        Row 0 holds the smallest gradients.
    value_edges, gradient_edges : ndarray, float64
        Limits of the bins, data units and data units per world unit.
    done : float
        Share of the volume that was counted, 0..1.
    """

    counts: Counts
    value_edges: Edges
    gradient_edges: Edges
    done: float


def even_histogram(
    values: Edges, bins: int, low: float, high: float, weights: Edges | None = None
) -> tuple[Edges, Edges]:
    """`numpy.histogram` between two limits, also where these are only a rounding apart or span all of float64.

    Parameters
    ----------
    values : ndarray of float64
        Those beyond the limits count in the outermost bins.
    bins : int
    low, high : float
        Finite, low < high.
    weights : ndarray, optional
        One for each value.

    Returns
    -------
    counts : ndarray of shape (bins,)
    edges : ndarray of shape (bins + 1,), float64
        Neighbouring ones are equal where float64 has no number between them.
    """
    values = np.clip(values, low, high)
    edges = np.linspace(low, high, bins + 1) if np.isfinite(high - low) else np.empty(0)
    if len(edges) and np.all(edges[1:] > edges[:-1]):
        counts, edges = np.histogram(values, bins, (low, high), weights=weights)
        return np.asarray(counts, np.float64), edges
    # halves do not overflow; a range of subnormal numbers is divided before it is halved
    half = high / 2 - low / 2
    share = (values / 2 - low / 2) / half if half > 0 else (values > low).astype(np.float64)
    index = np.minimum((share * bins).astype(np.intp), bins - 1)
    fractions = np.arange(bins + 1) / bins
    counts = np.bincount(index.ravel(), None if weights is None else weights.ravel(), bins)
    # the sum of two products may end a rounding below its neighbour
    edges = np.maximum.accumulate(np.clip(low * (1 - fractions) + high * fractions, low, high))
    return np.asarray(counts, np.float64), edges


def histogram(
    array: AnyArray,
    bins: int = 256,
    value_range: tuple[float, float] | None = None,
    *,
    cancel: Callable[[], bool] | None = None,
) -> Histogram:
    """Number of voxels in each of `bins` equal intervals of value.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars of any real type; never copied as a whole.
    bins : int, default: 256
        At least 1.
    value_range : (lo, hi), optional
        In data units; default the finite range. Equal limits are widened by 0.5 to each side.
    cancel : callable, optional
        Asked between pieces of work; True raises `Cancelled`.

    Raises
    ------
    InputError
        Not a volume, no bins, or a range that is not one.
    Cancelled
        `cancel` said so.
    """
    *_, last = progressive_histogram(array, bins, value_range, cancel=cancel)
    return last


def progressive_histogram(
    array: AnyArray,
    bins: int = 256,
    value_range: tuple[float, float] | None = None,
    *,
    cancel: Callable[[], bool] | None = None,
) -> Iterator[Histogram]:
    """As `histogram`, but giving a partial result after each sixteenth of the volume or so.

    Yields
    ------
    Histogram
        With `done` rising; the last one is complete and has ``done == 1``. Each has arrays of its own.
    """
    edges = _checked_edges(array, bins, value_range)
    counts = np.zeros(bins, np.int64)
    for chunks, done in _rounds(array.shape[0], cancel):

        def count(first: int, last: int, chunks: Sequence[tuple[int, int]] = chunks) -> Counts:
            return _count_values((native_slab(array, a, b).reshape(-1) for a, b in chunks[first:last]), edges)

        for part in map_ranges(count, len(chunks)):
            counts += part
        yield Histogram(counts.copy(), edges, done)


def joint_histogram(
    array: AnyArray,
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    *,
    bins: tuple[int, int] = (256, 128),
    value_range: tuple[float, float] | None = None,
    gradient_range: tuple[float, float] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> JointHistogram:
    """Number of voxels per value and gradient magnitude.

    Boundaries between two materials show as arcs between their values (Kindlmann and Durkin 1998).

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars of any real type; never copied as a whole.
    spacing : tuple of 3 floats
        Distance of voxel centres along (x, y, z), world units.
    bins : (value bins, gradient bins), default: (256, 128)
    value_range : (lo, hi), optional
        In data units; default the finite range.
    gradient_range : (lo, hi), optional
        In data units per world unit; default 0 to the largest magnitude.
    cancel : callable, optional
        Asked between pieces of work; True raises `Cancelled`.

    Raises
    ------
    InputError
        Not a volume, no bins, or a range that is not one.
    Cancelled
        `cancel` said so.
    """
    *_, last = progressive_joint_histogram(
        array, spacing, bins=bins, value_range=value_range, gradient_range=gradient_range, cancel=cancel
    )
    return last


def progressive_joint_histogram(
    array: AnyArray,
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    *,
    bins: tuple[int, int] = (256, 128),
    value_range: tuple[float, float] | None = None,
    gradient_range: tuple[float, float] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> Iterator[JointHistogram]:
    """As `joint_histogram`, but giving a partial result after each sixteenth of the volume or so.

    Yields
    ------
    JointHistogram
        With `done` rising; the last one is complete and has ``done == 1``. Each has counts of its own.
    """
    value_edges = _checked_edges(array, bins[0], value_range)
    scale = inverse_spacing(spacing)
    lowest = finite_range(array).low
    if gradient_range is None:
        gradient_range = (0.0, gradient_statistics(array, spacing, lowest=lowest).maximum)
    gradient_edges = _edges(bins[1], gradient_range)
    counts = np.zeros((bins[1], bins[0]), np.int64)
    for chunks, done in _rounds(array.shape[0], cancel):

        def count(first: int, last: int, chunks: Sequence[tuple[int, int]] = chunks) -> Counts:
            part = np.zeros((bins[1], bins[0]), np.int64)
            plane = np.empty(array.shape[1:], np.float32)
            for a, b in chunks[first:last]:
                slab, offset = slab_with_neighbours(array, a, b)
                for z in range(offset, offset + b - a):
                    magnitude_plane(slab, z, lowest, scale, plane)
                    _count_joint(slab[z], plane, value_edges, gradient_edges, part)
            return part

        for part in map_ranges(count, len(chunks)):
            counts += part
        yield JointHistogram(counts.copy(), value_edges, gradient_edges, done)


def _edges(bins: int, limits: tuple[float, float]) -> Edges:
    low, high = float(limits[0]), float(limits[1])
    if bins < 1:
        raise InputError(f"a histogram needs at least 1 bin, got {bins}.")
    if not (np.isfinite(low) and np.isfinite(high) and low <= high):
        raise InputError(f"the range of a histogram must be two finite numbers in order, got {limits}.")
    if low == high:
        low, high = low - 0.5, high + 0.5
    return np.linspace(low, high, bins + 1)


def _checked_edges(array: AnyArray, bins: int, value_range: tuple[float, float] | None) -> Edges:
    check_scalars(array)
    return _edges(bins, value_range if value_range is not None else finite_range(array)[:2])


def _rounds(depth: int, cancel: Callable[[], bool] | None) -> Iterator[tuple[list[tuple[int, int]], float]]:
    """Groups of plane ranges in scattered order, each with the share that is done after it."""
    chunks = [(a, min(a + _PLANES, depth)) for a in range(0, depth, _PLANES)]
    # multiples of the golden ratio fill the volume evenly from the first few on
    order = np.argsort(np.arange(len(chunks)) * 0.6180339887498949 % 1.0)
    scattered = [chunks[i] for i in np.argsort(order)]
    size = max(1, (len(chunks) + _PARTS - 1) // _PARTS)
    planes = 0
    for first in range(0, len(chunks), size):
        if cancel is not None and cancel():
            raise Cancelled("the histogram was cancelled.")
        group = scattered[first : first + size]
        planes += sum(b - a for a, b in group)
        yield group, planes / depth


def _count_values(pieces: Iterable[AnyArray], edges: Edges) -> Counts:
    """Counts of some pieces. Short integers are counted value by value first, which is exact and fast."""
    counts = np.zeros(len(edges) - 1, np.int64)
    raw: Counts | None = None
    lowest = 0
    for values in pieces:
        if values.dtype.kind in "ui" and values.dtype.itemsize <= 2:
            if raw is None:
                info = np.iinfo(values.dtype)
                lowest = int(info.min)
                raw = np.zeros((4, int(info.max) - lowest + 1), np.int64)
            _count_integers(values, lowest, raw)
        else:
            _count_numbers(values, edges, counts)
    if raw is not None:
        totals = raw.sum(axis=0)
        used = np.flatnonzero(totals)
        # counts are exact as float64 weights
        counts += np.histogram(used + lowest, edges, weights=totals[used])[0].astype(np.int64)
    return counts


@compiled
def _count_integers(values: AnyArray, lowest: int, raw: Counts) -> None:
    """Four tables in turn: equal neighbours do not wait for each other's increment."""
    whole = len(values) // 4 * 4
    for i in range(0, whole, 4):
        raw[0, values[i] - lowest] += 1
        raw[1, values[i + 1] - lowest] += 1
        raw[2, values[i + 2] - lowest] += 1
        raw[3, values[i + 3] - lowest] += 1
    for i in range(whole, len(values)):
        raw[0, values[i] - lowest] += 1


@compiled
def _bin(value: float, edges: Edges) -> int:
    """Bin of a value, -1 outside the range and for what is not finite."""
    last = len(edges) - 2
    if not edges[0] <= value <= edges[last + 1]:
        return -1
    i = min(int((value - edges[0]) / (edges[last + 1] - edges[0]) * (last + 1)), last)
    # rounding of the division may miss by one: the edges decide
    while i > 0 and value < edges[i]:
        i -= 1
    while i < last and value >= edges[i + 1]:
        i += 1
    return i


@compiled
def _count_numbers(values: AnyArray, edges: Edges, counts: Counts) -> None:
    for value in values:
        i = _bin(np.float64(value), edges)
        if i >= 0:
            counts[i] += 1


@compiled
def _count_joint(
    values: AnyArray, magnitudes: AnyArray, value_edges: Edges, gradient_edges: Edges, counts: Counts
) -> None:
    rows, columns = values.shape
    for y in range(rows):
        for x in range(columns):
            i = _bin(np.float64(values[y, x]), value_edges)
            j = _bin(np.float64(magnitudes[y, x]), gradient_edges)
            if i >= 0 and j >= 0:
                counts[j, i] += 1
