"""A smooth path of the camera through several places."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from volviz.model.camera import Camera


class CameraPath:
    """Passes through cameras at given moments: the focal point on a curve, turns without a jerk.

    Orientations are those of a rotation spline with continuous acceleration, distances and scales change by factors,
    and curves do not leave the range of neighbouring places (Fritsch and Carlson 1980). Between two cameras alone the
    turn is the shortest one, at even speed.

    Parameters
    ----------
    cameras : sequence of Camera
        At least two.
    moments : sequence of float, optional
        When each is reached, rising; the default is evenly from 0 to 1.
    """

    def __init__(self, cameras: Sequence[Camera], moments: Sequence[float] | None = None) -> None:
        from scipy.interpolate import PchipInterpolator
        from scipy.spatial.transform import Rotation, RotationSpline, Slerp

        self._cameras = tuple(cameras)
        self._moments = np.linspace(0.0, 1.0, len(cameras)) if moments is None else np.asarray(moments, float)
        frames = Rotation.from_matrix([_frame(camera) for camera in cameras])
        self._turns: Any = (Slerp if len(cameras) == 2 else RotationSpline)(self._moments, frames)
        self._numbers = PchipInterpolator(self._moments, [_numbers(camera) for camera in cameras])

    def at(self, moment: float) -> Camera:
        """The camera at a moment between the first and the last."""
        moment = float(np.clip(moment, self._moments[0], self._moments[-1]))
        reached = np.flatnonzero(self._moments == moment)
        if len(reached):
            return self._cameras[int(reached[0])]
        x, y, z, log_distance, log_scale, angle = self._numbers(moment)
        _right, up, back = self._turns(moment).as_matrix().T
        nearest = self._cameras[int(np.argmin(np.abs(self._moments - moment)))]
        focal = np.array([x, y, z])
        scaled = any(camera.parallel_scale is not None for camera in self._cameras)
        camera: Camera = replace(
            nearest,
            position=tuple((focal + np.exp(log_distance) * back).tolist()),
            focal_point=tuple(focal.tolist()),
            view_up=tuple(up.tolist()),
            view_angle=float(angle),
            parallel_scale=float(np.exp(log_scale)) if scaled else None,
        )
        return camera


def _frame(camera: Camera) -> Any:
    """Right, up and backwards as columns of a rotation matrix."""
    back = -np.asarray(camera.direction)
    right = np.cross(camera.view_up, back)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(back, right), back], axis=1)


def _numbers(camera: Camera) -> list[float]:
    return [*camera.focal_point, np.log(camera.distance), np.log(camera.scale), camera.view_angle]
