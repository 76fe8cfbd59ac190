"""What is drawn: the cut plane's polygon and the faces of the box, with a tangent space at every vertex."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from volviz.kernels.slices import slice_polygons
from volviz.kernels.tangents import plane_basis
from volviz.model.cut_plane import default_cut_plane

Float64Array = npt.NDArray[np.float64]
Vector = Sequence[float]

#: Floats of a vertex: position 3, normal 3, tangent 4, texture coordinates 2.
VERTEX_FLOATS = 12

#: Corners of the faces -x, +x, -y, +y, -z, +z, each in the order of its rim; bit 0 is x, bit 1 y, bit 2 z.
_FACES = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))


@dataclass(frozen=True)
class Polygon:
    """A flat, convex piece of surface.

    Attributes
    ----------
    corners : ndarray of shape (n, 3), float64
        World points along the rim.
    tangent, normal : ndarray of shape (3,)
        Unit vectors; the normal points to the side of the eye.
    origin : ndarray of shape (3,)
        Where its texture coordinates are zero.
    layer : int
        Back to front: 0 far faces of the box, 1 cut plane, 2 near faces. Pieces of one layer never overlap in
        an image, and layers are drawn in order.
    """

    corners: Float64Array
    tangent: Float64Array
    normal: Float64Array
    origin: Float64Array
    layer: int


def polygons(
    corners: Float64Array,
    axes: Float64Array,
    *,
    surface: str,
    plane: tuple[Vector | None, Vector | None],
    up: Vector | None,
    eye: Float64Array,
) -> list[Polygon]:
    """The pieces of surface that are seen.

    Parameters
    ----------
    corners : ndarray of shape (8, 3)
        World corners of the cropped box; bit 0 of the row is x, bit 1 y, bit 2 z.
    axes : ndarray of shape (3, 3)
        Columns are the world directions of the volume's axes; the third is above unless `up` is given.
    surface : {"plane", "box", "both"}
        What is shown.
    plane : tuple of (origin, normal)
        Of the cut plane; None = `volviz.model.cut_plane.default_cut_plane`.
    up : tuple of 3 floats or None
        Direction of the upper side of patterns.
    eye : ndarray of shape (3,)
        World position of the eye; far behind the view for parallel projection.

    Returns
    -------
    list of Polygon
        In ascending layers; empty when the plane misses the box.
    """
    ups: list[Float64Array] = [axes[:, 2], axes[:, 1], axes[:, 0]]
    if up is not None and np.any(up):
        ups.insert(0, np.asarray(up, np.float64))
    pieces: list[Polygon] = []
    if surface in {"plane", "both"}:
        default_origin, default_normal = default_cut_plane(corners)
        origin = np.asarray(plane[0] if plane[0] is not None else default_origin, np.float64)
        normal = np.asarray(plane[1] if plane[1] is not None else default_normal, np.float64)
        length = np.linalg.norm(normal)
        normal = normal / length if length > 0 else np.asarray(default_normal)
        vertices, counts = slice_polygons(corners, normal, [float(origin @ normal)])
        if counts[0]:
            pieces.append(_piece(vertices[0, : counts[0]], normal, origin, ups, eye, layer=1))
    if surface in {"box", "both"}:
        middle = corners.mean(axis=0)
        for numbers in _FACES:
            rim = corners[list(numbers)]
            outward = np.cross(rim[1] - rim[0], rim[3] - rim[0])
            if outward @ (rim[0] - middle) < 0:
                outward = -outward
            towards = float(outward @ (eye - rim[0])) > 0
            pieces.append(_piece(rim, outward, rim.mean(axis=0), ups, eye, layer=2 if towards else 0))
    return sorted(pieces, key=lambda piece: piece.layer)


def _piece(
    rim: Float64Array,
    normal: Float64Array,
    origin: Float64Array,
    ups: list[Float64Array],
    eye: Float64Array,
    *,
    layer: int,
) -> Polygon:
    # seen from behind, a surface shows the relief of that side
    facing = normal if normal @ (eye - origin) >= 0 else -normal
    tangent, _, unit = plane_basis(facing, ups)
    return Polygon(rim, tangent, unit, origin, layer)


def vertex_data(
    pieces: Sequence[Polygon], middle: Float64Array, subdivisions: int
) -> tuple[npt.NDArray[np.float32], list[tuple[int, int, int]]]:
    """Triangles of polygons, ready for a vertex buffer.

    Parameters
    ----------
    pieces : sequence of Polygon
        In ascending layers.
    middle : ndarray of shape (3,)
        World point that positions are relative to, so that float32 holds them well.
    subdivisions : int
        Pieces into which every edge of a triangle is divided.

    Returns
    -------
    data : ndarray of shape (V, 12), float32
        Position, normal, tangent with w = 1, texture coordinates in world units; three rows a triangle.
    ranges : list of (layer, first vertex, number of vertices)
        In ascending layers.
    """
    blocks: list[npt.NDArray[np.float32]] = []
    ranges: list[tuple[int, int, int]] = []
    first = 0
    for piece in pieces:
        fan = [(0, i, i + 1) for i in range(1, len(piece.corners) - 1)]
        triangles = piece.corners[np.array(fan)]
        points = np.einsum("vc,fci->fvi", _grid(subdivisions), triangles).reshape(-1, 3)
        binormal = np.cross(piece.normal, piece.tangent)
        block = np.empty((len(points), VERTEX_FLOATS), np.float32)
        block[:, 0:3] = points - middle
        block[:, 3:6] = piece.normal
        block[:, 6:9] = piece.tangent
        block[:, 9] = 1.0
        block[:, 10] = (points - piece.origin) @ piece.tangent
        block[:, 11] = (points - piece.origin) @ binormal
        blocks.append(block)
        if ranges and ranges[-1][0] == piece.layer:
            layer, start, count = ranges[-1]
            ranges[-1] = (layer, start, count + len(block))
        else:
            ranges.append((piece.layer, first, len(block)))
        first += len(block)
    return np.concatenate(blocks) if blocks else np.zeros((0, VERTEX_FLOATS), np.float32), ranges


def _grid(n: int) -> Float64Array:
    """Barycentric weights of the corners of n^2 equal triangles that make up one, shape (3 n^2, 3)."""
    weights = []
    for i in range(n):
        for j in range(n - i):
            cells = [((i, j), (i + 1, j), (i, j + 1))]
            if i + j < n - 1:
                cells.append(((i + 1, j), (i + 1, j + 1), (i, j + 1)))
            weights += [(1.0 - (a + b) / n, a / n, b / n) for cell in cells for a, b in cell]
    return np.array(weights)
