"""Meshes with a tangent space at every vertex: an isosurface of the data, or one from a file."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.techniques.bump_mapping.receivers import VERTEX_FLOATS
from volviz.kernels.tangents import box_projection, vertex_tangents
from volviz.meshes.extraction import extract_triangles
from volviz.volume_data.volume import Volume


class MeshData(NamedTuple):
    """Vertices and triangles, ready for buffers.

    Attributes
    ----------
    data : ndarray of shape (V, 12), float32
        Position relative to the volume's middle, normal, tangent with the binormal's sign, texture coordinates.
    faces : ndarray of shape (F, 3), int32
        Vertex numbers.
    own_uv : bool
        The texture coordinates are those of the file, in repeats of the pattern; otherwise those of a projection along
        the volume's axes, in world units.
    notice : str
        What people should know; empty when all is as they would expect.
    """

    data: npt.NDArray[np.float32]
    faces: npt.NDArray[np.int32]
    own_uv: bool = False
    notice: str = ""


def isosurface_mesh(
    volume: Volume, isovalue: float, stride: int, cancel: Callable[[], bool] | None = None
) -> MeshData:
    """A coarse isosurface of a volume.

    Parameters
    ----------
    volume : Volume
        The data.
    isovalue : float
        In data units.
    stride : int
        Every n-th voxel is used.
    cancel : callable, optional
        When it returns True the work ends with `Cancelled`.
    """
    largest = max(2, min(volume.dimensions) - 1)
    vertices, faces, normals = extract_triangles(
        volume, isovalue, coordinates="centred", stride=min(stride, largest), cancel=cancel
    )
    return _projected(vertices, normals, faces, volume)


def file_mesh(volume: Volume, triangles: Any, name: str) -> MeshData:
    """A mesh from a file in the world of a volume, with a basis per vertex.

    Parameters
    ----------
    volume : Volume
        Whose middle positions are relative to, and along whose axes a mesh without texture coordinates is projected.
    triangles : object
        With the fields vertices, faces, normals, uv: see `volviz.meshes.reading.FileTriangles`.
    name : str
        Of the file, for the notice.
    """
    vertices = triangles.vertices - np.asarray(volume.center)
    corners = np.asarray(volume.corners) - np.asarray(volume.center)
    apart = (vertices.min(axis=0) > corners.max(axis=0)) | (vertices.max(axis=0) < corners.min(axis=0))
    notice = (
        f"{name} lies outside the volume: nothing of it is shown; move the mesh into the volume's place."
        if apart.any()
        else ""
    )
    if triangles.uv is None:
        return _projected(vertices, triangles.normals, triangles.faces, volume)._replace(notice=notice)
    tangents = vertex_tangents(vertices, triangles.normals, triangles.faces, triangles.uv)
    data = _packed(vertices, triangles.normals, tangents, triangles.uv)
    return MeshData(data, triangles.faces.astype(np.int32), own_uv=True, notice=notice)


def _projected(vertices: Any, normals: Any, faces: Any, volume: Volume) -> MeshData:
    projected = box_projection(vertices, normals, faces, volume.direction)
    kept = projected.vertices
    data = _packed(vertices[kept], normals[kept], projected.tangents, projected.uv)
    return MeshData(data, projected.faces.astype(np.int32))


def _packed(vertices: Any, normals: Any, tangents: Any, uv: Any) -> npt.NDArray[np.float32]:
    data = np.empty((len(vertices), VERTEX_FLOATS), np.float32)
    data[:, 0:3], data[:, 3:6], data[:, 6:10], data[:, 10:12] = vertices, normals, tangents, uv
    return data
