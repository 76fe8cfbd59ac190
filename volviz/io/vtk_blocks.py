"""The lists of blocks in packed VTK XML files, checked before VTK believes them.

VTK takes the memory for as many and as large blocks as such a list claims, and ends the process when there is none.
Source: "VTK XML Formats", docs.vtk.org: number of blocks, size of a block, size of the last one when it is shorter,
then the packed size of each.
"""

from __future__ import annotations

import base64
import binascii
import mmap
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np


def are_believable(path: Path, most: int) -> bool:
    """Whether the lists of all arrays claim what the file can hold.

    Parameters
    ----------
    path : Path
        An XML file, packed or not.
    most : int
        Bytes of the largest array that its header promises.
    """
    with path.open("rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as data:
        first = re.search(rb"<VTKFile\b[^>]*>", data[: 1 << 20])
        if first is None or _said(first[0], b"compressor") is None:
            return True
        word = "u8" if _said(first[0], b"header_type") == b"UInt64" else "u4"
        kind = np.dtype((">" if _said(first[0], b"byte_order") == b"BigEndian" else "<") + word)
        return all(_is_believable(data, place, kind, most, plain) for place, plain in _places(data))


def _places(data: mmap.mmap) -> Iterator[tuple[int, bool]]:
    """Where the list of each array begins, and whether it lies there as bytes, not as base64."""
    appended = data.rfind(b"<AppendedData")
    start = data.find(b"_", data.find(b">", appended)) + 1 if appended >= 0 else 0
    is_raw = appended >= 0 and _said(data[appended : appended + 200], b"encoding") == b"raw"
    at = data.find(b"<DataArray")
    while at >= 0 and (appended < 0 or at < appended):
        end = data.find(b">", at)
        tag = data[at : end + 1]
        form, offset = _said(tag, b"format"), _said(tag, b"offset") or b""
        if _said(tag, b"NumberOfTuples") != b"0":
            if form == b"binary":
                yield end + 1, False
            elif form == b"appended" and offset.isdigit() and start:
                yield start + int(offset), is_raw
        at = data.find(b"<DataArray", end + 1) if end >= 0 else -1


def _is_believable(data: mmap.mmap, at: int, kind: np.dtype[np.generic], most: int, plain: bool) -> bool:
    three = _numbers(data, at, 3, kind, plain)
    if three is None:
        return False
    count, size, last = three
    if count < 1 or size < 1 or last > size or count * kind.itemsize > len(data):
        return False
    if size * (count - 1) + (last or size) > most:
        return False
    every = _numbers(data, at, 3 + count, kind, plain)
    return every is not None and max(every[3:]) <= len(data)


def _numbers(
    data: mmap.mmap, at: int, count: int, kind: np.dtype[np.generic], plain: bool
) -> list[int] | None:
    wanted = count * kind.itemsize
    if plain:
        found = data[at : at + wanted]
    else:
        digits = -(-wanted // 3) * 4
        # blanks may stand before the digits of an array in the text
        text = data[at : at + digits + 256].lstrip()[:digits]
        try:
            found = base64.b64decode(text)[:wanted]
        except binascii.Error:
            return None
    return [int(n) for n in np.frombuffer(found, kind)] if len(found) == wanted else None


def _said(tag: bytes, name: bytes) -> bytes | None:
    found = re.search(rb"\b" + name + rb"\s*=\s*[\"']([^\"']*)", tag)
    return None if found is None else found[1].strip()
