"""MATLAB files of version 5 to 7.2 (.mat), by SciPy; those of 7.3 are HDF5 files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import VolvizError
from volviz.io import reader_thread
from volviz.io.endings import MATLAB
from volviz.io.entries import Entry, choose_entry
from volviz.io.geometry import Geometry
from volviz.io.hdf5.axes import matlab_axes
from volviz.io.pyramid import StoredLevel, pyramid_source
from volviz.io.reader import stem

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.pyramid import Index
    from volviz.io.reader import LoadRequest


_TYPES = {"double": "float64", "single": "float32", "logical": "bool"}
_TYPES |= {f"{sign}int{bits}": f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)}


def sniff(head: bytes, _path: Path) -> bool:
    """Whether these are the first bytes of a MATLAB file of version 5."""
    return head.startswith(b"MATLAB 5.0 MAT-file")


def open_source(request: LoadRequest) -> FileSource:
    """The variable that is asked for, or the largest one with three axes or more."""
    from scipy.io import whosmat

    entries = [
        Entry(name, tuple(map(int, shape)), _TYPES[kind])
        for name, shape, kind in _guarded(request, lambda: whosmat(str(request.path)))
        if kind in _TYPES and 3 <= len(shape) <= 5 and sum(n > 1 for n in shape) >= 3
    ]
    if not entries:
        raise request.error(
            "it holds no array of numbers with three axes or more; fields of structures are not looked at."
        )
    chosen = entries[choose_entry(request, entries, what="variable")]
    request.note("MATLAB counts rows first: rows are taken for y, columns for x, pages for z.")
    return pyramid_source(
        request,
        matlab_axes(chosen.sizes),
        [StoredLevel(chosen.sizes, Geometry(), _Variable(request.path, chosen).read)],
        chosen.dtype,
        format="MATLAB",
        name=stem(request.path, MATLAB) if len(entries) == 1 else chosen.name,
        entries=entries,
    )


class _Variable:
    """A variable of a file; SciPy reads it as a whole."""

    def __init__(self, path: Path, entry: Entry) -> None:
        self._path = path
        self._entry = entry

    def read(self, index: Index, request: LoadRequest) -> npt.NDArray[Any]:
        from scipy.io import loadmat

        request.report(0.0, "reading")
        name = self._entry.name
        found = _guarded(request, lambda: loadmat(str(self._path), variable_names=[name]).get(name))
        if getattr(found, "shape", None) != self._entry.sizes:
            raise request.error("this MATLAB file is damaged; get it again.")
        values = np.asarray(found)
        # true and false come as bytes
        return (values.astype(bool) if self._entry.dtype == "bool" else values)[index]


def _guarded(request: LoadRequest, work: Callable[[], Any]) -> Any:
    try:
        return request.wait(reader_thread.submit(work))
    except (VolvizError, MemoryError):
        raise
    except Exception as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise
        raise request.error("this MATLAB file is damaged or cut off; get it again.") from None
