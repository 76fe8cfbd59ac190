"""Files packed as a whole (.nrrd.gz, .npy.bz2, .vti.xz): unpacked into a temporary file, then read as any other.

Readers that unpack while they read (NIfTI, raw) get what gzip has packed as it is.
"""

from __future__ import annotations

import bz2
import gzip
import lzma
import shutil
import tempfile
import weakref
import zlib
from dataclasses import replace
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from volviz.io.reader import PACKED_SUFFIXES
from volviz.volume_data.references import content_id

if TYPE_CHECKING:
    from collections.abc import Callable

    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest

GZIP = b"\x1f\x8b"

_BLOCK = 4 << 20

#: Bytes of the disk that stay free whatever a packed file holds.
_LEFT_FREE = 256 << 20

#: First bytes of the ways to pack, and what unpacks a file.
_UNPACKERS: dict[bytes, Callable[[IO[bytes]], Any]] = {
    GZIP: gzip.open, b"BZh": bz2.open, b"\xfd7zXZ\0": lzma.open,
}  # fmt: skip

_DAMAGE = (EOFError, zlib.error, lzma.LZMAError, gzip.BadGzipFile, OSError, ValueError)

#: Headers whose values lie in another file, which would not be found beside an unpacked copy.
_HEADERS = (".nhdr", ".mhd", ".hdr")


def is_packed(head: bytes) -> bool:
    """Whether these first bytes are those of a packed file."""
    return head.startswith(tuple(_UNPACKERS))


def unpacked_head(path: Path, count: int) -> bytes:
    """The first bytes of what a packed file holds; none of a damaged one."""
    with path.open("rb") as stream, _unpacker(stream) as plain:
        try:
            head: bytes = plain.read(count)
        except _DAMAGE:
            return b""
    return head


def open_unpacked(request: LoadRequest, opening: Callable[[LoadRequest], FileSource]) -> FileSource:
    """What a reader makes of the unpacked copy, which stays as long as the source does.

    Parameters
    ----------
    opening : callable(LoadRequest) -> FileSource
        Of the reader that knows what is packed.

    Raises
    ------
    LoadError
        Damaged, or larger than the room for temporary files; what the reader refuses.
    Cancelled
    """
    path = request.path
    name = path.name
    for suffix in PACKED_SUFFIXES:
        name = name[: -len(suffix)] if name.lower().endswith(suffix) else name
    if name.lower().endswith(_HEADERS):
        raise request.error("a packed header does not lead to the values beside it; unpack it first.")
    folder = Path(tempfile.mkdtemp(prefix="volviz-"))
    try:
        # under its own name, so that sentences name the file that was asked for
        _unpack(request, folder / path.name)
        source = opening(replace(request, path=folder / path.name))
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    weakref.finalize(source, shutil.rmtree, folder, ignore_errors=True)
    said = source.description
    source.description = replace(
        said,
        content_id=content_id(str(path)),
        metadata={**said.metadata, "source": request.source},
    )
    return source


def _unpacker(stream: IO[bytes]) -> Any:
    head = stream.read(8)
    stream.seek(0)
    return next(make for magic, make in _UNPACKERS.items() if head.startswith(magic))(stream)


def _unpack(request: LoadRequest, target: Path) -> None:
    size = max(request.path.stat().st_size, 1)
    with request.path.open("rb") as stream, _unpacker(stream) as plain, target.open("wb") as copy:
        while True:
            try:
                block = plain.read(_BLOCK)
            except EOFError:
                raise request.error("the file is cut off; get it again.") from None
            except _DAMAGE:
                raise request.error("the compressed data is damaged; get the file again.") from None
            if not block:
                return
            if shutil.disk_usage(target.parent).free < len(block) + _LEFT_FREE:
                raise request.error(
                    f"unpacked, it takes more room than is free for temporary files in {target.parent.parent}; "
                    "unpack it yourself where there is room."
                )
            copy.write(block)
            request.report(0.5 * stream.tell() / size, "unpacking")
