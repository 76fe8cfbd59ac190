"""Where the samples of an extraction lie: stride, bounds, spacing and direction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.kernels.arrays import check_scalars

#: Relative rounding of a 32-bit float, and what of it is bearable, in voxels.
EPSILON, TOLERANCE = 2.0**-24, 2.0**-10

Neighbours = tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], npt.NDArray[Any]]


@dataclass(frozen=True, eq=False)
class Lattice:
    """Samples between which the surface is sought.

    Attributes
    ----------
    samples : ndarray of shape (Z, Y, X)
        The scalars themselves, a view of a part, or a copy of every n-th of them.
    coordinates : 3 ndarrays of float64
        Voxel indices of the samples along x, y, z.
    to_world : ndarray of shape (3, 4), float64
        From voxel index (i, j, k, 1) to world (x, y, z).
    choice : 3 slices or index arrays
        What of the volume was taken along z, y, x.
    """

    samples: npt.NDArray[Any]
    coordinates: tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.float64]]
    to_world: npt.NDArray[np.float64]
    choice: tuple[Any, Any, Any]

    @property
    def is_far(self) -> bool:
        """Whether 32-bit floats cannot tell positions in a voxel apart: the lattice lies far from the origin."""
        last = np.array([axis[-1] for axis in self.coordinates])
        reach = np.abs(self.to_world[:, 3]) + np.abs(self.to_world[:, :3]) @ last
        shortest = float(np.linalg.norm(self.to_world[:, :3], axis=0).min())
        return float(reach.max()) * EPSILON > TOLERANCE * shortest

    @property
    def first_position(self) -> npt.NDArray[np.float64]:
        """World position (x, y, z) of the first sample."""
        first = np.array([axis[0] for axis in self.coordinates])
        return np.asarray(self.to_world[:, :3] @ first + self.to_world[:, 3])

    def moved(self, shift: npt.NDArray[np.float64]) -> Lattice:
        """The same samples elsewhere in the world."""
        return replace(self, to_world=np.column_stack([self.to_world[:, :3], self.to_world[:, 3] + shift]))

    @property
    def is_mirrored(self) -> bool:
        """Tell whether world space is a mirror image of index space, which turns triangles inside out."""
        return bool(np.linalg.det(self.to_world[:, :3]) < 0)

    def gradient_neighbours(self, dtype: npt.DTypeLike) -> tuple[Neighbours, ...]:
        """Along x, y, z: flat distances to the samples before and after, and the weight of their difference.

        Central differences inside, one-sided ones at the border, in units of value per voxel.
        """
        result = []
        stride = 1
        for positions in self.coordinates:
            n = len(positions)
            before = np.full(n, -stride, np.int64)
            after = np.full(n, stride, np.int64)
            before[0] = after[-1] = 0
            extended = np.concatenate([positions[:1], positions, positions[-1:]])
            weights = (1.0 / (extended[2:] - extended[:-2])).astype(dtype)
            result.append((before, after, weights))
            stride *= n
        return tuple(result)


def sample_lattice(
    scalars: npt.ArrayLike,
    spacing: Sequence[float],
    origin: Sequence[float],
    direction: npt.ArrayLike | None,
    stride: int,
    bounds: Sequence[int] | None,
) -> Lattice:
    """Check the arguments of an extraction and choose its samples; see `marching_cubes` for what they mean.

    Raises
    ------
    InputError
        An argument is not what it should be.
    """
    array = np.asarray(scalars)
    check_scalars(array, "scalars")
    if min(array.shape) < 2:
        sizes = " x ".join(str(n) for n in array.shape[::-1])
        raise InputError(
            f"scalars has {sizes} voxels (x, y, z); an isosurface needs at least 2 along every axis."
        )
    if np.ndim(stride) or np.asarray(stride).dtype.kind not in "iu" or stride < 1:
        raise InputError(f"stride must be a whole number of voxels, at least 1, got {stride!r}.")
    steps = _triple(spacing, "spacing")
    if min(steps) <= 0:
        raise InputError(f"spacing must be greater than 0 along every axis, got {tuple(map(float, steps))}.")
    to_world = np.empty((3, 4))
    to_world[:, :3] = _matrix(direction) * steps
    to_world[:, 3] = _triple(origin, "origin")

    ranges = _ranges(array.shape[::-1], bounds)
    chosen = [_every(low, high, int(stride)) for low, high in ranges]
    i, j, k = (c.astype(np.float64) for c in chosen)
    if stride == 1:
        z, y, x = (slice(low, high + 1) for low, high in reversed(ranges))
        return Lattice(array[z, y, x], (i, j, k), to_world, (z, y, x))
    choice = np.ix_(*reversed(chosen))
    return Lattice(array[choice], (i, j, k), to_world, (choice[0], choice[1], choice[2]))


def _ranges(sizes: Sequence[int], bounds: Sequence[int] | None) -> list[tuple[int, int]]:
    """First and last voxel along x, y, z."""
    if bounds is None:
        return [(0, n - 1) for n in sizes]
    try:
        numbers = [int(b) for b in bounds]
        whole = [float(b) == n for b, n in zip(bounds, numbers, strict=True)]
    except (TypeError, ValueError, OverflowError):
        numbers, whole = [], []
    if len(numbers) != 6 or not all(whole):
        raise InputError(f"bounds must be six voxel indices (i0, i1, j0, j1, k0, k1), got {bounds!r}.")
    ranges = [(numbers[2 * a], numbers[2 * a + 1]) for a in range(3)]
    for axis, (low, high), n in zip("xyz", ranges, sizes, strict=True):
        if not 0 <= low < high < n:
            raise InputError(
                f"bounds along {axis} are {low}..{high}; give two voxels of 0..{n - 1} in order."
            )
    return ranges


def _every(low: int, high: int, stride: int) -> npt.NDArray[np.int64]:
    """Every n-th voxel from the first to the last, and the last one whatever the stride."""
    chosen = np.arange(low, high, stride)
    return np.append(chosen, high)


def _triple(values: Sequence[float], what: str) -> npt.NDArray[np.float64]:
    try:
        triple = np.array([float(v) for v in values])
    except (TypeError, ValueError):
        triple = np.empty(0)
    if triple.shape != (3,) or not np.all(np.isfinite(triple)):
        raise InputError(f"{what} must be three finite numbers (x, y, z), got {values!r}.")
    return triple


def _matrix(direction: npt.ArrayLike | None) -> npt.NDArray[np.float64]:
    if direction is None:
        return np.eye(3)
    try:
        matrix = np.array(direction, dtype=np.float64).reshape(3, 3)
    except (TypeError, ValueError):
        raise InputError("direction must be a 3 x 3 matrix of numbers; its columns are the axes.") from None
    if not np.all(np.isfinite(matrix)) or abs(np.linalg.det(matrix)) < 1e-12:
        raise InputError("direction must be a 3 x 3 matrix of finite numbers that can be inverted.")
    return matrix
