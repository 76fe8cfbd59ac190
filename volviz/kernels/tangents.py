"""Tangent space: a basis (t, b, n) at every vertex, in which normal maps are written.

t points to where u grows, b = n x t to where v grows. (With t x n instead, the green channel of every map is
upside down.) A mirrored parametrisation, where b would have to be -(n x t), is told by a fourth component of
the tangent: b = w (n x t), as in glTF.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.kernels.compiled import compiled

Array = npt.NDArray[Any]
Float64Array = npt.NDArray[np.float64]

#: Sine of the angle between normal and up direction below which another direction is taken as up.
_PARALLEL = 1e-6
#: How often normals are averaged with their neighbours before a side is chosen for each triangle.
_SMOOTHING = 12


class ProjectedMesh(NamedTuple):
    """A mesh with texture coordinates; vertices on the border of two projections occur once for each.

    Attributes
    ----------
    vertices : ndarray of shape (W,), int64
        For each new vertex the number of the old one.
    faces : ndarray of shape (F, 3), int64
        Numbers of new vertices.
    uv : ndarray of shape (W, 2), float64
        Texture coordinates in world units.
    tangents : ndarray of shape (W, 4), float64
        Unit tangents, perpendicular to the vertex normals, and w = +-1.
    """

    vertices: npt.NDArray[np.int64]
    faces: npt.NDArray[np.int64]
    uv: Float64Array
    tangents: Float64Array


def plane_basis(
    normal: npt.ArrayLike, ups: Sequence[npt.ArrayLike]
) -> tuple[Float64Array, Float64Array, Float64Array]:
    """The basis of a plane, upright as seen from the side its normal points to.

    Parameters
    ----------
    normal : array_like of shape (3,)
        Not zero.
    ups : sequence of array_like of shape (3,)
        Directions that may lie above; the first one that is not parallel to the normal is taken.

    Returns
    -------
    tangent, binormal, normal : ndarray of shape (3,), float64
        Orthonormal and right-handed; the binormal is the up direction as far as it lies in the plane. Turning
        `normal` and `ups` turns the basis.
    """
    n = np.asarray(normal, np.float64)
    length = np.linalg.norm(n)
    if not (np.isfinite(length) and length > 0):
        raise InputError(f"a plane needs a normal that is not zero, got {normal!r}.")
    n = n / length
    for up in ups:
        direction = np.asarray(up, np.float64)
        t = np.cross(direction, n)
        size = np.linalg.norm(t)
        if size > _PARALLEL * np.linalg.norm(direction):
            t = t / size
            return t, np.cross(n, t), n
    raise InputError("a plane needs an upper side: give a direction that is not parallel to its normal.")


def vertex_tangents(
    positions: npt.ArrayLike, normals: npt.ArrayLike, faces: npt.ArrayLike, uv: npt.ArrayLike
) -> Float64Array:
    """Tangents of a mesh from its texture coordinates.

    The direction in which u grows in each triangle, summed over the triangles of a vertex and made
    perpendicular to its normal (Lengyel, *Mathematics for 3D Game Programming and Computer Graphics*, section 7.8).

    Parameters
    ----------
    positions : array_like of shape (V, 3)
        World positions.
    normals : array_like of shape (V, 3)
        Unit vectors.
    faces : array_like of shape (F, 3)
        Vertex numbers of triangles.
    uv : array_like of shape (V, 2)
        Texture coordinates.

    Returns
    -------
    ndarray of shape (V, 4), float64
        Unit tangent and w; the binormal is w (n x t). Where the texture coordinates give no direction, any
        vector perpendicular to the normal.
    """
    p, n = np.asarray(positions, np.float64), np.asarray(normals, np.float64)
    f, t = np.asarray(faces, np.int64), np.asarray(uv, np.float64)
    if p.shape != n.shape or p.ndim != 2 or p.shape[1] != 3 or t.shape != (len(p), 2) or f.ndim != 2:
        raise InputError(
            f"positions and normals must be (V, 3), uv (V, 2) and faces (F, 3), got {p.shape}, {n.shape}, "
            f"{t.shape} and {f.shape}."
        )
    edge1, edge2 = p[f[:, 1]] - p[f[:, 0]], p[f[:, 2]] - p[f[:, 0]]
    du1, dv1 = (t[f[:, 1]] - t[f[:, 0]]).T
    du2, dv2 = (t[f[:, 2]] - t[f[:, 0]]).T
    area = du1 * dv2 - du2 * dv1
    inverse = np.divide(1.0, area, out=np.zeros_like(area), where=area != 0)[:, None]
    along_u = (edge1 * dv2[:, None] - edge2 * dv1[:, None]) * inverse
    along_v = (edge2 * du1[:, None] - edge1 * du2[:, None]) * inverse
    tangent, binormal = (_summed(part, f, len(p)) for part in (along_u, along_v))
    unit = _perpendicular(tangent, n)
    side = np.einsum("vi,vi->v", np.cross(n, unit), binormal)
    return np.concatenate([unit, np.where(side < 0, -1.0, 1.0)[:, None]], axis=1)


def box_projection(
    positions: npt.ArrayLike, normals: npt.ArrayLike, faces: npt.ArrayLike, axes: npt.ArrayLike
) -> ProjectedMesh:
    """Texture coordinates for a mesh that has none: each triangle is projected along the axis it faces most.

    Which one that is, the normals of its surroundings decide as well, so that patches with one projection are
    large and whole.

    Parameters
    ----------
    positions : array_like of shape (V, 3)
        World positions; texture coordinates count from the world's origin.
    normals : array_like of shape (V, 3)
        Unit vectors.
    faces : array_like of shape (F, 3)
        Vertex numbers of triangles.
    axes : array_like of shape (3, 3)
        Columns are the three axes of projection; the last one is above.

    Returns
    -------
    ProjectedMesh
        Never mirrored: w is +1 throughout.
    """
    p, n = np.asarray(positions, np.float64), np.asarray(normals, np.float64)
    f, a = np.asarray(faces, np.int64), np.asarray(axes, np.float64)
    across = _smoothed(np.ascontiguousarray(n), np.ascontiguousarray(f), _SMOOTHING)[f].sum(axis=1) @ a
    axis = np.argmax(np.abs(across), axis=1)
    side = 2 * axis + (np.take_along_axis(across, axis[:, None], axis=1)[:, 0] < 0)
    # one new vertex for each old one and side of the box
    keys = 6 * f + side[:, None]
    used = np.zeros(6 * len(p), bool)
    used[keys] = True
    numbers = (np.cumsum(used) - 1)[keys]
    vertices, sides = np.divmod(np.flatnonzero(used), 6)
    bases = [plane_basis((1.0, -1.0)[s % 2] * a[:, s // 2], (a[:, 2], a[:, 1])) for s in range(6)]
    along_u, along_v = (np.array([basis[i] for basis in bases])[sides] for i in (0, 1))
    old = p[vertices]
    uv = np.stack([np.einsum("vi,vi->v", old, along_u), np.einsum("vi,vi->v", old, along_v)], axis=1)
    tangents = np.concatenate([_perpendicular(along_u, n[vertices]), np.ones((len(vertices), 1))], axis=1)
    return ProjectedMesh(vertices, numbers.astype(np.int64), uv, tangents)


@compiled
def _smoothed(normals: Float64Array, faces: Array, rounds: int) -> Float64Array:
    """Normals, each replaced `rounds` times by the mean of its own and the mean of its triangles'."""
    result = normals.copy()
    total = np.empty_like(result)
    count = np.zeros(len(normals))
    for f in range(len(faces)):
        for corner in range(3):
            count[faces[f, corner]] += 1.0
    for _ in range(rounds):
        total[:] = 0.0
        for f in range(len(faces)):
            for i in range(3):
                mean = (result[faces[f, 0], i] + result[faces[f, 1], i] + result[faces[f, 2], i]) / 3.0
                for corner in range(3):
                    total[faces[f, corner], i] += mean
        for v in range(len(result)):
            if count[v] > 0.0:
                for i in range(3):
                    result[v, i] = 0.5 * result[v, i] + 0.5 * total[v, i] / count[v]
    return result


def _summed(per_face: Float64Array, faces: Array, count: int) -> Float64Array:
    return np.stack(
        [sum(np.bincount(faces[:, corner], per_face[:, i], count) for corner in range(3)) for i in range(3)],
        axis=1,
    )


def _perpendicular(vectors: Float64Array, normals: Float64Array) -> Float64Array:
    """Unit vectors along the parts of `vectors` that are perpendicular to `normals` (Gram-Schmidt)."""
    part = vectors - normals * np.einsum("vi,vi->v", vectors, normals)[:, None]
    length = np.linalg.norm(part, axis=1)
    lost = ~(length > 1e-9 * np.maximum(np.linalg.norm(vectors, axis=1), 1e-300))
    if np.any(lost):
        # along the axis that the normal is farthest from
        other = np.eye(3)[np.argmin(np.abs(normals[lost]), axis=1)]
        part[lost] = other - normals[lost] * np.einsum("vi,vi->v", other, normals[lost])[:, None]
        length[lost] = np.linalg.norm(part[lost], axis=1)
    return np.asarray(part / np.maximum(length, 1e-300)[:, None])
