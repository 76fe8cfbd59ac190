"""Labels of the float64 oracle: to which label a point belongs, and where a ray crosses from one to another.

The indicator of a label is 1 at its voxels and 0 elsewhere, linear between voxel centres. A point belongs to the label
with the largest indicator; between two labels that is where their indicators pass one half. So surfaces are smooth
without a mesh, and labels that touch leave no gap. The normal is the gradient of the indicator, smoothed over
`NORMAL_RADIUS` voxels: that of the linear one itself is rough.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from volviz.reference.rays import box_interval, index_limits
from volviz.reference.sampling import Float64Array

#: Voxels around a point that decide over its normal; the weight is 1 - (distance / radius)^2.
NORMAL_RADIUS = 3.0
#: Halvings of the interval in which a ray crosses a border.
BISECTIONS = 40

Indices = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class ReferenceLabels:
    """Labels on a lattice of their own and how they are seen.

    Attributes
    ----------
    indices : ndarray of shape (Z, Y, X), integers
        For each voxel the row of its label in `palette`.
    index_to_world : ndarray of shape (4, 4)
        From continuous index (i, j, k, 1) to the place where the layer is shown.
    palette : ndarray of shape (n, 4)
        Colour and opacity of the surface of each label; opacity 0 = it is not shown.
    smooth : bool
        Borders as described above; False: along voxels.
    mode : {"add", "mask"}
        Surfaces are seen; image layers are seen only within labels that are shown.
    crop : tuple of 6 floats, optional
        (i0, i1, j0, j1, k0, k1) in continuous indices of the lattice.
    """

    indices: npt.NDArray[Any]
    index_to_world: Float64Array
    palette: Float64Array
    smooth: bool = True
    mode: Literal["add", "mask"] = "add"
    crop: tuple[float, ...] | None = None

    @cached_property
    def to_index(self) -> Float64Array:
        """From the world to continuous index, shape (4, 4)."""
        return np.asarray(np.linalg.inv(self.index_to_world))

    def interval(self, starts: Float64Array, directions: Float64Array) -> tuple[Float64Array, Float64Array]:
        """Lengths along rays between which they are in its box."""
        m = self.to_index[:3, :3].T
        limits = index_limits(self.indices.shape, self.crop)
        return box_interval(starts @ m + self.to_index[:3, 3], directions @ m, limits)

    def index_of(self, points: Float64Array) -> Float64Array:
        """Continuous indices (i, j, k) of world points, shape (n, 3)."""
        return np.asarray(points @ self.to_index[:3, :3].T + self.to_index[:3, 3])

    def _voxel(self, index: npt.NDArray[Any]) -> Indices:
        last = np.array(self.indices.shape[::-1]) - 1
        i, j, k = np.clip(index, 0, last).T
        return np.asarray(self.indices[k, j, i], np.int64)

    def at(self, index: Float64Array) -> Indices:
        """Rows of the palette of the labels to which continuous indices belong, shape (n,)."""
        if not self.smooth:
            return self._voxel(np.floor(index + 0.5).astype(int))
        first = np.floor(index).astype(int)
        part = index - first
        corners, weights = [], []
        for c in range(8):
            offset = np.array([c & 1, c >> 1 & 1, c >> 2 & 1])
            corners.append(self._voxel(first + offset))
            weights.append(np.where(offset, part, 1.0 - part).prod(axis=1))
        found, most = corners[0], np.full(len(index), -1.0)
        for label in corners:
            share = sum(
                np.where(other == label, weight, 0.0) for other, weight in zip(corners, weights, strict=True)
            )
            found, most = np.where(share > most, label, found), np.maximum(share, most)
        return found

    def gradient(self, index: Float64Array, labels: Indices) -> Float64Array:
        """World gradients of the smoothed indicators of labels at continuous indices, shape (n, 3), of any length."""
        first = np.floor(index).astype(int)
        slope = np.zeros_like(index)
        reach = range(1 - int(NORMAL_RADIUS), 1 + int(NORMAL_RADIUS))
        for offset in ((i, j, k) for k in reach for j in reach for i in reach):
            away = first + np.array(offset) - index
            weight = np.clip(1.0 - (away**2).sum(axis=1) / NORMAL_RADIUS**2, 0.0, None)
            slope += (np.where(self._voxel(first + np.array(offset)) == labels, weight, 0.0))[:, None] * away
        return np.asarray(slope @ self.to_index[:3, :3])

    def is_shown(self, labels: Indices) -> npt.NDArray[np.bool_]:
        """Whether labels are shown."""
        return np.asarray(self.palette[labels, 3] > 0)


def first_border(
    layer: ReferenceLabels,
    starts: Float64Array,
    directions: Float64Array,
    begin: Float64Array,
    end: Float64Array,
    before: Indices,
    after: Indices,
) -> tuple[Float64Array, Indices]:
    """Where rays cross into the label that they reach or, when that is not shown, out of the one that they leave.

    Parameters
    ----------
    layer : ReferenceLabels
    starts, directions : ndarray of shape (n, 3)
        World points and unit vectors of the rays.
    begin, end : ndarray of shape (n,)
        World lengths between which they cross.
    before, after : ndarray of shape (n,)
        Labels there.

    Returns
    -------
    lengths : ndarray of shape (n,)
        World lengths of the borders.
    labels : ndarray of shape (n,)
        To which label the surface belongs: `after` where that is shown, else `before`.
    """
    entering = layer.is_shown(after)
    owner = np.where(entering, after, before)
    low, high = begin.copy(), end.copy()
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        found = layer.at(layer.index_of(starts + middle[:, None] * directions))
        beyond = np.where(entering, found == after, found != before)
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return 0.5 * (low + high), owner
