"""SLC volumes of the program VolVis: a header in text, and slices of bytes, plain or packed by run lengths.

Read here and not by VTK, whose reader trusts the lengths in a file and writes where they lead. Source: "VolVis
Documentation" (State University of New York, 1994), and the reader of VTK for the order of the fields.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.axes import to_zyx
from volviz.io.endings import SLC
from volviz.io.file_source import file_source
from volviz.io.memory import check_memory
from volviz.io.raw_payload import RawPayload, check_sizes, read_part
from volviz.io.reader import stem

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest


_WORD = rb"\s+([-+.\deE]+)"
#: Magic number, sizes, bits, spacings, unit, origin of the data, modification, packing, size of the icon.
_HEADER = re.compile(rb"\s*11111" + _WORD * 13 + rb"\s+X")
_PLAIN, _RUNS = 0, 1
#: Two bytes stand for 127 at most.
_MOST = 64


def sniff(head: bytes, _path: Path) -> bool:
    """Whether the magic number and thirteen further numbers stand at the beginning."""
    return _HEADER.match(head) is not None


def open_source(request: LoadRequest) -> FileSource:
    """What the header says.

    Raises
    ------
    LoadError
        No such file, other values than bytes, a way to pack that is unknown.
    """
    with request.path.open("rb") as stream:
        found = _HEADER.match(stream.read(1024))
    try:
        if found is None:
            raise ValueError
        sizes = [int(found[n]) for n in (1, 2, 3)]
        bits = int(found[4])
        steps = np.array([float(found[n]) for n in (5, 6, 7)])
        packing, across, down = (int(found[n]) for n in (11, 12, 13))
        if min(sizes) < 1 or min(across, down) < 0:
            raise ValueError
    except ValueError:
        raise request.error(
            "this is no SLC volume, though it is called so, or its header is damaged; check how it was made."
        ) from None
    if bits != 8 or packing not in (_PLAIN, _RUNS):
        what = f"values of {bits} bits" if bits != 8 else f"way to pack (number {packing})"
        raise request.error(f"its {what} cannot be read; save it with 8 bits, plain or with run lengths.")
    if not np.all(np.isfinite(steps)) or steps.min() <= 0:
        request.note("The file gives no distance between voxels along every axis; 1 is taken.")
        steps = np.where(np.isfinite(steps) & (steps > 0), steps, 1.0)
    shape = tuple(sizes[::-1])
    # an icon of three colours lies before the slices
    start = found.end() + 3 * across * down
    plain = RawPayload((request.path,), shape, np.dtype("u1"), offset=start)
    if packing == _PLAIN:
        check_sizes(plain, request)
    elif math.prod(shape) > _MOST * request.path.stat().st_size:
        raise request.error(
            f"the file is cut off: its header promises {math.prod(shape):,} voxels, more than it can hold."
        )

    def values(request: LoadRequest) -> npt.NDArray[Any]:
        if packing == _PLAIN:
            return read_part(plain, "ZYX", request)
        return to_zyx(_unpacked(request, shape, start), "ZYX", request)

    return file_source(
        request,
        values,
        "ZYX",
        shape,
        request.geometry(np.c_[np.diag(steps), np.zeros(3)]),
        format="SLC",
        name=stem(request.path, SLC),
        dtype=np.uint8,
    )


def _unpacked(request: LoadRequest, shape: tuple[int, ...], start: int) -> npt.NDArray[np.uint8]:
    """All slices; before each stands the number of its packed bytes, and an X."""
    check_memory(request, math.prod(shape))
    data = request.path.read_bytes()
    values = np.empty(shape, np.uint8)
    at = start
    for number, plane in enumerate(values):
        request.report(number / len(values))
        found = re.compile(rb"\s*(\d{1,9})\s+X").match(data, at)
        end = at if found is None else found.end() + int(found[1])
        pixels = None if found is None else _of_runs(data[found.end() : end], plane.size)
        if pixels is None:
            raise request.error(f"slice {number + 1} of {len(values)} is damaged or cut off; get it again.")
        plane.reshape(-1)[:] = np.frombuffer(pixels, np.uint8)
        at = end
    return values


def _of_runs(packed: bytes, size: int) -> bytes | None:
    """The bytes of a slice; None where they are not as many.

    A byte says how many follow (the lower seven bits), and whether they stand there one by one (the highest bit) or
    are one and the same; zero ends the slice.
    """
    pieces: list[bytes] = []
    at = 0
    while at < len(packed) and (count := packed[at] & 0x7F):
        if packed[at] & 0x80:
            pieces.append(packed[at + 1 : at + 1 + count])
            at += 1 + count
        else:
            pieces.append(packed[at + 1 : at + 2] * count)
            at += 2
    pixels = b"".join(pieces)
    return pixels if len(pixels) == size else None
