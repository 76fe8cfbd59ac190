"""The camera as a value."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.volume_data.vectors import Vector, finite_vector

#: The near plane lies no nearer than this share of the distance of the far plane.
NEAREST = 0.001


@dataclass(frozen=True)
class Camera:
    """Where the eye is and what it sees.

    Attributes
    ----------
    position, focal_point, view_up : tuple of 3 floats
        World coordinates (x, y, z) and an up direction.
    view_angle : float
        Full vertical angle of view in degrees, 1..170.
    parallel : bool
        Parallel projection instead of perspective.
    parallel_scale : float or None
        Half the height of the view in world units (parallel projection); None derives it from the view angle
        at the focal point.
    """

    position: Vector
    focal_point: Vector
    view_up: Vector = (0.0, 0.0, 1.0)
    view_angle: float = 30.0
    parallel: bool = False
    parallel_scale: float | None = None

    def __post_init__(self) -> None:
        for name in ("position", "focal_point", "view_up"):
            object.__setattr__(self, name, finite_vector(getattr(self, name), f"{name} of a camera"))
        if not 1 <= self.view_angle <= 170:
            raise InputError(f"view_angle must lie between 1 and 170 degrees, got {self.view_angle:g}.")
        if self.position == self.focal_point:
            raise InputError("camera position and focal point are the same point; move one of them.")
        across = np.cross(np.subtract(self.focal_point, self.position), self.view_up)
        if not np.linalg.norm(across) > 1e-9 * self.distance * np.linalg.norm(self.view_up):
            raise InputError("view_up lies along the view or is zero; give a direction across it.")
        if self.parallel_scale is not None and not self.parallel_scale > 0:
            raise InputError(f"parallel_scale must be greater than 0, got {self.parallel_scale!r}.")

    @property
    def direction(self) -> Vector:
        """Unit vector from the eye to the focal point."""
        d = np.subtract(self.focal_point, self.position)
        x, y, z = d / np.linalg.norm(d)
        return float(x), float(y), float(z)

    @property
    def distance(self) -> float:
        """World distance from the eye to the focal point."""
        return float(np.linalg.norm(np.subtract(self.focal_point, self.position)))

    @property
    def scale(self) -> float:
        """Half the height of the view at the focal point, in world units."""
        if self.parallel_scale is not None:
            return self.parallel_scale
        return self.distance * float(np.tan(np.radians(self.view_angle) / 2))

    def turned(self, azimuth: float = 0.0, elevation: float = 0.0) -> Camera:
        """The camera moved around the focal point, in degrees: azimuth about view up, then elevation."""
        offset = np.subtract(self.position, self.focal_point)
        up = np.asarray(self.view_up) / np.linalg.norm(self.view_up)
        offset = _rotation(up, azimuth) @ offset
        right = np.cross(-offset, up)
        norm = np.linalg.norm(right)
        if norm > 1e-12:
            turn = _rotation(right / norm, -elevation)
            offset, up = turn @ offset, turn @ up
        return replace(
            self,
            position=_vector(np.add(self.focal_point, offset)),
            view_up=_vector(up),
        )

    def rotated(self, axis: Vector, degrees: float) -> Camera:
        """The camera moved around an axis through the focal point, by the right-hand rule; what is up turns with it.

        Parameters
        ----------
        axis : tuple of 3 floats
            Unit vector in the world.
        degrees : float
        """
        turn = _rotation(np.asarray(axis), degrees)
        offset = turn @ np.subtract(self.position, self.focal_point)
        return replace(
            self,
            position=_vector(np.add(self.focal_point, offset)),
            view_up=_vector(turn @ np.asarray(self.view_up)),
        )

    def clipping_range(self, points: npt.NDArray[np.float64]) -> tuple[float, float]:
        """World distances of a near and a far plane that hold all points, by the rule of VTK's renderers.

        Parameters
        ----------
        points : ndarray of shape (N, 3)
            World points, the corners of the visible boxes.
        """
        depths = (points - np.asarray(self.position)) @ np.asarray(self.direction)
        near, far = float(depths.min()), max(float(depths.max()), 1e-18)
        # flat things get some depth
        least = 0.1 * self.scale if self.parallel else 0.2 * math.tan(math.radians(self.view_angle) / 2) * far
        missing = max(least - (far - near), 0.0)
        near, far = max(near - missing / 2, 0.0), far + missing / 2
        room = 0.5 * (far - near)
        near, far = 0.99 * near - room, 1.01 * far + 0.5 * (far - (0.99 * near - room))
        return max(near, NEAREST * far), far

    def matrices(
        self, aspect: float, clipping_range: tuple[float, float]
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """View and projection matrix in the conventions of OpenGL, for column vectors.

        Parameters
        ----------
        aspect : float
            Width / height of the view.
        clipping_range : tuple of 2 floats
            World distances of the near and the far plane from the eye.

        Returns
        -------
        view, projection : ndarray of shape (4, 4)
            World to eye space, and eye to clip space (z in -1..1).
        """
        forward = np.asarray(self.direction)
        right = np.cross(forward, self.view_up)
        right /= np.linalg.norm(right)
        view = np.eye(4)
        view[:3, :3] = right, np.cross(right, forward), -forward
        view[:3, 3] = -view[:3, :3] @ np.asarray(self.position)
        near, far = clipping_range
        projection = np.zeros((4, 4))
        if self.parallel:
            projection[0, 0], projection[1, 1] = 1.0 / (self.scale * aspect), 1.0 / self.scale
            projection[2, 2:] = -2.0 / (far - near), -(far + near) / (far - near)
            projection[3, 3] = 1.0
        else:
            slope = math.tan(math.radians(self.view_angle) / 2)
            projection[0, 0], projection[1, 1] = 1.0 / (slope * aspect), 1.0 / slope
            projection[2, 2:] = -(far + near) / (far - near), -2.0 * far * near / (far - near)
            projection[3, 2] = -1.0
        return view, projection

    @classmethod
    def coerce(cls, value: Any) -> Camera:
        """A camera from a `Camera` or a pyvista ``camera_position`` triple (position, focal point, up)."""
        if isinstance(value, Camera):
            return value
        try:
            position, focal_point, view_up = (_vector(part) for part in value)
        except (TypeError, ValueError):
            raise InputError(
                "camera must be a volviz.Camera or three triples (position, focal point, view up), "
                f"got {value!r}."
            ) from None
        return cls(position, focal_point, view_up)

    @classmethod
    def fit(
        cls,
        corners: npt.NDArray[np.float64],
        *,
        direction: Sequence[float] = (0.0, 1.0, 0.0),
        view_up: Sequence[float] = (0.0, 0.0, 1.0),
        view_angle: float = 30.0,
        aspect: float = 1.0,
        fill: float = 0.92,
    ) -> Camera:
        """The camera that looks along `direction` and just holds all `corners`.

        Parameters
        ----------
        corners : ndarray of shape (N, 3)
            World points that must be visible.
        direction : tuple of 3 floats
            Viewing direction; the default looks from anterior to posterior in LPS, at a patient's face.
        aspect : float
            Width / height of the view.
        fill : float
            Fraction of the view that the points may fill, 0..1.
        """
        d = np.asarray(direction, float)
        d /= np.linalg.norm(d)
        up = np.asarray(view_up, float)
        right = np.cross(d, up)
        right /= np.linalg.norm(right)
        up = np.cross(right, d)
        center = (corners.min(axis=0) + corners.max(axis=0)) / 2
        local = corners - center
        tan_y = np.tan(np.radians(view_angle) / 2) * fill
        tan_x = tan_y * aspect
        depth = local @ d
        distance = float(
            max(np.max(np.abs(local @ right) / tan_x - depth), np.max(np.abs(local @ up) / tan_y - depth))
        )
        return cls(_vector(center - distance * d), _vector(center), _vector(up), view_angle)


def _vector(values: Any) -> Vector:
    x, y, z = (float(v) for v in values)
    return x, y, z


def _rotation(axis: npt.NDArray[np.float64], degrees: float) -> npt.NDArray[np.float64]:
    """Rotation matrix about a unit axis (Rodrigues 1840)."""
    angle = np.radians(degrees)
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross))
