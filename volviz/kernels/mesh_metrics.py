"""Figures of triangle meshes, on plain arrays: size, topology, orientation.

Meshes are vertices of shape (V, 3), world positions (x, y, z), and faces of shape (F, 3), vertex numbers in
an order that is counter-clockwise seen from outside. Distances are in `volviz.compare.surface_distance`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.kernels.compiled import compiled
from volviz.kernels.marching import face_components

Array = npt.NDArray[Any]


@dataclass(frozen=True)
class MeshMetrics:
    """Size and topology of one mesh.

    Attributes
    ----------
    vertices, faces : int
        Vertices that are used by a triangle, and triangles.
    edges : int
        Different edges.
    area, volume : float
        In squared and cubic world units; the volume is signed.
    euler_characteristic : int
        Vertices - edges + faces.
    boundary_edges, non_manifold_edges : int
        Edges of one triangle, and of three or more.
    inconsistent_edges : int
        Edges that two triangles run along in the same direction.
    components : int
        Connected parts.
    """

    vertices: int
    edges: int
    faces: int
    area: float
    volume: float
    euler_characteristic: int
    boundary_edges: int
    non_manifold_edges: int
    inconsistent_edges: int
    components: int

    @property
    def is_closed(self) -> bool:
        """Tell whether every edge has exactly two triangles."""
        return self.boundary_edges == 0 and self.non_manifold_edges == 0

    @property
    def is_oriented(self) -> bool:
        """Tell whether neighbouring triangles agree on which side is outside."""
        return self.inconsistent_edges == 0


def mesh_metrics(vertices: npt.ArrayLike, faces: npt.ArrayLike) -> MeshMetrics:
    """All figures of one mesh.

    Parameters
    ----------
    vertices : array_like of shape (V, 3)
        World positions (x, y, z).
    faces : array_like of shape (F, 3), integers
        Vertex numbers.

    Raises
    ------
    InputError
        Wrong shapes, or vertex numbers out of range.
    """
    points, triangles = _checked(vertices, faces)
    _, uses, balance = edge_uses(triangles)
    used = _count_used(triangles)
    return MeshMetrics(
        vertices=used,
        edges=len(uses),
        faces=len(triangles),
        area=surface_area(points, triangles),
        volume=enclosed_volume(points, triangles),
        euler_characteristic=used - len(uses) + len(triangles),
        boundary_edges=int(np.count_nonzero(uses == 1)),
        non_manifold_edges=int(np.count_nonzero(uses > 2)),
        inconsistent_edges=int(np.count_nonzero((uses == 2) & (balance != 0))),
        components=face_components(triangles, len(points))[1],
    )


def edge_uses(faces: npt.ArrayLike) -> tuple[Array, Array, Array]:
    """Edges of a mesh and how triangles use them.

    Parameters
    ----------
    faces : array_like of shape (F, 3), integers
        Vertex numbers.

    Returns
    -------
    edges : ndarray of shape (E, 2), int64
        Lower and higher vertex number of each edge, in ascending order.
    uses : ndarray of shape (E,), int64
        Triangles at the edge.
    balance : ndarray of shape (E,), int64
        Triangles that run from the lower to the higher vertex, minus those that run back; 0 where two
        triangles have the same outside.
    """
    triangles = np.ascontiguousarray(faces, np.int64)
    vertices = int(triangles.max()) + 1 if len(triangles) else 0
    starts = np.zeros(vertices + 1, np.int64)
    ends = np.empty(3 * len(triangles), np.int64)
    _collect_edges(triangles, starts, ends)
    edges = np.empty((len(ends), 2), np.int64)
    uses, balance = np.empty(len(ends), np.int64), np.empty(len(ends), np.int64)
    count = _count_edges(starts, ends, edges, uses, balance)
    return edges[:count].copy(), uses[:count].copy(), balance[:count].copy()


@compiled
def _collect_edges(faces: Array, starts: Array, ends: Array) -> None:
    """Sort the sides of all triangles by their lower vertex.

    Parameters
    ----------
    faces : ndarray of shape (F, 3), int64
    starts : ndarray of shape (V + 1,), int64, zeros
        Where the sides of each vertex begin in `ends`.
    ends : ndarray of shape (3 F,), int64
        Twice the higher vertex, plus 1 for triangles that run from the higher to the lower one.
    """
    for f in range(faces.shape[0]):
        for i in range(3):
            starts[min(faces[f, i], faces[f, (i + 1) % 3])] += 1
    total = 0
    for v in range(starts.size):
        here = starts[v]
        starts[v] = total
        total += here
    for f in range(faces.shape[0]):
        for i in range(3):
            a, b = faces[f, i], faces[f, (i + 1) % 3]
            low, high = min(a, b), max(a, b)
            ends[starts[low]] = 2 * high + (a >= b)
            starts[low] += 1
    for v in range(starts.size - 1, 0, -1):
        starts[v] = starts[v - 1]
    if starts.size:
        starts[0] = 0


@compiled
def _count_edges(starts: Array, ends: Array, edges: Array, uses: Array, balance: Array) -> int:
    """Run through the sides of every vertex in the order of their other end."""
    count = 0
    for v in range(starts.size - 1):
        here = ends[starts[v] : starts[v + 1]]
        here.sort()
        last = -1
        for side in here:
            if side >> 1 != last:
                last = side >> 1
                edges[count, 0], edges[count, 1] = v, last
                uses[count] = balance[count] = 0
                count += 1
            uses[count - 1] += 1
            balance[count - 1] += 1 - 2 * (side & 1)
    return count


@compiled
def _area_and_volume(vertices: Array, faces: Array, centre: Array) -> tuple[float, float]:
    area = 0.0
    volume = 0.0
    for f in range(faces.shape[0]):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        ax, ay, az = vertices[a, 0] - centre[0], vertices[a, 1] - centre[1], vertices[a, 2] - centre[2]
        bx, by, bz = vertices[b, 0] - centre[0], vertices[b, 1] - centre[1], vertices[b, 2] - centre[2]
        cx, cy, cz = vertices[c, 0] - centre[0], vertices[c, 1] - centre[1], vertices[c, 2] - centre[2]
        ux, uy, uz = bx - ax, by - ay, bz - az
        vx, vy, vz = cx - ax, cy - ay, cz - az
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        area += np.sqrt(nx * nx + ny * ny + nz * nz)
        # The tetrahedron from the centre to the triangle, by the triple product.
        volume += ax * nx + ay * ny + az * nz
    return area / 2.0, volume / 6.0


def _sums(vertices: Array, faces: Array) -> tuple[float, float]:
    if not len(faces):
        return 0.0, 0.0
    area, volume = _area_and_volume(vertices, faces, np.asarray(vertices, np.float64).mean(axis=0))
    return float(area), float(volume)


def surface_area(vertices: npt.ArrayLike, faces: npt.ArrayLike) -> float:
    """Area of all triangles in squared world units, summed in float64."""
    return _sums(*_checked(vertices, faces))[0]


def enclosed_volume(vertices: npt.ArrayLike, faces: npt.ArrayLike) -> float:
    """Signed volume inside a closed mesh in cubic world units: positive when the triangles face outward.

    By the divergence theorem, relative to the mean vertex, so that small holes matter little.
    """
    return _sums(*_checked(vertices, faces))[1]


def euler_characteristic(faces: npt.ArrayLike) -> int:
    """Vertices - edges + faces of a mesh, counting only vertices that are used."""
    triangles = np.asarray(faces)
    return _count_used(triangles) - len(edge_uses(triangles)[0]) + len(triangles)


def _count_used(faces: Array) -> int:
    """Number of vertices that belong to a triangle."""
    return int(np.count_nonzero(np.bincount(faces.ravel()))) if faces.size else 0


def _checked(vertices: npt.ArrayLike, faces: npt.ArrayLike) -> tuple[Array, Array]:
    """Both as arrays of the right shape, faces as int64."""
    points, triangles = np.asarray(vertices), np.asarray(faces)
    if points.ndim != 2 or points.shape[1:] != (3,) or points.dtype.kind not in "fiu":
        raise InputError(f"vertices have shape {points.shape}; a mesh needs (V, 3) numbers.")
    if triangles.ndim != 2 or triangles.shape[1:] != (3,) or triangles.dtype.kind not in "iu":
        raise InputError(f"faces have shape {triangles.shape}; a mesh needs (F, 3) vertex numbers.")
    if len(triangles) and (triangles.min() < 0 or triangles.max() >= len(points)):
        raise InputError(f"faces name vertices outside 0..{len(points) - 1}.")
    return np.asarray(points, np.float64), np.ascontiguousarray(triangles, np.int64)
