"""Which voxel the eye sees under the pointer: one ray through the volume, classified as in the picture."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.transfer_function import TransferFunction
from volviz.model.volume import Volume
from volviz_ui.camera_moves import frame

SAMPLES_PER_VOXEL = 2.0
SEEN = 0.5
"""Share of the ray's whole opacity at which it is said to have arrived."""


class Picked(NamedTuple):
    """A voxel: its index (i, j, k), its value in data units, its world position."""

    index: tuple[int, int, int]
    value: float
    world: tuple[float, float, float]


def picked_voxel(
    volume: Volume,
    transfer_function: TransferFunction,
    clipping: Clipping,
    camera: Camera,
    position: tuple[float, float],
    size: tuple[int, int],
) -> Picked | None:
    """The voxel in which the ray through a pixel has gathered half of its opacity.

    Parameters
    ----------
    position : tuple of 2 floats
        Pixel, from the upper left.
    size : tuple of 2 ints
        Width and height of the viewport in the same pixels.

    Returns
    -------
    Picked or None
        None where the ray misses the volume or meets nothing visible.
    """
    origin, direction = _ray(camera, position, size)
    to_index = volume.world_to_index
    start = to_index[:3, :3] @ origin + to_index[:3, 3]
    step = to_index[:3, :3] @ direction
    last = np.asarray(volume.dimensions, float) - 1
    crop = np.asarray(clipping.crop_within(volume.dimensions)).reshape(3, 2)
    low, high = np.maximum(crop[:, 0], 0.0), np.minimum(crop[:, 1], last)
    with np.errstate(divide="ignore", invalid="ignore"):
        near, far = (low - start) / step, (high - start) / step
    entry = float(np.nanmax(np.minimum(near, far)))
    leave = float(np.nanmin(np.maximum(near, far)))
    entry = max(entry, 0.0) if not camera.parallel else entry
    for plane_origin, normal in clipping.planes:
        slope = float(np.dot(normal, direction))
        distance = float(np.dot(normal, np.subtract(plane_origin, origin)))
        if abs(slope) < 1e-12:
            if distance > 0:
                return None
        elif slope > 0:
            entry = max(entry, distance / slope)
        else:
            leave = min(leave, distance / slope)
    if not leave > entry:
        return None
    count = int((leave - entry) * float(np.linalg.norm(step)) * SAMPLES_PER_VOXEL) + 1
    t = entry + (np.arange(count) + 0.5) * (leave - entry) / count
    index = np.rint(start + t[:, None] * step).astype(np.intp)
    np.clip(index, 0, last.astype(np.intp), out=index)
    values = volume.array[index[:, 2], index[:, 1], index[:, 0]].astype(np.float64)
    values[~np.isfinite(values)] = volume.range[0]
    opacity = transfer_function.evaluate(values, volume.range)[:, 3]
    length = (leave - entry) / count / volume.mean_spacing
    transparency = np.cumprod((1 - np.clip(opacity, 0, 1 - 1e-9)) ** length)
    gathered = 1 - transparency
    if gathered[-1] < 1e-3:
        return None
    at = int(np.searchsorted(gathered, SEEN * gathered[-1]))
    i, j, k = (int(v) for v in index[at])
    x, y, z = (float(v) for v in origin + t[at] * direction)
    return Picked((i, j, k), float(values[at]), (x, y, z))


def _ray(
    camera: Camera, position: tuple[float, float], size: tuple[int, int]
) -> tuple[np.ndarray, np.ndarray]:
    """Origin and unit direction of the ray through the middle of a pixel, in the world."""
    width, height = size
    right, up = frame(camera)
    forward = np.asarray(camera.direction)
    u = (2 * (position[0] + 0.5) / width - 1) * width / height
    v = 1 - 2 * (position[1] + 0.5) / height
    eye = np.asarray(camera.position)
    if camera.parallel:
        return eye + camera.scale * (u * right + v * up), forward
    tangent = np.tan(np.radians(camera.view_angle) / 2)
    direction = forward + tangent * (u * right + v * up)
    return eye, direction / np.linalg.norm(direction)
