"""Rays of the float64 oracle: from pixels into the box of the volume.

Matrices follow OpenGL: column vectors, the eye looks along its own -z, clip space from -1 to 1. A ray
starts on the near plane and ends on the far plane; positions along it are world lengths from its start.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError

Float64Array = npt.NDArray[np.float64]
Plane = tuple[Sequence[float], Sequence[float]]


class Rays(NamedTuple):
    """One ray per pixel.

    Attributes
    ----------
    starts : ndarray of shape (h, w, 3), float64
        World points on the near plane; row 0 is the top of the image.
    directions : ndarray of shape (h, w, 3), float64
        Unit vectors from near to far.
    entries, exits : ndarray of shape (h, w), float64
        World lengths from the start between which the ray is inside; entry >= exit = the ray misses.
    """

    starts: Float64Array
    directions: Float64Array
    entries: Float64Array
    exits: Float64Array

    def rows(self, first: int, last: int) -> Rays:
        """The rays of some rows of the image."""
        return Rays(*(np.ascontiguousarray(part[first:last]) for part in self))


def pixel_rays(
    view: npt.ArrayLike, projection: npt.ArrayLike, size: tuple[int, int]
) -> tuple[Float64Array, Float64Array, Float64Array]:
    """Rays through the centres of all pixels.

    Parameters
    ----------
    view, projection : array_like of shape (4, 4)
        World to eye, eye to clip space.
    size : (w, h)
        Pixels of the image.

    Returns
    -------
    starts, directions : ndarray of shape (h, w, 3)
        World points on the near plane and unit vectors towards the far plane.
    lengths : ndarray of shape (h, w)
        World length from the near to the far plane.
    """
    width, height = size
    if width < 1 or height < 1:
        raise InputError(f"size must be at least 1 x 1 pixels, got {width} x {height}.")
    inverse = np.linalg.inv(np.asarray(projection, np.float64) @ np.asarray(view, np.float64))
    x = 2.0 * (np.arange(width) + 0.5) / width - 1.0
    y = 1.0 - 2.0 * (np.arange(height) + 0.5) / height
    clip = np.ones((height, width, 4))
    clip[..., 0], clip[..., 1] = np.meshgrid(x, y)
    ends = []
    for depth in (-1.0, 1.0):
        clip[..., 2] = depth
        point = clip @ inverse.T
        ends.append(point[..., :3] / point[..., 3:])
    along = ends[1] - ends[0]
    lengths = np.linalg.norm(along, axis=-1)
    return ends[0], along / lengths[..., None], lengths


def box_interval(
    starts: Float64Array, directions: Float64Array, limits: npt.ArrayLike
) -> tuple[Float64Array, Float64Array]:
    """Where rays enter and leave a box whose faces are parallel to the axes.

    Parameters
    ----------
    starts, directions : ndarray of shape (..., 3)
        In the box's own coordinates, here continuous voxel indices (i, j, k).
    limits : array_like of shape (6,)
        (i0, i1, j0, j1, k0, k1).

    Returns
    -------
    entries, exits : ndarray of shape (...)
        Multiples of `directions`; entry > exit = the ray misses. A ray within a face counts as inside.
    """
    box = np.asarray(limits, np.float64).reshape(3, 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        a = (box[:, 0] - starts) / directions
        b = (box[:, 1] - starts) / directions
    parallel = directions == 0
    inside = (starts >= box[:, 0]) & (starts <= box[:, 1])
    near = np.where(parallel, np.where(inside, -np.inf, np.inf), np.minimum(a, b))
    far = np.where(parallel, np.where(inside, np.inf, -np.inf), np.maximum(a, b))
    return near.max(axis=-1), far.min(axis=-1)


def plane_interval(
    starts: Float64Array, directions: Float64Array, planes: Sequence[Plane]
) -> tuple[Float64Array, Float64Array]:
    """The part of rays that lies on the kept side of all clip planes.

    Parameters
    ----------
    starts, directions : ndarray of shape (..., 3)
        World coordinates.
    planes : sequence of (origin, normal)
        World space; the normal points to the kept side.

    Returns
    -------
    entries, exits : ndarray of shape (...)
        (-inf, inf) without planes; entry > exit = nothing is kept.
    """
    entries = np.full(starts.shape[:-1], -np.inf)
    exits = np.full(starts.shape[:-1], np.inf)
    for origin, normal in planes:
        n = np.asarray(normal, np.float64)
        height = (starts - np.asarray(origin, np.float64)) @ n
        slope = directions @ n
        with np.errstate(divide="ignore", invalid="ignore"):
            t = -height / slope
        entries = np.where(slope > 0, np.maximum(entries, t), entries)
        exits = np.where(slope < 0, np.minimum(exits, t), exits)
        exits = np.where((slope == 0) & (height < 0), -np.inf, exits)
    return entries, exits


def index_limits(shape: Sequence[int], crop: Sequence[float] | None) -> Float64Array:
    """Limits (i0, i1, j0, j1, k0, k1) of what is shown: first to last voxel centre, cut with `crop`."""
    full = np.array([v for n in reversed(list(shape)) for v in (0.0, n - 1.0)])
    if crop is None:
        return full
    wanted = np.asarray(crop, np.float64)
    if wanted.shape != (6,):
        raise InputError(f"crop must be six numbers (i0, i1, j0, j1, k0, k1), got {crop!r}.")
    full[0::2] = np.maximum(full[0::2], wanted[0::2])
    full[1::2] = np.minimum(full[1::2], wanted[1::2])
    return full


def volume_rays(
    shape: Sequence[int],
    index_to_world: npt.ArrayLike,
    *,
    view: npt.ArrayLike,
    projection: npt.ArrayLike,
    size: tuple[int, int],
    crop: Sequence[float] | None = None,
    clip_planes: Sequence[Plane] = (),
) -> Rays:
    """Rays of a camera with the interval in which each is inside the shown part of a volume.

    Parameters
    ----------
    shape : (Z, Y, X)
        Of the volume.
    index_to_world : array_like of shape (4, 4)
        From continuous index (i, j, k, 1) to world (x, y, z, 1).
    view, projection, size
        As in `pixel_rays`.
    crop : tuple of 6 floats, optional
        (i0, i1, j0, j1, k0, k1) in continuous voxel indices.
    clip_planes : sequence of (origin, normal)
        World space; the normal points to the kept side.
    """
    starts, directions, lengths = pixel_rays(view, projection, size)
    to_index = np.linalg.inv(np.asarray(index_to_world, np.float64))
    box_near, box_far = box_interval(
        starts @ to_index[:3, :3].T + to_index[:3, 3],
        directions @ to_index[:3, :3].T,
        index_limits(shape, crop),
    )
    plane_near, plane_far = plane_interval(starts, directions, clip_planes)
    entries = np.maximum(np.maximum(box_near, plane_near), 0.0)
    exits = np.minimum(np.minimum(box_far, plane_far), lengths)
    return Rays(starts, directions, entries, exits)


def index_to_world_matrix(
    spacing: Sequence[float], origin: Sequence[float], direction: npt.ArrayLike | None
) -> Float64Array:
    """4 x 4 matrix from continuous index (i, j, k, 1) to world (x, y, z, 1).

    Parameters
    ----------
    spacing, origin : tuple of 3 floats
        In (x, y, z).
    direction : array_like of shape (3, 3) or None
        Columns are the world directions of the index axes; None = identity.
    """
    axes: Any = np.eye(3) if direction is None else np.asarray(direction, np.float64).reshape(3, 3)
    matrix = np.eye(4)
    matrix[:3, :3] = axes * np.asarray(spacing, np.float64)
    matrix[:3, 3] = origin
    return matrix
