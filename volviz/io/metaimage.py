"""MetaImage files, values in the file itself (.mha) or beside the header (.mhd).

Source: "MetaIO/Documentation" of the Insight Toolkit (itk.org/Wiki/MetaIO/Documentation). The matrix of a
MetaImage lists the direction of one axis a row, in the patient frame LPS.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from volviz.io.file_source import file_source
from volviz.io.geometry import is_usable
from volviz.io.nrrd import FILES_AT_MOST, _numbered
from volviz.io.reader import shortened, stem
from volviz.io.stored import Stored, check_sizes, read_part
from volviz.volume_data.description import Statistics

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.reader import Job

SUFFIXES = (".mha", ".mhd")

HEADER_BYTES = 1 << 20

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
    return re.match(rb"(?:\s*\w+\s*=[^\n]*\n)*?\s*(ObjectType|NDims)\s*=", head) is not None


def open_source(job: Job) -> FileSource:
    """What the header says; the fourth axis is time."""
    fields, end = _header(job)
    sizes = _sizes(job, fields)
    if not sizes or len(sizes) != _integer(job, fields, "NDims", len(sizes)):
        raise job.error("its header gives no sizes that fit its dimensions; the file is damaged.")
    rank = len(sizes)
    sizes += [1] * (3 - rank)
    if min(sizes) < 1:
        raise job.error(f"its header gives the size {' x '.join(map(str, sizes))}; the file is damaged.")
    kind = fields.get("ElementType", "").upper().removesuffix("_ARRAY")
    if kind not in _TYPES:
        raise job.error(
            f"values of the MetaImage type {shortened(kind) if kind else '(none)'} cannot be shown; save it as numbers."
        )
    channels = _integer(job, fields, "ElementNumberOfChannels", 1)
    if len(sizes) > 4 or channels < 1:
        raise job.error(
            f"{len(sizes)} dimensions and {channels} channels are not those of a volume; save one volume."
        )
    stored = _stored(job, fields, end, sizes, channels, kind)
    check_sizes(stored, job)
    axes = "TZYX"[4 - len(sizes) :]
    if channels > 1:
        axes += "S"
    return file_source(
        job,
        lambda job: read_part(stored, axes, job),
        axes,
        stored.shape,
        job.geometry(_affine(job, fields, rank)),
        format="MetaImage",
        name=stem(job.path, SUFFIXES),
        dtype=stored.dtype,
        statistics=_statistics(job, fields),
        length_unit="mm",
    )


def _statistics(job: Job, fields: dict[str, str]) -> Statistics | None:
    found = [_parse(job, fields.get(name, "")) for name in ("ElementMin", "ElementMax")]
    low, high = (values[0] if len(values) == 1 else np.nan for values in found)
    return Statistics(low, high) if -np.inf < low <= high < np.inf else None


def _header(job: Job) -> tuple[dict[str, str], int]:
    """Fields by name and the byte at which the values begin (for values in the same file)."""
    with job.path.open("rb") as stream:
        head = stream.read(HEADER_BYTES)
    if not sniff(head, job.path):
        raise job.error("this is no MetaImage file, though it is called so; check how it was made.")
    last = re.search(rb"^[ \t]*ElementDataFile[ \t]*=[^\n]*(\n|\Z)", head, re.MULTILINE)
    if last is None:
        raise job.error("its header names no ElementDataFile; the file is cut off or damaged.")
    fields: dict[str, str] = {}
    for line in head[: last.end()].decode("utf-8", "replace").splitlines():
        name, equals, value = line.partition("=")
        if equals:
            fields[name.strip()] = value.strip()
    if fields["ElementDataFile"].upper().startswith("LIST"):
        fields["list"] = head[last.end() :].decode("utf-8", "replace")
    return fields, last.end()


def _stored(job: Job, fields: dict[str, str], end: int, sizes: list[int], channels: int, kind: str) -> Stored:
    target = fields["ElementDataFile"]
    local = target.upper() == "LOCAL"
    files = (job.path,) if local else _data_files(job, fields, target)
    skip = _integer(job, fields, "HeaderSize", 0)
    big = _is_true(fields.get("ElementByteOrderMSB", fields.get("BinaryDataByteOrderMSB", "False")))
    shape = tuple(sizes[::-1]) + ((channels,) if channels > 1 else ())
    dtype = np.dtype((">" if big else "<") + _TYPES[kind])
    start = end if local else 0
    if not _is_true(fields.get("BinaryData", "True")):
        return Stored(files, shape, dtype, offset=start, encoding="text")
    if _is_true(fields.get("CompressedData", "False")):
        return Stored(files, shape, dtype, packed_offset=start + max(skip, 0), encoding="gzip")
    return Stored(files, shape, dtype, offset=-1 if skip < 0 else start + skip)


def _data_files(job: Job, fields: dict[str, str], target: str) -> tuple[Path, ...]:
    folder = job.path.parent
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
            raise job.error("its header numbers the data files unreadably; the file is damaged.") from None
        return tuple(folder / _numbered(words[0], n) for n in numbers)
    return (folder / target,)


def _affine(job: Job, fields: dict[str, str], rank: int) -> npt.NDArray[np.float64]:
    spacing = _first(fields, "ElementSpacing", "ElementSize")
    origin = _first(fields, "Offset", "Position", "Origin")
    rows = _first(fields, "TransformMatrix", "Rotation", "Orientation")
    steps = np.array((_parse(job, spacing) or [1.0] * rank)[:3] + [1.0] * max(0, 3 - rank))
    start = np.array((_parse(job, origin) or [0.0] * rank)[:3] + [0.0] * max(0, 3 - rank))
    matrix = np.eye(3)
    values = _parse(job, rows)
    if values:
        size = round(len(values) ** 0.5)
        if size * size != len(values) or size < min(rank, 3):
            raise job.error("its TransformMatrix does not fit its dimensions; the file is damaged.")
        matrix[: min(size, 3), : min(size, 3)] = np.reshape(values, (size, size))[:3, :3]
    if len(steps) != 3 or len(start) != 3 or not is_usable(matrix) or not np.all(np.isfinite(steps)):
        raise job.error("its spacing, offset or TransformMatrix is unusable; the file is damaged.")
    steps = np.where(steps == 0, 1.0, np.abs(steps))
    # the rows of the file are the columns of `direction`
    affine: npt.NDArray[np.float64] = np.c_[matrix.T * steps, start]
    return affine


def _first(fields: dict[str, str], *names: str) -> str:
    return next((fields[name] for name in names if name in fields), "")


def _parse(job: Job, text: str) -> list[float]:
    try:
        return [float(word) for word in text.split()]
    except ValueError:
        raise job.error(
            f"its header holds {shortened(text)} where numbers should be; the file is damaged."
        ) from None


def _sizes(job: Job, fields: dict[str, str]) -> list[int]:
    sizes = _parse(job, fields.get("DimSize", ""))
    if not all(size.is_integer() and abs(size) < LARGEST for size in sizes):
        raise job.error(
            f"its header gives the size {' x '.join(f'{n:g}' for n in sizes)}; the file is damaged."
        )
    return [int(size) for size in sizes]


def _integer(job: Job, fields: dict[str, str], name: str, default: int) -> int:
    try:
        return int(fields.get(name, default))
    except ValueError:
        raise job.error(
            f"its header gives {shortened(fields[name])} for {name}; the file is damaged."
        ) from None


def _is_true(text: str) -> bool:
    return text.strip().lower() in ("true", "1", "yes")
