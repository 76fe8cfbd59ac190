"""The cut plane that is shown when none has been chosen."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from volviz.model.camera import Camera

Vector = tuple[float, float, float]

#: The view that the plane faces: degrees about the upright axis and above the horizon, from the front. The
#: first view of a volume is the same (`volviz.custom_gl.framing.default_camera`).
AZIMUTH, ELEVATION = -30.0, 15.0


def default_cut_plane(corners: npt.NDArray[np.float64]) -> tuple[Vector, Vector]:
    """Origin and normal of the plane through the middle of a box that faces the first view of it.

    Parameters
    ----------
    corners : ndarray of shape (8, 3)
        World corners of the (cropped) box.

    Returns
    -------
    origin, normal : tuple of 3 floats
        World point, and unit vector towards the eye.
    """
    x, y, z = (float(v) for v in (corners.min(axis=0) + corners.max(axis=0)) / 2)
    dx, dy, dz = Camera.fit(corners).turned(AZIMUTH, ELEVATION).direction
    return (x, y, z), (-dx, -dy, -dz)
