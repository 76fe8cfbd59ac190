"""Volumes by counting voxels: of labels, and of what lies between two values within a crop box.

How far a count is off depends on how the surface lies to the lattice. Where its direction changes, errors cancel: the
variance of the count is the surface times a constant of the lattice (Kendall 1948; Matérn, "Precision of area
estimation", 1989, here in three dimensions). Faces along the lattice do not cancel: each lies anywhere within a
voxel.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.measure.noise import noise_of
from volviz.measure.results import Float64Array, Measured, cell_volume, length_unit
from volviz.model.clipping import Clipping
from volviz.model.measurements import COVERAGE
from volviz.reference.slices import index_box
from volviz.volume_data.volume import Volume

#: Standard deviations that bars have to hold: errors of one shape are no normal distribution, and it may lie as
#: badly as twice the mean variance.
_LATTICE_COVERAGE = COVERAGE * 2**0.5
#: Standard deviation of what a flat face along the lattice, and one that begins to curve away, may be off: of the first
#: and second Bernoulli polynomial over a voxel.
_FLAT, _CURVED = 12**-0.5, 180**-0.5 / 2
#: Terms of the sum over the dual lattice to each side.
_TERMS = 6


def label_volumes(labels: Volume) -> dict[int, Measured]:
    """Volume of every label.

    Parameters
    ----------
    labels : Volume
        Whole numbers; 0 is nothing.

    Returns
    -------
    dict of int to Measured
        By label, in cubic world units. The errors are those of counting voxels; what the labels leave out is not known.

    Raises
    ------
    InputError
        Values that are no whole numbers.
    """
    array = labels.array
    if array.dtype.kind == "b":
        array = array.view(np.uint8)
    if array.dtype.kind not in "iu":
        whole = labels.finite_array
        if not np.array_equal(whole, np.rint(whole)):
            raise InputError(
                f"{labels.name} holds values that are no whole numbers; labels are whole numbers."
            )
        array = whole.astype(np.int64)
    known, counts = np.unique(array, return_counts=True)
    dense = np.searchsorted(known, array).astype(np.uint32)
    faces = [_faces(dense, axis, len(known)) for axis in range(3)]
    unit = f"{length_unit(labels)}³"
    return {
        int(label): _counted(float(counts[n]), [levels[n] for levels in faces], labels, unit)
        for n, label in enumerate(known)
        if label != 0
    }


def threshold_volume(
    volume: Volume, low: float, high: float = math.inf, *, crop: Sequence[float] | None = None
) -> Measured:
    """Volume of the voxels whose values lie between two limits, both included, within a crop box.

    Parameters
    ----------
    volume : Volume
    low, high : float
        In data units; one of them may be infinite.
    crop : tuple of 6 floats, optional
        (i0, i1, j0, j1, k0, k1) in continuous voxel indices. Voxels at its faces count by the part that lies within.

    Returns
    -------
    Measured
        In cubic world units. The error is that of counting voxels, of rounded values, and of noise: the same voxels
        counted after a mean over neighbours.

    Raises
    ------
    InputError
        Limits that hold nothing, or a crop box that is none.
    """
    if math.isnan(low) or math.isnan(high) or low > high:
        raise InputError(f"limits of a threshold must be low <= high, got {low:g} and {high:g}.")
    limits = Clipping(None if crop is None else tuple(crop)).crop_within(volume.dimensions)  # type: ignore[arg-type]
    box = index_box(volume.dimensions, limits)
    first = np.maximum(np.ceil(box[0] - 0.5), 0).astype(int)
    stop = np.minimum(np.floor(box[1] + 0.5).astype(int) + 1, volume.dimensions)
    part = volume.array[first[2] : stop[2], first[1] : stop[1], first[0] : stop[0]]
    weights = [
        np.clip(
            np.minimum(np.arange(a, b) + 0.5, high_face) - np.maximum(np.arange(a, b) - 0.5, low_face), 0, 1
        )
        for a, b, low_face, high_face in zip(first, stop, *box, strict=True)
    ]

    def count(values: npt.NDArray[Any]) -> tuple[float, npt.NDArray[np.bool_]]:
        with np.errstate(invalid="ignore"):
            inside = (values >= low) & (values <= high) & np.isfinite(values)
        return float(np.einsum("kji,i,j,k->", inside, *weights, optimize=True)), inside

    found, inside = count(part)
    faces = [_faces(inside.astype(np.uint32), axis, 2)[1] for axis in range(3)]
    unit = f"{length_unit(volume)}³"
    counted = _counted(found, faces, volume, unit)
    cell = cell_volume(volume)
    noise = noise_of(part)
    # values within their noise of a limit may lie on its other side; that shifts the count, and makes chance
    near = sum(
        float(np.count_nonzero(np.abs(part - limit) <= COVERAGE * noise))
        for limit in (low, high)
        if math.isfinite(limit)
    )
    rounding = 12**-0.5 if part.dtype.kind in "iu" else 0.0
    shift = abs(count(_means(part))[0] - found) if noise > rounding else 0.0
    error = math.sqrt(counted.error**2 + (shift * cell) ** 2 + (COVERAGE * cell) ** 2 * near / 4)
    return Measured(counted.value, unit, min(error, part.size * cell))


def _counted(count: float, faces: Sequence[npt.NDArray[np.int64]], volume: Volume, unit: str) -> Measured:
    """Volume and error of so many voxels.

    Parameters
    ----------
    count : float
        Voxels.
    faces : sequence of 3 arrays of shape (2, n + 1)
        Along i, j and k: how many faces of voxels look to lower and to higher indices, between each two layers.
    """
    cell = cell_volume(volume)
    axes = volume.index_to_world[:3, :3]
    area, aligned = 0.0, 0.0
    for axis, levels in enumerate(faces):
        face = cell * float(np.linalg.norm(np.linalg.inv(axes)[axis]))
        area += face * float(levels.sum())
        for level in levels:
            beside = np.maximum(np.append(level[1:], 0), np.append(0, level[:-1]))
            flat = float(np.maximum(level - beside, 0).max(initial=0))
            aligned += (_FLAT * flat) ** 2 + (_CURVED * float(level.max(initial=0))) ** 2
    # faces of voxels are one and a half times as large as a smooth surface of all directions that they follow
    chance = area / 1.5 * _lattice_constant(tuple(axes.ravel()))
    return Measured(count * cell, unit, math.hypot(
        _LATTICE_COVERAGE * math.sqrt(chance), COVERAGE * cell * math.sqrt(aligned)
    ))  # fmt: skip


def _faces(dense: npt.NDArray[np.uint32], axis: int, count: int) -> npt.NDArray[np.int64]:
    """Faces between voxels of different labels along an index axis.

    Parameters
    ----------
    dense : ndarray of shape (Z, Y, X), uint32
        Labels 0 .. count - 1.
    axis : int
        0 for i (x), 1 for j, 2 for k.
    count : int

    Returns
    -------
    ndarray of shape (count, 2, n + 1), int64
        For each label how many of its faces look to lower and to higher indices, in front of each layer.
    """
    layers = np.moveaxis(dense, 2 - axis, 0)
    found = np.zeros((count, 2, len(layers) + 1), np.int64)
    for at in range(1, len(layers)):
        before, after = layers[at - 1], layers[at]
        differ = before != after
        found[:, 1, at] = np.bincount(before[differ], minlength=count)
        found[:, 0, at] = np.bincount(after[differ], minlength=count)
    found[:, 0, 0] = np.bincount(layers[0].ravel(), minlength=count)
    found[:, 1, -1] = np.bincount(layers[-1].ravel(), minlength=count)
    return found


@cache
def _lattice_constant(axes: tuple[float, ...]) -> float:
    """Variance of the volume by counting, divided by the surface: 1 / (8 π³) times the sum of |ξ|^-4.

    The sum goes over the dual lattice without its origin. The squared spectrum of a body of all directions falls as
    its surface / (8 π³ |ξ|^4), for the covariogram begins with a fall of a quarter of the surface (Matheron 1965).
    """
    dual = np.linalg.inv(np.array(axes).reshape(3, 3))
    steps = np.arange(-_TERMS, _TERMS + 1)
    numbers = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    numbers = numbers[np.any(numbers != 0, axis=1)]
    return float(np.sum(np.sum((numbers @ dual) ** 2, axis=1) ** -2.0)) / (8 * math.pi**3)


def _means(values: npt.NDArray[Any]) -> Float64Array:
    """Means over three voxels along each axis."""
    from scipy.ndimage import uniform_filter

    known = np.asarray(values, np.float64)
    known = np.where(np.isfinite(known), known, np.nanmin(np.where(np.isfinite(known), known, np.nan)))
    return np.asarray(uniform_filter(known, 3, mode="nearest"))
