"""The mesh of a picture in world units, for whoever measures, picks or exports it."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.mesh_drawing.store import ReadyMesh

#: Vertices that are taken to the world at once, so that double precision needs little memory.
PIECE = 1 << 18


def world_triangles(
    mesh: ReadyMesh,
) -> tuple[npt.NDArray[np.float32], npt.NDArray[Any], npt.NDArray[np.float32]]:
    """Take a mesh from voxel indices to the world.

    Parameters
    ----------
    mesh : ReadyMesh
        Of a picture: `VolumeHandle.mesh`.

    Returns
    -------
    vertices : ndarray of shape (V, 3), float32
        World positions (x, y, z).
    faces : ndarray of shape (F, 3), integers
        Counter-clockwise seen from lower values, also when the volume's directions are left-handed.
    normals : ndarray of shape (V, 3), float32
        Unit vectors to lower values.
    """
    to_normals = np.linalg.inv(mesh.wish.volume.index_to_world[:3, :3])
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
    to_world = mesh.wish.volume.index_to_world
    vertices = np.empty(mesh.vertices.shape, np.float32)
    for begin in range(0, len(vertices), PIECE):
        piece = slice(begin, begin + PIECE)
        vertices[piece] = mesh.vertices[piece].astype(np.float64) @ to_world[:3, :3].T + to_world[:3, 3]
    faces = mesh.faces
    if np.linalg.det(to_world[:3, :3]) < 0:
        faces = np.ascontiguousarray(faces[:, ::-1])
    return vertices, faces
