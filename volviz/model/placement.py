"""Where a layer lies: a move and a turn about its middle as a 4 x 4 matrix, and back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from volviz.model.layers import Transform

Vector = tuple[float, float, float]
Matrix = npt.NDArray[np.float64]
#: How far a matrix may be from a turn, as rounding leaves it.
_RIGID = 1e-6


@dataclass(frozen=True)
class Placement:
    """How a layer is moved from where its file says.

    Attributes
    ----------
    move : tuple of 3 floats
        Along the axes x, y, z of the world, in its units.
    turn : tuple of 3 floats
        About these axes through the middle of the volume, x first, in degrees.
    stretch : 3 x 3 matrix as rows
        What comes before the turn; the identity of a matrix that only moves and turns.
    """

    move: Vector = (0.0, 0.0, 0.0)
    turn: Vector = (0.0, 0.0, 0.0)
    stretch: tuple[Vector, Vector, Vector] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

    @classmethod
    def of(cls, transform: Transform | None, center: Sequence[float]) -> Placement:
        """The move and turn of a matrix (None is none) about the middle of a volume."""
        if transform is None:
            return cls()
        matrix, middle = np.array(transform), np.asarray(center, float)
        linear = matrix[:3, :3]
        x, y, z = (matrix[:3, 3] - middle + linear @ middle).tolist()
        rigid = np.allclose(linear @ linear.T, np.eye(3), atol=_RIGID) and np.linalg.det(linear) > 0
        if not rigid:
            a, b, c = (tuple(row) for row in linear.tolist())
            return cls((x, y, z), (0.0, 0.0, 0.0), (a, b, c))
        # imported where it is needed: a start of the program does not wait for SciPy
        from scipy.spatial.transform import Rotation

        u, v, w = Rotation.from_matrix(linear).as_euler("xyz", degrees=True).tolist()
        return cls((x, y, z), (u, v, w))

    def transform(self, center: Sequence[float]) -> Transform | None:
        """The matrix; None where nothing is moved."""
        if self == Placement():
            return None
        middle = np.asarray(center, float)
        from scipy.spatial.transform import Rotation

        linear = Rotation.from_euler("xyz", self.turn, degrees=True).as_matrix() @ np.array(self.stretch)
        matrix: Matrix = np.eye(4)
        matrix[:3, :3] = linear
        matrix[:3, 3] = np.asarray(self.move) + middle - linear @ middle
        a, b, c, d = (tuple(row) for row in matrix.tolist())
        return a, b, c, d
