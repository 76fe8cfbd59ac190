"""Raw files: values without a header, described by hints or by the name of the file."""

from __future__ import annotations

import math
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import InputError, VolvizError
from volviz.io.endings import RAW
from volviz.io.file_source import file_source
from volviz.io.geometry import Geometry
from volviz.io.raw_payload import RawPayload, check_sizes, read_part
from volviz.io.reader import stem

if TYPE_CHECKING:
    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadOptions, LoadRequest


_PATTERN = re.compile(r"(?<![\dx])(\d+)x(\d+)x(\d+)(?!\d|x\d)", re.IGNORECASE)
_TYPE = re.compile(
    r"(?<![a-z])(?:(un)?signed[ _.-]?)?(u?int(?:8|16|32|64)?|float(?:16|32|64)|u?char|u?short|float|double)"
    r"(?:_t)?(?![a-z\d])"
)
_SYNONYMS = {
    "uchar": "uint8", "char": "int8", "ushort": "uint16", "short": "int16", "uint": "uint32", "int": "int32",
    "float": "float32", "double": "float64",
}  # fmt: skip
_WANTED = "give dims=(x, y, z) and dtype=..., or call the file like head_256x256x225_uint8.raw"


def sniff(_head: bytes, path: Path) -> bool:
    """Whether the name of the file says what is in it."""
    return hints_from_name(path.name) is not None


def hints_from_name(name: str) -> tuple[tuple[int, int, int], str] | None:
    """Sizes (x, y, z) and type of the values in a name such as ``head_256x256x225_uint8.raw``."""
    sizes = _PATTERN.search(name)
    kind = _TYPE.search(name.lower())
    if sizes is None or kind is None:
        return None
    return (int(sizes[1]), int(sizes[2]), int(sizes[3])), _plain(kind)


def named_type(name: str) -> str | None:
    """The type of values that a name says, None where it says none."""
    kind = _TYPE.search(name.lower())
    return None if kind is None else _plain(kind)


def _plain(kind: re.Match[str]) -> str:
    """NumPy's name of a type that is written as in C."""
    name = _SYNONYMS.get(kind[2], kind[2])
    return "u" + name if kind[1] and name.startswith("int") else name


def fits(request: LoadRequest) -> bool:
    """Whether what is said of a raw file gives exactly the size that it has, so that it can be nothing else."""
    named = hints_from_name(request.path.name)
    if request.hints.dims is None and named is None:
        return False
    try:
        dims, dtype = _described(request)
    except VolvizError:
        return False
    wanted = math.prod(dims) * dtype.itemsize + max(request.hints.header or 0, 0)
    if not _is_gzip(request.path):
        return wanted == request.path.stat().st_size
    with request.path.open("rb") as stream:
        # a gzip member ends with the size of what it holds, modulo 2^32
        stream.seek(-4, os.SEEK_END)
        return wanted % 2**32 == int.from_bytes(stream.read(4), "little")


def open_source(request: LoadRequest) -> FileSource:
    """A raw file, plain or gzipped, as it is described."""
    dims, dtype = _described(request)
    packed = _is_gzip(request.path)
    header = request.hints.header or 0
    if header < 0 and packed:
        raise InputError(
            f"{request.path.name}: header=-1 needs a file that is not compressed; unpack it first."
        )
    payload = RawPayload(
        (request.path,), dims[::-1], dtype, offset=header, encoding="gzip" if packed else "raw"
    )
    if not packed:
        _compare_with_file(payload, request)
    check_sizes(payload, request)
    if request.hints.spacing is None:
        request.note("A raw file does not say how far its voxels lie apart; 1 is taken along every axis.")
    return file_source(
        request,
        lambda request: read_part(payload, "ZYX", request),
        "ZYX",
        payload.shape,
        Geometry(),
        format="raw",
        name=stem(request.path, RAW),
        dtype=payload.dtype,
    )


def _described(request: LoadRequest) -> tuple[tuple[int, int, int], np.dtype[Any]]:
    hints: LoadOptions = request.hints
    named = hints_from_name(request.path.name)
    sizes = _PATTERN.search(request.path.name)
    dims = hints.dims or (named[0] if named else None)
    if dims is None and sizes is not None:
        dims = int(sizes[1]), int(sizes[2]), int(sizes[3])
    kind = hints.dtype if hints.dtype is not None else (named[1] if named else None)
    if dims is None or kind is None:
        what = "size" if dims is None else "type of its values"
        raise request.error(f"a raw file does not say the {what}; {_WANTED}.")
    if min(dims) < 1:
        raise InputError(f"dims must be three positive integers (x, y, z), got {dims!r}.")
    return dims, _dtype(kind, hints.endian)


def _dtype(kind: Any, endian: str | None) -> np.dtype[Any]:
    try:
        if isinstance(kind, str):
            said = _TYPE.fullmatch(kind.lower())
            kind = kind.lower() if said is None else _plain(said)
        dtype: np.dtype[Any] = np.dtype(kind)
    except TypeError:
        raise InputError(
            f"dtype {kind!r} is unknown; use uint8, int16, uint16, float32 or the like."
        ) from None
    if dtype.kind not in "buif":
        raise InputError(
            f"values of type {dtype} cannot be shown; use uint8, int16, uint16, float32 or the like."
        )
    if endian is not None:
        return dtype.newbyteorder(">" if endian == "big" else "<")
    # a dtype such as ">u2" says it itself; a plain name means little endian, whatever the machine
    return dtype if dtype.byteorder in "<>|" else dtype.newbyteorder("<")


def _compare_with_file(payload: RawPayload, request: LoadRequest) -> None:
    """Say it when the file has more bytes than the description: probably the description is wrong."""
    spare = request.path.stat().st_size - payload.nbytes - max(payload.offset, 0)
    if spare > 0 and payload.offset >= 0:
        request.note(
            f"The file is {spare:,} bytes longer than its description says; they were left out. "
            "If the picture looks shifted, give header=-1 or correct dims and dtype."
        )


def _is_gzip(path: Path) -> bool:
    with path.open("rb") as stream:
        return stream.read(2) == b"\x1f\x8b"
