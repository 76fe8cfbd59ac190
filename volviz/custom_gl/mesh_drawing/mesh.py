"""The mesh of an image: extracted and filtered in voxel indices, taken to the world for whoever measures it."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.meshes.extraction import extract_triangles
from volviz.tasks import Cancel, Progress
from volviz.volume_data.volume import Volume

Array = npt.NDArray[Any]
#: Vertices that are taken to the world at once, so that double precision needs little memory.
PIECE = 1 << 18


@dataclass(frozen=True)
class MeshRequest:
    """What is to be extracted; equal requests give equal meshes.

    Attributes
    ----------
    volume : Volume
        The data; compared by identity. What is not finite counts as the lowest value.
    isovalue : float
        In data units.
    method : str
        As in `volviz.marching_cubes`.
    stride : int
        In voxels.
    largest_part : bool
        Keep only the connected part with the most triangles.
    min_triangles : int
        Keep only connected parts with at least this many triangles.
    smoothing : int
        Iterations of smoothing.
    decimation : float
        Share of the triangles to remove, 0 to 0.99.
    """

    volume: Volume
    isovalue: float
    method: str
    stride: int
    largest_part: bool = False
    min_triangles: int = 0
    smoothing: int = 0
    decimation: float = 0.0

    def coarser(self, factor: int) -> MeshRequest:
        """The same surface from every n-th of its voxels, for an LOD mesh.

        Its triangles are few already, and a part has fewer of them by the square of the factor.
        """
        return replace(
            self,
            stride=self.stride * factor,
            min_triangles=self.min_triangles // factor**2,
            decimation=self.decimation if factor == 1 else 0.0,
        )


@dataclass(frozen=True, eq=False)
class ReadyMesh:
    """A finished mesh in voxel indices of its volume.

    Attributes
    ----------
    request : MeshRequest
        What was asked for.
    vertices : ndarray of shape (V, 3), float32
        Continuous voxel indices (i, j, k).
    faces : ndarray of shape (F, 3), integers
        Vertex numbers.
    normals : ndarray of shape (V, 3), float32
        Direction of the falling gradient per voxel: a covector, taken to the world by the transposed inverse of
        the index-to-world matrix, so that neither spacing nor direction is part of the mesh.
    """

    request: MeshRequest
    vertices: npt.NDArray[np.float32]
    faces: npt.NDArray[Any]
    normals: npt.NDArray[np.float32]

    @property
    def triangles(self) -> int:
        """Number of triangles."""
        return len(self.faces)


def extracted(request: MeshRequest, progress: Progress, cancel: Cancel) -> ReadyMesh:
    """The mesh of a request; for a thread that nobody waits for.

    Parameters
    ----------
    request : MeshRequest
        What is to be extracted.
    progress, cancel : callable
        As in `volviz.marching_cubes`.
    """
    options = {f.name: getattr(request, f.name) for f in fields(request)}
    vertices, faces, normals = extract_triangles(
        **options, coordinates="index", progress=progress, cancel=cancel
    )
    return ReadyMesh(request, vertices, faces, np.zeros_like(vertices) if normals is None else normals)


def world_triangles(
    mesh: ReadyMesh,
) -> tuple[npt.NDArray[np.float32], npt.NDArray[Any], npt.NDArray[np.float32]]:
    """Take a mesh from voxel indices to the world.

    Parameters
    ----------
    mesh : ReadyMesh
        Of an image: `VolumeHandle.mesh`.

    Returns
    -------
    vertices : ndarray of shape (V, 3), float32
        World positions (x, y, z).
    faces : ndarray of shape (F, 3), integers
        Counter-clockwise seen from lower values, also when the volume's directions are left-handed.
    normals : ndarray of shape (V, 3), float32
        Unit vectors to lower values.
    """
    to_normals = np.linalg.inv(mesh.request.volume.index_to_world[:3, :3])
    vertices, faces = world_places(mesh)
    normals = np.empty(mesh.vertices.shape, np.float32)
    for begin in range(0, len(vertices), PIECE):
        piece = slice(begin, begin + PIECE)
        turned = mesh.normals[piece].astype(np.float64) @ to_normals
        lengths = np.linalg.norm(turned, axis=1, keepdims=True)
        normals[piece] = turned / np.where(lengths > 0, lengths, 1.0)
    return vertices, faces, normals


def world_places(mesh: ReadyMesh) -> tuple[npt.NDArray[np.float32], npt.NDArray[Any]]:
    """Vertices and faces of a mesh in the world, without normals; see `world_triangles`."""
    to_world = mesh.request.volume.index_to_world
    vertices = np.empty(mesh.vertices.shape, np.float32)
    for begin in range(0, len(vertices), PIECE):
        piece = slice(begin, begin + PIECE)
        vertices[piece] = mesh.vertices[piece].astype(np.float64) @ to_world[:3, :3].T + to_world[:3, 3]
    faces = mesh.faces
    if np.linalg.det(to_world[:3, :3]) < 0:
        faces = np.ascontiguousarray(faces[:, ::-1])
    return vertices, faces
