"""NumPy archives (.npz): one of their arrays, read block by block."""

from __future__ import annotations

import math
import zipfile
import zlib
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from volviz.io.axes import usual_axes
from volviz.io.endings import NPZ
from volviz.io.entries import Entry, choose_entry
from volviz.io.geometry import Geometry
from volviz.io.numpy_files import read_header
from volviz.io.pyramid import StoredLevel, pyramid_source
from volviz.io.reader import stem

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.pyramid import Index
    from volviz.io.reader import LoadRequest


_DAMAGE = (zipfile.BadZipFile, zlib.error, EOFError, ValueError, NotImplementedError, KeyError, RuntimeError)


def sniff(head: bytes, path: Path) -> bool:
    """Whether this is a zip file whose first member is a NumPy array."""
    if not head.startswith(b"PK\x03\x04") or not path.is_file():
        return False
    try:
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
    except _DAMAGE:
        return path.suffix.lower() == ".npz"
    return bool(names) and all(name.endswith(".npy") for name in names)


def open_source(request: LoadRequest) -> FileSource:
    """The array that is asked for, or the largest one with three axes or more."""
    headers: list[tuple[Entry, bool]] = []
    try:
        with zipfile.ZipFile(request.path) as archive:
            for name in archive.namelist():
                request.check_cancelled()
                with archive.open(name) as stream:
                    shape, fortran, dtype = read_header(request, stream)
                if dtype.kind in "buifc" and 3 <= len(shape) <= 5 and sum(n > 1 for n in shape) >= 3:
                    headers.append((Entry(name.removesuffix(".npy"), shape, dtype.str), fortran))
    except _DAMAGE:
        raise request.error("this archive is damaged or cut off; get it again.") from None
    if not headers:
        raise request.error(
            "it holds no array of numbers with three axes or more; a volume needs z, y and x."
        )
    entries = [entry for entry, _ in headers]
    chosen, fortran = headers[choose_entry(request, entries, what="array")]
    dtype = np.dtype(chosen.dtype)
    axes, shape = usual_axes(chosen.sizes, dtype), chosen.sizes
    if fortran:
        # the file holds the reversed array in C order
        axes, shape = axes[::-1], shape[::-1]
    stored = _StoredArray(request.path, chosen.name, shape, dtype)
    return pyramid_source(
        request,
        axes,
        [StoredLevel(shape, Geometry(), stored.read)],
        dtype,
        format="NumPy archive",
        name=stem(request.path, NPZ) if len(entries) == 1 else chosen.name,
        entries=entries,
    )


class _StoredArray:
    """An array of an archive, in C order."""

    def __init__(self, path: Path, name: str, shape: tuple[int, ...], dtype: np.dtype[Any]) -> None:
        self._path = path
        self._name = name
        self._shape = shape
        self._dtype = dtype

    def read(self, index: Index, request: LoadRequest) -> npt.NDArray[Any]:
        """Entry by entry along the first axis, of which those are kept that are wanted."""
        first, rest = index[0], index[1:]
        wanted = range(first, first + 1) if isinstance(first, int) else range(first.start, first.stop)
        size = math.prod(self._shape[1:]) * self._dtype.itemsize
        kept: list[npt.NDArray[Any]] = []
        try:
            with zipfile.ZipFile(self._path) as archive, archive.open(f"{self._name}.npy") as stream:
                read_header(request, stream)
                for at in range(wanted.stop):
                    request.report(at / wanted.stop, "reading")
                    block = _exactly(stream, size)
                    if at in wanted:
                        kept.append(np.frombuffer(block, self._dtype).reshape(self._shape[1:])[rest])
        except _DAMAGE:
            raise request.error("the array is damaged or cut off; get the file again.") from None
        return kept[0] if isinstance(first, int) else np.stack(kept)


def _exactly(stream: IO[bytes], size: int) -> bytes:
    block = stream.read(size)
    if len(block) != size:
        raise EOFError
    return block
