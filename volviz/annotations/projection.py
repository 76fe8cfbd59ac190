"""Where world points lie in a picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from volviz.model.camera import Camera

Floats = npt.NDArray[np.float64]
#: Share of the distance of the focal point at which lines are cut off before the eye.
NEAR = 1e-3


@dataclass(frozen=True)
class Projection:
    """A camera and the size of its picture.

    Attributes
    ----------
    camera : Camera
    size : tuple of 2 ints
        Width and height in pixels.
    """

    camera: Camera
    size: tuple[int, int]

    @property
    def axes(self) -> Floats:
        """Unit vectors to the right, upwards and towards the viewer, as rows, shape (3, 3)."""
        forward = np.asarray(self.camera.direction)
        right = np.cross(forward, self.camera.view_up)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(right, forward), -forward])

    def pixels(self, points: npt.ArrayLike) -> Floats:
        """Pixels of world points, shape (N, 2); those behind the eye are no numbers."""
        width, height = self.size
        x, y, toward = ((np.asarray(points, float) - self.camera.position) @ self.axes.T).T
        if self.camera.parallel:
            scale: Floats | float = height / (2.0 * self.camera.scale)
        else:
            slope = np.tan(np.radians(self.camera.view_angle) / 2)
            depth = np.where(-toward > NEAR * self.camera.distance, -toward, np.nan)
            scale = height / (2.0 * slope * depth)
        return np.stack([width / 2 + x * scale, height / 2 - y * scale], axis=1)

    def cut(self, start: npt.ArrayLike, end: npt.ArrayLike) -> tuple[Floats, Floats] | None:
        """The part of a world line that lies before the eye; None when nothing does."""
        a, b = np.asarray(start, float), np.asarray(end, float)
        if self.camera.parallel:
            return a, b
        forward = np.asarray(self.camera.direction)
        near = 1.01 * NEAR * self.camera.distance
        da, db = (a - self.camera.position) @ forward - near, (b - self.camera.position) @ forward - near
        if da < 0 and db < 0:
            return None
        if da < 0:
            a = a + (b - a) * (da / (da - db))
        elif db < 0:
            b = b + (a - b) * (db / (db - da))
        return a, b

    def faces_eye(self, point: npt.ArrayLike, normal: npt.ArrayLike) -> bool:
        """Whether a face with an outward normal is seen from the eye."""
        toward = (
            -np.asarray(self.camera.direction)
            if self.camera.parallel
            else self.camera.position - np.asarray(point)
        )
        return bool(toward @ np.asarray(normal) > 0)

    @property
    def pixel_length(self) -> float:
        """World length of a pixel, at the focal point."""
        return 2.0 * self.camera.scale / self.size[1]
