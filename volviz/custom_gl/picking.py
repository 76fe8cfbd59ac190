"""What the eye sees at a pixel: one ray through the data, found by the rule of the technique. No OpenGL.

A technique whose image is a surface says where that is (`TechniqueInfo.pick`); for all others it is the place where
the ray has gathered half of its opacity, or the extreme value in the modes that show one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.settings import CommonSettings
from volviz.model.label_palette import LabelLook
from volviz.model.transfer.function import TransferFunction
from volviz.reference.rays import box_interval, index_limits, plane_interval
from volviz.reference.surface_pick import PixelRay, surface_on_ray, values_at
from volviz.volume_data.label_indices import label_indices_of
from volviz.volume_data.volume import Volume

Float64Array = npt.NDArray[np.float64]
Vector = tuple[float, float, float]

SAMPLES_PER_VOXEL = 2.0
#: Share of the ray's whole opacity at which it is said to have arrived.
SEEN = 0.5
#: A ray that gathers less opacity meets nothing.
FAINTEST = 1e-3


class Picked(NamedTuple):
    """What is seen at a pixel.

    Attributes
    ----------
    position : tuple of 3 floats
        World point (x, y, z).
    voxel : tuple of 3 ints
        Index (i, j, k) of the voxel that holds it.
    value : float
        Scalar at the point, in data units.
    isovalue : float or None
        The isovalue of the surface that was hit; None where the image shows no isosurface.
    volume : Volume or None
        Of several layers, the one that is seen; `voxel` is one of its voxels.
    label : int or None
        The label whose surface was hit; `value` is the same number.
    """

    position: Vector
    voxel: tuple[int, int, int]
    value: float
    isovalue: float | None = None
    volume: Volume | None = None
    label: int | None = None


@dataclass(frozen=True)
class Sight:
    """One ray and what it may meet.

    Attributes
    ----------
    volume, transfer_function, settings, common
        As they are drawn (see `Frame`); a function with `by_gradient` shows its regions.
    ray : PixelRay
        In the world.
    crop : tuple of 6 floats
        Box that is shown, in continuous voxel indices.
    planes : sequence of (origin, normal)
        Clip planes in world space.
    isovalues : tuple of floats
        Of the surfaces that are shown, in data units.
    """

    volume: Volume
    transfer_function: TransferFunction
    settings: Any
    common: CommonSettings
    ray: PixelRay
    crop: tuple[float, float, float, float, float, float]
    planes: Sequence[tuple[Vector, Vector]] = ()
    isovalues: tuple[float, ...] = ()

    def interval(self) -> tuple[float, float] | None:
        """World distances at which the ray enters and leaves what is shown of the box; None when it misses."""
        to_index = self.volume.world_to_index
        start = to_index[:3, :3] @ self.ray.start + to_index[:3, 3]
        along = to_index[:3, :3] @ self.ray.direction
        near, far = box_interval(start[None], along[None], index_limits(self.volume.array.shape, self.crop))
        cut_near, cut_far = plane_interval(self.ray.start[None], self.ray.direction[None], self.planes)
        entry = max(float(near[0]), float(cut_near[0]), 0.0)
        leave = min(float(far[0]), float(cut_far[0]), self.ray.length)
        return (entry, leave) if leave > entry else None

    def point(self, t: float) -> Float64Array:
        """World point at a distance along the ray."""
        return np.asarray(self.ray.start + t * self.ray.direction)

    def indices(self, t: Any) -> Float64Array:
        """Continuous voxel indices (n, 3) at distances along the ray."""
        points = self.ray.start + np.atleast_1d(t)[:, None] * self.ray.direction
        matrix = self.volume.world_to_index
        return np.asarray(points @ matrix[:3, :3].T + matrix[:3, 3])

    def values(self, t: Any) -> Float64Array:
        """Scalars in data units at distances along the ray, as the image interpolates them."""
        nearest = self.common.interpolation == "nearest"
        return values_at(
            self.volume.array, self.indices(t), nearest=nearest, lowest=float(self.volume.range[0])
        )

    def gradients(self, t: Float64Array) -> Float64Array:
        """Gradient magnitudes at distances along the ray, in data units per world unit, as shaders see them."""
        delta = self.common.gradient_delta
        index = self.indices(t)
        slopes = np.empty_like(index)
        for axis in range(3):
            step = delta * np.eye(3)[axis]
            after, before = (
                values_at(self.volume.array, place, nearest=False, lowest=float(self.volume.range[0]))
                for place in (index + step, index - step)
            )
            slopes[:, axis] = (after - before) / (2.0 * delta)
        return np.asarray(np.linalg.norm(slopes @ self.volume.world_to_index[:3, :3], axis=1))

    def opacities(self, t: Float64Array, values: Float64Array) -> Float64Array:
        """Opacities per mean spacing at distances along the ray, 0 below the density threshold."""
        function = self.transfer_function
        if function.by_gradient is None:
            found = function.evaluate(values, self.volume.range)[:, 3]
        else:
            found = function.by_gradient.evaluate(values, self.gradients(t))[:, 3] * function.opacity
        low, high = self.volume.bulk_range
        share = self.common.density_threshold
        threshold = low + share * (high - low) if share > 0 else -np.inf
        return np.where(values < threshold, 0.0, np.clip(found, 0.0, 1 - 1e-9))

    def picked(self, t: float, isovalue: float | None = None) -> Picked:
        """The answer for a distance along the ray."""
        x, y, z = (float(v) for v in self.point(t))
        last = np.array(self.volume.dimensions) - 1
        i, j, k = (int(v) for v in np.clip(np.rint(self.indices(t)[0]), 0, last))
        return Picked((x, y, z), (i, j, k), float(self.values(t)[0]), isovalue, self.volume)


def first_visible(sight: Sight) -> Picked | None:
    """The place where the ray has gathered half of its opacity; the extreme value in modes that show it."""
    interval = sight.interval()
    if interval is None:
        return None
    near, far = interval
    length = (far - near) / sight.volume.mean_spacing
    count = int(np.ceil(length * SAMPLES_PER_VOXEL)) + 1
    t = near + (np.arange(count) + 0.5) * (far - near) / count
    values = sight.values(t)
    opacities = sight.opacities(t, values)
    mode = sight.common.mode
    if mode in {"maximum", "minimum"}:
        at = int(np.argmax(values) if mode == "maximum" else np.argmin(values))
        return sight.picked(t[at]) if opacities[at] > 0 else None
    gathered = 1.0 - np.cumprod((1.0 - opacities) ** (length / count))
    if gathered[-1] < FAINTEST:
        return None
    return sight.picked(t[int(np.searchsorted(gathered, SEEN * gathered[-1]))])


def first_label(sight: Sight, look: LabelLook) -> Picked | None:
    """The first label along the ray that is shown; its surface is met within half a voxel."""
    interval = sight.interval()
    if interval is None:
        return None
    near, far = interval
    count = int(np.ceil(SAMPLES_PER_VOXEL * (far - near) / min(sight.volume.spacing))) + 1
    t = near + (np.arange(count) + 0.5) * (far - near) / count
    known = label_indices_of(sight.volume)
    last = np.array(sight.volume.dimensions) - 1
    i, j, k = np.clip(np.rint(sight.indices(t)), 0, last).astype(np.intp).T
    rows = known.indices[k, j, i]
    shown = look.palette(known.labels)[:, 3] > 0.0
    hits = np.flatnonzero(shown[rows])
    if not len(hits):
        return None
    first = int(hits[0])
    label = int(known.labels[rows[first]])
    x, y, z = (float(v) for v in sight.point(t[first]))
    voxel = int(i[first]), int(j[first]), int(k[first])
    return Picked((x, y, z), voxel, float(label), None, sight.volume, label)


def surface(
    sight: Sight,
    isovalues: Sequence[float],
    *,
    opacities: Sequence[float] | None = None,
    step: float = 0.5,
    interpolation: str = "linear",
) -> Picked | None:
    """The isosurface that is seen along the ray; `step` in voxels of the smallest spacing."""
    found = surface_on_ray(
        sight.volume.array,
        sight.volume.index_to_world,
        sight.ray,
        isovalues=isovalues,
        opacities=opacities,
        step_world=step * min(sight.volume.spacing),
        crop=sight.crop,
        clip_planes=sight.planes,
        interpolation=interpolation,
        lowest=float(sight.volume.range[0]),
    )
    if found is None:
        return None
    last = np.array(sight.volume.dimensions) - 1
    i, j, k = (int(v) for v in np.clip(np.rint(found.voxel), 0, last))
    return Picked(found.position, (i, j, k), found.value, float(isovalues[found.surface]), sight.volume)


def on_isovalue(sight: Sight) -> Picked | None:
    """The surface that is seen, for techniques that show one."""
    return surface(sight, sight.isovalues)
