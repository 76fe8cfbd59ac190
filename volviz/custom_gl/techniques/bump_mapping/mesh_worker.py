"""The mesh is made on a thread of its own; the drawing waits a moment for it and asks again."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from volviz.custom_gl.techniques.bump_mapping.mesh_surface import MeshData
from volviz.errors import Cancelled

#: Makes the mesh; asks the callable whether it is still wanted.
Make = Callable[[Callable[[], bool]], MeshData]


class MeshWorker:
    """Makes one mesh at a time and keeps the last; a wish that has changed cancels the one in work."""

    def __init__(self) -> None:
        self._key: Any = None
        self._mesh: MeshData | None = None
        self._job: _Job | None = None

    def get(self, key: Any, make: Make, patience: float) -> MeshData | None:
        """The mesh of a key, or None when it is not ready within `patience` seconds.

        Raises
        ------
        VolvizError
            Whatever making it raised; the next call tries again.
        """
        if self._mesh is not None and self._key == key:
            return self._mesh
        if self._job is not None and self._job.key != key:
            self._job.cancelled.set()
            self._job.thread.join(patience)
            if self._job.thread.is_alive():
                return None
            self._job = None
        if self._job is None:
            self._job = _Job(key, make)
        self._job.thread.join(patience)
        if self._job.thread.is_alive():
            return None
        job, self._job = self._job, None
        if job.error is not None:
            raise job.error
        self._key, self._mesh = job.key, job.mesh
        return self._mesh

    def close(self) -> None:
        """Stop working and forget the mesh."""
        if self._job is not None:
            self._job.cancelled.set()
            self._job.thread.join()
            self._job = None
        self._key = self._mesh = None


class _Job:
    def __init__(self, key: Any, make: Make) -> None:
        self.key = key
        self.mesh: MeshData | None = None
        self.error: Exception | None = None
        self.cancelled = threading.Event()
        self._make = make
        # not a task of the shared pool: the extraction itself hands its pieces to that pool and waits for them
        self.thread = threading.Thread(target=self._work, name="volviz-bump-mesh", daemon=True)
        self.thread.start()

    def _work(self) -> None:
        try:
            self.mesh = self._make(self.cancelled.is_set)
        except Cancelled:
            return
        except Exception as error:  # noqa: BLE001 - raised again where the mesh is asked for
            self.error = error
