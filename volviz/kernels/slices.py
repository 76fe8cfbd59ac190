"""Slice polygons: planes perpendicular to a direction, cut with the box of a volume.

The order in which a plane meets the edges of a box is the same for every plane that has the same *front
corner* (the one with the smallest distance along the direction). From there three edge paths lead to the
opposite corner, each along the three axes in cyclic order; a plane meets each path exactly once. Between
two neighbouring paths lies one of the three remaining edges, which the plane may meet or not. Path, edge,
path, edge, path, edge: three to six points in convex order (Rezk-Salama and Kolb, "A Vertex Program for
Efficient Box-Plane Intersection", 2005). `edge_order` derives the table for all eight front corners.

Corners are numbered with bit 0 = x, bit 1 = y, bit 2 = z of the volume's own axes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.kernels.compiled import compiled

if TYPE_CHECKING:
    from collections.abc import Sequence

AnyArray = npt.NDArray[Any]
Float64Array = npt.NDArray[np.float64]

MAX_VERTICES = 6


def edge_order() -> npt.NDArray[np.int64]:
    """The edges of a box in the order in which a plane meets them, for every front corner.

    Returns
    -------
    ndarray of shape (8, 12, 2), int64
        For each front corner 12 edges as pairs (nearer corner, farther corner): rows 0-2, 4-6 and 8-10 are
        the three paths from the front corner to the opposite one; rows 3, 7 and 11 the edge between a path
        and the next. Every edge of the box occurs once.
    """
    table = np.empty((8, 12, 2), np.int64)
    for front in range(8):
        # an odd corner mirrors the box: walking the axes the other way keeps the sense of rotation
        mirrored = (front).bit_count() % 2 == 1
        axes = (0, 1, 2) if mirrored else (2, 1, 0)
        for path in range(3):
            first, second, _third = (1 << axes[(path + i) % 3] for i in range(3))
            row = 4 * path
            table[front, row] = front, front ^ first
            table[front, row + 1] = front ^ first, front ^ first ^ second
            table[front, row + 2] = front ^ first ^ second, front ^ 7
            # from the next path's first corner to this path's second one
            table[front, row + 3] = front ^ second, front ^ second ^ first
    return table


_EDGE_ORDER = edge_order()


def box_distance_range(corners: npt.ArrayLike, view_direction: npt.ArrayLike) -> tuple[float, float]:
    """Smallest and largest distance of a box's corners along a direction.

    Parameters
    ----------
    corners : array_like of shape (8, 3)
        World corners.
    view_direction : array_like of shape (3,)
        Unit vector from the eye into the scene.

    Returns
    -------
    lo, hi : float
        Distances from the world's origin along the direction, in world units.
    """
    distances = np.asarray(corners, np.float64) @ np.asarray(view_direction, np.float64)
    return float(distances.min()), float(distances.max())


def slab_centres(lo: float, hi: float, count: int) -> Float64Array:
    """Distances of `count` slices at the middle of equally thick slabs.

    Parameters
    ----------
    lo, hi : float
        Range of distances, from `box_distance_range`.
    count : int
        Number of slabs, at least 1.

    Returns
    -------
    ndarray of shape (count,), float64
        ``lo + (i + 0.5) (hi - lo) / count``, ascending: nearest first.
    """
    if count < 1:
        raise InputError(f"the number of slices must be at least 1, got {count}.")
    return np.asarray(lo + (np.arange(count) + 0.5) * ((hi - lo) / count), np.float64)


def slice_polygons(
    corners: npt.ArrayLike, view_direction: npt.ArrayLike, distances: npt.ArrayLike
) -> tuple[Float64Array, npt.NDArray[np.int32]]:
    """Polygons in which planes perpendicular to a direction cut a box.

    Parameters
    ----------
    corners : array_like of shape (8, 3)
        World corners of a (cropped, possibly oblique) box; bit 0 of the row number is x, bit 1 y, bit 2 z.
    view_direction : array_like of shape (3,)
        Unit vector from the eye into the scene, not zero.
    distances : array_like of shape (S,)
        Distance of each plane along the direction, in world units, as in `box_distance_range`; any order.

    Returns
    -------
    vertices : ndarray of shape (S, 6, 3), float64
        World vertices in convex order, counter-clockwise for the eye that looks along `view_direction`.
        Unused rows repeat the last vertex (zeros where there is no polygon).
    counts : ndarray of shape (S,), int32
        Number of vertices: 3 to 6, or 0 where the plane misses the box or touches it in a point or an edge.

    Raises
    ------
    InputError
        Wrong shapes, or a direction of length zero.
    """
    box = np.ascontiguousarray(corners, np.float64)
    direction = np.ascontiguousarray(view_direction, np.float64)
    planes = np.ascontiguousarray(distances, np.float64).reshape(-1)
    if box.shape != (8, 3) or direction.shape != (3,):
        raise InputError(
            f"corners must be (8, 3) and view_direction (3,), got {box.shape} and {direction.shape}."
        )
    if not np.any(direction):
        raise InputError("view_direction has length zero; give the direction from the eye into the scene.")
    vertices = np.zeros((len(planes), MAX_VERTICES, 3))
    counts = np.zeros(len(planes), np.int32)
    along = box @ direction
    front = int(np.argmin(along))
    order = _EDGE_ORDER[front]
    # a left-handed box turns the other way round
    if np.linalg.det(np.stack([box[1] - box[0], box[2] - box[0], box[4] - box[0]])) < 0:
        order = order[[8, 9, 10, 7, 4, 5, 6, 3, 0, 1, 2, 11]]
    _cut(box, along, np.ascontiguousarray(order), planes, vertices, counts)
    return vertices, counts


@compiled
def _cut(
    corners: Float64Array,
    along: Float64Array,
    order: AnyArray,
    planes: Float64Array,
    vertices: Float64Array,
    counts: npt.NDArray[np.int32],
) -> None:
    lowest = along.min()
    highest = along.max()
    for s in range(len(planes)):
        d = planes[s]
        if not lowest <= d <= highest:
            continue
        polygon = vertices[s]
        n = 0
        for group in range(6):
            # groups 0, 2, 4 are paths of three edges, groups 1, 3, 5 the single edges between them
            first = 4 * (group // 2) + 3 * (group % 2)
            for e in range(first, first + (1 if group % 2 else 3)):
                a, b = order[e, 0], order[e, 1]
                d0, d1 = along[a], along[b]
                if not (d0 <= d <= d1 and d0 < d1):
                    continue
                t = (d - d0) / (d1 - d0)
                new = n == 0
                for i in range(3):
                    # exact at both ends, so that a corner met on two edges is the same point
                    polygon[n, i] = (1.0 - t) * corners[a, i] + t * corners[b, i]
                    if n > 0 and polygon[n, i] != polygon[n - 1, i]:
                        new = True
                if new:
                    n += 1
                break
        while n > 1 and (
            polygon[n - 1, 0] == polygon[0, 0]
            and polygon[n - 1, 1] == polygon[0, 1]
            and polygon[n - 1, 2] == polygon[0, 2]
        ):
            n -= 1
        if n < 3:
            polygon[:] = 0.0
            continue
        counts[s] = n
        for v in range(n, 6):
            polygon[v] = polygon[n - 1]


def fan_triangles(
    vertices: Float64Array, counts: npt.NDArray[np.int32]
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.int64]]:
    """Triangles of slice polygons, ready for a vertex buffer; nothing is padded.

    Parameters
    ----------
    vertices : ndarray of shape (S, 6, 3), float64
    counts : ndarray of shape (S,), int32
        From `slice_polygons`. Reverse both for back to front.

    Returns
    -------
    positions : ndarray of shape (V, 3), float32
        Three vertices a triangle, slice after slice, at most 12 a slice.
    first : ndarray of shape (S + 1,), int64
        Slice s occupies the vertices ``first[s] .. first[s + 1] - 1``: a range of slices is one draw call.
    """
    triangles = np.maximum(counts.astype(np.int64) - 2, 0)
    first = np.concatenate(([0], np.cumsum(3 * triangles)))
    fan = np.stack([np.zeros(4, np.int64), np.arange(1, 5), np.arange(2, 6)], axis=1)
    used = np.arange(4)[None, :] < triangles[:, None]
    positions = vertices[:, fan][used]
    return positions.reshape(-1, 3).astype(np.float32), first


def outline_segments(
    vertices: Float64Array, counts: npt.NDArray[np.int32]
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.int64]]:
    """Edges of slice polygons as line segments, for the wireframe view.

    Parameters
    ----------
    vertices, counts
        From `slice_polygons`.

    Returns
    -------
    positions : ndarray of shape (V, 3), float32
        Two vertices an edge, slice after slice.
    first : ndarray of shape (S + 1,), int64
        Slice s occupies the vertices ``first[s] .. first[s + 1] - 1``.
    """
    sides = np.arange(MAX_VERTICES)
    used = sides[None, :] < counts[:, None]
    following = np.where(sides[None, :] + 1 < counts[:, None], sides[None, :] + 1, 0)
    ends = np.take_along_axis(vertices, following[:, :, None], axis=1)
    positions = np.stack([vertices, ends], axis=2)[used]
    first = np.concatenate(([0], np.cumsum(2 * counts.astype(np.int64))))
    return positions.reshape(-1, 3).astype(np.float32), first


def crop_corners(
    index_to_world: npt.ArrayLike, crop: Sequence[float] | None, dimensions: Sequence[int]
) -> Float64Array:
    """World corners of a volume's box, or of its cropped part.

    Parameters
    ----------
    index_to_world : array_like of shape (4, 4)
        Maps continuous index (i, j, k, 1) to world (x, y, z, 1).
    crop : tuple of 6 floats or None
        (i0, i1, j0, j1, k0, k1) in continuous voxel indices; None = from the first to the last voxel centre.
    dimensions : tuple of 3 ints
        Voxels along (x, y, z).

    Returns
    -------
    ndarray of shape (8, 3), float64
        Bit 0 of the row number is x, bit 1 y, bit 2 z.
    """
    limits = crop if crop is not None else [v for n in dimensions for v in (0.0, n - 1.0)]
    index = np.array(
        [[limits[2 * axis + (c >> axis & 1)] for axis in range(3)] for c in range(8)], np.float64
    )
    matrix = np.asarray(index_to_world, np.float64)
    return np.asarray(index @ matrix[:3, :3].T + matrix[:3, 3])
