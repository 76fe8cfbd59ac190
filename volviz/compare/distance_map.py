"""Distance of every place of a surface to another one, with a sign where there is an inside."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.compare.surface_distance import SurfaceDistance, root_mean_square
from volviz.compare.surface_tree import SurfaceTree, mesh_arrays
from volviz.kernels.compiled import compiled
from volviz.kernels.marching.surface import clean_mesh
from volviz.kernels.mesh_metrics import edge_uses
from volviz.kernels.threads import map_ranges
from volviz.model.surface_values import SurfaceValues

Array = npt.NDArray[Any]
Mesh = tuple[npt.ArrayLike, npt.ArrayLike]

#: Part of the work that is left when the distances are known and the signs are not.
SIGN_SHARE = 0.1


class _Metrics(NamedTuple):
    """What is reported of the distances of all samples, without their signs."""

    samples: int
    maximum: float
    maximum_at_vertices: float
    mean: float
    rms: float


@dataclass(frozen=True, eq=False)
class DistanceMap:
    """Distances of one surface to another, in world units, at vertices and middles of triangles.

    Attributes
    ----------
    values : SurfaceValues
        The surface with its distances.
    is_signed : bool
        Whether distances are positive outside of the other surface and negative inside.
    """

    values: SurfaceValues
    is_signed: bool

    @property
    def at_vertices(self) -> npt.NDArray[np.float32]:
        """Distances of the vertices, shape (V,)."""
        return self.values.at_vertices

    @property
    def at_middles(self) -> npt.NDArray[np.float32]:
        """Distances of the middles of the triangles, shape (F,)."""
        return self.values.at_middles

    def without_sign(self) -> DistanceMap:
        """The same distances, all of them positive."""
        if not self.is_signed:
            return self
        values = self.values
        return DistanceMap(
            values.with_numbers(np.abs(values.at_vertices), np.abs(values.at_middles)), is_signed=False
        )

    def prepare(self) -> None:
        """Do now, on a worker, what metrics and colours would need time for when they are asked for."""
        self.values.prepare()
        _ = self._metrics, self.rounding

    @cached_property
    def _metrics(self) -> _Metrics:
        used = np.bincount(self.values.faces.ravel(), minlength=len(self.at_vertices)) > 0
        at_vertices, at_middles = np.abs(self.at_vertices[used]), np.abs(self.at_middles)
        sizes = np.concatenate([at_vertices, at_middles]).astype(np.float64)
        return _Metrics(
            len(sizes),
            float(sizes.max()),
            float(at_vertices.max()),
            float(sizes.mean()),
            root_mean_square(sizes),
        )

    @property
    def samples(self) -> int:
        """How many places were measured: vertices that a triangle uses, and middles of triangles."""
        return self._metrics.samples

    @property
    def maximum(self) -> float:
        """Largest distance, without its sign, of all samples."""
        return self._metrics.maximum

    @property
    def maximum_at_vertices(self) -> float:
        """Largest distance of a vertex, without its sign."""
        return self._metrics.maximum_at_vertices

    @property
    def mean(self) -> float:
        """Mean of the distances without their signs."""
        return self._metrics.mean

    @property
    def rms(self) -> float:
        """Root of the mean square of the distances."""
        return self._metrics.rms

    @cached_property
    def rounding(self) -> float:
        """Rounding of a position of the surface in 32-bit floats, in world units."""
        return float(np.spacing(np.float32(np.abs(self.values.vertices).max())))


def distance_maps(
    first: Mesh,
    second: Mesh,
    *,
    signed: bool = True,
    progress: Callable[[float], object] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> tuple[DistanceMap, DistanceMap]:
    """Distances of two surfaces to one another: of the first to the second, and back.

    Both have a sign, or none has: where one of the meshes does not say which side is outside (`distance_map`).

    Parameters
    ----------
    first, second : tuples of vertices (V, 3) and faces (F, 3)
        World positions (x, y, z) and vertex numbers, counter-clockwise seen from outside.
    signed, progress, cancel
        As for `distance_map`.

    Raises
    ------
    InputError
        A mesh without triangles.
    Cancelled
        `cancel` said so.
    """
    a, b = mesh_arrays(*first), mesh_arrays(*second)
    orientations = [_Orientation(*mesh) for mesh in (a, b)] if signed else []
    has_sign = signed and all(each.is_consistent for each in orientations)
    share = (2 * len(a[1])) / (2 * len(a[1]) + 2 * len(b[1]))
    forward = _map(
        a, b, orientations[1] if has_sign else None,
        None if progress is None else lambda part: progress(share * part), cancel,
    )  # fmt: skip
    backward = _map(
        b, a, orientations[0] if has_sign else None,
        None if progress is None else lambda part: progress(share + (1 - share) * part), cancel,
    )  # fmt: skip
    return forward, backward


def distance_metrics(maps: tuple[DistanceMap, DistanceMap]) -> SurfaceDistance:
    """The metrics of both surfaces, from all samples."""
    forward, backward = maps
    return SurfaceDistance(
        hausdorff=max(forward.maximum, backward.maximum),
        forward=forward.maximum,
        backward=backward.maximum,
        mean=float(np.average([forward.mean, backward.mean], weights=[each.samples for each in maps])),
        forward_mean=forward.mean,
        backward_mean=backward.mean,
        forward_rms=forward.rms,
        backward_rms=backward.rms,
    )


def distance_map(
    mesh: Mesh,
    other: Mesh,
    *,
    signed: bool = True,
    progress: Callable[[float], object] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> DistanceMap:
    """Exact distance of every vertex of a mesh, and of the middles of its triangles, to another mesh.

    Parameters
    ----------
    mesh, other : tuples of vertices (V, 3) and faces (F, 3)
        World positions (x, y, z) and vertex numbers, counter-clockwise seen from outside.
    signed : bool, default: True
        Positive outside of the other surface, negative inside, by the angle-weighted normal of the nearest
        triangle, edge or vertex (Baerentzen and Aanaes 2005, "Signed Distance Computation Using the
        Angle Weighted Pseudonormal"). Where the triangles of the other mesh do not agree on which side is
        outside, distances have no sign (`DistanceMap.is_signed`). Beside the rim of an open surface the sign
        tells the side of the triangle there.
    progress : callable, optional
        Told the finished fraction, 0..1.
    cancel : callable, optional
        Asked now and then; when it returns True the work ends with `Cancelled`.

    Returns
    -------
    DistanceMap
        ``at_vertices`` of shape (V,) and ``at_middles`` of shape (F,), float32, in world units.

    Raises
    ------
    InputError
        A mesh without triangles.
    Cancelled
        `cancel` said so.
    """
    a, b = mesh_arrays(*mesh), mesh_arrays(*other)
    orientation = _Orientation(*b) if signed else None
    if orientation is not None and not orientation.is_consistent:
        orientation = None
    return _map(a, b, orientation, progress, cancel)


def _map(
    mesh: tuple[Array, Array],
    other: tuple[Array, Array],
    orientation: _Orientation | None,
    progress: Callable[[float], object] | None,
    cancel: Callable[[], bool] | None,
) -> DistanceMap:
    vertices, faces = mesh
    middles = (vertices[faces[:, 0]] + vertices[faces[:, 1]] + vertices[faces[:, 2]]) / 3.0
    points = np.concatenate([vertices, middles])
    # of the surface that is asked for its sides, vertices at one place are one
    tree = SurfaceTree(*((orientation.vertices, orientation.faces) if orientation is not None else other))
    share = 1.0 if orientation is None else 1.0 - SIGN_SHARE
    report = None if progress is None else lambda part: progress(share * part)
    distances, nearest = tree.nearest(points, progress=report, cancel=cancel)
    if orientation is not None:
        distances = distances * orientation.signs(points, nearest)
    if progress is not None:
        progress(1.0)
    found = distances.astype(np.float32)
    # half the memory; positions were 32-bit floats before
    small = faces.astype(np.int32) if len(vertices) < 2**31 else faces
    return DistanceMap(
        SurfaceValues(
            vertices.astype(np.float32), small, found[: len(vertices)].copy(), found[len(vertices) :].copy()
        ),
        orientation is not None,
    )


class _Orientation:
    """Which side of a mesh is outside, at its triangles, edges and vertices."""

    def __init__(self, vertices: Array, faces: Array) -> None:
        self.vertices, triangles, _ = clean_mesh(vertices, faces, None)
        self.faces = np.ascontiguousarray(triangles, np.int64)
        edges, uses, balance = edge_uses(self.faces)
        self.is_consistent = len(self.faces) > 0 and not np.any((uses == 2) & (balance != 0))
        if not self.is_consistent:
            return
        count = len(self.vertices)
        starts = np.concatenate([[0], np.cumsum(np.bincount(edges[:, 0], minlength=count))])
        self._edges = np.empty_like(self.faces)
        _number_edges(self.faces, starts, edges, self._edges)
        self._normals = np.empty((len(self.faces), 3))
        self._edge_normals, self._vertex_normals = np.zeros((len(edges), 3)), np.zeros((count, 3))
        _collect_normals(
            self.vertices, self.faces, self._edges, self._normals, self._edge_normals, self._vertex_normals
        )

    def signs(self, points: Array, nearest: Array) -> npt.NDArray[np.float64]:
        """1 outside and -1 inside, for points and the triangles that are nearest to them."""
        signs = np.empty(len(points))
        map_ranges(
            lambda a, b: _find_signs(
                points[a:b], nearest[a:b], self.vertices, self.faces, self._edges, self._normals,
                self._edge_normals, self._vertex_normals, signs[a:b],
            ),
            len(points),
        )  # fmt: skip
        return signs


@compiled
def _number_edges(faces: Array, starts: Array, edges: Array, numbers: Array) -> None:
    """The numbers of the three sides of every triangle, of which side i begins at corner i.

    Parameters
    ----------
    faces : ndarray of shape (F, 3), int64
    starts : ndarray of shape (V + 1,), int64
        Where the edges with each vertex as their lower one begin.
    edges : ndarray of shape (E, 2), int64
        In ascending order, see `edge_uses`.
    numbers : ndarray of shape (F, 3), int64
        Output.
    """
    for f in range(faces.shape[0]):
        for i in range(3):
            a, b = faces[f, i], faces[f, (i + 1) % 3]
            low, high = min(a, b), max(a, b)
            e = starts[low]
            while edges[e, 1] != high:
                e += 1
            numbers[f, i] = e


@compiled
def _collect_normals(
    vertices: Array, faces: Array, edges: Array, normals: Array, edge_normals: Array, vertex_normals: Array
) -> None:
    """Unit normals of triangles, their sums at edges, their sums weighted by angles at vertices."""
    sides = np.empty((3, 3))
    lengths = np.empty(3)
    for f in range(faces.shape[0]):
        for i in range(3):
            a, b = faces[f, i], faces[f, (i + 1) % 3]
            for axis in range(3):
                sides[i, axis] = vertices[b, axis] - vertices[a, axis]
            lengths[i] = np.sqrt(sides[i, 0] ** 2 + sides[i, 1] ** 2 + sides[i, 2] ** 2)
        x = sides[0, 1] * sides[1, 2] - sides[0, 2] * sides[1, 1]
        y = sides[0, 2] * sides[1, 0] - sides[0, 0] * sides[1, 2]
        z = sides[0, 0] * sides[1, 1] - sides[0, 1] * sides[1, 0]
        size = np.sqrt(x * x + y * y + z * z)
        if size > 0:
            x, y, z = x / size, y / size, z / size
        normals[f, 0], normals[f, 1], normals[f, 2] = x, y, z
        for i in range(3):
            j = (i + 2) % 3
            cosine = 1.0
            if lengths[i] > 0 and lengths[j] > 0:
                dot = sides[i, 0] * sides[j, 0] + sides[i, 1] * sides[j, 1] + sides[i, 2] * sides[j, 2]
                cosine = min(1.0, max(-1.0, -dot / (lengths[i] * lengths[j])))
            angle = np.arccos(cosine)
            edge, vertex = edges[f, i], faces[f, i]
            edge_normals[edge, 0] += x
            edge_normals[edge, 1] += y
            edge_normals[edge, 2] += z
            vertex_normals[vertex, 0] += angle * x
            vertex_normals[vertex, 1] += angle * y
            vertex_normals[vertex, 2] += angle * z


@compiled
def _find_signs(
    points: Array,
    nearest: Array,
    vertices: Array,
    faces: Array,
    edges: Array,
    normals: Array,
    edge_normals: Array,
    vertex_normals: Array,
    signs: Array,
) -> None:
    for q in range(points.shape[0]):
        f = nearest[q]
        corner, kind = _nearest_feature(
            points[q], vertices[faces[f, 0]], vertices[faces[f, 1]], vertices[faces[f, 2]]
        )
        if kind == 0:
            normal = vertex_normals[faces[f, corner]]
        elif kind == 1:
            normal = edge_normals[edges[f, corner]]
        else:
            normal = normals[f]
        # the normal of an edge is upright on it: any of its points will do
        p, a = points[q], vertices[faces[f, corner]]
        dot = (p[0] - a[0]) * normal[0] + (p[1] - a[1]) * normal[1] + (p[2] - a[2]) * normal[2]
        signs[q] = -1.0 if dot < 0 else 1.0


@compiled
def _nearest_feature(p: Array, a: Array, b: Array, c: Array) -> tuple[int, int]:
    """What of a triangle is nearest to a point (Ericson 2005, "Real-Time Collision Detection", 5.1.5).

    Returns
    -------
    corner, kind : int
        Kind 0: that corner; 1: the edge from that corner to the next; 2: the inside.
    """
    d1 = d2 = d3 = d4 = d5 = d6 = 0.0
    for axis in range(3):
        ab, ac = b[axis] - a[axis], c[axis] - a[axis]
        d1 += ab * (p[axis] - a[axis])
        d2 += ac * (p[axis] - a[axis])
        d3 += ab * (p[axis] - b[axis])
        d4 += ac * (p[axis] - b[axis])
        d5 += ab * (p[axis] - c[axis])
        d6 += ac * (p[axis] - c[axis])
    if d1 <= 0 and d2 <= 0:
        return 0, 0
    if d3 >= 0 and d4 <= d3:
        return 1, 0
    if d1 * d4 - d3 * d2 <= 0 and d1 >= 0 and d3 <= 0:
        return 0, 1
    if d6 >= 0 and d5 <= d6:
        return 2, 0
    if d5 * d2 - d1 * d6 <= 0 and d2 >= 0 and d6 <= 0:
        return 2, 1
    if d3 * d6 - d5 * d4 <= 0 and d4 - d3 >= 0 and d5 - d6 >= 0:
        return 1, 1
    return 0, 2
