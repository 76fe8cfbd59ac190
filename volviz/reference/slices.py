"""Slices and slabs in float64: the definition that the shaders of the technique are measured against.

Values are resampled by `scipy.ndimage.map_coordinates`: nearest voxel, linear, or the cubic B-spline that passes
through the voxels (Unser, "Splines: a perfect fit for signal and image processing", 1999; mirrored at the borders).
A voxel reaches half a spacing to either side of its centre, so the first and the last are seen whole.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError

Float64Array = npt.NDArray[np.float64]

INTERPOLATIONS = ("nearest", "linear", "cubic")
SLAB_MODES = ("mean", "maximum", "minimum", "composite")

#: What rounding may take an index beyond the face of the box in which it lies, in voxels.
TOLERANCE = 1e-6
#: Voxels around those that are touched from which the spline's coefficients are found: what lies farther away counts
#: for less than 0.27^16.
_SPLINE_REACH = 16


def slab_offsets(thickness: float, step: float) -> Float64Array:
    """Distances from the middle plane at which a slab is sampled: midpoints of equal parts, no longer than a step.

    Parameters
    ----------
    thickness : float
        World units; 0 is the plane alone.
    step : float
        World units, greater than 0.

    Returns
    -------
    ndarray of shape (N,), float64
        Ascending, symmetric about 0.
    """
    count = max(math.ceil(thickness / step - 1e-9), 1)
    return np.asarray(((np.arange(count) + 0.5) / count - 0.5) * thickness)


def index_box(dimensions: Sequence[int], crop: Sequence[float] | None = None) -> Float64Array:
    """What is seen of a volume, as limits of continuous voxel indices: shape (2, 3), lowest and highest (i, j, k).

    A crop box that reaches to the first or last voxel centre shows that voxel whole.
    """
    last = np.asarray(dimensions, np.float64) - 1.0
    if crop is None:
        return np.stack([np.full(3, -0.5), last + 0.5])
    low, high = np.asarray(crop, np.float64).reshape(3, 2).T
    return np.stack([np.where(low <= 0.0, -0.5, low), np.where(high >= last, last + 0.5, high)])


def whole_crop(dimensions: Sequence[int], crop: Sequence[float] | None = None) -> tuple[float, ...]:
    """The limits of `index_box` as a crop box: (i0, i1, j0, j1, k0, k1)."""
    return tuple(float(v) for v in index_box(dimensions, crop).T.ravel())


def resample(
    array: npt.NDArray[Any], index: Float64Array, interpolation: str, box: Float64Array | None = None
) -> Float64Array:
    """Values at continuous voxel indices.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars in data units.
    index : ndarray of shape (..., 3), float64
        (i, j, k), along x, y, z.
    interpolation : {"nearest", "linear", "cubic"}
    box : ndarray of shape (2, 3), optional
        From `index_box`; None is the whole volume.

    Returns
    -------
    ndarray of shape (...,), float64
        NaN outside the box, and where a voxel that is not finite takes part.
    """
    from scipy.ndimage import map_coordinates, spline_filter

    if interpolation not in INTERPOLATIONS:
        raise InputError(f"interpolation must be {', '.join(INTERPOLATIONS)}, got {interpolation!r}.")
    limits = index_box(array.shape[::-1]) if box is None else box
    inside = np.all((index >= limits[0] - TOLERANCE) & (index <= limits[1] + TOLERANCE), axis=-1)
    values = np.full(index.shape[:-1], np.nan)
    if not inside.any():
        return values
    last = np.asarray(array.shape[::-1]) - 1.0
    places = np.clip(index[inside], 0.0, last)
    # only what is touched becomes float64
    reach = _SPLINE_REACH if interpolation == "cubic" else 1
    first = np.maximum(np.floor(places.min(axis=0)).astype(int) - reach, 0)
    stop = np.minimum(np.ceil(places.max(axis=0)) + 1 + reach, last + 1).astype(int)
    part = array[first[2] : stop[2], first[1] : stop[1], first[0] : stop[0]].astype(np.float64)
    coordinates = (places - first)[:, ::-1].T
    order = {"nearest": 0, "linear": 1, "cubic": 3}[interpolation]
    finite = np.isfinite(part)
    known = bool(finite.all())
    if not known:
        part = np.where(finite, part, 0.0)
    if order == 3:
        part = spline_filter(part, order=3, mode="mirror")
    found = map_coordinates(part, coordinates, order=order, mode="mirror", prefilter=False)
    if not known:
        missing = map_coordinates(
            (~finite).astype(np.float64), coordinates, order=min(order, 1), mode="mirror", prefilter=False
        )
        found[missing > TOLERANCE] = np.nan
    values[inside] = found
    return values


def slab_samples(
    array: npt.NDArray[Any],
    world_to_index: Float64Array,
    points: Float64Array,
    normal: npt.ArrayLike,
    offsets: Float64Array,
    interpolation: str,
    box: Float64Array | None = None,
) -> Iterator[Float64Array]:
    """Values on the planes of a slab, one after the other: (H, W) each, NaN outside.

    Parameters
    ----------
    array, interpolation, box
        As for `resample`.
    world_to_index : ndarray of shape (4, 4)
    points : ndarray of shape (..., 3)
        World positions on the middle plane.
    normal : array_like of shape (3,)
        Unit vector along which the offsets count, in the world.
    offsets : ndarray of shape (N,)
        From `slab_offsets`.
    """
    index = points @ world_to_index[:3, :3].T + world_to_index[:3, 3]
    along = world_to_index[:3, :3] @ np.asarray(normal, np.float64)
    for offset in offsets:
        yield resample(array, index + offset * along, interpolation, box)


def projected(samples: Iterator[Float64Array], mode: str) -> Float64Array:
    """One value of the samples across a slab: their mean, maximum or minimum, of those that lie inside.

    Parameters
    ----------
    samples : iterator of ndarrays of one shape
        From `slab_samples`.
    mode : {"mean", "maximum", "minimum"}

    Returns
    -------
    ndarray of that shape, float64
        NaN where none is inside.
    """
    if mode not in SLAB_MODES or mode == "composite":
        raise InputError(f"mode of a slab must be mean, maximum or minimum, got {mode!r}.")
    total = next(samples)
    count = np.isfinite(total).astype(np.float64)
    if mode == "mean":
        total = np.nan_to_num(total)
    for values in samples:
        if mode == "maximum":
            total = np.fmax(total, values)
        elif mode == "minimum":
            total = np.fmin(total, values)
        else:
            total += np.nan_to_num(values)
            count += np.isfinite(values)
    if mode != "mean":
        return total
    return np.asarray(np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0))


def composited(
    samples: Iterator[Float64Array], classify: Any, length: float, unit_distance: float
) -> Float64Array:
    """A slab classified sample by sample and composited, the first sample in front.

    Parameters
    ----------
    samples : iterator of ndarrays of shape (H, W)
        From `slab_samples`, front to back.
    classify : callable
        From values to straight RGBA, opacities per unit distance; not asked about NaN.
    length : float
        Of the ray that a sample stands for, in world units.
    unit_distance : float
        Length to which the opacities belong, in world units.

    Returns
    -------
    ndarray of shape (H, W, 4), float64
        Premultiplied RGBA.
    """
    image: Float64Array | None = None
    for values in samples:
        if image is None:
            image = np.zeros((*values.shape, 4))
        inside = np.isfinite(values)
        color = classify(values[inside])
        alpha = 1.0 - (1.0 - np.minimum(color[:, 3], 1.0)) ** (length / unit_distance)
        color = np.concatenate([color[:, :3] * alpha[:, None], alpha[:, None]], axis=1)
        image[inside] += (1.0 - image[inside, 3:]) * color
    assert image is not None
    return image
