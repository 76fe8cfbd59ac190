"""What is measured and marked in a scene: points in the world, and by which rule they were found."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from volviz.errors import InputError
from volviz.volume_data.vectors import Vector, finite_vector

Color = tuple[float, float, float]
Covariance = tuple[Vector, Vector, Vector]
Kind = Literal["distance", "angle", "polyline", "polygon", "ellipse", "profile", "point", "arrow"]
KINDS: tuple[Kind, ...] = get_args(Kind)
#: Fewest points of a kind, and most; None is as many as one likes.
COUNTS: dict[Kind, tuple[int, int | None]] = {
    "distance": (2, 2), "angle": (3, 3), "polyline": (2, None), "polygon": (3, None), "ellipse": (3, 3),
    "profile": (2, 2), "point": (1, 1), "arrow": (2, 2),
}  # fmt: skip
#: Colours that new measurements get in turn: told apart on grey slices, also by people who confuse red and green
#: (Okabe and Ito, "Color universal design", 2008).
COLORS: tuple[Color, ...] = (
    (0.94, 0.89, 0.26), (0.34, 0.71, 0.91), (0.90, 0.62, 0.0), (0.0, 0.72, 0.52), (0.85, 0.55, 0.73),
    (0.90, 0.42, 0.16),
)  # fmt: skip

#: Standard deviations to either side that hold 95 of 100 values of a normal distribution.
COVERAGE = 1.96
_NO_COVARIANCE: Covariance = ((0.0,) * 3, (0.0,) * 3, (0.0,) * 3)


@dataclass(frozen=True)
class Point:
    """A world point, how well it is known and by which rule it was found.

    Attributes
    ----------
    position : tuple of 3 floats
        World point (x, y, z).
    covariance : tuple of 3 tuples of 3 floats
        Of the position, in squared world units; zero where it is exact.
    rule : str
        How it was found: "placed", "isovalue", "opacity", "maximum" or "label".
    number : float or None
        The number that belongs to the rule: the isovalue, the value there, the label.
    """

    position: Vector
    covariance: Covariance = _NO_COVARIANCE
    rule: str = "placed"
    number: float | None = None

    @property
    def error(self) -> float:
        """Half-width of the 95 % interval along the direction in which the point is known worst, in world units."""
        return COVERAGE * math.sqrt(max(float(np.linalg.eigvalsh(np.asarray(self.covariance))[-1]), 0.0))


@dataclass(frozen=True)
class Measurement:
    """Something measured or marked in the world of a scene.

    Attributes
    ----------
    kind : str
        One of `KINDS`.
    points : tuple of Point
        As many as `COUNTS` says. Of an angle the second one is the vertex, of an ellipse the first one the middle;
        an arrow points from the first to the second.
    name : str
        What people call it; of points and arrows the text that stands beside them.
    color : tuple of 3 floats
        Red, green, blue in 0..1.
    visible, locked : bool
        A locked one is neither moved nor deleted.

    Raises
    ------
    InputError
        An unknown kind, or not so many points.
    """

    kind: Kind
    points: tuple[Point, ...]
    name: str = ""
    color: Color = COLORS[0]
    visible: bool = True
    locked: bool = False

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError(f"there is no measurement {self.kind!r}; choose {', '.join(KINDS)}.")
        least, most = COUNTS[self.kind]
        if len(self.points) < least or (most is not None and len(self.points) > most):
            words = str(least) if most == least else f"at least {least}"
            raise InputError(f"{self.kind} has {words} points, got {len(self.points)}.")


def measurement_to_dict(measurement: Measurement) -> dict[str, Any]:
    """Plain data for JSON."""
    points = [
        {"position": p.position, "covariance": p.covariance, "rule": p.rule, "number": p.number}
        for p in measurement.points
    ]
    return {
        "kind": measurement.kind, "points": points, "name": measurement.name, "color": measurement.color,
        "visible": measurement.visible, "locked": measurement.locked,
    }  # fmt: skip


def measurement_from_dict(data: dict[str, Any]) -> Measurement:
    """What `measurement_to_dict` described."""
    points = tuple(
        Point(
            finite_vector(point["position"], "a point"),
            tuple(finite_vector(row, "a covariance") for row in point["covariance"]),  # type: ignore[arg-type]
            str(point["rule"]),
            None if point["number"] is None else float(point["number"]),
        )
        for point in data["points"]
    )
    return Measurement(
        data["kind"], points, str(data["name"]), finite_vector(data["color"], "a colour"), bool(data["visible"]),
        bool(data["locked"]),
    )  # fmt: skip
