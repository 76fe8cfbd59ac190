"""Meshes extracted in the background; the newest wish counts."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import Cancelled
from volviz.kernels.marching import marching_cubes
from volviz.model.volume import Volume


@dataclass(frozen=True)
class MeshWish:
    """What is to be extracted; equal wishes give equal meshes.

    Attributes
    ----------
    volume : Volume
        The data; compared by identity.
    isovalue : float
        In data units.
    method : str
        As in `volviz.marching_cubes`.
    stride : int
        In voxels.
    """

    volume: Volume
    isovalue: float
    method: str
    stride: int


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

    def __init__(self, wish: MeshWish) -> None:
        self.wish = wish
        self.mesh: ReadyMesh | None = None
        self.error: Exception | None = None
        self.cancelled = threading.Event()
        # not a task of the shared pool: the extraction itself hands its pieces to that pool and waits for them
        self.thread = threading.Thread(target=self._work, name="volviz-mesh", daemon=True)
        self.thread.start()

    def _work(self) -> None:
        try:
            vertices, faces, normals = marching_cubes(
                self.wish.volume.array,
                self.wish.isovalue,
                method=self.wish.method,
                stride=self.wish.stride,
                cancel=self.cancelled.is_set,
            )
        except Cancelled:
            return
        except Exception as error:  # noqa: BLE001 - raised again where the mesh is asked for
            self.error = error
            return
        if normals is None:
            normals = np.zeros_like(vertices)
        self.mesh = ReadyMesh(self.wish, vertices, faces, normals)


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
        self._meshes: list[ReadyMesh] = []
        self._job: _Job | None = None

    @property
    def last(self) -> ReadyMesh | None:
        """The mesh that was finished or asked for last."""
        return self._meshes[-1] if self._meshes else None

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
                self._job = _Job(wish)
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
