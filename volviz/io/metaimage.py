"""MetaImage files, values in the file itself (.mha) or beside the header (.mhd).

Source: "MetaIO/Documentation" of the Insight Toolkit (itk.org/Wiki/MetaIO/Documentation). The matrix of a
MetaImage lists the direction of one axis a row, in the patient frame LPS.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from volviz.io.endings import METAIMAGE
from volviz.io.file_source import file_source
from volviz.io.geometry import is_usable
from volviz.io.nrrd import FILES_AT_MOST, _numbered
from volviz.io.raw_payload import RawPayload, check_sizes, read_part
from volviz.io.reader import shortened, stem
from volviz.volume_data.description import Statistics

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest


#: A header longer than this is none; those of tracked ultrasound, with lines for every frame, have megabytes.
HEADER_BYTES = 1 << 26

#: A size beyond this is none.
LARGEST = 2**40

_TYPES = {
    "MET_CHAR": "i1", "MET_UCHAR": "u1", "MET_SHORT": "i2", "MET_USHORT": "u2", "MET_INT": "i4",
    "MET_UINT": "u4",
    "MET_LONG": "i4", "MET_ULONG": "u4", "MET_LONG_LONG": "i8", "MET_ULONG_LONG": "u8", "MET_FLOAT": "f4",
    "MET_DOUBLE": "f8",
}  # fmt: skip


def sniff(head: bytes, _path: Path) -> bool:
    """Whether these are the first bytes of a MetaImage header."""
    # comments may come first, with a sign of equality or without
    return re.match(rb"(?:[^\n\0]*\n)*?[ \t]*(?:ObjectType|NDims)[ \t]*=", head) is not None


def open_source(request: LoadRequest) -> FileSource:
    """What the header says; the fourth axis is time."""
    fields, end = _header(request)
    sizes = _sizes(request, fields)
    if not sizes or len(sizes) != _integer(request, fields, "NDims", len(sizes)):
        raise request.error("its header gives no sizes that fit its dimensions; the file is damaged.")
    rank = len(sizes)
    sizes += [1] * (3 - rank)
    if min(sizes) < 1:
        raise request.error(f"its header gives the size {' x '.join(map(str, sizes))}; the file is damaged.")
    kind = fields.get("ElementType", "").upper().removesuffix("_ARRAY")
    if kind not in _TYPES:
        raise request.error(
            f"values of the MetaImage type {shortened(kind) if kind else '(none)'} cannot be shown; save it as numbers."
        )
    channels = _integer(request, fields, "ElementNumberOfChannels", 1)
    if len(sizes) > 4 or channels < 1:
        raise request.error(
            f"{len(sizes)} dimensions and {channels} channels are not those of a volume; save one volume."
        )
    payload = _payload(request, fields, end, sizes, channels, kind)
    check_sizes(payload, request)
    axes = "TZYX"[4 - len(sizes) :]
    if channels > 1:
        axes += "S"
    return file_source(
        request,
        lambda request: read_part(payload, axes, request),
        axes,
        payload.shape,
        request.geometry(_affine(request, fields, rank)),
        format="MetaImage",
        name=stem(request.path, METAIMAGE),
        dtype=payload.dtype,
        statistics=_statistics(request, fields),
        length_unit="mm",
    )


def _statistics(request: LoadRequest, fields: dict[str, str]) -> Statistics | None:
    found = [_parse(request, fields.get(name, "")) for name in ("ElementMin", "ElementMax")]
    low, high = (values[0] if len(values) == 1 else np.nan for values in found)
    return Statistics(low, high) if -np.inf < low <= high < np.inf else None


def _header(request: LoadRequest) -> tuple[dict[str, str], int]:
    """Fields by name and the byte at which the values begin (for values in the same file)."""
    head, last, wanted = b"", None, 1 << 16
    with request.path.open("rb") as stream:
        while last is None and len(head) < HEADER_BYTES:
            block = stream.read(wanted - len(head))
            if not block:
                break
            head += block
            wanted *= 4
            last = re.search(rb"^[ \t]*ElementDataFile[ \t]*=[^\n]*\n", head, re.MULTILINE)
    if not sniff(head, request.path):
        raise request.error("this is no MetaImage file, though it is called so; check how it was made.")
    # the line may end with the file
    last = last or re.search(rb"^[ \t]*ElementDataFile[ \t]*=[^\n]*\Z", head, re.MULTILINE)
    if last is None:
        raise request.error("its header names no ElementDataFile; the file is cut off or damaged.")
    fields: dict[str, str] = {}
    for line in head[: last.end()].decode("utf-8", "replace").splitlines():
        name, equals, value = line.partition("=")
        if equals:
            fields[name.strip()] = value.strip()
    if fields["ElementDataFile"].upper().startswith("LIST"):
        fields["list"] = head[last.end() :].decode("utf-8", "replace")
    return fields, last.end()


def _payload(
    request: LoadRequest, fields: dict[str, str], end: int, sizes: list[int], channels: int, kind: str
) -> RawPayload:
    target = fields["ElementDataFile"]
    local = target.upper() == "LOCAL"
    files = (request.path,) if local else _data_files(request, fields, target)
    skip = _integer(request, fields, "HeaderSize", 0)
    big = _is_true(fields.get("ElementByteOrderMSB", fields.get("BinaryDataByteOrderMSB", "False")))
    shape = tuple(sizes[::-1]) + ((channels,) if channels > 1 else ())
    dtype = np.dtype((">" if big else "<") + _TYPES[kind])
    start = end if local else 0
    if not _is_true(fields.get("BinaryData", "True")):
        return RawPayload(files, shape, dtype, offset=start, encoding="text")
    if _is_true(fields.get("CompressedData", "False")):
        start += max(skip, 0)
        if skip < 0 and "CompressedDataSize" in fields and files[0].is_file():
            # the values end with the file, so their packed size says where they begin
            packed = _integer(request, fields, "CompressedDataSize", 0)
            start = max(start, files[0].stat().st_size - packed)
        return RawPayload(files, shape, dtype, packed_offset=start, encoding="gzip")
    return RawPayload(files, shape, dtype, offset=-1 if skip < 0 else start + skip)


def _data_files(request: LoadRequest, fields: dict[str, str], target: str) -> tuple[Path, ...]:
    folder = request.path.parent
    words = target.split()
    if words and words[0].upper() == "LIST":
        return tuple(folder / line.strip() for line in fields["list"].splitlines() if line.strip())
    if re.search(r"%0?\d*d", target) and len(words) >= 3:
        try:
            first, last = int(words[1]), int(words[2])
            step = int(words[3]) if len(words) > 3 else 1
            numbers = range(first, last + 1, step)
            if len(numbers) > FILES_AT_MOST:
                raise ValueError
        except (ValueError, OverflowError):
            raise request.error(
                "its header numbers the data files unreadably; the file is damaged."
            ) from None
        return tuple(folder / _numbered(words[0], n) for n in numbers)
    return (folder / target,)


def _affine(request: LoadRequest, fields: dict[str, str], rank: int) -> npt.NDArray[np.float64]:
    spacing = _first(fields, "ElementSpacing", "ElementSize")
    origin = _first(fields, "Offset", "Position", "Origin")
    rows = _first(fields, "TransformMatrix", "Rotation", "Orientation")
    known = min(rank, 3)
    steps = np.array((_parse(request, spacing) or [1.0] * rank)[:known] + [1.0] * (3 - known))
    start = np.array((_parse(request, origin) or [0.0] * rank)[:known] + [0.0] * (3 - known))
    matrix = np.eye(3)
    values = _parse(request, rows)
    if values:
        size = round(len(values) ** 0.5)
        if size * size != len(values) or size < known:
            raise request.error("its TransformMatrix does not fit its dimensions; the file is damaged.")
        matrix[:known, :known] = np.reshape(values, (size, size))[:known, :known]
    if len(steps) != 3 or len(start) != 3 or not is_usable(matrix) or not np.all(np.isfinite(steps)):
        raise request.error("its spacing, offset or TransformMatrix is unusable; the file is damaged.")
    if not np.all(steps):
        request.note("The file gives a distance of 0 between voxels; 1 is taken.")
        steps = np.where(steps == 0, 1.0, steps)
    # the rows of the file are the columns of `direction`; a negative step turns the axis
    affine: npt.NDArray[np.float64] = np.c_[matrix.T * steps, start]
    return affine


def _first(fields: dict[str, str], *names: str) -> str:
    return next((fields[name] for name in names if name in fields), "")


def _parse(request: LoadRequest, text: str) -> list[float]:
    try:
        return [float(word) for word in text.split()]
    except ValueError:
        raise request.error(
            f"its header holds {shortened(text)} where numbers should be; the file is damaged."
        ) from None


def _sizes(request: LoadRequest, fields: dict[str, str]) -> list[int]:
    sizes = _parse(request, fields.get("DimSize", ""))
    if not all(size.is_integer() and abs(size) < LARGEST for size in sizes):
        raise request.error(
            f"its header gives the size {' x '.join(f'{n:g}' for n in sizes)}; the file is damaged."
        )
    return [int(size) for size in sizes]


def _integer(request: LoadRequest, fields: dict[str, str], name: str, default: int) -> int:
    try:
        return int(fields.get(name, default))
    except ValueError:
        raise request.error(
            f"its header gives {shortened(fields[name])} for {name}; the file is damaged."
        ) from None


def _is_true(text: str) -> bool:
    return text.strip().lower() in ("true", "1", "yes")
