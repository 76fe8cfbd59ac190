"""The surface point under a pixel: what picking on an isosurface returns.

One ray needs some thousand samples: plain NumPy on the voxels it passes, in float64, without any OpenGL.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.reference.rays import Plane, box_interval, index_limits, plane_interval

if TYPE_CHECKING:
    from collections.abc import Sequence

Float64Array = npt.NDArray[np.float64]

#: Accumulated opacity at which a surface counts as the one that is seen.
SEEN = 0.5


class SurfacePoint(NamedTuple):
    """A point on an isosurface.

    Attributes
    ----------
    position : tuple of 3 floats
        World point (x, y, z).
    voxel : tuple of 3 floats
        Continuous voxel index (i, j, k) of the same point.
    value : float
        Scalar there, in data units: the isovalue, up to what bisection left.
    surface : int
        Which of the isovalues.
    """

    position: tuple[float, float, float]
    voxel: tuple[float, float, float]
    value: float
    surface: int


class PixelRay(NamedTuple):
    """The ray through the centre of one pixel: world start, unit direction, length from near to far plane."""

    start: Float64Array
    direction: Float64Array
    length: float


def pixel_ray(
    view: npt.ArrayLike, projection: npt.ArrayLike, size: tuple[int, int], pixel: tuple[float, float]
) -> PixelRay:
    """The ray through one place of the image.

    Parameters
    ----------
    view, projection : array_like of shape (4, 4)
        World to eye, eye to clip space; OpenGL conventions, column vectors.
    size : (w, h)
        Pixels of the image.
    pixel : (x, y)
        Column and row, row 0 at the top; whole numbers mean the centre of that pixel.
    """
    inverse = np.linalg.inv(np.asarray(projection, np.float64) @ np.asarray(view, np.float64))
    x = 2.0 * (pixel[0] + 0.5) / size[0] - 1.0
    y = 1.0 - 2.0 * (pixel[1] + 0.5) / size[1]
    near, far = (inverse @ (x, y, depth, 1.0) for depth in (-1.0, 1.0))
    start = near[:3] / near[3]
    along = far[:3] / far[3] - start
    length = float(np.linalg.norm(along))
    return PixelRay(start, along / length, length)


def surface_on_ray(
    array: npt.NDArray[Any],
    index_to_world: npt.ArrayLike,
    ray: PixelRay,
    *,
    isovalues: Sequence[float],
    step_world: float,
    opacities: Sequence[float] | None = None,
    bisections: int = 16,
    crop: Sequence[float] | None = None,
    clip_planes: Sequence[Plane] = (),
    interpolation: str = "linear",
    lowest: float = 0.0,
) -> SurfacePoint | None:
    """The isosurface that is seen along a ray, None when there is none.

    Seen is the first surface at which the opacity gathered so far reaches one half; where none does, the
    nearest that is not fully transparent. Samples lie as in the shader: at the entry, after every step and at
    the exit.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars in data units. NaN and infinities count as `lowest`.
    index_to_world : array_like of shape (4, 4)
        From continuous index (i, j, k, 1) to world (x, y, z, 1).
    ray : PixelRay
        From `pixel_ray`; shorten `length` to what lies before opaque geometry.
    isovalues : sequence of floats
        In data units.
    step_world : float
        Distance between samples, above 0, in world units.
    opacities : sequence of floats, optional
        One per isovalue, 0..1; default all 1.
    bisections : int, default: 16
        How often the piece of ray with the surface is halved before the point is interpolated.
    crop : tuple of 6 floats, optional
        (i0, i1, j0, j1, k0, k1) in continuous voxel indices.
    clip_planes : sequence of (origin, normal)
        World space; the normal points to the kept side.
    interpolation : {"linear", "nearest"}
    lowest : float
        The volume's lowest finite value.

    Raises
    ------
    InputError
        `step_world` is not above 0, or opacities and isovalues differ in number.
    """
    levels = np.asarray(isovalues, np.float64)
    weights = np.ones(levels.shape) if opacities is None else np.asarray(opacities, np.float64)
    if not step_world > 0 or weights.shape != levels.shape:
        raise InputError(
            f"a pick needs a step above 0 and one opacity per isovalue, got {step_world:g}, "
            f"{weights.size} and {levels.size}."
        )
    matrix = np.asarray(index_to_world, np.float64)
    to_index = np.linalg.inv(matrix)
    start = to_index[:3, :3] @ ray.start + to_index[:3, 3]
    along = to_index[:3, :3] @ ray.direction
    near, far = box_interval(start[None], along[None], index_limits(array.shape, crop))
    cut_near, cut_far = plane_interval(ray.start[None], ray.direction[None], clip_planes)
    entry = max(float(near[0]), float(cut_near[0]), 0.0)
    leave = min(float(far[0]), float(cut_far[0]), ray.length)
    if not leave > entry:
        return None

    def value_at(t: Any) -> Float64Array:
        index = start + np.atleast_1d(t)[:, None] * along
        return values_at(array, index, nearest=interpolation == "nearest", lowest=lowest)

    count = max(int(np.ceil((leave - entry) / step_world - 1e-3)), 1)
    places = np.minimum(entry + np.arange(count + 1) * step_world, leave)
    inside = value_at(places)[:, None] >= levels
    pieces, surfaces = np.nonzero(inside[1:] != inside[:-1])
    crossings: list[tuple[float, int]] = []
    for piece, m in zip(pieces, surfaces, strict=True):
        if weights[m] > 0:
            a, b = places[piece], places[piece + 1]
            crossings.append((_refined(value_at, a, b, levels[m], bisections), int(m)))
    if not crossings:
        return None
    crossings.sort()
    gathered, seen = 0.0, crossings[0]
    for crossing in crossings:
        gathered += (1.0 - gathered) * weights[crossing[1]]
        if gathered >= SEEN:
            seen = crossing
            break
    t, surface = seen
    i, j, k = (float(v) for v in start + t * along)
    x, y, z = (float(v) for v in ray.start + t * ray.direction)
    return SurfacePoint((x, y, z), (i, j, k), float(value_at(t)[0]), surface)


def _refined(value_at: Any, near: float, far: float, isovalue: float, bisections: int) -> float:
    """Place of a crossing between two samples: halvings, then the line between the ends."""
    a, b = value_at([near, far])
    for _ in range(bisections):
        middle = 0.5 * (near + far)
        value = value_at(middle)[0]
        if (value >= isovalue) == (a >= isovalue):
            near, a = middle, value
        else:
            far, b = middle, value
    return float(near + (far - near) * (isovalue - a) / (b - a))


def values_at(array: npt.NDArray[Any], index: Float64Array, *, nearest: bool, lowest: float) -> Float64Array:
    """Scalars at continuous indices (n, 3) in (i, j, k), clamped to the first and last voxel."""
    last = np.array(array.shape[::-1]) - 1
    place = np.clip(index, 0, last)
    if nearest:
        i, j, k = np.floor(place + 0.5).astype(np.intp).T
        return _finite(array[k, j, i], lowest)
    low = np.minimum(place.astype(np.intp), np.maximum(last - 1, 0))
    part = place - low
    total = np.zeros(len(index))
    for corner in range(8):
        bits = np.array([corner & 1, corner >> 1 & 1, corner >> 2 & 1])
        i, j, k = np.minimum(low + bits, last).T
        weight = np.where(bits, part, 1.0 - part).prod(axis=1)
        total += weight * _finite(array[k, j, i], lowest)
    return total


def _finite(values: npt.NDArray[Any], lowest: float) -> Float64Array:
    numbers = values.astype(np.float64)
    return np.asarray(np.where(np.isfinite(numbers), numbers, lowest))
