"""Meshes extracted and filtered for a picture, in voxel indices of their volume."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.model.volume import Volume
from volviz.tasks import Cancel, Progress

Array = npt.NDArray[Any]
#: ``filter_triangles`` of the host; see there.
TriangleFilter = Callable[..., tuple[npt.NDArray[np.float32], Array, npt.NDArray[np.float32]]]
#: Part of the work that the extraction is when filters follow.
EXTRACTION_SHARE = 0.2


@dataclass(frozen=True)
class MeshWish:
    """What is to be extracted; equal wishes give equal meshes.

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

    @property
    def is_filtered(self) -> bool:
        """Whether smoothing or decimation follow the extraction."""
        return bool(self.smoothing or self.decimation)

    def coarser(self, factor: int) -> MeshWish:
        """The same surface from every n-th of its voxels, for a stand-in.

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
    wish : MeshWish
        What was asked for.
    vertices : ndarray of shape (V, 3), float32
        Continuous voxel indices (i, j, k).
    faces : ndarray of shape (F, 3), integers
        Vertex numbers.
    normals : ndarray of shape (V, 3), float32
        Direction of the falling gradient per voxel: a covector, taken to the world by the transposed inverse of
        the index-to-world matrix, so that neither spacing nor direction is part of the mesh.
    """

    wish: MeshWish
    vertices: npt.NDArray[np.float32]
    faces: npt.NDArray[Any]
    normals: npt.NDArray[np.float32]

    @property
    def triangles(self) -> int:
        """Number of triangles."""
        return len(self.faces)


def extracted(wish: MeshWish, refine: TriangleFilter | None, progress: Progress, cancel: Cancel) -> ReadyMesh:
    """The mesh of a wish; for a thread that nobody waits for.

    Parameters
    ----------
    wish : MeshWish
        What is to be extracted.
    refine : callable or None
        Smooths and decimates; without one, the mesh stays as it was extracted.
    progress, cancel : callable
        As in `volviz.marching_cubes`.
    """
    # here, on a thread of its own: it imports numba
    from volviz.kernels.marching import keep_components, marching_cubes

    share = EXTRACTION_SHARE if wish.is_filtered else 1.0
    vertices, faces, normals = marching_cubes(
        wish.volume.finite_array,
        wish.isovalue,
        method=wish.method,
        stride=wish.stride,
        progress=lambda part: progress(share * part),
        cancel=cancel,
    )
    if wish.largest_part or wish.min_triangles:
        vertices, faces, normals = keep_components(
            vertices, faces, normals, largest_only=wish.largest_part, min_triangles=wish.min_triangles
        )
    if wish.is_filtered and len(faces) and refine is not None:
        # lengths are those of the world; its origin would only cost digits
        to_world = wish.volume.index_to_world[:3, :3]
        moved, faces, shading = refine(
            (vertices @ to_world.T).astype(np.float32),
            faces,
            smoothing=wish.smoothing,
            decimation=wish.decimation,
            progress=lambda part: progress(share + (1 - share) * part),
            cancel=cancel,
        )
        vertices = (moved @ np.linalg.inv(to_world).T).astype(np.float32)
        # a mirrored lattice turns the triangles over, and with them their normals
        sign = np.sign(np.linalg.det(to_world))
        covectors = shading @ (sign * to_world)
        lengths = np.linalg.norm(covectors, axis=1, keepdims=True)
        normals = (covectors / np.where(lengths > 0, lengths, 1.0)).astype(np.float32)
    if normals is None:
        normals = np.zeros_like(vertices)
    return ReadyMesh(wish, vertices, faces, normals)
