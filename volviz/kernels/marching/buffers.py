"""Memory of meshes that are gone, kept for the next one.

Pages that the system hands out for the first time have to be cleared, which takes about as long as filling
them with a mesh. Whoever drags an isovalue makes meshes of nearly the same size one after the other, so the
memory of the last ones is kept, up to `KEPT_BYTES`, and given out again once nothing refers to it any more.
"""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import numpy.typing as npt

#: Most memory that is kept, in bytes.
KEPT_BYTES = 256 * 2**20
#: Smaller arrays are not worth keeping: the C library does that.
SMALLEST = 2**18

_lock = threading.Lock()
_pool: list[npt.NDArray[np.uint8]] = []


class _Lease:
    """Owns a buffer as long as an array, or a view of one, refers to it; then the buffer goes back."""

    def __init__(self, buffer: npt.NDArray[np.uint8], size: int) -> None:
        self._buffer = buffer
        interface = buffer.__array_interface__
        self.__array_interface__ = {**interface, "shape": (size,), "strides": None}

    def __del__(self) -> None:
        _give_back(self._buffer)


def new_array(count: int, dtype: npt.DTypeLike) -> npt.NDArray[Any]:
    """An array with arbitrary contents, in kept memory when there is some of the right size.

    Parameters
    ----------
    count : int
        Number of elements.
    dtype : dtype
        Their type.

    Returns
    -------
    ndarray of shape (count,)
        Nothing else refers to its memory.
    """
    kind = np.dtype(dtype)
    size = count * kind.itemsize
    if size < SMALLEST:
        return np.empty(count, kind)
    buffer = _take(size)
    if buffer is None:
        # A little more than needed, so that the next, slightly larger mesh fits.
        buffer = np.empty(size + size // 8, np.uint8)
    return np.asarray(_Lease(buffer, size)).view(kind)


def release_kept_memory() -> None:
    """Give all kept memory back to the system."""
    with _lock:
        _pool.clear()


def _take(size: int) -> npt.NDArray[np.uint8] | None:
    """The smallest kept buffer that is large enough and not wastefully larger."""
    with _lock:
        fitting = [i for i, buffer in enumerate(_pool) if size <= buffer.nbytes <= size + size // 2]
        if not fitting:
            return None
        return _pool.pop(min(fitting, key=lambda i: _pool[i].nbytes))


def _give_back(buffer: npt.NDArray[np.uint8]) -> None:
    # A collection of garbage may call this while this very thread holds the lock: then the buffer is just
    # freed.
    if buffer.nbytes > KEPT_BYTES // 2 or not _lock.acquire(blocking=False):
        return
    try:
        _pool.append(buffer)
        total = sum(pooled.nbytes for pooled in _pool)
        while total > KEPT_BYTES:
            total -= _pool.pop(0).nbytes
    finally:
        _lock.release()
