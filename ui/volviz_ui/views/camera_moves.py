"""How a drag or a turn of the wheel moves the camera or the light: arithmetic on values, no window."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from volviz.model.camera import Camera
from volviz.volume_data.volume import Volume

Vector = tuple[float, float, float]

TURN = 200.0
"""Degrees for a drag over the whole shorter side of the viewport, as people know it from VTK."""

WHEEL_STEP = 1.15
"""Factor of one notch of the wheel."""

AXIS_VIEWS: dict[str, tuple[Vector, Vector]] = {
    "A": ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    "P": ((0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
    "L": ((-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "R": ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "S": ((0.0, 0.0, -1.0), (0.0, -1.0, 0.0)),
    "I": ((0.0, 0.0, 1.0), (0.0, -1.0, 0.0)),
}
"""Viewing direction and up vector for a look from each side of a patient in the LPS world."""


def rotated(camera: Camera, dx: float, dy: float, size: tuple[int, int]) -> Camera:
    """The camera after a drag by (dx right, dy down) pixels: the volume follows the pointer."""
    side = max(min(size), 1)
    return camera.turned(azimuth=-TURN * dx / side, elevation=TURN * dy / side)


def zoomed(camera: Camera, factor: float) -> Camera:
    """The camera nearer by a factor; the focal point stays."""
    if camera.parallel:
        return replace(camera, parallel_scale=camera.scale / factor)
    offset = np.subtract(camera.position, camera.focal_point) / factor
    return replace(camera, position=_vector(np.add(camera.focal_point, offset)))


def zoomed_at(camera: Camera, factor: float, place: tuple[float, float], size: tuple[int, int]) -> Camera:
    """The camera nearer by a factor; what lies at a place (x right, y down, in pixels) stays there.

    That holds at the depth of the focal point.
    """
    share = 1.0 - 1.0 / factor
    dx, dy = place[0] - size[0] / 2, place[1] - size[1] / 2
    return zoomed(panned(camera, -share * dx, -share * dy, size), factor)


def flown(camera: Camera, bounds: tuple[float, float, float, float, float, float]) -> Camera:
    """The camera in front of a world box (x0, x1, y0, y1, z0, z1), which fills about half of the view."""
    low, high = np.array(bounds[::2]), np.array(bounds[1::2])
    center, radius = (low + high) / 2, max(float(np.linalg.norm(high - low)) / 2, 1e-9)
    distance = 2.0 * radius / np.sin(np.radians(camera.view_angle / 2))
    return replace(
        camera,
        position=_vector(center - distance * np.asarray(camera.direction)),
        focal_point=_vector(center),
        parallel_scale=2.0 * radius if camera.parallel else camera.parallel_scale,
    )


def panned(camera: Camera, dx: float, dy: float, size: tuple[int, int]) -> Camera:
    """The camera after the scene was pushed by (dx right, dy down) pixels; the focal point follows."""
    per_pixel = 2 * camera.scale / max(size[1], 1)
    right, up = frame(camera)
    move = per_pixel * (dy * up - dx * right)
    return replace(
        camera,
        position=_vector(np.add(camera.position, move)),
        focal_point=_vector(np.add(camera.focal_point, move)),
    )


def faced_anew(camera: Camera, normal: Vector, up: Vector, about: Vector) -> Camera:
    """The camera straight before another plane: as near as before, with the same point in the same place."""
    right_before, up_before = frame(camera)
    offset = np.subtract(camera.focal_point, about)
    across, upwards = offset @ right_before, offset @ up_before
    focal = np.asarray(about) + across * np.cross(up, normal) + upwards * np.asarray(up)
    position = focal + camera.distance * np.asarray(normal)
    return replace(camera, position=_vector(position), focal_point=_vector(focal), view_up=up)


def point_on_plane(
    camera: Camera, place: tuple[float, float], size: tuple[int, int], through: Vector
) -> Vector:
    """World point behind a place (x right, y down, in pixels) on the plane across the view through another point."""
    per_pixel = 2 * camera.scale / max(size[1], 1)
    right, up = frame(camera)
    dx, dy = place[0] - size[0] / 2, place[1] - size[1] / 2
    point = np.asarray(camera.focal_point) + per_pixel * (dx * right - dy * up)
    direction = np.asarray(camera.direction)
    return _vector(point + ((np.asarray(through) - point) @ direction) * direction)


def axis_camera(volume: Volume, letter: str, aspect: float) -> Camera:
    """The view along an axis of the world, named by the side from which one looks."""
    direction, view_up = AXIS_VIEWS[letter]
    return Camera.fit(volume.corners, direction=direction, view_up=view_up, aspect=aspect)


def light_turned(
    position: Vector, center: Vector, camera: Camera, dx: float, dy: float, size: tuple[int, int]
) -> Vector:
    """The light after a drag: it turns around the volume, at the same distance."""
    side = max(min(size), 1)
    right, up = frame(camera)
    offset = np.subtract(position, center)
    offset = rotate(offset, up, TURN * dx / side)
    offset = rotate(offset, right, TURN * dy / side)
    return _vector(np.add(center, offset))


def light_moved(position: Vector, center: Vector, factor: float, radius: float) -> Vector:
    """The light nearer (factor above 1) or farther, between half a radius and twenty radii of the volume."""
    offset = np.subtract(position, center)
    distance = float(np.linalg.norm(offset)) or radius
    wanted = min(max(distance / factor, 0.5 * radius), 20.0 * radius)
    return _vector(np.add(center, offset / distance * wanted))


def frame(camera: Camera) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors to the right and up in the image."""
    direction = np.asarray(camera.direction)
    right = np.cross(direction, camera.view_up)
    right /= np.linalg.norm(right)
    return right, np.cross(right, direction)


def rotate(vector: np.ndarray, axis: np.ndarray, degrees: float) -> np.ndarray:
    """A vector turned about a unit axis, counter-clockwise when the axis points at the eye."""
    angle = np.radians(degrees)
    along = axis * (vector @ axis)
    across = vector - along
    return along + np.cos(angle) * across + np.sin(angle) * np.cross(axis, across)


def _vector(values: np.ndarray) -> Vector:
    x, y, z = (float(v) for v in values)
    return x, y, z
