"""The nearest place on a triangle mesh: a balanced binary tree of boxes, exact distances.

The triangles are sorted along a space-filling curve and grouped into boxes; a query goes down the nearer box first and
leaves out what is farther than the best distance so far.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import Cancelled, InputError
from volviz.kernels.compiled import compiled
from volviz.kernels.threads import map_ranges

Array = npt.NDArray[Any]

#: Triangles in the lowest boxes of the tree.
LEAF = 4
#: Queries between two looks at whether anybody still waits.
PIECE = 1 << 16


class SurfaceTree:
    """A triangle mesh, ready to be asked for the nearest place.

    Parameters
    ----------
    vertices : array_like of shape (V, 3)
        World positions (x, y, z).
    faces : array_like of shape (F, 3), integers
        Vertex numbers; at least one triangle.

    Raises
    ------
    InputError
        A mesh without triangles.
    """

    def __init__(self, vertices: npt.ArrayLike, faces: npt.ArrayLike) -> None:
        self.vertices, self.faces = mesh_arrays(vertices, faces)
        corners, triangles = self.vertices, self.faces
        middles = corners[triangles[:, 0]] + corners[triangles[:, 1]] + corners[triangles[:, 2]]
        self._order = _curve_order(middles)
        self._triangles = triangles[self._order]
        self._leaves = 1 << max(0, int(np.ceil(np.log2(len(triangles) / LEAF))))
        self._boxes = np.empty((2 * self._leaves, 2, 3))
        self._boxes[:, 0], self._boxes[:, 1] = np.inf, -np.inf
        _build(corners, self._triangles, self._boxes, self._leaves)

    def nearest(
        self,
        points: npt.ArrayLike,
        *,
        progress: Callable[[float], object] | None = None,
        cancel: Callable[[], bool] | None = None,
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
        """Exact distance of points to the mesh, and the triangle that is nearest.

        Parameters
        ----------
        points : array_like of shape (N, 3)
            World positions (x, y, z).
        progress : callable, optional
            Told the finished fraction, 0..1.
        cancel : callable, optional
            Asked now and then; when it returns True the work ends with `Cancelled`.

        Returns
        -------
        distances : ndarray of shape (N,), float64
            In world units.
        faces : ndarray of shape (N,), int64
            Numbers of the triangles; of several at the same distance any one.

        Raises
        ------
        Cancelled
            `cancel` said so.
        """
        queries = np.ascontiguousarray(points, np.float64)
        count = len(queries)
        distances, faces = np.empty(count), np.empty(count, np.int64)
        if not count:
            return distances, faces
        # neighbours are asked for one after the other: they go through the same boxes
        order = _curve_order(queries)
        ordered = queries[order]
        found, numbers = np.empty(count), np.empty(count, np.int64)
        for begin in range(0, count, PIECE):
            if cancel is not None and cancel():
                raise Cancelled("measuring the distance of the surfaces was cancelled.")
            end = min(begin + PIECE, count)
            self._search(ordered[begin:end], found[begin:end], numbers[begin:end])
            if progress is not None:
                progress(end / count)
        distances[order] = found
        faces[order] = self._order[numbers]
        return distances, faces

    def _search(self, queries: Array, distances: Array, faces: Array) -> None:
        map_ranges(
            lambda a, b: _search(
                queries[a:b], self.vertices, self._triangles, self._boxes, self._leaves,
                distances[a:b], faces[a:b],
            ),
            len(queries),
        )  # fmt: skip


def mesh_arrays(vertices: npt.ArrayLike, faces: npt.ArrayLike) -> tuple[Array, Array]:
    """Both as the kernels want them: float64 and int64, in one piece.

    Raises
    ------
    InputError
        A mesh without triangles.
    """
    corners, triangles = np.ascontiguousarray(vertices, np.float64), np.ascontiguousarray(faces, np.int64)
    if not len(triangles):
        raise InputError("A mesh without triangles has no distance to anything; choose another isovalue.")
    return corners, triangles


def _curve_order(points: Array) -> Array:
    """Order of points along the Z-order curve (Morton 1966), 2^20 steps along each axis."""
    low = points.min(axis=0)
    size = max(float((points.max(axis=0) - low).max()), np.finfo(float).tiny)
    grid = ((points - low) / size * (2**20 - 1)).astype(np.uint64)
    code = np.zeros(len(points), np.uint64)
    for axis in range(3):
        bits = grid[:, axis]
        for shift, mask in (
            (32, 0x1F00000000FFFF),
            (16, 0x1F0000FF0000FF),
            (8, 0x100F00F00F00F00F),
            (4, 0x10C30C30C30C30C3),
            (2, 0x1249249249249249),
        ):
            bits = (bits | bits << np.uint64(shift)) & np.uint64(mask)
        code |= bits << np.uint64(axis)
    return np.argsort(code, kind="stable")


@compiled
def _build(vertices: Array, faces: Array, boxes: Array, leaves: int) -> None:
    """Boxes of the leaves, from number `leaves` on, and of their parents: box i holds 2 i and 2 i + 1."""
    for f in range(faces.shape[0]):
        leaf = leaves + f * leaves // faces.shape[0]
        for i in range(3):
            for axis in range(3):
                value = vertices[faces[f, i], axis]
                boxes[leaf, 0, axis] = min(boxes[leaf, 0, axis], value)
                boxes[leaf, 1, axis] = max(boxes[leaf, 1, axis], value)
    for node in range(leaves - 1, 0, -1):
        for axis in range(3):
            boxes[node, 0, axis] = min(boxes[2 * node, 0, axis], boxes[2 * node + 1, 0, axis])
            boxes[node, 1, axis] = max(boxes[2 * node, 1, axis], boxes[2 * node + 1, 1, axis])


@compiled
def _search(
    queries: Array,
    vertices: Array,
    faces: Array,
    boxes: Array,
    leaves: int,
    distances: Array,
    numbers: Array,
) -> None:
    count = faces.shape[0]
    nodes = np.empty(64, np.int64)
    reaches = np.empty(64, np.float64)
    nearest = 0
    for q in range(queries.shape[0]):
        p = queries[q]
        # the triangle nearest to the query before is not far from this one either
        best = _squared_to_triangle(
            p, vertices[faces[nearest, 0]], vertices[faces[nearest, 1]], vertices[faces[nearest, 2]]
        )
        nodes[0], reaches[0] = 1, 0.0
        open_nodes = 1
        while open_nodes > 0:
            open_nodes -= 1
            node = nodes[open_nodes]
            if reaches[open_nodes] >= best:
                continue
            if node >= leaves:
                # The triangles f with f * leaves // count == node - leaves.
                leaf = node - leaves
                for f in range(-(-leaf * count // leaves), -(-(leaf + 1) * count // leaves)):
                    a, b, c = vertices[faces[f, 0]], vertices[faces[f, 1]], vertices[faces[f, 2]]
                    squared = _squared_to_triangle(p, a, b, c)
                    if squared < best:
                        best, nearest = squared, f
                continue
            left, right = _squared_to_box(p, boxes[2 * node]), _squared_to_box(p, boxes[2 * node + 1])
            near_is_left = left <= right
            nodes[open_nodes] = 2 * node + 1 if near_is_left else 2 * node
            reaches[open_nodes] = right if near_is_left else left
            nodes[open_nodes + 1] = 2 * node if near_is_left else 2 * node + 1
            reaches[open_nodes + 1] = left if near_is_left else right
            open_nodes += 2
        distances[q], numbers[q] = np.sqrt(best), nearest


@compiled
def _squared_to_box(p: Array, box: Array) -> float:
    total = 0.0
    for axis in range(3):
        gap = max(box[0, axis] - p[axis], p[axis] - box[1, axis], 0.0)
        total += gap * gap
    return total


@compiled
def _squared_to_triangle(p: Array, a: Array, b: Array, c: Array) -> float:
    """Squared distance of a point to a triangle: to its plane when the foot lies inside, else to a side."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    px, py, pz = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    uu, uv, vv = ux * ux + uy * uy + uz * uz, ux * vx + uy * vy + uz * vz, vx * vx + vy * vy + vz * vz
    up, vp = ux * px + uy * py + uz * pz, vx * px + vy * py + vz * pz
    determinant = uu * vv - uv * uv
    if determinant > 1e-14 * uu * vv:
        s, t = (vv * up - uv * vp) / determinant, (uu * vp - uv * up) / determinant
        if s >= 0 and t >= 0 and s + t <= 1:
            rx, ry, rz = px - s * ux - t * vx, py - s * uy - t * vy, pz - s * uz - t * vz
            return float(rx * rx + ry * ry + rz * rz)
    return min(_squared_to_segment(p, a, b), _squared_to_segment(p, b, c), _squared_to_segment(p, c, a))


@compiled
def _squared_to_segment(p: Array, a: Array, b: Array) -> float:
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    px, py, pz = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    length = ux * ux + uy * uy + uz * uz
    s = 0.0
    if length > 0:
        s = min(1.0, max(0.0, (ux * px + uy * py + uz * pz) / length))
    rx, ry, rz = px - s * ux, py - s * uy, pz - s * uz
    return float(rx * rx + ry * ry + rz * rz)
