"""The float64 oracle of volumetric shadows: a ray towards the light from every sample of every ray."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.kernels.compiled import compiled
from volviz.kernels.preintegration import extinction_sums
from volviz.kernels.threads import map_ranges
from volviz.reference.rays import Plane as ClipPlane
from volviz.reference.rays import Rays, index_limits, index_to_world_matrix, volume_rays
from volviz.reference.sampling import (
    Field,
    Float64Array,
    Plane,
    gradient_world,
    look_up,
    look_up_plane,
    make_field,
    make_plane,
    sample_world,
    to_index,
)

if TYPE_CHECKING:
    from collections.abc import Sequence


class ShadowScene(NamedTuple):
    """Transfer function, light and what is shown, in a form compiled code can read."""

    table: Float64Array
    low: float
    high: float
    lowest_shown: float
    unit_distance: float
    step: float
    light_step: float
    light_position: Float64Array
    light_color: Float64Array
    kappa: Float64Array
    ambient: float
    limits: Float64Array
    planes: Float64Array
    """Shape (m, 6): origin and normal."""
    plane: Plane
    """Takes the table's place when it is on."""


def reference_shadows(
    array: npt.NDArray[Any],
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    origin: Sequence[float] = (0.0, 0.0, 0.0),
    direction: npt.ArrayLike | None = None,
    *,
    table: npt.ArrayLike,
    value_range: tuple[float, float],
    view: npt.ArrayLike,
    projection: npt.ArrayLike,
    size: tuple[int, int],
    step_world: float,
    light_position: Sequence[float],
    light_color: Sequence[float] = (1.0, 1.0, 1.0),
    kappa: Sequence[float] = (1.0, 1.0, 1.0),
    ambient: float = 0.0,
    light_step: float | None = None,
    unit_distance: float | None = None,
    crop: Sequence[float] | None = None,
    clip_planes: Sequence[ClipPlane] = (),
    density_threshold: float = 0.0,
    gradient_table: npt.ArrayLike | None = None,
    gradient_range: tuple[float, float] | None = None,
) -> Float64Array:
    """The image with volumetric shadows that half-angle slicing approximates.

    ``composite`` with midpoint samples as in `volviz.reference.image.reference_render`; the colour of a
    sample is multiplied by ``ambient + (1 - ambient) * light_color * T``. T is what reaches the sample from
    the light: along the straight way to it, until the light or the end of what is shown, ``T_rgb = product
    of (1 - a)^(kappa_rgb d / unit)`` over midpoint samples of opacity a that stand for a length d.

    Parameters
    ----------
    array, spacing, origin, direction, table, value_range, view, projection, size, step_world, unit_distance, crop
        As in `reference_render`, and so are `clip_planes`, `density_threshold`, `gradient_table` and
        `gradient_range`; what is cut away or below the threshold casts no shadow.
    light_position : tuple of 3 floats
        World position of the light, anywhere.
    light_color : tuple of 3 floats
        Red, green, blue, 0..1.
    kappa : tuple of 3 floats
        How strongly red, green and blue light are attenuated: 0 = not at all, 1 = like the eye's own ray.
    ambient : float, default: 0.0
        0..1: the share of light that no shadow takes away.
    light_step : float, optional
        Step along the rays to the light, world units; default `step_world`.

    Returns
    -------
    ndarray of shape (h, w, 4), float64
        Premultiplied RGBA, row 0 at the top. Alpha is that of ``composite``.

    Raises
    ------
    InputError
        An argument outside what is described here.
    """
    low, high = value_range
    toward = step_world if light_step is None else light_step
    if not (step_world > 0 and toward > 0):
        raise InputError(f"step_world and light_step must be above 0, got {step_world:g} and {toward:g}.")
    rgba = np.ascontiguousarray(table, np.float64)
    extinction_sums(rgba)  # refuses tables that are not one
    matrix = index_to_world_matrix(spacing, origin, direction)
    planes = np.array([[*point, *normal] for point, normal in clip_planes], np.float64).reshape(-1, 6)
    scene = ShadowScene(
        table=rgba,
        low=float(low),
        high=float(high),
        lowest_shown=float(low + density_threshold * (high - low)) if density_threshold > 0 else -np.inf,
        unit_distance=float(unit_distance if unit_distance is not None else np.mean(spacing)),
        step=float(step_world),
        light_step=float(toward),
        light_position=np.array(light_position, np.float64),
        light_color=np.array(light_color, np.float64),
        kappa=np.array(kappa, np.float64),
        ambient=float(ambient),
        limits=index_limits(array.shape, crop),
        planes=planes,
        plane=make_plane(gradient_table, value_range, gradient_range),
    )
    field = make_field(array, matrix, interpolation="linear", delta=1.0, value_range=value_range)
    rays = volume_rays(
        array.shape, matrix, view=view, projection=projection, size=size, crop=crop, clip_planes=clip_planes
    )
    image = np.zeros((size[1], size[0], 4))

    def rows(first: int, last: int) -> None:
        _draw_shadowed(rays.rows(first, last), field, scene, image[first:last])

    map_ranges(rows, size[1])
    return image


@compiled
def _classified(field: Field, scene: ShadowScene, x: float, y: float, z: float, color: Float64Array) -> float:
    """Opacity at a world position; sets `color`, straight."""
    value = sample_world(field, x, y, z)
    if value < scene.lowest_shown:
        return 0.0
    if scene.plane.on:
        gx, gy, gz = gradient_world(field, x, y, z)
        return look_up_plane(scene.plane, value, np.sqrt(gx * gx + gy * gy + gz * gz), color)
    for c in range(3):
        color[c] = look_up(scene.table, scene.low, scene.high, value, c)
    return look_up(scene.table, scene.low, scene.high, value, 3)


@compiled
def _way_to_light(field: Field, scene: ShadowScene, p: Float64Array, ray: Float64Array) -> float:
    """Length from a point inside to the light or to the end of what is shown; sets `ray` to the direction."""
    distance = 0.0
    for axis in range(3):
        ray[axis] = scene.light_position[axis] - p[axis]
        distance += ray[axis] ** 2
    distance = np.sqrt(distance)
    if distance == 0:
        return 0.0
    for axis in range(3):
        ray[axis] /= distance
    index = to_index(field, p[0], p[1], p[2])
    m = field.to_index
    for axis in range(3):
        slope = m[axis, 0] * ray[0] + m[axis, 1] * ray[1] + m[axis, 2] * ray[2]
        if slope > 0:
            distance = min(distance, (scene.limits[2 * axis + 1] - index[axis]) / slope)
        elif slope < 0:
            distance = min(distance, (scene.limits[2 * axis] - index[axis]) / slope)
    for plane in scene.planes:
        height, slope = 0.0, 0.0
        for axis in range(3):
            height += (p[axis] - plane[axis]) * plane[3 + axis]
            slope += ray[axis] * plane[3 + axis]
        if slope < 0:
            distance = min(distance, -height / slope)
    return float(max(distance, 0.0))


@compiled
def _depth_to_light(field: Field, scene: ShadowScene, p: Float64Array, ray: Float64Array) -> float:
    """Logarithm of what reaches a point from the light, for kappa = 1; -inf behind something opaque."""
    way = _way_to_light(field, scene, p, ray)
    color = np.empty(3)
    total = 0.0
    for k in range(int(np.ceil(way / scene.light_step - 1e-11))):
        length = min(scene.light_step, way - k * scene.light_step)
        t = k * scene.light_step + 0.5 * length
        alpha = _classified(field, scene, p[0] + t * ray[0], p[1] + t * ray[1], p[2] + t * ray[2], color)
        if alpha > 0:
            total += np.log1p(-alpha) * length / scene.unit_distance
    return total


@compiled
def _draw_shadowed(rays: Rays, field: Field, scene: ShadowScene, image: Float64Array) -> None:
    rows, columns = rays.entries.shape
    p, color = np.empty(3), np.empty(3)
    toward = np.empty(3)
    for row in range(rows):
        for column in range(columns):
            start, ray = rays.starts[row, column], rays.directions[row, column]
            entry = rays.entries[row, column]
            inside = rays.exits[row, column] - entry
            pixel = image[row, column]
            for k in range(int(np.ceil(max(inside, 0.0) / scene.step - 1e-11))):
                length = min(scene.step, inside - k * scene.step)
                t = entry + k * scene.step + 0.5 * length
                for axis in range(3):
                    p[axis] = start[axis] + t * ray[axis]
                alpha = _classified(field, scene, p[0], p[1], p[2], color)
                alpha = 1.0 - (1.0 - alpha) ** (length / scene.unit_distance)
                if alpha <= 0:
                    continue
                depth = _depth_to_light(field, scene, p, toward)
                weight = (1.0 - pixel[3]) * alpha
                for c in range(3):
                    # kappa 0 lets everything pass, even where the depth is infinite
                    light = np.exp(scene.kappa[c] * depth) if scene.kappa[c] > 0 else 1.0
                    brightness = scene.ambient + (1.0 - scene.ambient) * scene.light_color[c] * light
                    pixel[c] += weight * brightness * color[c]
                pixel[3] += weight
