"""The camera with which a volume is seen first: all that is visible of it, from an angle that shows its shape."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.kernels.brick_gradients import occupancy_2d, visible_plane_sums
from volviz.kernels.bricks import occupancy, visible_prefix
from volviz.kernels.gradient import gradient_magnitude
from volviz.model.camera import Camera
from volviz.model.transfer.function import TransferFunction
from volviz.model.transfer.tables import baked
from volviz.volume_data.large_volume import at_finest
from volviz.volume_data.scalars import BRICK, bricks_of, gradient_bricks_of
from volviz.volume_data.vectors import Vector
from volviz.volume_data.volume import Volume

#: Viewing direction: degrees to the side of a look at a patient's face, and above the horizon.
AZIMUTH, ELEVATION = -30.0, 15.0

#: A volume whose shortest edge is below this share of the next one is a stack of slices, which one looks at from their
#: faces; so many degrees from the side and from above, that their distance is seen.
STACK = 0.35
STACK_AZIMUTH, STACK_ELEVATION = -20.0, 25.0

#: A brick counts as visible when it may hold at least this opacity: a veil does not decide the frame.
VISIBLE_OPACITY = 0.004

#: Volumes of at most so many voxels are looked at voxel by voxel: their bricks would be too coarse a frame.
SMALL = 2**18

#: Part of the image that what is faced fills.
FILL = 0.92

#: Voxels kept free around what is visible in them, along every axis.
AIR = 1


def default_camera(
    volume: Volume,
    size: tuple[int, int],
    azimuth: float = 0.0,
    elevation: float = 0.0,
    transfer_function: TransferFunction | None = None,
    facing: tuple[Vector, Vector] | None = None,
) -> Camera:
    """A camera that sees the whole volume, from the front, a little to the side and above.

    Parameters
    ----------
    volume : Volume
        What to see.
    size : tuple of 2 ints
        Width and height of the image in pixels.
    azimuth, elevation : float
        Further turn in degrees.
    transfer_function : TransferFunction, optional
        Frames only what this function shows, rather than the whole box: its regions when it has any (see
        `volviz.custom_gl.technique.drawn_function`).
    facing : pair of vectors, optional
        Direction towards the viewer, and up: a parallel projection from there (`TechniqueInfo.facing`).
    """
    if facing is not None:
        toward, up = facing
        camera = Camera.fit(
            volume.corners, direction=[-v for v in toward], view_up=up, aspect=size[0] / size[1]
        ).turned(azimuth, elevation)
        across, upwards = (float(np.ptp(volume.corners @ axis)) for axis in _screen_axes(camera))
        scale = max(upwards, across * size[1] / size[0]) / (2 * FILL)
        return replace(camera, parallel=True, parallel_scale=scale)
    points = (
        at_finest(volume).corners if transfer_function is None else visible_points(volume, transfer_function)
    )
    return camera_around(points, size, azimuth, elevation)


def layers_camera(
    layers: Iterable[tuple[Volume, TransferFunction]],
    size: tuple[int, int],
    azimuth: float = 0.0,
    elevation: float = 0.0,
    *,
    stacks_from_faces: bool = False,
) -> Camera:
    """The same for what the functions of several volumes show.

    With `stacks_from_faces`, a first volume of few slices is looked at from their faces (`face_of_stack`).
    """
    layers = list(layers)
    points = np.concatenate([visible_points(volume, function) for volume, function in layers])
    face = face_of_stack(layers[0][0]) if stacks_from_faces else None
    return camera_around(points, size, azimuth, elevation, face)


def face_of_stack(volume: Volume) -> tuple[Vector, Vector] | None:
    """Viewing direction and up that show the slices of a stack as their file holds them; None for no stack."""
    shortest, next_one, _ = np.argsort(volume.extent)
    if volume.extent[shortest] >= STACK * volume.extent[next_one]:
        return None
    i, j, k = volume.direction.T
    # rows of an image go down; what is not an image has its second axis upwards
    right, up = {0: (j, k), 1: (i, k), 2: (i, -j)}[int(shortest)]
    x, y, z = (float(v) for v in np.cross(up, right))
    return (x, y, z), (float(up[0]), float(up[1]), float(up[2]))


def camera_around(
    points: npt.NDArray[np.float64],
    size: tuple[int, int],
    azimuth: float,
    elevation: float,
    face: tuple[Vector, Vector] | None = None,
) -> Camera:
    """The same for world positions, shape (N, 3), or a little from the side of a direction and up."""
    if face is None:
        turned = Camera.fit(points).turned(AZIMUTH + azimuth, ELEVATION + elevation)
    else:
        straight = Camera.fit(points, direction=face[0], view_up=face[1])
        turned = straight.turned(STACK_AZIMUTH + azimuth, STACK_ELEVATION + elevation)
    return Camera.fit(points, direction=turned.direction, view_up=turned.view_up, aspect=size[0] / size[1])


def _screen_axes(camera: Camera) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Unit vectors to the right and upwards in the image."""
    right = np.cross(camera.direction, camera.view_up)
    right /= np.linalg.norm(right)
    return right, np.cross(right, camera.direction)


def visible_points(volume: Volume, transfer_function: TransferFunction) -> npt.NDArray[np.float64]:
    """World positions around everything that a transfer function shows; the box's corners when that is nothing.

    Returns
    -------
    ndarray of shape (N, 3)
        Outermost visible voxels of a small volume, corners of the visible bricks of a larger one.
    """
    index: npt.NDArray[Any] = (
        _voxels(volume, transfer_function)
        if volume.array.size <= SMALL
        else _bricks(volume, transfer_function)
    )
    finest = at_finest(volume)
    if len(index) == 0:
        return finest.corners
    matrix = volume.index_to_world
    if finest is not volume:
        # what is seen up to the border is seen up to that of the finest level, which lies a little farther out
        last = np.array(volume.dimensions) - 1
        inside = np.clip(_indices_in(finest, index @ matrix[:3, :3].T + matrix[:3, 3]), 0, None)
        end = np.array(finest.dimensions) - 1
        index = np.where(index == 0, 0.0, np.where(index == last, end, np.minimum(inside, end)))
        matrix = finest.index_to_world
    points: npt.NDArray[np.float64] = index @ matrix[:3, :3].T + matrix[:3, 3]
    return points


def _indices_in(volume: Volume, world: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """World positions, shape (N, 3), as continuous indices (i, j, k)."""
    matrix = volume.world_to_index
    return np.asarray(world @ matrix[:3, :3].T + matrix[:3, 3])


def _voxels(volume: Volume, transfer_function: TransferFunction) -> npt.NDArray[np.int64]:
    """First and last visible voxel of every row and some air around them, as indices (i, j, k)."""
    scalars = volume.finite_array
    if transfer_function.by_gradient is None:
        opacity = transfer_function.evaluate(scalars, volume.range)[..., 3]
    else:
        gradients = gradient_magnitude(volume.array, volume.spacing, lowest=volume.range[0])
        opacity = (
            transfer_function.by_gradient.evaluate(scalars, gradients)[..., 3] * transfer_function.opacity
        )
    seen = opacity >= VISIBLE_OPACITY
    k, j = np.nonzero(seen.any(axis=2))
    rows = seen[k, j]
    first = rows.argmax(axis=1)
    last = rows.shape[1] - 1 - rows[:, ::-1].argmax(axis=1)
    index = np.concatenate([np.stack([i, j, k], axis=1) for i in (first, last)])
    if len(index) == 0:
        return index
    # in small volumes a voxel is large in the image: room to move and for axes around it
    low, high = index.min(axis=0), index.max(axis=0)
    air = np.where(index > (low + high) / 2, AIR, -AIR)
    inside: npt.NDArray[np.int64] = np.clip(index + air, 0, np.array(volume.dimensions) - 1)
    return inside


def _bricks(volume: Volume, transfer_function: TransferFunction) -> npt.NDArray[np.int64]:
    """Corners of the visible bricks, as indices (i, j, k) limited to the volume."""
    bricks, table = bricks_of(volume), baked(transfer_function, volume)
    opacity = np.where(table.opacity >= VISIBLE_OPACITY, table.opacity, 0.0)
    if table.gradients is None:
        occupied = occupancy(bricks.low, bricks.high, visible_prefix(opacity[0]), table.values)
    else:
        steep = gradient_bricks_of(volume)
        occupied = occupancy_2d(
            (bricks.low, bricks.high), (steep.low, steep.high), visible_plane_sums(opacity),
            table.values, table.gradients,
        )  # fmt: skip
    touched = np.zeros([n + 1 for n in occupied.shape], bool)
    nz, ny, nx = occupied.shape
    for c in range(8):
        i, j, k = c & 1, c >> 1 & 1, c >> 2 & 1
        touched[k : k + nz, j : j + ny, i : i + nx] |= occupied
    corners = np.argwhere(touched)[:, ::-1] * BRICK
    index: npt.NDArray[np.int64] = np.minimum(corners, np.array(volume.dimensions) - 1)
    return index
