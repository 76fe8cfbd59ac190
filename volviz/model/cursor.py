"""The cursor of a scene: the world point that slices go through, moved within a volume."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from volviz.volume_data.vectors import Vector

if TYPE_CHECKING:
    from volviz.model.scene import Scene
    from volviz.volume_data.volume import Volume


def cursor_of(scene: Scene, volume: Volume) -> Vector:
    """Where the cursor stands: in the middle of the volume while nobody has moved it."""
    return volume.center if scene.cursor is None else scene.cursor


def within(volume: Volume, point: Sequence[float]) -> Vector:
    """The nearest place, along the axes of the lattice, between the first and the last voxel centres.

    Parameters
    ----------
    volume : Volume
    point : array_like of shape (3,)
        World point.
    """
    to_index, to_world = volume.world_to_index, volume.index_to_world
    index = to_index[:3, :3] @ np.asarray(point, np.float64) + to_index[:3, 3]
    index = np.clip(index, 0.0, np.asarray(volume.dimensions) - 1.0)
    x, y, z = (float(v) for v in to_world[:3, :3] @ index + to_world[:3, 3])
    return x, y, z


def stepped(volume: Volume, point: Sequence[float], direction: Sequence[float], steps: float) -> Vector:
    """The point moved along a direction by whole spacings of the lattice: planes across it meet the next voxels.

    Parameters
    ----------
    volume : Volume
    point : array_like of shape (3,)
        World point.
    direction : array_like of shape (3,)
        Unit vector in the world.
    steps : float
        How many spacings.
    """
    along = np.asarray(direction, np.float64)
    voxels = float(np.abs(volume.world_to_index[:3, :3] @ along).max())
    x, y, z = (float(v) for v in np.asarray(point) + steps / voxels * along)
    return within(volume, (x, y, z))
