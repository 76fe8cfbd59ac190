"""Rays of the float64 oracle through several layers: where each is met, and what it gives there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
from scipy.ndimage import map_coordinates

from volviz.reference.labels import ReferenceLabels, first_border
from volviz.reference.rays import Plane, box_interval, index_limits, plane_interval
from volviz.reference.sampling import FLAT_GRADIENT, Float64Array, Shading

#: What opaque matter lets through per unit distance: its logarithm must be finite.
LEAST_TRANSPARENCY = 1e-30


@dataclass(frozen=True, eq=False)
class ReferenceLayer:
    """Scalars on a lattice of their own and how they are classified.

    Attributes
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars in data units, finite.
    index_to_world : ndarray of shape (4, 4)
        From continuous index (i, j, k, 1) to the place where the layer is shown.
    table : ndarray of shape (n, 4)
        Straight RGBA over `table_range`, linear between entries, clamped.
    table_range : tuple of 2 floats
        Values of its first and last entry.
    value_range : tuple of 2 floats
        Lowest and highest value of the data.
    unit_distance : float
        World length to which opacities refer.
    mode : {"add", "mask", "modulate"}
        Its matter is added; the others are seen only where its opacity is at least one half; their extinction is
        multiplied by its opacity.
    crop : tuple of 6 floats, optional
        (i0, i1, j0, j1, k0, k1) in continuous indices of the lattice.
    """

    array: npt.NDArray[Any]
    index_to_world: Float64Array
    table: Float64Array
    table_range: tuple[float, float]
    value_range: tuple[float, float]
    unit_distance: float = 1.0
    mode: Literal["add", "mask", "modulate"] = "add"
    crop: Sequence[float] | None = None

    @cached_property
    def values(self) -> Float64Array:
        """The scalars as float64."""
        return np.asarray(self.array, np.float64)

    @cached_property
    def to_index(self) -> Float64Array:
        """From the world to continuous index, shape (4, 4)."""
        return np.asarray(np.linalg.inv(self.index_to_world))

    @property
    def flat(self) -> float:
        """A gradient up to this is rounding, in data units per world unit."""
        spacing = np.linalg.norm(self.index_to_world[:3, :3], axis=0).mean()
        return float(FLAT_GRADIENT * (self.value_range[1] - self.value_range[0]) / spacing)

    def interval(self, starts: Float64Array, directions: Float64Array) -> tuple[Float64Array, Float64Array]:
        """Lengths along rays between which they are in its box."""
        m = self.to_index[:3, :3].T
        limits = index_limits(self.array.shape, self.crop)
        return box_interval(starts @ m + self.to_index[:3, 3], directions @ m, limits)

    def sample(self, index: Float64Array, interpolation: str) -> Float64Array:
        """Values at continuous indices (i, j, k), shape (n, 3), clamped to the first and last voxel."""
        last = np.array(self.array.shape[::-1]) - 1.0
        inside = np.clip(index, 0.0, last)
        if interpolation == "nearest":
            i, j, k = np.floor(inside + 0.5).astype(int).T
            return np.asarray(self.values[k, j, i])
        return np.asarray(map_coordinates(self.values, inside[:, ::-1].T, order=1, mode="nearest"))

    def gradient(self, index: Float64Array, interpolation: str, delta: float) -> Float64Array:
        """World gradients at continuous indices by central differences, shape (n, 3); 0 where it is only rounding."""
        g = np.empty_like(index)
        for axis in range(3):
            step = np.zeros(3)
            step[axis] = delta
            high, low = (self.sample(index + sign * step, interpolation) for sign in (1, -1))
            g[:, axis] = (high - low) / (2 * delta)
        world = g @ self.to_index[:3, :3]
        world[np.linalg.norm(world, axis=1) <= self.flat] = 0.0
        return np.asarray(world)

    def classified(self, values: Float64Array, density_threshold: float) -> Float64Array:
        """Straight RGBA of values, shape (n, 4)."""
        first, last = self.table_range
        at = np.linspace(first, last, len(self.table))
        rgba = np.stack([np.interp(values, at, self.table[:, c]) for c in range(4)], axis=1)
        low, high = self.value_range
        if density_threshold > 0:
            rgba[values < low + density_threshold * (high - low), 3] = 0.0
        return rgba


@dataclass(frozen=True)
class Sampling:
    """How every layer is sampled and lit.

    Attributes
    ----------
    interpolation : {"linear", "nearest"}
    gradient_delta : float
        Distance of the central differences to each side, in voxels of each layer.
    gradient_opacity : float
        0..1, as in `reference_render`; the reference is a quarter of a layer's range per mean spacing.
    density_threshold : float
        Values below this fraction of a layer's range contribute nothing.
    shading : Shading or None
        Lighting; None leaves colours as they are classified. Its own `gradient_delta` is not read.
    surface_shading : Shading or None
        Lighting of the surfaces of labels; None is that of `Shading` by itself.
    """

    interpolation: str = "linear"
    gradient_delta: float = 1.0
    gradient_opacity: float = 0.0
    density_threshold: float = 0.0
    shading: Shading | None = None
    surface_shading: Shading | None = None


class LayerRays:
    """Rays through all layers, and what layers give along them.

    Parameters
    ----------
    layers : sequence of ReferenceLayer or ReferenceLabels
    starts, directions : ndarray of shape (n, 3)
        World points and unit vectors.
    lengths : ndarray of shape (n,)
        Of the rays, in world units.
    clip_planes, sampling
        As in `reference_layers`.
    """

    def __init__(
        self,
        layers: Sequence[ReferenceLayer | ReferenceLabels],
        starts: Float64Array,
        directions: Float64Array,
        lengths: Float64Array,
        clip_planes: Sequence[Plane],
        sampling: Sampling,
    ) -> None:
        self.sampling = sampling
        self.masks = [layer for layer in layers if layer.mode != "add"]
        self.starts, self.directions = starts, directions
        near, far = plane_interval(starts, directions, clip_planes)
        near, far = np.maximum(near, 0.0), np.minimum(far, lengths)
        self._spans: dict[int, tuple[Float64Array, Float64Array]] = {}
        self.near, self.far = np.full(len(near), np.inf), np.full(len(near), -np.inf)
        for layer in layers:
            low, high = layer.interval(self.starts, self.directions)
            low, high = np.maximum(low, near), np.minimum(high, far)
            self._spans[id(layer)] = low, high
            if layer.mode == "add":
                hit = high > low
                self.near = np.where(hit, np.minimum(self.near, low), self.near)
                self.far = np.where(hit, np.maximum(self.far, high), self.far)

    def segments(self, step: float, first_sample: float) -> Any:
        """Yields the rays that have a next segment, its beginning, its length and the place of its sample."""
        length = np.where(self.far > self.near, self.far - self.near, 0.0)
        if first_sample == 1.0:
            counts = np.floor(length / step + 1e-9).astype(int)
        else:
            counts = np.ceil(length / step - 1e-11).astype(int)
        for k in range(int(counts.max(initial=0))):
            rays = np.flatnonzero(counts > k)
            begin = self.near[rays] + k * step
            piece = np.minimum(step, self.far[rays] - begin)
            yield rays, begin, piece, begin + first_sample * piece

    def share(
        self, layer: ReferenceLayer | ReferenceLabels, rays: Any, begin: Float64Array, piece: Float64Array
    ) -> Float64Array:
        """The part of segments that lies in the box of a layer, 0..1."""
        low, high = self._spans[id(layer)]
        inside = np.minimum(begin + piece, high[rays]) - np.maximum(begin, low[rays])
        return np.asarray(np.clip(inside / piece, 0.0, 1.0))

    def points(self, rays: Any, at: Float64Array) -> Float64Array:
        """World points at lengths along rays, shape (n, 3)."""
        return np.asarray(self.starts[rays] + at[:, None] * self.directions[rays])

    def labels(self, layer: ReferenceLabels, rays: Any, at: Float64Array) -> npt.NDArray[np.int64]:
        """Labels at lengths along rays; outside of the layer's box the first one, which is nothing."""
        low, high = self._spans[id(layer)]
        found = layer.at(layer.index_of(self.points(rays, at)))
        return np.where((at >= low[rays]) & (at <= high[rays]), found, 0)

    def values(self, layer: ReferenceLayer, rays: Any, at: Float64Array) -> tuple[Float64Array, Float64Array]:
        """Continuous indices and values of a layer at lengths along rays."""
        p = self.points(rays, at)
        index = p @ layer.to_index[:3, :3].T + layer.to_index[:3, 3]
        return index, layer.sample(index, self.sampling.interpolation)

    def colors(self, layer: ReferenceLayer, rays: Any, at: Float64Array) -> Float64Array:
        """Straight RGBA of a layer at lengths along rays, lit, with opacities per unit distance; shape (n, 4)."""
        s = self.sampling
        index, values = self.values(layer, rays, at)
        rgba = layer.classified(values, s.density_threshold)
        if s.shading is None and s.gradient_opacity == 0.0:
            return rgba
        seen = rgba[:, 3] > 0
        gradient = np.zeros_like(index)
        gradient[seen] = layer.gradient(index[seen], s.interpolation, s.gradient_delta)
        if s.gradient_opacity > 0:
            low, high = layer.value_range
            spacing = np.linalg.norm(layer.index_to_world[:3, :3], axis=0).mean()
            steep = np.minimum(np.linalg.norm(gradient, axis=1) / ((high - low) / (4 * spacing)), 1.0)
            rgba[:, 3] *= 1.0 - s.gradient_opacity + s.gradient_opacity * steep
        if s.shading is not None:
            p = self.points(rays, at)
            rgba[:, :3] = lit(rgba[:, :3], gradient, p, self.directions[rays], s.shading)
        return rgba

    def border(
        self,
        layer: ReferenceLabels,
        rays: Any,
        begin: Float64Array,
        end: Float64Array,
        before: npt.NDArray[np.int64],
        after: npt.NDArray[np.int64],
    ) -> tuple[Float64Array, npt.NDArray[np.int64]]:
        """Where rays cross a border, and whose surface is seen there (`first_border`)."""
        low, high = self._spans[id(layer)]
        # nothing is beyond the faces of the box, which are borders of what touches them
        begin, end = np.maximum(begin, low[rays]), np.minimum(end, high[rays])
        return first_border(layer, self.starts[rays], self.directions[rays], begin, end, before, after)

    def factor(
        self, modes: Sequence[str], rays: Any, begin: Float64Array, piece: Float64Array, at: Float64Array
    ) -> Float64Array:
        """What layers of these modes leave of the extinction of the others, 0..1."""
        left = np.ones(len(rays))
        for mask in (layer for layer in self.masks if layer.mode in modes):
            if isinstance(mask, ReferenceLabels):
                labels = mask.at(mask.index_of(self.points(rays, at)))
                left *= mask.is_shown(labels) * self.share(mask, rays, begin, piece)
                continue
            opacity = self.colors(mask, rays, at)[:, 3]
            if mask.mode == "mask":
                opacity = np.where(opacity >= 0.5, 1.0, 0.0)
            left *= opacity * self.share(mask, rays, begin, piece)
        return left

    def matter(
        self, added: Sequence[ReferenceLayer], rays: Any, begin: Float64Array, piece: Float64Array, at: Any
    ) -> tuple[Float64Array, Float64Array]:
        """Optical depth of segments, shape (n,), and the colour that they emit times it, shape (n, 3)."""
        depth, emitted = np.zeros(len(rays)), np.zeros((len(rays), 3))
        for layer in added:
            rgba = self.colors(layer, rays, at)
            length = piece * self.share(layer, rays, begin, piece) / layer.unit_distance
            thickness = -np.log(np.maximum(1.0 - rgba[:, 3], LEAST_TRANSPARENCY)) * length
            depth += thickness
            emitted += thickness[:, None] * rgba[:, :3]
        left = self.factor(("mask", "modulate"), rays, begin, piece, at)
        return depth * left, emitted * left[:, None]


def lit(
    colors: Float64Array, gradient: Float64Array, p: Float64Array, ray: Float64Array, shading: Shading
) -> Float64Array:
    """Colours, shape (n, 3), lit as `Shading` says by their gradients; those without one stay as they are."""
    size = np.linalg.norm(gradient, axis=1)
    n = gradient / np.where(size > 0, size, 1.0)[:, None]
    towards = -ray
    light = towards
    if shading.light_position is not None:
        light = np.asarray(shading.light_position) - p
        light = light / np.maximum(np.linalg.norm(light, axis=1), 1e-300)[:, None]
    between = light + towards
    length = np.linalg.norm(between, axis=1)
    diffuse = np.abs((n * light).sum(axis=1))
    highlight = np.abs((n * between).sum(axis=1)) / np.where(length > 0, length, np.inf)
    lamp = np.asarray(shading.light_color)
    strength = shading.ambient + shading.diffuse * diffuse[:, None] * lamp
    glint = shading.specular * (highlight**shading.shininess)[:, None] * lamp
    return np.asarray(np.where(size[:, None] > 0, colors * strength + glint, colors))
