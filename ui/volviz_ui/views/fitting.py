"""Moves the camera back when a view becomes narrower, so that a volume that was fully visible stays so.

Arithmetic on cameras and points, without a window.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from volviz.model.camera import Camera
from volviz_ui.views.camera_moves import frame, zoomed

MARGIN = 1.04
"""Space left at both sides, as a factor of the width that the points need."""


def reach(camera: Camera, points: npt.NDArray[np.float64], aspect: float) -> tuple[float, float]:
    """Largest distance of points, shape (N, 3), from the middle of the image, across and upwards; 1 is its edge."""
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
    """The camera, moved back until points that were all visible at the old aspect ratio are so at the new one.

    A camera that did not show all points before is returned unchanged: the user looks at a part on purpose.

    Parameters
    ----------
    before, after : float
        Width divided by height of the image.
    """
    if max(reach(camera, points, before)) > 1:
        return camera
    for _ in range(8):
        wide = reach(camera, points, after)[0]
        if wide <= 1:
            return camera
        camera = zoomed(camera, 1 / (wide * MARGIN))
    return camera
