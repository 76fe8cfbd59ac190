"""Meshes extracted and filtered in the background; the newest wish counts."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import Cancelled
from volviz.model.volume import Volume

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


class _Job:
    """One extraction on a thread of its own."""

    def __init__(self, wish: MeshWish, refine: TriangleFilter | None) -> None:
        self.wish = wish
        self.progress = 0.0
        self._refine = refine
        self.mesh: ReadyMesh | None = None
        self.error: Exception | None = None
        self.cancelled = threading.Event()
        # not a task of the shared pool: the extraction itself hands its pieces to that pool and waits for them
        self.thread = threading.Thread(target=self._work, name="volviz-mesh", daemon=True)
        self.thread.start()

    def _work(self) -> None:
        try:
            self.mesh = self._made()
        except Cancelled:
            return
        except Exception as error:  # noqa: BLE001 - raised again where the mesh is asked for
            self.error = error

    def _made(self) -> ReadyMesh:
        # here, on a thread of its own: it imports numba
        from volviz.kernels.marching import keep_components, marching_cubes

        wish = self.wish
        share = EXTRACTION_SHARE if wish.is_filtered else 1.0
        vertices, faces, normals = marching_cubes(
            wish.volume.finite_array,
            wish.isovalue,
            method=wish.method,
            stride=wish.stride,
            progress=lambda part: self._tell(share * part),
            cancel=self.cancelled.is_set,
        )
        if wish.largest_part or wish.min_triangles:
            vertices, faces, normals = keep_components(
                vertices, faces, normals, largest_only=wish.largest_part, min_triangles=wish.min_triangles
            )
        if wish.is_filtered and len(faces) and self._refine is not None:
            # lengths are those of the world; its origin would only cost digits
            to_world = wish.volume.index_to_world[:3, :3]
            moved, faces, shading = self._refine(
                (vertices @ to_world.T).astype(np.float32),
                faces,
                smoothing=wish.smoothing,
                decimation=wish.decimation,
                progress=lambda part: self._tell(share + (1 - share) * part),
                cancel=self.cancelled.is_set,
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

    def _tell(self, fraction: float) -> None:
        self.progress = fraction


class MeshStore:
    """Keeps the last meshes and makes the next one, one at a time.

    Parameters
    ----------
    keeps : int
        Number of meshes that are kept.
    cancels : bool
        Whether an extraction that nobody wants any more is cancelled. Not where a series of wishes comes faster
        than meshes can be made: each would be cancelled, and none ever shown.
    """

    def __init__(self, *, keeps: int, cancels: bool) -> None:
        self._keeps = keeps
        self._cancels = cancels
        #: Smooths and decimates; without one, meshes stay as they were extracted.
        self.refine: TriangleFilter | None = None
        self._meshes: list[ReadyMesh] = []
        self._job: _Job | None = None

    @property
    def last(self) -> ReadyMesh | None:
        """The mesh that was finished or asked for last."""
        return self._meshes[-1] if self._meshes else None

    @property
    def progress(self) -> float:
        """How far the mesh in work is, 0..1; 1 when there is none."""
        return 1.0 if self._job is None else self._job.progress

    def held(self, wish: MeshWish) -> ReadyMesh | None:
        """The mesh, if there is one already."""
        return next((mesh for mesh in self._meshes if mesh.wish == wish), None)

    def _put_last(self, mesh: ReadyMesh) -> None:
        self._meshes = [*(other for other in self._meshes if other is not mesh), mesh][-self._keeps :]

    def get(self, wish: MeshWish, patience: float) -> ReadyMesh | None:
        """The mesh, or None when it is not ready within `patience` seconds; `last` is then an older one.

        Raises
        ------
        Exception
            Whatever the extraction raised.
        """
        end = time.monotonic() + patience
        while True:
            ready = self.held(wish)
            if ready is not None:
                self._put_last(ready)
                return ready
            if self._job is None:
                self._job = _Job(wish, self.refine)
            elif self._cancels and self._job.wish != wish:
                self._job.cancelled.set()
            self._job.thread.join(max(end - time.monotonic(), 0.0))
            if self._job.thread.is_alive():
                return None
            job, self._job = self._job, None
            if job.error is not None:
                raise job.error
            if job.mesh is not None:
                self._put_last(job.mesh)

    def close(self) -> None:
        """Stop working and forget the meshes."""
        if self._job is not None:
            self._job.cancelled.set()
            self._job.thread.join()
            self._job = None
        self._meshes.clear()
