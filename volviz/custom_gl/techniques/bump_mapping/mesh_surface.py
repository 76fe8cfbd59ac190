"""A coarse isosurface mesh with a tangent space at every vertex."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.techniques.bump_mapping.surfaces import VERTEX_FLOATS
from volviz.kernels.tangents import box_projection
from volviz.model.volume import Volume


def mesh_data(
    volume: Volume, isovalue: float, stride: int
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.int32]]:
    """Vertices and triangles of an isosurface, ready for buffers.

    Parameters
    ----------
    volume : Volume
        The data.
    isovalue : float
        In data units.
    stride : int
        Every n-th voxel is used.

    Returns
    -------
    data : ndarray of shape (V, 12), float32
        Position relative to the volume's middle, normal, tangent with the binormal's sign, texture
        coordinates of a projection along the volume's axes, in world units.
    faces : ndarray of shape (F, 3), int32
        Vertex numbers.
    """
    # here, with the first mesh: it imports numba
    from volviz.kernels.marching import marching_cubes

    middle = np.asarray(volume.center)
    largest = max(2, min(volume.dimensions) - 1)
    vertices, faces, normals = marching_cubes(
        volume.array, isovalue, spacing=volume.spacing, origin=tuple(np.subtract(volume.origin, middle)),
        direction=volume.direction, stride=min(stride, largest),
    )  # fmt: skip
    assert normals is not None
    projected = box_projection(vertices, normals, faces, volume.direction)
    data = np.empty((len(projected.vertices), VERTEX_FLOATS), np.float32)
    data[:, 0:3] = vertices[projected.vertices]
    data[:, 3:6] = normals[projected.vertices]
    data[:, 6:10] = projected.tangents
    data[:, 10:12] = projected.uv
    return data, projected.faces.astype(np.int32)
