"""What measuring gives: numbers with an error; and how errors of points become errors of numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.model.measurements import COVERAGE, Covariance, Point
from volviz.volume_data.vectors import finite_vector
from volviz.volume_data.volume import Volume

Float64Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Measured:
    """A number with its unit and its error.

    Attributes
    ----------
    value : float
        In `unit`.
    unit : str
        Such as "mm", "mm³", "°"; empty for what has none.
    error : float
        Half-width of the 95 % interval, in `unit`.
    """

    value: float
    unit: str
    error: float

    def __str__(self) -> str:
        """Value, error and unit, with no more digits than the error allows."""
        value, error = rounded(self.value, self.error)
        space = "" if self.unit in ("", "°") else " "
        return f"{value} ± {error}{space}{self.unit}"

    def to_dict(self) -> dict[str, Any]:
        """As plain values, for JSON."""
        return {"value": self.value, "unit": self.unit, "error": self.error}


PointLike = Point | Sequence[float]


def rounded(value: float, error: float) -> tuple[str, str]:
    """A value and its error as text: two digits of the error, and the value to the same place."""
    if not (math.isfinite(value) and math.isfinite(error)):
        return f"{value:g}", f"{error:g}"
    if error <= 1e-9 * abs(value) or error == 0:
        return f"{value:.6g}", "0"
    place = 1 - math.floor(math.log10(error))
    if place < 0:
        # tens and hundreds that the error leaves open
        return f"{round(value, place):.0f}", f"{round(error, place):.0f}"
    return f"{value:.{place}f}", f"{error:.{place}f}"


def length_unit(volume: Volume | None) -> str:
    """The unit of world lengths: that of the file, millimetres where nothing else is said."""
    return "mm" if volume is None else str(volume.metadata.get("length_unit") or "mm")


def cell_volume(volume: Volume) -> float:
    """Volume of a voxel, in cubic world units."""
    return abs(float(np.linalg.det(volume.index_to_world[:3, :3])))


def as_point(point: PointLike, volume: Volume | None, what: str) -> Point:
    """A point with its covariance.

    A bare position is exact without a volume. With one it was placed by hand: anywhere in a voxel is as likely.
    """
    if isinstance(point, Point):
        return point
    position = finite_vector(point, what)
    return Point(position) if volume is None else Point(position, voxel_covariance(volume))


def voxel_covariance(volume: Volume) -> Covariance:
    """Covariance of a point that lies anywhere within a voxel, in squared world units."""
    axes = volume.index_to_world[:3, :3]
    return covariance(axes @ axes.T / 12.0)


def covariance(matrix: Float64Array) -> Covariance:
    """A symmetric 3 x 3 matrix as plain values."""
    a, b, c = (tuple(float(v) for v in row) for row in matrix)
    return a, b, c  # type: ignore[return-value]


def along(direction: Float64Array, error: float) -> Covariance:
    """Covariance of a point whose place is open along one unit vector alone, by a 95 % half-width."""
    return covariance(np.outer(direction, direction) * (error / COVERAGE) ** 2)


def propagated(points: Sequence[Point], gradients: Float64Array) -> float:
    """95 % half-width of a function of points that are known independently of each other, by its gradients.

    Linear propagation (JCGM 100:2008, "Guide to the expression of uncertainty in measurement", eq. 10).

    Parameters
    ----------
    points : sequence of N points
    gradients : ndarray of shape (N, 3)
        Of the function, by each of the positions.
    """
    variance = sum(
        float(gradient @ np.asarray(point.covariance) @ gradient)
        for point, gradient in zip(points, gradients, strict=True)
    )
    return COVERAGE * math.sqrt(max(variance, 0.0))
