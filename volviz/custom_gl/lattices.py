"""Lattices of several volumes: which are the same, and the box around all of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from volviz.kernels.slices import crop_corners
from volviz.model.clipping import Crop, Plane
from volviz.volume_data.volume import Volume


def is_same_lattice(one: Volume, other: Volume) -> bool:
    """Whether two volumes have the same voxels in the same places."""
    return one.dimensions == other.dimensions and np.array_equal(one.index_to_world, other.index_to_world)


def joint_crop(volumes: Sequence[Volume]) -> Crop:
    """The box around all volumes, in continuous voxel indices of the first one; it may reach beyond its voxels."""
    matrix = volumes[0].world_to_index
    points = np.concatenate([volume.corners for volume in volumes]) @ matrix[:3, :3].T + matrix[:3, 3]
    low, high = points.min(axis=0), points.max(axis=0)
    return (
        float(low[0]), float(high[0]), float(low[1]), float(high[1]), float(low[2]), float(high[2]),
    )  # fmt: skip


def crop_planes(volume: Volume, crop: Crop) -> tuple[Plane, ...]:
    """The faces of a crop box as clip planes in world space: a box of one lattice that is to cut others, too."""
    corners = crop_corners(volume.index_to_world, crop, volume.dimensions)
    planes: list[Plane] = []
    for axis in range(3):
        # gradients of an index, for sheared lattices: the normal of the faces is no edge
        normal = volume.world_to_index[axis, :3]
        normal = normal / np.linalg.norm(normal)
        for corner, side in ((corners[0], normal), (corners[7], -normal)):
            (x, y, z), (u, v, w) = corner.tolist(), side.tolist()
            planes.append(((x, y, z), (u, v, w)))
    return tuple(planes)
