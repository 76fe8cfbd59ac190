"""Light and material-independent lighting values."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.errors import InputError
from volviz.volume_data.vectors import Vector, finite_vector

Color = tuple[float, float, float]


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

    Raises
    ------
    InputError
        A position or colour that is not three usable numbers.
    """

    headlight: bool = True
    position: Vector | None = None
    color: Color = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        if self.position is not None:
            object.__setattr__(self, "position", finite_vector(self.position, "the position of a light"))
        object.__setattr__(self, "color", finite_vector(self.color, "the colour of a light"))
        if not all(0.0 <= part <= 1.0 for part in self.color):
            raise InputError(f"the colour of a light needs parts between 0 and 1, got {self.color}.")


def default_position(bounds: tuple[float, float, float, float, float, float]) -> Vector:
    """A light position that is outside any box with these bounds and lights it from a corner.

    Parameters
    ----------
    bounds : tuple of 6 floats
        World bounds (x0, x1, y0, y1, z0, z1).
    """
    x0, x1, y0, y1, z0, z1 = bounds
    radius = 0.5 * ((x1 - x0) ** 2 + (y1 - y0) ** 2 + (z1 - z0) ** 2) ** 0.5
    distance = 2.5 * radius
    # a direction off all axes, so that no face of the box is lit at a grazing angle only
    ux, uy, uz = -0.48, -0.62, 0.62
    return (x0 + x1) / 2 + distance * ux, (y0 + y1) / 2 + distance * uy, (z0 + z1) / 2 + distance * uz
