"""Light and material-independent lighting values."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.volume_data.vectors import Vector, finite_vector

Color = tuple[float, float, float]

#: Distance of a light that nobody has placed from the middle of a box, in halves of its diagonal.
DISTANCE = 2.5


@dataclass(frozen=True)
class Light:
    """One light, shared by all views of a scene.

    Attributes
    ----------
    headlight : bool
        The light sits at the eye and `position` is ignored.
    position : tuple of 3 floats or None
        World position. None places it above and to the left of the first view, outside the volume's box
        (see `default_position`).
    color : tuple of 3 floats
        Red, green, blue in 0..1.
    beside_eye : bool
        The light keeps its place at the upper left of the eye while the camera turns, and `position` is ignored
        (see `position_beside_eye`); it needs a light that is no headlight.

    Raises
    ------
    InputError
        A position or colour that is not three usable numbers.
    """

    headlight: bool = True
    position: Vector | None = None
    color: Color = (1.0, 1.0, 1.0)
    beside_eye: bool = False

    def __post_init__(self) -> None:
        if self.position is not None:
            object.__setattr__(self, "position", finite_vector(self.position, "the position of a light"))
        object.__setattr__(self, "color", finite_vector(self.color, "the colour of a light"))
        if not all(0.0 <= part <= 1.0 for part in self.color):
            raise InputError(f"the colour of a light needs parts between 0 and 1, got {self.color}.")


#: The light of what is lit as long as nobody has placed one.
FROM_UPPER_LEFT = Light(headlight=False, beside_eye=True)
#: From the middle of what is lit towards a light beside the eye: shares along left, up and back to the eye.
TOWARDS_UPPER_LEFT = (0.5, 0.6, 1.0)


def position_beside_eye(bounds: tuple[float, ...], world_to_eye: npt.NDArray[np.float64]) -> Vector:
    """Where a light at the upper left of the eye stands, far enough outside a box to light it evenly.

    Parameters
    ----------
    bounds : tuple of 6 floats
        World bounds (x0, x1, y0, y1, z0, z1) of what is lit.
    world_to_eye : ndarray of shape (4, 4)
        View matrix; its rows are the directions to the right, upwards and backwards.
    """
    low, high = np.array(bounds[::2]), np.array(bounds[1::2])
    left, up, back = -world_to_eye[0, :3], world_to_eye[1, :3], world_to_eye[2, :3]
    way = sum(share * axis for share, axis in zip(TOWARDS_UPPER_LEFT, (left, up, back), strict=True))
    distance = DISTANCE * 0.5 * float(np.linalg.norm(high - low))
    x, y, z = (low + high) / 2 + distance * way / np.linalg.norm(way)
    return float(x), float(y), float(z)


def default_position(bounds: tuple[float, float, float, float, float, float]) -> Vector:
    """A light position that is outside any box with these bounds and lights it from a corner.

    Parameters
    ----------
    bounds : tuple of 6 floats
        World bounds (x0, x1, y0, y1, z0, z1).
    """
    x0, x1, y0, y1, z0, z1 = bounds
    radius = 0.5 * ((x1 - x0) ** 2 + (y1 - y0) ** 2 + (z1 - z0) ** 2) ** 0.5
    distance = DISTANCE * radius
    # a direction off all axes, so that no face of the box is lit at a grazing angle only
    ux, uy, uz = -0.48, -0.62, 0.62
    return (x0 + x1) / 2 + distance * ux, (y0 + y1) / 2 + distance * uy, (z0 + z1) / 2 + distance * uz
