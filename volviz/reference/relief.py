"""The float64 oracle of a cut plane lit as a relief of the data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.kernels.compiled import compiled
from volviz.kernels.tangents import plane_basis
from volviz.reference.rays import Plane, index_to_world_matrix, pixel_rays
from volviz.reference.sampling import Field, Float64Array, gradient_world, look_up, make_field, sample_index


class Relief(NamedTuple):
    """How a cut plane is lit: ``color * (ambient + diffuse * max(n . l, 0) * light color)``.

    Attributes
    ----------
    height : float
        World units that the whole range of the data is high.
    ambient, diffuse : float
        Weights.
    light_position : tuple of 3 floats or None
        World position; None = at the eye.
    light_color : tuple of 3 floats
        Red, green, blue in 0..1.
    gradient_delta : float
        Distance of the central differences to each side, in voxels.
    shown_from : float
        Opacity of the table from which on the plane is opaque; below, its opacity falls off linearly. 0 shows
        all of it.
    """

    height: float
    ambient: float = 0.15
    diffuse: float = 0.85
    light_position: tuple[float, float, float] | None = None
    light_color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    gradient_delta: float = 1.0
    shown_from: float = 0.0


def reference_relief(
    array: npt.NDArray[Any],
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    origin: Sequence[float] = (0.0, 0.0, 0.0),
    direction: npt.ArrayLike | None = None,
    *,
    plane: Plane,
    relief: Relief,
    table: npt.ArrayLike,
    value_range: tuple[float, float],
    view: npt.ArrayLike,
    projection: npt.ArrayLike,
    size: tuple[int, int],
    crop: Sequence[float] | None = None,
    clip_planes: Sequence[Plane] = (),
) -> tuple[Float64Array, Float64Array]:
    """The image of a cut plane whose normals are those of the data as a height field over it.

    The normal at a point is norm(n - h (t (t . g) + b (b . g))) with g the gradient as fraction of the range
    per world unit, n the plane's normal on the side of the eye and t, b any orthonormal basis of the plane (Blinn
    1978, equation for a flat surface).

    Parameters
    ----------
    array, spacing, origin, direction, table, value_range, view, projection, size, crop, clip_planes
        As in `volviz.reference.image.reference_render`.
    plane : (origin, normal)
        World space.
    relief : Relief
        Heights and light.

    Returns
    -------
    color : ndarray of shape (h, w, 4), float64
        Premultiplied RGBA, row 0 at the top; light is clamped to 0..1.
    depth : ndarray of shape (h, w), float64
        Window depth of the plane, 1 where it is not seen.
    """
    matrix = index_to_world_matrix(spacing, origin, direction)
    field = make_field(
        array, matrix, interpolation="linear", delta=relief.gradient_delta, value_range=value_range
    )
    starts, directions, lengths = pixel_rays(view, projection, size)
    point, normal = np.asarray(plane[0], np.float64), np.asarray(plane[1], np.float64)
    normal = normal / np.linalg.norm(normal)
    with np.errstate(divide="ignore", invalid="ignore"):
        along = ((point - starts) @ normal) / (directions @ normal)
    hit = np.isfinite(along) & (along >= 0) & (along <= lengths)
    world = starts + np.where(hit, along, 0.0)[..., None] * directions
    inverse = np.linalg.inv(matrix)
    index = world @ inverse[:3, :3].T + inverse[:3, 3]
    full = [v for n in np.shape(array)[::-1] for v in (0.0, n - 1.0)]
    limits = np.asarray(full if crop is None else crop, np.float64).reshape(3, 2)
    hit &= np.all((index >= limits[:, 0]) & (index <= limits[:, 1]), axis=-1)
    for clip_origin, kept in clip_planes:
        hit &= (world - np.asarray(clip_origin, np.float64)) @ np.asarray(kept, np.float64) >= 0
    transform = np.asarray(projection, np.float64) @ np.asarray(view, np.float64)
    clip = np.concatenate([world, np.ones((*world.shape[:2], 1))], axis=-1) @ transform.T
    depth = np.where(hit, 0.5 + 0.5 * clip[..., 2] / clip[..., 3], 1.0)
    # the eye lies against the ray
    side = np.where((directions @ normal) > 0, -1.0, 1.0)[..., None]
    light = starts - world if relief.light_position is None else np.asarray(relief.light_position) - world
    if relief.light_position is None:
        eye = np.linalg.inv(np.asarray(view, np.float64))[:3, 3]
        parallel = np.asarray(projection, np.float64)[3, 3] == 1.0
        light = -directions if parallel else eye - world
    tangent, binormal, _ = plane_basis(normal, list(np.eye(3)))
    color = np.zeros((size[1], size[0], 4))
    _shade(
        field, index, world, side * normal, light, hit,
        np.stack([tangent, binormal]), np.ascontiguousarray(table, np.float64),
        np.array([*value_range, relief.height, relief.ambient, relief.diffuse, relief.shown_from]),
        np.asarray(relief.light_color, np.float64), color,
    )  # fmt: skip
    return color, depth


@compiled
def _shade(
    field: Field,
    index: Float64Array,
    world: Float64Array,
    normals: Float64Array,
    light: Float64Array,
    hit: npt.NDArray[np.bool_],
    basis: Float64Array,
    table: Float64Array,
    values: Float64Array,
    light_color: Float64Array,
    color: Float64Array,
) -> None:
    low, high, height, ambient, diffuse, shown_from = values
    span = high - low if high > low else 1.0
    for row in range(hit.shape[0]):
        for column in range(hit.shape[1]):
            if not hit[row, column]:
                continue
            i, j, k = index[row, column]
            x, y, z = world[row, column]
            value = sample_index(field, i, j, k)
            gx, gy, gz = gradient_world(field, x, y, z)
            n = normals[row, column].copy()
            for axis in range(2):
                t = basis[axis]
                n -= t * (height * (gx * t[0] + gy * t[1] + gz * t[2]) / span)
            n /= np.sqrt(np.sum(n * n))
            to_light = light[row, column]
            product = max(np.sum(n * to_light) / np.sqrt(np.sum(to_light * to_light)), 0.0)
            alpha = 1.0
            if shown_from > 0.0:
                alpha = min(look_up(table, low, high, value, 3) / shown_from, 1.0)
            for c in range(3):
                shine = min(max(ambient + diffuse * product * light_color[c], 0.0), 1.0)
                color[row, column, c] = look_up(table, low, high, value, c) * shine * alpha
            color[row, column, 3] = alpha
