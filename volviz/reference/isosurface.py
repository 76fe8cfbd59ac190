"""The float64 oracle of ray-cast isosurfaces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.kernels.compiled import compiled
from volviz.kernels.outliers import bulk_range, no_data_of
from volviz.kernels.statistics import finite_range
from volviz.kernels.threads import map_ranges
from volviz.reference.rays import Plane, Rays, index_to_world_matrix, volume_rays
from volviz.reference.sampling import (
    Field,
    Float64Array,
    Lamp,
    Shading,
    gradient_world,
    lighting,
    make_field,
    make_lamp,
    sample_world,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

MAX_BISECTIONS = 60


class SurfaceImage(NamedTuple):
    """What `reference_isosurface` draws; row 0 is the top.

    Attributes
    ----------
    color : ndarray of shape (h, w, 4), float64
        Premultiplied RGBA of all surfaces along the ray, front to back; not clamped.
    depth : ndarray of shape (h, w), float64
        Window depth 0..1 of the nearest surface; 1 where there is none.
    position : ndarray of shape (h, w, 3), float64
        World point of the nearest surface, NaN where there is none.
    normal : ndarray of shape (h, w, 3), float64
        Unit normal there, from high to low values; (0, 0, 0) where the gradient is zero, NaN where there is
        no surface.
    surface : ndarray of shape (h, w), int64
        Which of the isovalues the nearest surface belongs to, -1 where there is none.
    """

    color: Float64Array
    depth: Float64Array
    position: Float64Array
    normal: Float64Array
    surface: npt.NDArray[np.int64]

    def rows(self, first: int, last: int) -> SurfaceImage:
        """Views of some rows of the image."""
        return SurfaceImage(
            self.color[first:last],
            self.depth[first:last],
            self.position[first:last],
            self.normal[first:last],
            self.surface[first:last],
        )


class Surfaces(NamedTuple):
    """Isovalues and their looks, in a form compiled code can read."""

    isovalues: Float64Array
    colors: Float64Array
    opacities: Float64Array
    bisections: int


def reference_isosurface(
    array: npt.NDArray[Any],
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    origin: Sequence[float] = (0.0, 0.0, 0.0),
    direction: npt.ArrayLike | None = None,
    *,
    isovalues: Sequence[float],
    colors: npt.ArrayLike = (0.5, 0.5, 0.5),
    opacities: npt.ArrayLike = 1.0,
    view: npt.ArrayLike,
    projection: npt.ArrayLike,
    size: tuple[int, int],
    step_world: float,
    bisections: int = 4,
    shading: Shading | None = None,
    crop: Sequence[float] | None = None,
    clip_planes: Sequence[Plane] = (),
    interpolation: str = "linear",
) -> SurfaceImage:
    """Isosurfaces found by crossings between samples, in both directions.

    The value is sampled where the ray enters the box, after every step, and where it leaves. Two
    neighbouring samples of which one is inside (value >= isovalue) and the other is not enclose a surface;
    `bisections` halve the interval, then one linear interpolation between its ends gives the point.
    Crossings of several isovalues between the same two samples are drawn in their order along the ray. Cut
    faces of the box or of clip planes are not closed.

    Parameters
    ----------
    array, spacing, origin, direction, view, projection, size, step_world, crop, clip_planes, interpolation
        As in `volviz.reference.image.reference_render`.
    isovalues : sequence of floats
        In data units; one surface each.
    colors : array_like of shape (3,) or (m, 3)
        Straight RGB.
    opacities : float or array_like of shape (m,)
        0..1, per crossing, whatever the angle; below 1 the ray goes on.
    bisections : int, default: 4
        0..60.
    shading : Shading, optional
        Lighting at the point; None = the plain colour.

    Returns
    -------
    SurfacePicture

    Raises
    ------
    InputError
        An argument outside what is described here.
    """
    levels = np.atleast_1d(np.asarray(isovalues, np.float64))
    if levels.ndim != 1 or levels.size == 0 or not np.all(np.isfinite(levels)):
        raise InputError(f"isovalues must be one or more finite numbers, got {isovalues!r}.")
    if not step_world > 0 or not 0 <= bisections <= MAX_BISECTIONS:
        raise InputError(
            f"step_world must be above 0 and bisections between 0 and {MAX_BISECTIONS}, "
            f"got {step_world:g} and {bisections}."
        )
    try:
        looks = np.ascontiguousarray(np.broadcast_to(np.asarray(colors, np.float64), (levels.size, 3)))
        strengths = np.ascontiguousarray(np.broadcast_to(np.asarray(opacities, np.float64), levels.shape))
    except ValueError:
        raise InputError(
            f"colors and opacities must be one for all or one for each of the {levels.size} isovalues."
        ) from None
    surfaces = Surfaces(levels, looks, strengths, int(bisections))
    matrix = index_to_world_matrix(spacing, origin, direction)
    low, high, _ = finite_range(array)
    low, high = bulk_range(array, low, high, no_data_of(array).values)
    field = make_field(
        array,
        matrix,
        interpolation=interpolation,
        delta=shading.gradient_delta if shading is not None else 1.0,
        value_range=(low, high),
    )
    lamp = make_lamp(shading)
    rays = volume_rays(
        array.shape, matrix, view=view, projection=projection, size=size, crop=crop, clip_planes=clip_planes
    )
    shape = (size[1], size[0])
    image = SurfaceImage(
        color=np.zeros((*shape, 4)),
        depth=np.ones(shape),
        position=np.full((*shape, 3), np.nan),
        normal=np.full((*shape, 3), np.nan),
        surface=np.full(shape, -1, np.int64),
    )
    to_clip = np.asarray(projection, np.float64) @ np.asarray(view, np.float64)

    def rows(first: int, last: int) -> None:
        target = image.rows(first, last)
        _draw_surfaces(rays.rows(first, last), field, surfaces, float(step_world), lamp, to_clip, target)

    map_ranges(rows, size[1])
    return image


@compiled
def _crossing(
    field: Field,
    start: Float64Array,
    ray: Float64Array,
    near: float,
    far: float,
    isovalue: float,
    halvings: int,
) -> float:
    """Length along the ray at which the value passes `isovalue`, between two samples on different sides."""
    a = sample_world(field, start[0] + near * ray[0], start[1] + near * ray[1], start[2] + near * ray[2])
    b = sample_world(field, start[0] + far * ray[0], start[1] + far * ray[1], start[2] + far * ray[2])
    for _ in range(halvings):
        t = 0.5 * (near + far)
        value = sample_world(field, start[0] + t * ray[0], start[1] + t * ray[1], start[2] + t * ray[2])
        if (value >= isovalue) == (a >= isovalue):
            near, a = t, value
        else:
            far, b = t, value
    return near + (far - near) * (isovalue - a) / (b - a)


@compiled
def _draw_surfaces(
    rays: Rays,
    field: Field,
    surfaces: Surfaces,
    step: float,
    lamp: Lamp,
    to_clip: Float64Array,
    image: SurfaceImage,
) -> None:
    rows, columns = rays.entries.shape
    levels = surfaces.isovalues
    found = np.empty(len(levels))
    which = np.empty(len(levels), np.int64)
    p = np.empty(3)
    for row in range(rows):
        for column in range(columns):
            start, ray = rays.starts[row, column], rays.directions[row, column]
            entry, leave = rays.entries[row, column], rays.exits[row, column]
            if leave <= entry:
                continue
            pixel = image.color[row, column]
            t0 = entry
            v0 = sample_world(field, start[0] + t0 * ray[0], start[1] + t0 * ray[1], start[2] + t0 * ray[2])
            for k in range(int(np.ceil((leave - entry) / step - 1e-11))):
                t1 = min(entry + (k + 1) * step, leave)
                v1 = sample_world(
                    field, start[0] + t1 * ray[0], start[1] + t1 * ray[1], start[2] + t1 * ray[2]
                )
                count = 0
                for m in range(len(levels)):
                    if (v0 >= levels[m]) != (v1 >= levels[m]):
                        found[count] = _crossing(field, start, ray, t0, t1, levels[m], surfaces.bisections)
                        which[count] = m
                        count += 1
                order = np.argsort(found[:count])
                for n in range(count):
                    t, m = found[order[n]], which[order[n]]
                    for axis in range(3):
                        p[axis] = start[axis] + t * ray[axis]
                    gradient = gradient_world(field, p[0], p[1], p[2])
                    if image.surface[row, column] < 0:
                        _mark_nearest(image, row, column, p, gradient, to_clip)
                        image.surface[row, column] = m
                    _blend(pixel, surfaces, m, lamp, gradient, p, ray)
                if pixel[3] >= 1.0:
                    break
                t0, v0 = t1, v1


@compiled
def _blend(
    pixel: Float64Array,
    surfaces: Surfaces,
    m: int,
    lamp: Lamp,
    gradient: tuple[float, float, float],
    p: Float64Array,
    ray: Float64Array,
) -> None:
    """Put one crossing behind what the pixel already holds."""
    lit = lamp.on and (gradient[0] != 0 or gradient[1] != 0 or gradient[2] != 0)
    diffuse, highlight = 0.0, 0.0
    if lit:
        diffuse, highlight = lighting(lamp, gradient, p, ray)
    weight = (1.0 - pixel[3]) * surfaces.opacities[m]
    for c in range(3):
        color = surfaces.colors[m, c]
        if lit:
            color *= lamp.weights[0] + lamp.weights[1] * diffuse * lamp.color[c]
            color += lamp.weights[2] * highlight * lamp.color[c]
        pixel[c] += weight * color
    pixel[3] += weight


@compiled
def _mark_nearest(
    image: SurfaceImage,
    row: int,
    column: int,
    p: Float64Array,
    gradient: tuple[float, float, float],
    to_clip: Float64Array,
) -> None:
    """Record where the first crossing of a ray lies."""
    length = np.sqrt(gradient[0] ** 2 + gradient[1] ** 2 + gradient[2] ** 2)
    for axis in range(3):
        image.position[row, column, axis] = p[axis]
        image.normal[row, column, axis] = -gradient[axis] / length if length > 0 else 0.0
    z, w = to_clip[2, 3], to_clip[3, 3]
    for axis in range(3):
        z += to_clip[2, axis] * p[axis]
        w += to_clip[3, axis] * p[axis]
    image.depth[row, column] = 0.5 * z / w + 0.5
