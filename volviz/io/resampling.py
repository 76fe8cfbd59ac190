"""Lattices whose axes are not at right angles (a tilted gantry, say), resampled onto rectangular ones."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.geometry import Geometry, vector

if TYPE_CHECKING:
    import numpy.typing as npt


def rectangular(array: npt.NDArray[Any], geometry: Geometry) -> tuple[npt.NDArray[Any], Geometry]:
    """The same volume on a lattice with axes at right angles, by trilinear interpolation.

    The plane of the first two axes stays, with the first axis as it is; the third one becomes its normal. Spacings are
    the distances of the sheared lattice's rows, columns and slices; the box is just large enough for all of it. What
    lies outside of the sheared lattice gets the lowest value of the data, air in a CT.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
    geometry : Geometry
        Where it lies; its direction may be sheared by any angle below 90 degrees.

    Returns
    -------
    ndarray of shape (Z', Y', X'), Geometry
        In the type of `array`; whole numbers are rounded.
    """
    from scipy.ndimage import affine_transform

    direction = np.asarray(geometry.direction).reshape(3, 3)
    steps = direction * np.asarray(geometry.spacing)
    axes, _ = np.linalg.qr(direction)
    # QR leaves the sign of each axis open
    axes = axes * np.sign(np.sum(axes * direction, axis=0))
    spacing = np.abs(np.sum(axes * steps, axis=0))
    last = np.array(array.shape[::-1]) - 1
    bits = np.array([[c & 1, c >> 1 & 1, c >> 2 & 1] for c in range(8)])
    corners = (bits * last) @ steps.T @ axes / spacing
    low, high = np.floor(corners.min(axis=0) + 1e-6), np.ceil(corners.max(axis=0) - 1e-6)
    count = (high - low).astype(int) + 1
    origin = np.asarray(geometry.origin) + axes @ (low * spacing)
    to_old = np.linalg.inv(steps)
    matrix = to_old @ (axes * spacing)
    offset = to_old @ (origin - np.asarray(geometry.origin))
    lowest = float(np.nanmin(array)) if array.dtype.kind == "f" else int(array.min())
    result = affine_transform(
        array, matrix[::-1, ::-1], offset[::-1], tuple(count[::-1].tolist()), order=1, mode="constant",
        cval=lowest, output=np.float32 if array.dtype.itemsize <= 2 else np.float64,
    )  # fmt: skip
    values = np.rint(result) if array.dtype.kind in "ui" else result
    placed = Geometry(vector(spacing), vector(origin), tuple(float(v) for v in axes.flat))
    return values.astype(array.dtype), placed
