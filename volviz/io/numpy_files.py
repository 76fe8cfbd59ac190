"""NumPy arrays (.npy), axes (Z, Y, X)."""

from __future__ import annotations

import tokenize
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from volviz.io.axes import usual_axes
from volviz.io.endings import NUMPY
from volviz.io.file_source import file_source
from volviz.io.geometry import Geometry
from volviz.io.raw_payload import RawPayload, check_sizes, read_part
from volviz.io.reader import stem

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest


def sniff(head: bytes, _path: Path) -> bool:
    """Whether these are the first bytes of a NumPy array file."""
    return head.startswith(b"\x93NUMPY")


def open_source(request: LoadRequest) -> FileSource:
    """What the header says; arrays of four axes hold time points or colours, of five time points and channels.

    The last axis of more than three is taken for colours when it has 3 or 4 entries of 8 bits; the first axis is
    time, the second of five the channel.
    """
    with request.path.open("rb") as stream:
        shape, fortran, dtype = read_header(request, stream)
        offset = stream.tell()
    if dtype.hasobject or dtype.kind not in "buifc":
        raise request.error(f"values of type {dtype} cannot be shown; save it as integers or real numbers.")
    rank = len(shape)
    if rank not in (3, 4, 5):
        raise request.error(f"the array has {rank} axes; save it with the three axes z, y, x.")
    axes = usual_axes(shape, dtype)
    if fortran:
        # the file holds the reversed array in C order
        axes, shape = axes[::-1], shape[::-1]
    payload = RawPayload((request.path,), shape, dtype, offset=offset)
    check_sizes(payload, request)

    def values(request: LoadRequest) -> npt.NDArray[Any]:
        array = read_part(payload, axes, request)
        if array.dtype.kind == "c":
            request.note("Complex values are shown as their magnitude.")
            array = np.abs(array)
        return array

    return file_source(
        request,
        values,
        axes,
        shape,
        Geometry(),
        format="NumPy",
        name=stem(request.path, NUMPY),
        dtype=dtype,
    )


def read_header(request: LoadRequest, stream: IO[bytes]) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Sizes, whether the first index runs fastest, and type; the stream then stands at the values.

    Raises
    ------
    LoadError
    """
    reading = {
        (1, 0): np.lib.format.read_array_header_1_0,
        (2, 0): np.lib.format.read_array_header_2_0,
        # 3.0 is 2.0 with UTF-8 names of fields, which no volume has
        (3, 0): np.lib.format.read_array_header_2_0,
    }
    try:
        version = np.lib.format.read_magic(stream)
        shape, fortran, dtype = reading[version](stream)
    except (
        ValueError,
        KeyError,
        TypeError,
        SyntaxError,
        tokenize.TokenError,
        RecursionError,
        MemoryError,
    ):
        raise request.error("its NumPy header is unreadable; the file is damaged.") from None
    return tuple(int(n) for n in shape), bool(fortran), dtype
