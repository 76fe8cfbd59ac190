"""Areas and perimeters of polygons and ellipses on a plane, and what lies in them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.measure.lengths import path_length
from volviz.measure.results import Float64Array, Measured, PointLike, as_point, length_unit, propagated
from volviz.model.measurements import COVERAGE
from volviz.volume_data.volume import Volume

Inside = Callable[[Float64Array], npt.NDArray[np.bool_]]
"""Tells which of the positions in the plane, shape (N, 2), lie inside."""


@dataclass(frozen=True)
class LayerStatistics:
    """Values of the voxels that a figure holds: those cut by its plane whose centres lie in it.

    Attributes
    ----------
    name : str
        Of the volume.
    voxels : int
        How many.
    mean : Measured
        Its error is that of the mean of so many independent voxels.
    deviation, minimum, median, maximum : float
        Standard deviation and order statistics, in data units; NaN without voxels.
    """

    name: str
    voxels: int
    mean: Measured
    deviation: float
    minimum: float
    median: float
    maximum: float

    def to_dict(self) -> dict[str, Any]:
        """As plain values, for JSON."""
        return {
            "name": self.name, "voxels": self.voxels, "mean": self.mean.to_dict(), "deviation": self.deviation,
            "minimum": self.minimum, "median": self.median, "maximum": self.maximum,
        }  # fmt: skip


@dataclass(frozen=True)
class Area(Measured):
    """An area with its outline and what lies in it.

    Attributes
    ----------
    perimeter : Measured
    statistics : tuple of LayerStatistics
        One for each volume that was given.
    """

    perimeter: Measured
    statistics: tuple[LayerStatistics, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """As plain values, for JSON."""
        return {
            **super().to_dict(),
            "perimeter": self.perimeter.to_dict(),
            "statistics": [each.to_dict() for each in self.statistics],
        }


def area(points: Sequence[PointLike], volumes: Volume | Sequence[Volume] = ()) -> Area:
    """Area and perimeter of a polygon, and statistics of the voxels in it.

    Parameters
    ----------
    points : sequence of Point or 3 floats
        Corners in order, at least three, in the world. Corners that do not lie in one plane count as they are
        projected on the plane that fits them (Newell's normal); the perimeter is that in space.
    volumes : Volume or sequence of Volume
        Whose values are asked for. Bare corners count as placed by hand in the first one, see `distance`.

    Raises
    ------
    InputError
        Fewer than three corners, corners on one line, or sides that cross each other.
    """
    shown = _volumes(volumes)
    known = [as_point(point, shown[0] if shown else None, "a corner") for point in points]
    if len(known) < 3:
        raise InputError(f"an area needs at least three corners, got {len(known)}.")
    places = np.array([point.position for point in known])
    before, after = np.roll(places, 1, axis=0), np.roll(places, -1, axis=0)
    middle = places.mean(axis=0)
    doubled = np.cross(places - middle, after - middle).sum(axis=0)
    size = float(np.linalg.norm(doubled)) / 2
    if size <= 1e-12 * float(np.ptp(places, axis=0).max()) ** 2:
        raise InputError("the corners of the polygon lie on one line; it has no area.")
    normal = doubled / (2 * size)
    across, up = _axes(normal)
    corners = np.column_stack([(places - middle) @ across, (places - middle) @ up])
    if _crosses_itself(corners):
        raise InputError(
            "sides of the polygon cross each other; its area is not defined, so move its corners."
        )
    gradients = np.cross(after - before, normal) / 2
    closed = np.concatenate([places, places[:1]])
    length, slopes = path_length(closed)
    slopes[0] += slopes[-1]
    unit = length_unit(shown[0] if shown else None)
    plane = (middle, across, up)
    return Area(
        size, _squared(unit), propagated(known, gradients),
        Measured(length, unit, propagated(known, slopes[:-1])),
        tuple(_statistics(volume, plane, corners, lambda xy: in_polygon(corners, xy)) for volume in shown),
    )  # fmt: skip


def ellipse(
    center: PointLike, first: PointLike, second: PointLike, volumes: Volume | Sequence[Volume] = ()
) -> Area:
    """Area and perimeter of an ellipse, and statistics of the voxels in it.

    Parameters
    ----------
    center : Point or 3 floats
        World point.
    first, second : Point or 3 floats
        Where its axes end: a world point on the outline, and another one on it, or beside it: what counts is its
        distance from the first axis.
    volumes : Volume or sequence of Volume
        As for `area`.

    Raises
    ------
    InputError
        Points on one line.
    """
    shown = _volumes(volumes)
    known = [
        as_point(p, shown[0] if shown else None, "a point of an ellipse") for p in (center, first, second)
    ]
    middle, one, other = (np.asarray(point.position) for point in known)
    u, v = one - middle, other - middle
    a = float(np.linalg.norm(u))
    rest = v - (v @ u) / (u @ u) * u if a > 0 else v * 0
    b = float(np.linalg.norm(rest))
    if b <= 1e-9 * a or a == 0:
        raise InputError("the points of the ellipse lie on one line; it has no area.")
    across, up = u / a, rest / b
    unit = length_unit(shown[0] if shown else None)
    # of a: along u; of b: along the other axis, turned with the first one
    lean = float(v @ across) / a
    by_a = np.array([-across, across, 0 * across])
    by_b = np.array([-(1 - lean) * up, -lean * up, up])
    perimeter, slope_a, slope_b = _ellipse_perimeter(a, b)
    corners = np.array([[-a, -b], [a, b]])
    plane = (middle, across, up)
    return Area(
        math.pi * a * b, _squared(unit), propagated(known, math.pi * (b * by_a + a * by_b)),
        Measured(perimeter, unit, propagated(known, slope_a * by_a + slope_b * by_b)),
        tuple(
            _statistics(volume, plane, corners, lambda xy: np.sum((xy / (a, b)) ** 2, axis=1) <= 1.0)
            for volume in shown
        ),
    )  # fmt: skip


def in_polygon(corners: Float64Array, places: Float64Array) -> npt.NDArray[np.bool_]:
    """Which places of a plane, shape (N, 2), a polygon of shape (M, 2) holds, by the even-odd rule."""
    inside = np.zeros(len(places), bool)
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if y0 != y1:
            between = (places[:, 1] < y0) != (places[:, 1] < y1)
            inside ^= between & (places[:, 0] < x0 + (places[:, 1] - y0) * (x1 - x0) / (y1 - y0))
    return inside


def _statistics(
    volume: Volume,
    plane: tuple[Float64Array, Float64Array, Float64Array],
    corners: Float64Array,
    inside: Inside,
) -> LayerStatistics:
    """Of the voxels next to the plane, one for each line of voxels that crosses it."""
    middle, across, up = plane
    matrix, to_index = volume.index_to_world, volume.world_to_index
    normal = np.cross(across, up) @ matrix[:3, :3]
    axis = int(np.argmax(np.abs(normal)))
    low, high = corners.min(axis=0), corners.max(axis=0)
    frame = [middle + x * across + y * up for x in (low[0], high[0]) for y in (low[1], high[1])]
    index = np.asarray(frame) @ to_index[:3, :3].T + to_index[:3, 3]
    last = np.asarray(volume.dimensions) - 1
    first = np.clip(np.floor(index.min(axis=0)).astype(int) - 1, 0, last)
    stop = np.clip(np.ceil(index.max(axis=0)).astype(int) + 1, 0, last) + 1
    ranges = [np.arange(a, b) for a, b in zip(first, stop, strict=True)]
    ranges[axis] = np.zeros(1, int)
    grid = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1).reshape(-1, 3).astype(np.float64)
    point = to_index[:3, :3] @ middle + to_index[:3, 3]
    grid[:, axis] = np.rint(point[axis] - (grid - point) @ (normal * (np.arange(3) != axis)) / normal[axis])
    grid = grid[(grid[:, axis] >= 0) & (grid[:, axis] <= last[axis])]
    world = grid @ matrix[:3, :3].T + matrix[:3, 3] - middle
    chosen = grid[inside(np.column_stack([world @ across, world @ up]))].astype(int)
    values = volume.array[chosen[:, 2], chosen[:, 1], chosen[:, 0]].astype(np.float64)
    values = values[np.isfinite(values)]
    if not values.size:
        nothing = math.nan
        return LayerStatistics(volume.name, 0, Measured(nothing, volume.unit, nothing), *4 * (nothing,))
    deviation = float(values.std(ddof=1)) if values.size > 1 else 0.0
    mean = Measured(float(values.mean()), volume.unit, COVERAGE * deviation / math.sqrt(values.size))
    return LayerStatistics(
        volume.name, int(values.size), mean, deviation, float(values.min()), float(np.median(values)),
        float(values.max()),
    )  # fmt: skip


def _ellipse_perimeter(a: float, b: float) -> tuple[float, float, float]:
    """4 a E(1 - b²/a²) with the complete elliptic integral, and its derivatives by both half axes."""
    from scipy.special import ellipe

    def perimeter(a: float, b: float) -> float:
        large, small = max(a, b), min(a, b)
        return float(4 * large * ellipe(1 - (small / large) ** 2))

    step = 1e-6
    by_a = (perimeter(a * (1 + step), b) - perimeter(a * (1 - step), b)) / (2 * step * a)
    by_b = (perimeter(a, b * (1 + step)) - perimeter(a, b * (1 - step))) / (2 * step * b)
    return perimeter(a, b), by_a, by_b


def _axes(normal: Float64Array) -> tuple[Float64Array, Float64Array]:
    """Two unit vectors that with the normal make a right-handed frame."""
    helper = np.eye(3)[int(np.argmin(np.abs(normal)))]
    across = np.cross(helper, normal)
    across = across / np.linalg.norm(across)
    return across, np.cross(normal, across)


def _crosses_itself(corners: Float64Array) -> bool:
    """Whether two sides that are not neighbours cross each other."""
    starts, ends = corners, np.roll(corners, -1, axis=0)
    count = len(corners)
    steps = ends - starts

    def side(n: int, places: Float64Array) -> Float64Array:
        away = places - starts[n]
        return np.asarray(steps[n, 0] * away[:, 1] - steps[n, 1] * away[:, 0])

    signs = np.array([np.sign(side(n, starts)) * np.sign(side(n, ends)) for n in range(count)]) < 0
    apart = np.abs(np.subtract.outer(np.arange(count), np.arange(count)))
    return bool(np.any(signs & signs.T & (apart > 1) & (apart < count - 1)))


def _volumes(volumes: Volume | Sequence[Volume]) -> tuple[Volume, ...]:
    return (volumes,) if isinstance(volumes, Volume) else tuple(volumes)


def _squared(unit: str) -> str:
    return f"{unit}²"
