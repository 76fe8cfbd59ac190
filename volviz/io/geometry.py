"""Where a lattice lies: affine matrices to spacing, origin and direction; RAS to LPS."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

Vector = tuple[float, float, float]

#: Turns RAS world coordinates (x to the right, y to anterior) into LPS (x to the left, y to posterior), and
#: back.
RAS_TO_LPS = np.diag([-1.0, -1.0, 1.0])


@dataclass(frozen=True)
class Geometry:
    """Spacing, origin and direction as `Volume` takes them; world frame LPS.

    Attributes
    ----------
    spacing, origin : tuple of 3 floats
        (x, y, z).
    direction : tuple of 9 floats
        Row by row; the columns are the world directions of the index axes i, j, k.
    """

    spacing: Vector = (1.0, 1.0, 1.0)
    origin: Vector = (0.0, 0.0, 0.0)
    direction: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)

    @classmethod
    def from_affine(cls, affine: npt.ArrayLike) -> Geometry:
        """Split an affine matrix.

        Parameters
        ----------
        affine : array_like of shape (4, 4) or (3, 4)
            Index (i, j, k, 1) to world (x, y, z), LPS.

        Raises
        ------
        ValueError
            Not finite, or an axis without length.
        """
        matrix = np.asarray(affine, np.float64)[:3]
        # numbers of a damaged file may be too large to be squared
        with np.errstate(over="ignore", invalid="ignore"):
            spacing = np.linalg.norm(matrix[:, :3], axis=0)
        if not np.all(np.isfinite(matrix)) or not np.all(np.isfinite(spacing)) or spacing.min() <= 0:
            raise ValueError("an axis has no length")
        return cls(
            vector(spacing), vector(matrix[:, 3]), tuple(float(v) for v in (matrix[:, :3] / spacing).flat)
        )


def vector(values: Any) -> Vector:
    """Three plain floats."""
    x, y, z = (float(v) for v in values)
    return x, y, z


def is_usable(matrix: npt.NDArray[np.float64]) -> bool:
    """Whether a 3 x 3 matrix is finite and its three axes span space."""
    if not np.all(np.isfinite(matrix)):
        return False
    with np.errstate(over="ignore", invalid="ignore"):
        lengths = np.linalg.norm(matrix, axis=0)
    return bool(
        np.all(np.isfinite(lengths)) and lengths.min() > 0 and abs(np.linalg.det(matrix / lengths)) > 1e-6
    )
