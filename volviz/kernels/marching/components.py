"""Connected parts of a mesh: which triangles hang together, and keeping only the large parts."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.kernels.compiled import compiled
from volviz.kernels.marching.surface import drop_unused_vertices

Array = npt.NDArray[Any]


@compiled
def _root(parent: Array, vertex: int) -> int:
    while parent[vertex] != vertex:
        parent[vertex] = parent[parent[vertex]]
        vertex = parent[vertex]
    return vertex


@compiled
def _unite(faces: Array, parent: Array) -> None:
    """Give all vertices of a part the same root: its lowest vertex."""
    for f in range(faces.shape[0]):
        a = _root(parent, faces[f, 0])
        for i in range(1, 3):
            b = _root(parent, faces[f, i])
            if a < b:
                parent[b] = a
            elif b < a:
                parent[a] = b
                a = b


@compiled
def _label(faces: Array, parent: Array, labels: Array) -> int:
    """Number the parts in the order of their first triangles."""
    number = np.full(parent.size, -1, np.int64)
    count = 0
    for f in range(faces.shape[0]):
        root = _root(parent, faces[f, 0])
        if number[root] < 0:
            number[root] = count
            count += 1
        labels[f] = number[root]
    return count


def face_components(faces: Array, vertex_count: int) -> tuple[npt.NDArray[np.int64], int]:
    """Number the connected parts of a mesh; triangles that share a vertex belong together.

    Parameters
    ----------
    faces : ndarray of shape (F, 3), integers
        Vertex numbers, 0..vertex_count - 1.
    vertex_count : int

    Returns
    -------
    labels : ndarray of shape (F,), int64
        Part of each triangle, numbered from 0 in the order of their first triangles.
    count : int
        Number of parts.
    """
    parent = np.arange(vertex_count, dtype=np.int64)
    _unite(faces, parent)
    labels = np.empty(len(faces), np.int64)
    return labels, int(_label(faces, parent, labels))


def keep_components(
    vertices: Array,
    faces: Array,
    normals: Array | None,
    *,
    largest_only: bool = False,
    min_triangles: int = 0,
) -> tuple[Array, Array, Array | None]:
    """Keep the connected parts of a mesh that are large enough.

    Parameters
    ----------
    vertices : ndarray of shape (V, 3)
        World positions (x, y, z).
    faces : ndarray of shape (F, 3), integers
        Vertex numbers.
    normals : ndarray of shape (V, 3), one a triangle (F, 3), or None
        When V equals F they are taken to belong to the vertices.
    largest_only : bool, default: False
        Keep only the part with the most triangles; of equal ones the first.
    min_triangles : int, default: 0
        Keep parts with at least this many triangles.

    Returns
    -------
    tuple
        Vertices, faces and normals of what is kept.

    Raises
    ------
    InputError
        `min_triangles` is negative.
    """
    if min_triangles < 0:
        raise InputError(f"min_triangles must be 0 or more, got {min_triangles}.")
    if not len(faces):
        return vertices, faces, normals
    labels, count = face_components(faces, len(vertices))
    sizes = np.bincount(labels, minlength=count)
    kept = sizes >= min_triangles
    if largest_only:
        kept &= np.arange(count) == np.argmax(sizes)
    chosen = kept[labels]
    if chosen.all():
        return vertices, faces, normals
    per_face = normals is not None and len(normals) == len(faces) != len(vertices)
    if per_face and normals is not None:
        vertices, remaining, _ = drop_unused_vertices(vertices, faces[chosen], None)
        return vertices, remaining, normals[chosen]
    return drop_unused_vertices(vertices, faces[chosen], normals)
