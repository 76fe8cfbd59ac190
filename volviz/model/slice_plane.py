"""Planes on which slices are seen: where they lie, which side one looks at, what is up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.volume_data.vectors import Vector, finite_vector

#: Directions towards the viewer and upwards of the planes of anatomy, in LPS world axes (x to the patient's left, y to
#: the back, z to the head), by the radiological convention: axial slices are seen from the feet, with the patient's
#: left on the right; coronal ones from the front; sagittal ones from the left, with the face to the left.
NAMED_PLANES: dict[str, tuple[Vector, Vector]] = {
    "axial": ((0.0, 0.0, -1.0), (0.0, -1.0, 0.0)),
    "coronal": ((0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
    "sagittal": ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
}
#: The world axis along which `at` counts for the planes of anatomy.
_AXES = {"axial": 2, "coronal": 1, "sagittal": 0}


@dataclass(frozen=True)
class SlicePlane:
    """A plane with a face: a point of it, where the viewer is, and what is up in the picture.

    Attributes
    ----------
    point : tuple of 3 floats
        World point (x, y, z) on it.
    normal : tuple of 3 floats
        Unit vector towards the viewer.
    up : tuple of 3 floats
        Unit vector in the plane, upwards in the picture.
    """

    point: Vector
    normal: Vector
    up: Vector

    @property
    def right(self) -> Vector:
        """Unit vector in the plane, to the right in the picture."""
        x, y, z = np.cross(self.up, self.normal)
        return float(x), float(y), float(z)

    def points(self, size: tuple[int, int], extent: tuple[float, float]) -> npt.NDArray[np.float64]:
        """World positions of the centres of pixels of a picture in the middle of which `point` lies.

        Parameters
        ----------
        size : tuple of 2 ints
            Width and height in pixels.
        extent : tuple of 2 floats
            Width and height of the picture in world units.

        Returns
        -------
        ndarray of shape (H, W, 3), float64
            (x, y, z); row 0 at the top.
        """
        (columns, rows), (width, height) = size, extent
        across = ((np.arange(columns) + 0.5) / columns - 0.5) * width
        upwards = (0.5 - (np.arange(rows) + 0.5) / rows) * height
        return np.asarray(
            np.asarray(self.point)
            + across[None, :, None] * np.asarray(self.right)
            + upwards[:, None, None] * np.asarray(self.up)
        )


def slice_plane(
    plane: str | Sequence[Sequence[float]], at: float | Sequence[float] | None, center: Vector
) -> SlicePlane:
    """A plane as people say it.

    Parameters
    ----------
    plane : str or pair
        "axial", "coronal" or "sagittal" (`NAMED_PLANES`), or two world vectors: the normal, towards the viewer, and up,
        which need not be perpendicular to it.
    at : float, 3 floats or None
        Where it lies: the world coordinate (z of an axial plane, y of a coronal, x of a sagittal one; the distance
        from the world's origin along the normal of any other), in world units, or a world point on it. None = through
        `center`.
    center : tuple of 3 floats
        Middle of what is sliced; a plane that is placed by a number has its point next to this one.

    Raises
    ------
    InputError
        An unknown name, vectors that span no plane, or numbers that are not finite.
    """
    normal, up = _directions(plane)
    middle = np.asarray(center, np.float64)
    if at is None:
        point = middle
    elif np.ndim(at) == 0:
        try:
            distance = float(at)  # type: ignore[arg-type]
        except (TypeError, ValueError):
            distance = np.nan
        if not np.isfinite(distance):
            raise InputError(f"at must be a number or a point of three numbers, got {at!r}.")
        axis = np.eye(3)[_AXES[plane]] if isinstance(plane, str) else normal
        point = middle + (distance - axis @ middle) * axis
    else:
        point = np.asarray(finite_vector(at, "at"))  # type: ignore[arg-type]
    return SlicePlane(_vector(point), _vector(normal), _vector(up))


def _directions(plane: Any) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Perpendicular unit vectors towards the viewer and upwards."""
    if isinstance(plane, str):
        if plane not in NAMED_PLANES:
            raise InputError(
                f"there is no plane {plane!r}; choose {', '.join(NAMED_PLANES)}, or give a normal and what is up."
            )
        first, second = NAMED_PLANES[plane]
    else:
        try:
            first, second = plane
        except (TypeError, ValueError):
            raise InputError(
                f"plane must be {', '.join(NAMED_PLANES)} or two vectors (normal, up), got {plane!r}."
            ) from None
    normal = np.asarray(finite_vector(first, "normal of a plane"))
    up = np.asarray(finite_vector(second, "up of a plane"))
    length = np.linalg.norm(normal)
    if length > 0:
        normal = normal / length
        up = up - (up @ normal) * normal
    rest = np.linalg.norm(up)
    if length == 0 or not rest > 1e-9 * np.linalg.norm(second):
        raise InputError(
            "normal and up of a plane must be two directions that differ; one is zero or both are the same."
        )
    return normal, up / rest


def _vector(values: npt.NDArray[np.float64]) -> Vector:
    x, y, z = (float(v) for v in values)
    return x, y, z
