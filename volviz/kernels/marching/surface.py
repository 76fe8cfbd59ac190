"""What is done to a finished mesh: flat normals, dropping unused vertices, merging coincident ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.kernels.compiled import compiled

Array = npt.NDArray[Any]


@compiled
def _face_normals(vertices: Array, faces: Array, normals: Array) -> None:
    for f in range(faces.shape[0]):
        a, b, c = vertices[faces[f, 0]], vertices[faces[f, 1]], vertices[faces[f, 2]]
        ux, uy, uz = np.float64(b[0]) - a[0], np.float64(b[1]) - a[1], np.float64(b[2]) - a[2]
        vx, vy, vz = np.float64(c[0]) - a[0], np.float64(c[1]) - a[1], np.float64(c[2]) - a[2]
        x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        length = np.sqrt(x * x + y * y + z * z)
        scale = 1.0 / length if length > 0 else 0.0
        normals[f, 0], normals[f, 1], normals[f, 2] = x * scale, y * scale, z * scale


def face_normals(vertices: Array, faces: Array) -> npt.NDArray[np.float32]:
    """Unit normals of triangles by the right-hand rule.

    Parameters
    ----------
    vertices : ndarray of shape (V, 3)
        World positions (x, y, z).
    faces : ndarray of shape (F, 3), integers
        Vertex numbers.

    Returns
    -------
    ndarray of shape (F, 3), float32
        (0, 0, 0) for triangles without area.
    """
    normals = np.empty(faces.shape, np.float32)
    _face_normals(vertices, faces, normals)
    return normals


def drop_unused_vertices(
    vertices: Array, faces: Array, normals: Array | None
) -> tuple[Array, Array, Array | None]:
    """Keep only the vertices that a triangle uses, in their order.

    Parameters
    ----------
    vertices : ndarray of shape (V, 3)
    faces : ndarray of shape (F, 3), integers
    normals : ndarray of shape (V, 3) or None

    Returns
    -------
    tuple
        The same three, smaller.
    """
    used = np.zeros(len(vertices), bool)
    used[faces.ravel()] = True
    if used.all():
        return vertices, faces, normals
    number = np.cumsum(used, dtype=np.int64) - 1
    return vertices[used], number[faces].astype(faces.dtype), None if normals is None else normals[used]


def clean_mesh(vertices: Array, faces: Array, normals: Array | None) -> tuple[Array, Array, Array | None]:
    """Merge vertices at the same position and drop the triangles that vanish with it.

    An isovalue that equals a sample puts the crossings of up to six edges onto that sample. Merging them
    removes all triangles without area; the mesh may then touch itself in vertices and edges, as that of
    vtkMarchingCubes does.

    Parameters
    ----------
    vertices : ndarray of shape (V, 3), float32
    faces : ndarray of shape (F, 3), integers
    normals : ndarray of shape (V, 3) or None
        Of merged vertices the normal of the first one is kept.

    Returns
    -------
    tuple
        The same three, smaller. Vertices keep their order.
    """
    if not len(vertices):
        return vertices, faces, normals
    positions = vertices + 0.0  # -0.0 and 0.0 are one place
    order = np.lexsort(positions.T)
    ordered = positions[order]
    is_new = np.ones(len(order), bool)
    is_new[1:] = np.any(ordered[1:] != ordered[:-1], axis=1)
    group_starts = np.flatnonzero(is_new)
    # lexsort is stable: the first of each group is its lowest number.
    representative = np.empty(len(order), np.int64)
    representative[order] = order[group_starts][np.cumsum(is_new) - 1]
    merged = representative[faces]
    a, b, c = merged.T
    kept = merged[(a != b) & (b != c) & (c != a)].astype(faces.dtype)
    return drop_unused_vertices(vertices, kept, normals)
