"""Reading HDF5 on the thread of readers: the library lets only one call in at a time."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from volviz.errors import VolvizError
from volviz.io import reader_thread

if TYPE_CHECKING:
    from pathlib import Path

    import h5py
    import numpy.typing as npt

    from volviz.io.pyramid import Index
    from volviz.io.reader import LoadRequest

Result = TypeVar("Result")

#: Bytes that are read at once.
_PIECE = 8 << 20


def on_thread(request: LoadRequest, work: Callable[[], Result], path: Path | None = None) -> Result:
    """What a piece of work gives that is done on the thread of HDF5.

    Raises
    ------
    LoadError
        Instead of what the library raises.
    Cancelled
    """
    try:
        return request.wait(reader_thread.submit(work))
    except (VolvizError, MemoryError):
        raise
    except Exception as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise
        words = str(error).lower()
        if "filter" in words:
            told = (
                "its values are packed by a filter that HDF5 itself does not have; save it again with gzip."
            )
        elif "truncated" in words:
            told = "the file is cut off; get it again."
        else:
            told = "this HDF5 file is damaged or of an unusual kind; get it again."
        raise request.error(told, path) from None


def opened(path: Path) -> h5py.File:
    """The file, also while another program writes to it."""
    import h5py

    return h5py.File(path, "r", locking=False)


@dataclass(frozen=True)
class StoredDataset:
    """A data set of a file.

    Attributes
    ----------
    path : Path
    name : str
        Inside the file.
    dtype : dtype, optional
        Read the bytes as these (unsigned numbers that are stored as signed ones).
    """

    path: Path
    name: str
    dtype: np.dtype[Any] | None = None

    def read(self, index: Index, request: LoadRequest) -> npt.NDArray[Any]:
        """Values of a number or slice along each axis, a few chunks at a time."""
        file = on_thread(request, lambda: opened(self.path), self.path)
        try:
            dataset, stored, chunks = on_thread(request, lambda: _look_at(file, self.name), self.path)
            shape = tuple(i.stop - i.start for i in index if isinstance(i, slice))
            values = np.empty(shape, stored)
            at = next(n for n, i in enumerate(index) if isinstance(i, slice))
            whole = index[at]
            assert isinstance(whole, slice)
            step = _step(chunks[at] if chunks else 1, values.nbytes // max(shape[0], 1))
            edges = [whole.start, *range((whole.start // step + 1) * step, whole.stop, step), whole.stop]
            for low, high in itertools.pairwise(edges):
                request.report((low - whole.start) / len(values), "reading")
                part = (*index[:at], slice(low, high), *index[at + 1 :])
                out = values[low - whole.start : high - whole.start]
                on_thread(request, partial(_copy, dataset, part, out), self.path)
        finally:
            # behind whatever still runs for this file
            reader_thread.submit(file.close)
        return values if self.dtype is None else values.view(self.dtype)


def _look_at(file: h5py.File, name: str) -> tuple[Any, np.dtype[Any], tuple[int, ...] | None]:
    dataset = file[name]
    return dataset, dataset.dtype, dataset.chunks


def _copy(dataset: Any, part: Index, out: npt.NDArray[Any]) -> None:
    # an array without axes takes a single number, and a piece may be one
    out[...] = dataset[part]


def _step(chunk: int, bytes_each: int) -> int:
    """Entries along an axis that are read at once: whole chunks, some megabytes."""
    return chunk * max(_PIECE // max(chunk * bytes_each, 1), 1)


def text(value: Any) -> str:
    """An attribute as text: one text, bytes, or an array of single letters."""
    if isinstance(value, np.ndarray):
        if value.dtype.kind == "S" and value.ndim:
            value = b"".join(value.ravel().tolist())
        elif value.size == 1:
            value = value.ravel()[0]
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace").strip("\0 ")
    return value.strip() if isinstance(value, str) else ""


def numbers(value: Any, count: int | None = None) -> list[float] | None:
    """An attribute as finite numbers (so many), also those that are written as text; None where it is none."""
    try:
        if isinstance(value, bytes | str) or (isinstance(value, np.ndarray) and value.dtype.kind == "S"):
            found = [float(part) for part in text(value).replace(",", " ").split()]
        else:
            found = [float(v) for v in np.ravel(value)]
    except (TypeError, ValueError):
        return None
    if (count is not None and len(found) != count) or not all(map(math.isfinite, found)):
        return None
    return found
