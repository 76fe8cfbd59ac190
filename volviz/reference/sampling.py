"""Sampling, classification and lighting of the float64 oracle, one sample at a time.

What is written here is the definition that the shaders are measured against.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.kernels.arrays import check_scalars
from volviz.kernels.compiled import compiled
from volviz.kernels.statistics import finite_range

Float64Array = npt.NDArray[np.float64]

#: A gradient below this share of (value range / mean spacing) counts as zero: it is rounding, not a surface.
FLAT_GRADIENT = 1e-5


class Shading(NamedTuple):
    """Blinn-Phong lighting, two-sided.

    ``color * (ambient + diffuse |n.l| light) + specular |n.h|^shininess light``, with n along the gradient,
    l towards the light, v towards the eye and h = norm(l + v) (Blinn 1977). Where the gradient is zero the
    colour stays as it is.

    Attributes
    ----------
    ambient, diffuse, specular : float
        Weights, 0..1.
    shininess : float
        Exponent of the highlight.
    light_position : tuple of 3 floats or None
        World position; None = a headlight, which shines along the ray.
    light_color : tuple of 3 floats
        Red, green, blue in 0..1; colours diffuse and specular light.
    gradient_delta : float
        Distance of the central differences to each side, in voxels.
    """

    ambient: float = 0.1
    diffuse: float = 0.7
    specular: float = 0.2
    shininess: float = 20.0
    light_position: tuple[float, float, float] | None = None
    light_color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    gradient_delta: float = 1.0


class Field(NamedTuple):
    """The scalars and how they are sampled, in a form compiled code can read."""

    values: Float64Array
    to_index: Float64Array
    """Rows map a world position (x, y, z, 1) to a continuous index (i, j, k); shape (3, 4)."""
    gradient_to_world: Float64Array
    """Maps differences per voxel along (i, j, k) to a world gradient; shape (3, 3)."""
    nearest: bool
    delta: float
    flat: float


class Lamp(NamedTuple):
    """`Shading` in a form compiled code can read."""

    on: bool
    weights: Float64Array
    headlight: bool
    position: Float64Array
    color: Float64Array


def make_field(
    array: npt.NDArray[Any],
    index_to_world: Float64Array,
    *,
    interpolation: str,
    delta: float,
    value_range: tuple[float, float],
) -> Field:
    """The scalars as float64, NaN and infinities replaced by the lowest finite value."""
    check_scalars(array)
    if interpolation not in {"linear", "nearest"}:
        raise InputError(f'interpolation must be "linear" or "nearest", got {interpolation!r}.')
    if delta <= 0:
        raise InputError(f"gradient_delta must be greater than 0 voxels, got {delta:g}.")
    values = np.asarray(array, np.float64, order="C")
    if not np.all(np.isfinite(values)):
        values = np.where(np.isfinite(values), values, finite_range(array).low)
    scales = np.linalg.norm(index_to_world[:3, :3], axis=0)
    return Field(
        values=np.ascontiguousarray(values),
        to_index=np.ascontiguousarray(np.linalg.inv(index_to_world)[:3]),
        # the transposed inverse carries gradients; for orthonormal directions it is direction / spacing
        gradient_to_world=np.ascontiguousarray(np.linalg.inv(index_to_world[:3, :3]).T),
        nearest=interpolation == "nearest",
        delta=float(delta),
        flat=FLAT_GRADIENT * (value_range[1] - value_range[0]) / float(scales.mean()),
    )


def make_lamp(shading: Shading | None) -> Lamp:
    """Lighting values as arrays; None = off."""
    s = shading if shading is not None else Shading()
    position = s.light_position if s.light_position is not None else (0.0, 0.0, 0.0)
    return Lamp(
        on=shading is not None,
        weights=np.array([s.ambient, s.diffuse, s.specular, s.shininess], np.float64),
        headlight=s.light_position is None,
        position=np.array(position, np.float64),
        color=np.array(s.light_color, np.float64),
    )


@compiled
def sample_index(field: Field, i: float, j: float, k: float) -> float:
    """Value at a continuous index, clamped to the first and last voxel along each axis."""
    values = field.values
    nz, ny, nx = values.shape
    i = min(max(i, 0.0), nx - 1.0)
    j = min(max(j, 0.0), ny - 1.0)
    k = min(max(k, 0.0), nz - 1.0)
    if field.nearest:
        return values[int(np.floor(k + 0.5)), int(np.floor(j + 0.5)), int(np.floor(i + 0.5))]  # type: ignore[no-any-return]
    x0 = min(int(i), nx - 2) if nx > 1 else 0
    y0 = min(int(j), ny - 2) if ny > 1 else 0
    z0 = min(int(k), nz - 2) if nz > 1 else 0
    x1, y1, z1 = min(x0 + 1, nx - 1), min(y0 + 1, ny - 1), min(z0 + 1, nz - 1)
    u, v, w = i - x0, j - y0, k - z0
    lower = (values[z0, y0, x0] * (1 - u) + values[z0, y0, x1] * u) * (1 - v) + (
        values[z0, y1, x0] * (1 - u) + values[z0, y1, x1] * u
    ) * v
    upper = (values[z1, y0, x0] * (1 - u) + values[z1, y0, x1] * u) * (1 - v) + (
        values[z1, y1, x0] * (1 - u) + values[z1, y1, x1] * u
    ) * v
    return lower * (1 - w) + upper * w  # type: ignore[no-any-return]


@compiled
def to_index(field: Field, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Continuous index (i, j, k) of a world position."""
    m = field.to_index
    return (
        m[0, 0] * x + m[0, 1] * y + m[0, 2] * z + m[0, 3],
        m[1, 0] * x + m[1, 1] * y + m[1, 2] * z + m[1, 3],
        m[2, 0] * x + m[2, 1] * y + m[2, 2] * z + m[2, 3],
    )


@compiled
def sample_world(field: Field, x: float, y: float, z: float) -> float:
    """Value at a world position."""
    i, j, k = to_index(field, x, y, z)
    return sample_index(field, i, j, k)


@compiled
def gradient_world(field: Field, x: float, y: float, z: float) -> tuple[float, float, float]:
    """World gradient from central differences of clamped samples; (0, 0, 0) where it is only rounding."""
    i, j, k = to_index(field, x, y, z)
    d = field.delta
    gi = (sample_index(field, i + d, j, k) - sample_index(field, i - d, j, k)) / (2 * d)
    gj = (sample_index(field, i, j + d, k) - sample_index(field, i, j - d, k)) / (2 * d)
    gk = (sample_index(field, i, j, k + d) - sample_index(field, i, j, k - d)) / (2 * d)
    m = field.gradient_to_world
    gx = m[0, 0] * gi + m[0, 1] * gj + m[0, 2] * gk
    gy = m[1, 0] * gi + m[1, 1] * gj + m[1, 2] * gk
    gz = m[2, 0] * gi + m[2, 1] * gj + m[2, 2] * gk
    if gx * gx + gy * gy + gz * gz <= field.flat * field.flat:
        return 0.0, 0.0, 0.0
    return gx, gy, gz


@compiled
def look_up(table: Float64Array, low: float, high: float, value: float, channel: int) -> float:
    """One channel of the table at a value: linear between entries, clamped at both ends."""
    n = len(table)
    t = (value - low) / (high - low) if high > low else 0.0
    x = min(max(t, 0.0), 1.0) * (n - 1)
    i = min(int(x), max(n - 2, 0))
    f = x - i
    return table[i, channel] * (1 - f) + table[min(i + 1, n - 1), channel] * f  # type: ignore[no-any-return]


class Plane(NamedTuple):
    """A transfer function over value and gradient magnitude, in a form compiled code can read."""

    on: bool
    table: Float64Array
    """Colour times opacity and opacity, shape (gradients, values, 4)."""
    value_low: float
    value_high: float
    gradient_low: float
    gradient_high: float


def make_plane(
    table: npt.ArrayLike | None, value_range: tuple[float, float], gradient_range: tuple[float, float] | None
) -> Plane:
    """A table of shape (gradients, values, 4), straight RGBA, over two ranges; None = off."""
    if table is None:
        return Plane(False, np.zeros((1, 1, 4)), 0.0, 1.0, 0.0, 1.0)
    texels = np.array(table, np.float64)
    if texels.ndim != 3 or texels.shape[2] != 4 or min(texels.shape[:2]) < 2 or gradient_range is None:
        raise InputError(
            f"a table over gradient and value has shape (m, n, 4) and a gradient_range, got {texels.shape}."
        )
    texels[..., :3] *= texels[..., 3:]
    low, high = (float(v) for v in value_range)
    return Plane(True, texels, low, high, float(gradient_range[0]), float(gradient_range[1]))


@compiled
def look_up_plane(plane: Plane, value: float, magnitude: float, color: Float64Array) -> float:
    """Opacity at a value and a gradient magnitude; sets `color`, straight.

    Opacity and colours weighted by it are bilinear between entries and clamped at the ends.
    """
    rows, columns = plane.table.shape[:2]
    x = (value - plane.value_low) / (plane.value_high - plane.value_low)
    y = (magnitude - plane.gradient_low) / (plane.gradient_high - plane.gradient_low)
    x = min(max(x, 0.0), 1.0) * (columns - 1)
    y = min(max(y, 0.0), 1.0) * (rows - 1)
    i, j = min(int(x), columns - 2), min(int(y), rows - 2)
    u, v = x - i, y - j
    entry = (plane.table[j, i] * (1 - u) + plane.table[j, i + 1] * u) * (1 - v) + (
        plane.table[j + 1, i] * (1 - u) + plane.table[j + 1, i + 1] * u
    ) * v
    if entry[3] > 0:
        for c in range(3):
            color[c] = entry[c] / entry[3]
    return float(entry[3])


@compiled
def lighting(
    lamp: Lamp, gradient: tuple[float, float, float], position: Float64Array, ray: Float64Array
) -> tuple[float, float]:
    """Diffuse and specular term at a point: (|n.l|, |n.h|^shininess).

    The gradient must not be zero.
    `ray` is the unit vector from the eye into the scene; v = -ray, and l = v for a headlight.
    """
    gx, gy, gz = gradient
    length = np.sqrt(gx * gx + gy * gy + gz * gz)
    nx, ny, nz = gx / length, gy / length, gz / length
    vx, vy, vz = -ray[0], -ray[1], -ray[2]
    if lamp.headlight:
        lx, ly, lz = vx, vy, vz
    else:
        lx, ly, lz = (
            lamp.position[0] - position[0],
            lamp.position[1] - position[1],
            lamp.position[2] - position[2],
        )
        far = np.sqrt(lx * lx + ly * ly + lz * lz)
        if far == 0:
            return 0.0, 0.0
        lx, ly, lz = lx / far, ly / far, lz / far
    hx, hy, hz = lx + vx, ly + vy, lz + vz
    half = np.sqrt(hx * hx + hy * hy + hz * hz)
    diffuse = abs(nx * lx + ny * ly + nz * lz)
    if half == 0:
        return diffuse, 0.0
    return diffuse, (abs(nx * hx + ny * hy + nz * hz) / half) ** lamp.weights[3]
