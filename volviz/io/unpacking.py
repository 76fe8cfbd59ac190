"""Streams of packed files: their first bytes, all of them, and whole gzip and zlib streams in one call.

That call is libdeflate's, more than twice as fast as zlib in blocks.
"""

from __future__ import annotations

import mmap
import threading
import zlib
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from volviz.io import zstd
from volviz.io.reader import PACKINGS

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.reader import LoadRequest


#: Streams up to this size are read into memory and unpacked by the caller itself: that takes some 0.2 s at most.
SHORT_BYTES = 32 << 20

#: How often a long call is looked after, in seconds, and at how many places to see how far it is.
PATIENCE, PROBES = 0.05, 512


#: Modules of Python that unpack, by the ending of the way to pack; imagecodecs does zstd.
_MODULES = {".gz": "gzip", ".bz2": "bz2", ".xz": "lzma"}


def unpacker(stream: IO[bytes]) -> Any:
    """A stream of what a packed file holds."""
    stream.seek(0)
    head = stream.read(8)
    stream.seek(0)
    ending = next(ending for ending, magic in PACKINGS.items() if head.startswith(magic))
    return zstd.unpacked(stream) if ending == ".zst" else import_module(_MODULES[ending]).open(stream)


def damage() -> tuple[type[Exception], ...]:
    """What an `unpacker` of a damaged file raises."""
    import lzma

    return EOFError, zlib.error, lzma.LZMAError, OSError, ValueError


def unpacked_head(path: Path, count: int) -> bytes:
    """The first bytes of what a packed file holds; none of a damaged one."""
    with path.open("rb") as stream:
        is_zstd = stream.read(4) == PACKINGS[".zst"]
        stream.seek(0)
        try:
            if is_zstd:
                return zstd.unpacked_start(stream)[:count]
            with unpacker(stream) as plain:
                return bytes(plain.read(count))
        except Exception as error:
            if isinstance(error, damage()):
                return b""
            raise


def unpacked_at_once(file: Path, start: int, size: int, request: LoadRequest) -> npt.NDArray[np.uint8] | None:
    """The `size` bytes that a stream holds, or None where it is in any way unusual: zlib in blocks then decides.

    Parameters
    ----------
    file : Path
    start : int
        Bytes of the file before the stream.
    size : int
        Bytes that it should hold.
    request : LoadRequest
        Told the progress, asked whether to go on.

    Raises
    ------
    Cancelled
        A long call ends by itself on its own thread.
    """
    try:
        import imagecodecs
    except ImportError:
        return None
    unpacked = np.empty(size, np.uint8)
    with file.open("rb") as stream:
        is_long = file.stat().st_size - start > SHORT_BYTES
        # a long one is not copied into memory: its pages are given back while it is unpacked
        pages = mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) if is_long else None
        packed = memoryview(stream.read() if pages is None else pages)[start:]
    # deflate_decode is libdeflate's reader of zlib streams; zlib_decode would be zlib's own
    decode = imagecodecs.gzip_decode if bytes(packed[:2]) == b"\x1f\x8b" else imagecodecs.deflate_decode

    def unpack() -> bool:
        try:
            return len(decode(packed, out=unpacked)) == size
        except (RuntimeError, ValueError):
            return False

    request.report(0.1, "unpacking")
    if pages is None:
        return unpacked if unpack() else None
    return unpacked if _looked_after(unpack, pages, unpacked, request) else None


def _looked_after(
    unpack: Callable[[], bool], pages: mmap.mmap, unpacked: npt.NDArray[np.uint8], request: LoadRequest
) -> bool:
    """Run a long call on a thread, tell its progress and keep the packed file out of memory."""
    outcome: list[bool] = []
    thread = threading.Thread(
        target=lambda: outcome.append(unpack()), name="volviz-shared unpacking", daemon=True
    )
    thread.start()
    # fresh memory is zero: the last place that is not tells how far the call is
    probes = unpacked[:: max(len(unpacked) // PROBES, 1)]
    while thread.is_alive():
        thread.join(PATIENCE)
        if hasattr(pages, "madvise"):
            # what is still needed is taken from the system's cache again
            pages.madvise(mmap.MADV_DONTNEED)
        reached = np.flatnonzero(probes)
        request.report(0.1 + 0.9 * (reached[-1] / len(probes) if len(reached) else 0.0), "unpacking")
    return outcome == [True]
