"""GIPL and Interfile: small headers, and one run of values.

Sources: the header of the Guy's Image Processing Lab in ITK's ``itkGiplImageIO.cxx``; "The Interfile 3.3 standard"
(A. Todd-Pokropek, T. D. Cradduck, F. Deconinck, 1992).
"""

from __future__ import annotations

import re
import struct
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from volviz.io.endings import GIPL, INTERFILE
from volviz.io.file_source import file_source
from volviz.io.raw_payload import RawPayload, check_sizes, read_part
from volviz.io.reader import shortened, stem

if TYPE_CHECKING:
    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest


_GIPL_HEADER = 256
_GIPL_MAGIC = (b"\xef\xff\xe9\xb0", b"\x2a\xe3\x89\xb8")
_GIPL_TYPES = {1: "u1", 7: "i1", 8: "u1", 15: "i2", 16: "u2", 31: "u4", 32: "i4", 64: "f4", 65: "f8"}

#: A header longer than this is none.
_INTERFILE_BYTES = 1 << 20
_NUMBER_FORMATS = {
    "signed integer": "i",
    "unsigned integer": "u",
    "short float": "f",
    "long float": "f",
    "float": "f",
}


def sniff_gipl(head: bytes, _path: Path) -> bool:
    """Whether the magic number ends a header of 256 bytes."""
    return head[252:256] in _GIPL_MAGIC


def open_gipl(request: LoadRequest) -> FileSource:
    """What the header says; everything is big-endian."""
    import gzip

    with request.path.open("rb") as stream:
        is_packed = stream.read(2) == b"\x1f\x8b"
        stream.seek(0)
        try:
            head = (gzip.GzipFile(fileobj=stream) if is_packed else stream).read(_GIPL_HEADER)
        except EOFError:
            head = b""
    if not sniff_gipl(head, request.path):
        raise request.error("this is no GIPL file, though it is called so; check how it was made.")
    sizes = [max(n, 1) for n in struct.unpack(">4h", head[:8])]
    (kind,) = struct.unpack(">H", head[8:10])
    steps = np.array(struct.unpack(">3f", head[10:22]), float)
    origin = np.array(struct.unpack(">3d", head[204:228]))
    if kind not in _GIPL_TYPES:
        raise request.error(f"values of the GIPL type {kind} cannot be shown; save it as numbers.")
    if not np.all(np.isfinite(steps)) or steps.min() <= 0:
        request.note("The file gives no distance between voxels along every axis; 1 is taken.")
        steps = np.where(np.isfinite(steps) & (steps > 0), steps, 1.0)
    payload = RawPayload(
        (request.path,),
        tuple(sizes[::-1]) if sizes[3] > 1 else tuple(sizes[2::-1]),
        np.dtype(">" + _GIPL_TYPES[kind]),
        offset=_GIPL_HEADER,
        encoding="gzip" if is_packed else "raw",
    )
    check_sizes(payload, request)
    axes = "TZYX"[-len(payload.shape) :]
    return file_source(
        request,
        lambda request: read_part(payload, axes, request),
        axes,
        payload.shape,
        request.geometry(np.c_[np.diag(steps), np.nan_to_num(origin)]),
        format="GIPL",
        name=stem(request.path, GIPL),
        dtype=payload.dtype,
        length_unit="mm",
    )


def sniff_interfile(head: bytes, _path: Path) -> bool:
    """Whether the first key names the format."""
    return re.match(rb"\s*!?\s*interfile\s*:=", head, re.IGNORECASE) is not None


def open_interfile(request: LoadRequest) -> FileSource:
    """What the header says; the values lie in another file, or behind the header."""
    fields = _interfile_fields(request)

    def integer(*names: str, default: int) -> int:
        text = next((fields[name] for name in names if name in fields), str(default))
        try:
            return int(text)
        except ValueError:
            raise request.error(
                f"its header gives {shortened(text)} for {names[0]}; the file is damaged."
            ) from None

    def length(axis: int) -> float:
        text = fields.get(f"scaling factor (mm/pixel) [{axis}]", "")
        try:
            value = float(text)
        except ValueError:
            value = 0.0
        return value if 0.0 < value < np.inf else 0.0

    x, y = integer("matrix size [1]", default=0), integer("matrix size [2]", default=0)
    z = integer(
        "matrix size [3]", "number of slices", "total number of images", "number of images", default=1
    )
    number = fields.get("number format", "unsigned integer").lower()
    size = integer("number of bytes per pixel", default=2 if "integer" in number else 4)
    code = f"{_NUMBER_FORMATS.get(number, '?')}{size}"
    if code not in ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8"):
        raise request.error(
            f"values of {size} bytes in the Interfile format {shortened(number)} cannot be shown; save it as numbers."
        )
    order = "<" if "little" in fields.get("imagedata byte order", "bigendian").lower() else ">"
    name = fields.get("name of data file", "")
    file = request.path.parent / name if name else request.path
    offset = integer("data offset in bytes", default=0) or 2048 * integer("data starting block", default=0)
    payload = RawPayload((file,), (z, y, x), np.dtype(order + code), offset=offset, whole=False)
    check_sizes(payload, request)
    steps = [length(axis) for axis in (1, 2, 3)]
    if not steps[2]:
        # slices are given in pixels, by those formats that have no third axis
        try:
            steps[2] = float(fields.get("centre-centre slice separation (pixels)", "")) * (steps[0] or 1.0)
        except ValueError:
            steps[2] = 0.0
    if not all(0.0 < step < np.inf for step in steps):
        request.note("The file does not say how far its voxels lie apart along every axis; 1 is taken.")
        steps = [step if 0.0 < step < np.inf else 1.0 for step in steps]
    return file_source(
        request,
        lambda request: read_part(payload, "ZYX", request),
        "ZYX",
        payload.shape,
        request.geometry(np.c_[np.diag(steps), np.zeros(3)]),
        format="Interfile",
        name=stem(request.path, INTERFILE),
        dtype=payload.dtype,
        length_unit="mm",
    )


def _interfile_fields(request: LoadRequest) -> dict[str, str]:
    """Keys in lower case without their mark, and what is said of them."""
    with request.path.open("rb") as stream:
        head = stream.read(_INTERFILE_BYTES)
    if not sniff_interfile(head, request.path):
        raise request.error("this is no Interfile header, though it is called so; check how it was made.")
    text = re.split(rb"!?\s*end of interfile\s*:=", head, maxsplit=1, flags=re.IGNORECASE)[0]
    fields: dict[str, str] = {}
    for line in text.decode("utf-8", "replace").splitlines():
        name, mark, value = line.partition(":=")
        if mark and not line.lstrip().startswith(";"):
            key = " ".join(name.strip().lstrip("!%").lower().split())
            # "matrix size[1]" and "matrix size [1]" are the same
            fields[re.sub(r"\s*\[\s*(\d)\s*\]", r" [\1]", key)] = value.split(";")[0].strip()
    return fields
