"""Values along a line."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from volviz.errors import InputError
from volviz.measure.noise import noise_of
from volviz.measure.results import Float64Array, PointLike, as_point, length_unit
from volviz.model.measurements import COVERAGE
from volviz.reference.slices import INTERPOLATIONS, TOLERANCE, index_box, resample
from volviz.reference.surface_pick import values_at
from volviz.volume_data.volume import Volume

#: Samples for each smallest spacing.
SAMPLES_PER_VOXEL = 2.0
MOST_SAMPLES = 20_000
#: Samples whose spline is found at once.
SPLINE_BLOCK = 64


@dataclass(frozen=True, eq=False)
class Profile:
    """Values of volumes along a line.

    Attributes
    ----------
    distance : ndarray of shape (N,), float64
        From the first point, in `unit`.
    points : ndarray of shape (N, 3), float64
        World points (x, y, z).
    values : tuple of ndarrays of shape (N,), float64
        Of each volume, in data units; NaN outside.
    errors : tuple of ndarrays of shape (N,), float64
        95 % half-widths: the noise of the voxels, and what linear interpolation may be off where values bend.
    names, units : tuple of str
        Of the volumes and their values.
    unit : str
        Of the distance.
    """

    distance: Float64Array
    points: Float64Array
    values: tuple[Float64Array, ...]
    errors: tuple[Float64Array, ...]
    names: tuple[str, ...]
    units: tuple[str, ...]
    unit: str

    def to_csv(self) -> str:
        """As a table: distance, position, then value and error of each volume."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        head = [f"distance ({self.unit})", *(f"{axis} ({self.unit})" for axis in "xyz")]
        for name, unit in zip(self.names, self.units, strict=True):
            words = f"{name} ({unit})" if unit else name
            head += [words, f"error of {words}"]
        writer.writerow(head)
        columns = [self.distance, *self.points.T]
        for values, errors in zip(self.values, self.errors, strict=True):
            columns += [values, errors]
        for row in zip(*columns, strict=True):
            writer.writerow(["" if math.isnan(v) else f"{v:.9g}" for v in row])
        return text.getvalue()


def profile(
    a: PointLike,
    b: PointLike,
    volumes: Volume | Sequence[Volume],
    *,
    samples: int | None = None,
    interpolation: Literal["nearest", "linear", "cubic"] = "linear",
) -> Profile:
    """Values of one or more volumes along the line from one world point to another.

    Parameters
    ----------
    a, b : Point or 3 floats
        Ends, in the world.
    volumes : Volume or sequence of Volume
    samples : int, optional
        How many, both ends among them; the default is two for each smallest spacing.
    interpolation : {"nearest", "linear", "cubic"}

    Raises
    ------
    InputError
        Both ends are one point, no volume, or fewer than two samples.
    """
    shown = (volumes,) if isinstance(volumes, Volume) else tuple(volumes)
    if not shown:
        raise InputError("a profile needs a volume whose values lie along it.")
    start, end = (np.asarray(as_point(point, None, "an end of a profile").position) for point in (a, b))
    length = float(np.linalg.norm(end - start))
    if length == 0:
        raise InputError("both ends of the profile are one point; move one of them.")
    if samples is None:
        pitch = min(min(volume.spacing) for volume in shown) / SAMPLES_PER_VOXEL
        samples = min(math.ceil(length / pitch) + 1, MOST_SAMPLES)
    if interpolation not in INTERPOLATIONS:
        raise InputError(f"interpolation must be {', '.join(INTERPOLATIONS)}, got {interpolation!r}.")
    if samples < 2:
        raise InputError(f"a profile has at least two samples, got {samples}.")
    parts = np.linspace(0.0, 1.0, samples)
    points = start + parts[:, None] * (end - start)
    found = [_values(volume, points, interpolation) for volume in shown]
    return Profile(
        parts * length, points, tuple(values for values, _ in found), tuple(errors for _, errors in found),
        tuple(volume.name for volume in shown), tuple(volume.unit for volume in shown), length_unit(shown[0]),
    )  # fmt: skip


def _values(volume: Volume, points: Float64Array, interpolation: str) -> tuple[Float64Array, Float64Array]:
    index = points @ volume.world_to_index[:3, :3].T + volume.world_to_index[:3, 3]
    values = _sampled(volume, index, interpolation)
    # half a voxel to both sides along the line: what the mean of these is off is the bound of the error of linear
    # interpolation, h² |f''| / 8
    step = np.diff(index[[0, -1]], axis=0)[0]
    step = step / (2.0 * np.abs(step).max())
    sides = [_sampled(volume, index + sign * step, "linear") for sign in (-1.0, 1.0)]
    bend = np.abs((sides[0] + sides[1]) / 2 - _sampled(volume, index, "linear"))
    low = np.clip(np.floor(index.min(axis=0)).astype(int) - 2, 0, np.asarray(volume.dimensions) - 1)
    high = np.clip(np.ceil(index.max(axis=0)).astype(int) + 3, low + 1, volume.dimensions)
    around = volume.array[low[2] : high[2], low[1] : high[1], low[0] : high[0]]
    # at the very ends there is nothing beyond
    return values, np.hypot(COVERAGE * noise_of(around), np.where(np.isnan(bend), 0.0, bend))


def _sampled(volume: Volume, index: Float64Array, interpolation: str) -> Float64Array:
    """Values at continuous indices, NaN outside; a line through a large volume touches few of its voxels."""
    if interpolation == "cubic" or volume.nonfinite_count:
        blocks = np.array_split(index, math.ceil(len(index) / SPLINE_BLOCK))
        return np.concatenate([resample(volume.array, block, interpolation) for block in blocks])
    low, high = index_box(volume.dimensions)
    inside = np.all((index >= low - TOLERANCE) & (index <= high + TOLERANCE), axis=1)
    values = values_at(volume.array, index, nearest=interpolation == "nearest", lowest=float(volume.range[0]))
    return np.where(inside, values, np.nan)
