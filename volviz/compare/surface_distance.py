"""Distance between two triangle meshes: exact from samples of the one to the triangles of the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.compare.surface_tree import SurfaceTree, mesh_arrays

Array = npt.NDArray[Any]


@dataclass(frozen=True)
class SurfaceDistance:
    """Distances of two surfaces in world units, each sampled at vertices and middles of its triangles.

    Attributes
    ----------
    hausdorff : float
        Largest distance from a sample of one surface to the other surface.
    forward, backward : float
        Largest distance from the first to the second surface, and back.
    mean : float
        Mean distance of all samples of both.
    forward_mean, backward_mean, forward_rms, backward_rms : float
        Mean and root of the mean square of the distances from the first to the second surface, and back.
    """

    hausdorff: float
    forward: float
    backward: float
    mean: float
    forward_mean: float
    backward_mean: float
    forward_rms: float
    backward_rms: float


def surface_distance(
    first: tuple[npt.ArrayLike, npt.ArrayLike],
    second: tuple[npt.ArrayLike, npt.ArrayLike],
    *,
    max_samples: int = 500_000,
) -> SurfaceDistance:
    """Hausdorff and mean distance of two meshes.

    Parameters
    ----------
    first, second : tuples of vertices (V, 3) and faces (F, 3)
        World positions (x, y, z) and vertex numbers; neither mesh may be empty.
    max_samples : int, default: 500_000
        A mesh with more samples is sampled at every n-th only, evenly over its length.

    Raises
    ------
    InputError
        A mesh without triangles.
    """
    a, b = mesh_arrays(*first), mesh_arrays(*second)
    forward = distances_to_surface(_samples(*a, max_samples), *b)
    backward = distances_to_surface(_samples(*b, max_samples), *a)
    high, low = float(forward.max()), float(backward.max())
    return SurfaceDistance(
        hausdorff=max(high, low),
        forward=high,
        backward=low,
        mean=float(np.concatenate([forward, backward]).mean()),
        forward_mean=float(forward.mean()),
        backward_mean=float(backward.mean()),
        forward_rms=root_mean_square(forward),
        backward_rms=root_mean_square(backward),
    )


def distances_to_surface(
    points: npt.ArrayLike, vertices: npt.ArrayLike, faces: npt.ArrayLike
) -> npt.NDArray[np.float64]:
    """Exact distance of points to the nearest triangle of a mesh.

    Parameters
    ----------
    points : array_like of shape (N, 3)
        World positions (x, y, z).
    vertices : array_like of shape (V, 3)
    faces : array_like of shape (F, 3), integers
        At least one triangle.

    Returns
    -------
    ndarray of shape (N,), float64
        In world units.
    """
    return SurfaceTree(vertices, faces).nearest(points)[0]


def root_mean_square(values: Array) -> float:
    """Root of the mean of the squares."""
    return float(np.sqrt(np.mean(np.square(values))))


def _samples(vertices: Array, faces: Array, most: int) -> Array:
    """Vertices in use and middles of the triangles, every n-th where there are too many."""
    used = np.flatnonzero(np.bincount(faces.ravel()))
    chosen = np.arange(0, len(used) + len(faces), max(-(-(len(used) + len(faces)) // most), 1))
    corners = faces[chosen[chosen >= len(used)] - len(used)]
    middles = (vertices[corners[:, 0]] + vertices[corners[:, 1]] + vertices[corners[:, 2]]) / 3.0
    return np.concatenate([vertices[used[chosen[chosen < len(used)]]], middles])
