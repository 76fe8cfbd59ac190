"""Bodies of known size in volumes of any lattice: sharp, averaged over voxels or soft, with noise."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from volviz.volume_data.volume import Volume

Array = npt.NDArray[np.float64]
Depth = Callable[[Array], Array]
"""From world points (..., 3) to how deep inside they lie, negative outside."""


def direction(rng: np.random.Generator) -> Array:
    """A random frame, left-handed in half of the cases."""
    return np.linalg.qr(rng.normal(size=(3, 3)))[0]


def lattice(rng: np.random.Generator, size: int) -> Volume:
    """An empty volume with spacings of its own, tilted, far from the origin."""
    zeros = np.zeros((size, size, size), np.uint8)
    return Volume(zeros, rng.uniform(0.5, 1.5, 3), rng.uniform(-50.0, 50.0, 3), direction(rng))


def inner_point(volume: Volume, rng: np.random.Generator) -> Array:
    """Near the middle, anywhere within a voxel."""
    return np.asarray(volume.center) + volume.index_to_world[:3, :3] @ rng.uniform(-0.5, 0.5, 3)


def smallest_extent(volume: Volume) -> float:
    """The shortest side of the box."""
    return min(volume.extent)


def filled(volume: Volume, depth: Depth, look: str, noise: float, rng: np.random.Generator) -> Volume:
    """100 inside, 0 outside, 50 on the surface.

    Parameters
    ----------
    look : {"sharp", "averaged", "soft"}
        Voxels decide by their centre, are means of what they hold, or values rise over two spacings to either side.
    """
    n = np.arange(volume.dimensions[0], dtype=float)
    k, j, i = np.meshgrid(n, n, n, indexing="ij")
    index = np.stack([i, j, k], axis=-1)

    def at(shift: tuple[float, float, float]) -> Array:
        return depth((index + shift) @ volume.index_to_world[:3, :3].T + volume.index_to_world[:3, 3])

    if look == "soft":
        values = 100 * np.clip(0.5 + at((0.0, 0.0, 0.0)) / (4 * volume.mean_spacing), 0, 1)
    elif look == "sharp":
        values = 100.0 * (at((0.0, 0.0, 0.0)) > 0)
    else:
        thirds = (-1 / 3, 0.0, 1 / 3)
        parts = [at((a, b, c)) > 0 for a in thirds for b in thirds for c in thirds]
        values = 100.0 * np.mean(parts, axis=0)
    values = values + rng.normal(0.0, noise, values.shape) if noise else values
    return Volume(values.astype(np.float32), volume.spacing, volume.origin, volume.direction, name=look)


def ball(center: Array, radius: float) -> tuple[Depth, float]:
    """A ball and its volume."""
    return (lambda p: radius - np.linalg.norm(p - center, axis=-1)), 4 / 3 * np.pi * radius**3


def tube(center: Array, axis: Array, radius: float, half: float = np.inf) -> tuple[Depth, float]:
    """A cylinder, endless or of a length, and its volume."""

    def depth(p: Array) -> Array:
        away = p - center
        along = away @ axis
        across = np.linalg.norm(away - along[..., None] * axis, axis=-1)
        return np.minimum(radius - across, half - np.abs(along))

    return depth, np.pi * radius**2 * 2 * half


def plate(center: Array, normal: Array, half: float) -> Depth:
    """All that lies no farther from a plane."""
    return lambda p: half - np.abs((p - center) @ normal)


def box(center: Array, frame: Array, halves: Array) -> tuple[Depth, float]:
    """A box along the columns of a frame and its volume."""
    return (lambda p: np.min(halves - np.abs((p - center) @ frame), axis=-1)), 8 * float(np.prod(halves))
