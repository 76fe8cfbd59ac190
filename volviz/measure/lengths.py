"""Distances, angles and lengths of lines through points."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from volviz.errors import InputError
from volviz.measure.results import Float64Array, Measured, PointLike, as_point, length_unit, propagated
from volviz.volume_data.volume import Volume


def distance(a: PointLike, b: PointLike, volume: Volume | None = None) -> Measured:
    """Distance of two points.

    Parameters
    ----------
    a, b : Point or 3 floats
        World points.
    volume : Volume, optional
        In which bare positions were placed by hand: each lies anywhere in its voxel. Without one they are exact.
        Its unit of length is that of the result.

    Raises
    ------
    InputError
        Points that are not three finite numbers.
    """
    return polyline((a, b), volume)


def polyline(points: Sequence[PointLike], volume: Volume | None = None) -> Measured:
    """Length of a line from point to point.

    Parameters
    ----------
    points : sequence of Point or 3 floats
        At least two, in the world.
    volume : Volume, optional
        As for `distance`.

    Raises
    ------
    InputError
        Fewer than two points, or such that are not three finite numbers.
    """
    known = [as_point(point, volume, "a point") for point in points]
    if len(known) < 2:
        raise InputError(f"a length needs at least two points, got {len(known)}.")
    places = np.array([point.position for point in known])
    length, gradients = path_length(places)
    return Measured(length, length_unit(volume), propagated(known, gradients))


def angle(a: PointLike, vertex: PointLike, b: PointLike, volume: Volume | None = None) -> Measured:
    """Angle at a vertex between the directions to two points, 0 to 180 degrees.

    Parameters
    ----------
    a, vertex, b : Point or 3 floats
        World points.
    volume : Volume, optional
        As for `distance`.

    Raises
    ------
    InputError
        One of the points is the vertex itself, or not three finite numbers.
    """
    known = [as_point(point, volume, "a point of an angle") for point in (a, vertex, b)]
    first, middle, last = (np.asarray(point.position) for point in known)
    u, v = first - middle, last - middle
    lengths = np.linalg.norm(u), np.linalg.norm(v)
    if min(lengths) == 0:
        raise InputError("an angle needs two points that are not its vertex; move one of them away from it.")
    u, v = u / lengths[0], v / lengths[1]
    # both arguments keep their digits near 0 and 180 degrees (Kahan, "How futile are mindless assessments of roundoff
    # in floating-point computation?", 2006, section 12)
    found = 2.0 * math.atan2(float(np.linalg.norm(u - v)), float(np.linalg.norm(u + v)))
    across_u, across_v = _across(u, v) / lengths[0], _across(v, u) / lengths[1]
    gradients = np.array([-across_u, across_u + across_v, -across_v])
    error = min(propagated(known, np.degrees(gradients)), 180.0)
    return Measured(math.degrees(found), "°", error)


def path_length(places: Float64Array) -> tuple[float, Float64Array]:
    """Length of a line through points of shape (N, 3), and its gradients by them, shape (N, 3)."""
    steps = np.diff(places, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    units = steps / np.where(lengths > 0, lengths, 1.0)[:, None]
    # points that coincide have no direction: whatever moves one of them makes a length
    units[lengths == 0] = np.full(3, 3**-0.5)
    gradients = np.zeros(places.shape)
    gradients[1:] += units
    gradients[:-1] -= units
    return float(lengths.sum()), gradients


def _across(u: Float64Array, v: Float64Array) -> Float64Array:
    """Unit vector at right angles to u, in the plane of both, towards v; any where they are parallel."""
    rest = v - (v @ u) * u
    if np.linalg.norm(rest) < 1e-12:
        rest = np.eye(3)[int(np.argmin(np.abs(u)))]
        rest = rest - (rest @ u) * u
    return np.asarray(rest / np.linalg.norm(rest))
