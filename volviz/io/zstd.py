"""Files packed by Zstandard: how much they can hold, their first bytes, and all of it.

imagecodecs unpacks such a file in one call, into memory. So its blocks are counted before: none holds more than 128
KiB. Source: RFC 8878, sections 3.1.1 (frames, blocks) and 3.1.2 (skippable frames).
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import IO

from volviz.io.memory import free_bytes
from volviz.io.reader import PACKINGS

_MAGIC = PACKINGS[".zst"]

_BLOCK = 128 << 10
_RUN = 1
_SKIPPABLE = range(0x184D2A50, 0x184D2A60)


def unpacked(stream: IO[bytes]) -> IO[bytes]:
    """What a file holds.

    Raises
    ------
    EOFError
        It is cut off.
    ValueError
        It is damaged.
    MemoryError
        It may hold more than memory does.
    """
    import imagecodecs

    packed = stream.read()
    most = sum(1 for _ in _blocks(packed)) * _BLOCK
    free = free_bytes()
    if free is not None and most > free:
        raise MemoryError
    try:
        return io.BytesIO(imagecodecs.zstd_decode(packed))
    except RuntimeError as error:
        raise ValueError(str(error)) from None


def unpacked_start(stream: IO[bytes]) -> bytes:
    """What the first block of a file holds: its first 128 KiB, unless they were packed in smaller pieces.

    Raises
    ------
    EOFError, ValueError
        As for `unpacked`.
    """
    import imagecodecs

    packed = stream.read(4 * _BLOCK)
    at, end = next(_blocks(packed))
    header = int.from_bytes(packed[at : at + 3], "little") | 1
    # a frame of this block alone, without a size and a checksum, with a window of 128 KiB
    alone = _MAGIC + b"\x00\x38" + header.to_bytes(3, "little") + packed[at + 3 : end]
    try:
        return bytes(imagecodecs.zstd_decode(alone))
    except RuntimeError as error:
        raise ValueError(str(error)) from None


def _blocks(packed: bytes) -> Iterator[tuple[int, int]]:
    """Where each block begins and ends."""
    at = 0
    while at < len(packed):
        magic = int.from_bytes(packed[at : at + 4], "little")
        if magic in _SKIPPABLE:
            at += 8 + int.from_bytes(packed[at + 4 : at + 8], "little")
            continue
        if packed[at : at + 4] != _MAGIC or at + 5 > len(packed):
            raise ValueError("no frame")
        flags = packed[at + 4]
        is_single = flags >> 5 & 1
        size_bytes = (is_single, 2, 4, 8)[flags >> 6]
        at += 5 + (1 - is_single) + (0, 1, 2, 4)[flags & 3] + size_bytes
        is_last = False
        while not is_last:
            if at + 3 > len(packed):
                raise EOFError
            header = int.from_bytes(packed[at : at + 3], "little")
            is_last = bool(header & 1)
            # of a run of equal bytes the size is that of what it stands for
            end = at + 3 + (1 if header >> 1 & 3 == _RUN else header >> 3)
            if end > len(packed):
                raise EOFError
            yield at, end
            at = end
        at += 4 * (flags >> 2 & 1)
