"""Stepping back when a narrower view would cut off what was seen whole. Arithmetic on values."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from volviz.model.camera import Camera
from volviz_ui.views.camera_moves import frame, zoomed

MARGIN = 1.04
"""A little air at both sides."""


def reach(camera: Camera, points: npt.NDArray[np.float64], aspect: float) -> tuple[float, float]:
    """How far points of shape (N, 3) extend in the picture, across and upwards; 1 is its edge."""
    right, up = frame(camera)
    offsets = points - np.asarray(camera.position)
    if camera.parallel:
        half = np.full(len(points), camera.scale)
    else:
        depth = np.maximum(offsets @ np.asarray(camera.direction), 1e-9 * camera.distance)
        half = depth * np.tan(np.radians(camera.view_angle) / 2)
    across, upwards = np.abs(offsets @ right) / (half * aspect), np.abs(offsets @ up) / half
    return float(across.max()), float(upwards.max())


def fitted(camera: Camera, points: npt.NDArray[np.float64], before: float, after: float) -> Camera:
    """The camera farther away, if points that were all seen at one aspect would not be at another.

    Parameters
    ----------
    before, after : float
        Width divided by height of the picture.
    """
    if max(reach(camera, points, before)) > 1:
        return camera  # the user looks at a part on purpose
    for _ in range(8):
        wide = reach(camera, points, after)[0]
        if wide <= 1:
            return camera
        camera = zoomed(camera, 1 / (wide * MARGIN))
    return camera
