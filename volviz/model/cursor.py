"""The cursor of a scene: the world point that slices go through and how they are tilted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from volviz.volume_data.vectors import Vector

if TYPE_CHECKING:
    from volviz.model.scene import Scene
    from volviz.volume_data.volume import Volume


#: Rows of a rotation matrix.
Tilt = tuple[Vector, Vector, Vector]


def tilted(tilt: Tilt | None, direction: Sequence[float]) -> Vector:
    """A direction as the planes of a scene are tilted; itself where they are not."""
    rows = np.eye(3) if tilt is None else np.asarray(tilt)
    x, y, z = (float(v) for v in rows @ np.asarray(direction, np.float64))
    return x, y, z


def turned(tilt: Tilt | None, axis: Sequence[float], degrees: float) -> Tilt:
    """The tilt after all planes have been turned about a world axis, counter-clockwise seen against it.

    Parameters
    ----------
    tilt : Tilt or None
    axis : array_like of shape (3,)
        Unit vector.
    degrees : float
    """
    from scipy.spatial.transform import Rotation

    more = Rotation.from_rotvec(np.radians(degrees) * np.asarray(axis, np.float64))
    before = Rotation.identity() if tilt is None else Rotation.from_matrix(np.asarray(tilt))
    # composed as quaternions: what is turned many times stays a rotation
    a, b, c = (tuple(float(v) for v in row) for row in (more * before).as_matrix())
    return a, b, c  # type: ignore[return-value]


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
