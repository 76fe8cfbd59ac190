"""Lattices whose axes are not at right angles (a tilted gantry, say), resampled onto rectangular ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.geometry import Geometry, vector

if TYPE_CHECKING:
    import numpy.typing as npt


@dataclass(frozen=True)
class Rectangular:
    """The rectangular lattice that takes the place of a sheared one.

    The plane of the first two axes stays, with the first axis as it is; the third one becomes its normal. Spacings are
    the distances of the sheared lattice's rows, columns and slices; the box is just large enough for all of it.

    Attributes
    ----------
    dimensions : tuple of 3 ints
        Number of voxels along (x, y, z).
    geometry : Geometry
    matrix, offset : ndarray of shape (3, 3), (3,)
        From its indices (i, j, k) to those of the sheared lattice.
    """

    dimensions: tuple[int, int, int]
    geometry: Geometry
    matrix: npt.NDArray[np.float64]
    offset: npt.NDArray[np.float64]

    @classmethod
    def around(cls, dimensions: tuple[int, int, int], sheared: Geometry) -> Rectangular:
        """The lattice around a sheared one with so many voxels along (x, y, z), sheared by less than 90 degrees."""
        direction = np.asarray(sheared.direction).reshape(3, 3)
        steps = direction * np.asarray(sheared.spacing)
        axes, _ = np.linalg.qr(direction)
        # QR leaves the sign of each axis open
        axes = axes * np.sign(np.sum(axes * direction, axis=0))
        spacing = np.abs(np.sum(axes * steps, axis=0))
        bits = np.array([[c & 1, c >> 1 & 1, c >> 2 & 1] for c in range(8)])
        corners = (bits * (np.array(dimensions) - 1)) @ steps.T @ axes / spacing
        low, high = np.floor(corners.min(axis=0) + 1e-6), np.ceil(corners.max(axis=0) - 1e-6)
        x, y, z = ((high - low).astype(int) + 1).tolist()
        origin = np.asarray(sheared.origin) + axes @ (low * spacing)
        placed = Geometry(vector(spacing), vector(origin), tuple(float(v) for v in axes.flat))
        back = np.linalg.inv(steps)
        return cls((x, y, z), placed, back @ (axes * spacing), back @ (origin - np.asarray(sheared.origin)))

    def resampled(self, array: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Values of the sheared lattice, shape (Z, Y, X), on this one, by trilinear interpolation.

        What lies outside of the sheared lattice gets the lowest value of the data, air in a CT. The type stays; whole
        numbers are rounded.
        """
        from scipy.ndimage import affine_transform

        finite = array[np.isfinite(array)] if array.dtype.kind == "f" else array
        lowest = finite.min() if finite.size else 0
        result: npt.NDArray[Any] = affine_transform(
            array, self.matrix[::-1, ::-1], self.offset[::-1], self.dimensions[::-1], order=1, mode="constant",
            cval=float(lowest), output=np.float32 if array.dtype.itemsize <= 2 else np.float64,
        )  # fmt: skip
        values: npt.NDArray[Any] = np.rint(result) if array.dtype.kind in "ui" else result
        return values.astype(array.dtype)
