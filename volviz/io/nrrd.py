"""NRRD files, values in the file itself (.nrrd) or beside the header (.nhdr).

Source: "Definition of NRRD File Format" (G. Kindlmann, teem.sourceforge.net/nrrd/format.html) for fields,
encodings, spaces and the order of axes (fastest first).
"""

from __future__ import annotations

import re
import shlex
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from volviz.io.endings import NRRD
from volviz.io.file_source import file_source
from volviz.io.geometry import RAS_TO_LPS, is_usable
from volviz.io.raw_payload import Encoding, RawPayload, check_sizes, read_part
from volviz.io.reader import shortened, stem
from volviz.volume_data.description import Channel, Label

if TYPE_CHECKING:
    from volviz.io.file_source import FileSource
    from volviz.io.geometry import Geometry
    from volviz.io.reader import LoadRequest


#: A header longer than this is none.
HEADER_BYTES = 1 << 20

#: Numbered data files beyond this count are a damaged header, not a volume.
FILES_AT_MOST = 100_000

_TYPES = {
    "i1": "int8, int8_t, signed char",
    "u1": "uint8, uint8_t, uchar, unsigned char",
    "i2": "int16, int16_t, short, short int, signed short, signed short int",
    "u2": "uint16, uint16_t, ushort, unsigned short, unsigned short int",
    "i4": "int32, int32_t, int, signed int",
    "u4": "uint32, uint32_t, uint, unsigned int",
    "i8": "int64, int64_t, longlong, long long, long long int, signed long long, signed long long int",
    "u8": "uint64, uint64_t, ulonglong, unsigned long long, unsigned long long int",
    "f4": "float",
    "f8": "double",
}
_DTYPES = {name: code for code, names in _TYPES.items() for name in names.split(", ")}

_ENCODINGS: dict[str, Encoding] = {
    "raw": "raw", "gzip": "gzip", "gz": "gzip", "bzip2": "bzip2", "bz2": "bzip2",
    "ascii": "text", "text": "text", "txt": "text", "hex": "hex",
}  # fmt: skip

_TO_LPS = {"right-anterior-superior": RAS_TO_LPS, "ras": RAS_TO_LPS}
_TO_LPS |= dict.fromkeys(("left-anterior-superior", "las"), np.diag([1.0, -1.0, 1.0]))
_TIME_KINDS = {"time"}
_SECONDS = {"s": 1.0, "sec": 1.0, "ms": 1e-3}
_COLOUR_KINDS = {"rgb-color", "rgba-color", "3-color", "4-color"}
_SPACE_KINDS = {"domain", "space", "???", "none", "time"}


def sniff(head: bytes, _path: Path) -> bool:
    """Whether these are the first bytes of a NRRD file."""
    return re.match(rb"NRRD000[1-9]\r?\n", head) is not None


def open_source(request: LoadRequest) -> FileSource:
    """What the header says; a list of volumes is one of time points, or of channels."""
    fields, end = _header(request)
    try:
        sizes = [int(n) for n in fields["sizes"].split()]
        kind = fields["type"].lower()
        encoding = fields["encoding"].lower()
        dimension = int(fields.get("dimension", len(sizes)))
    except (KeyError, ValueError):
        raise request.error("its header gives no readable type, sizes and encoding.") from None
    if dimension != len(sizes):
        raise request.error(
            f"its header gives {dimension} dimensions and {len(sizes)} sizes; the file is damaged."
        )
    if dimension < 3:
        raise request.error(
            f"a volume needs three axes, this file has {dimension}; open a stack of images instead of a single one."
        )
    if kind not in _DTYPES:
        raise request.error(
            f"values of the NRRD type {shortened(kind)} cannot be shown; save it as integers or real numbers."
        )
    if encoding not in _ENCODINGS:
        raise request.error(
            f"the NRRD encoding {shortened(encoding)} cannot be read; save it with raw or gzip encoding."
        )
    labels = _labels(fields)
    is_labels = bool(labels) or request.path.name.lower().endswith(".seg.nrrd")
    order = ">" if fields.get("endian", "little").lower() == "big" else "<"
    payload = _payload(
        request, fields, end, tuple(sizes[::-1]), np.dtype(order + _DTYPES[kind]), _ENCODINGS[encoding]
    )
    check_sizes(payload, request)
    geometry, letters, colour = _axes(request, fields, sizes)
    if is_labels:
        # layers of labels, however many bits they have, are no components of a colour
        colour = False
        letters = letters.replace("S", "C")
    axes = letters[::-1]
    layers = payload.shape[axes.index("C")] if "C" in axes else 1
    return file_source(
        request,
        lambda request: read_part(payload, axes, request, colour=colour),
        axes,
        payload.shape,
        geometry,
        dtype=payload.dtype,
        colour=colour,
        is_labels=is_labels,
        # numbers that stand for one thing in one layer and for another in the next have no name as such
        labels=[label for _, label in labels if sum(label.number == one.number for _, one in labels) == 1],
        channels=[
            Channel(", ".join(label.name for at, label in labels if at == layer)) for layer in range(layers)
        ]
        if labels
        else (),
        times=_times(fields, letters, sizes),
        format="NRRD",
        name=stem(request.path, NRRD),
        unit=_quoted(fields.get("sampleunits", "")),
        length_unit=_length_unit(fields),
    )


def _header(request: LoadRequest) -> tuple[dict[str, str], int]:
    """Fields by name (lower case, without blanks) and the byte at which the values begin."""
    with request.path.open("rb") as stream:
        head = stream.read(HEADER_BYTES)
    if not sniff(head, request.path):
        raise request.error("this is no NRRD file, though it is called so; check how it was made.")
    blank = re.search(rb"\r?\n\r?\n", head)
    if blank is None and len(head) == HEADER_BYTES:
        raise request.error("its header does not end; the file is damaged.")
    # a detached header may end with the file
    text = head[: blank.start() if blank else None].decode("utf-8", "replace")
    fields: dict[str, str] = {}
    lines = text.splitlines()[1:]
    for number, line in enumerate(lines):
        if line.startswith("#") or ":" not in line:
            continue
        if ":=" in line:
            if line.startswith("Segment"):
                name, _, value = line.partition(":=")
                fields[name] = value.strip()
            continue
        name, _, value = line.partition(":")
        key = name.lower().replace(" ", "")
        fields[key] = value.strip()
        if key == "datafile" and value.strip().upper().startswith("LIST"):
            fields["list"] = "\n".join(lines[number + 1 :])
            break
    return fields, blank.end() if blank else len(head)


def _payload(
    request: LoadRequest,
    fields: dict[str, str],
    end: int,
    shape: tuple[int, ...],
    dtype: np.dtype[np.generic],
    encoding: Encoding,
) -> RawPayload:
    detached = fields.get("datafile")
    files = _data_files(request, detached, fields) if detached else (request.path,)
    start = 0 if detached else end
    try:
        lines = int(fields.get("lineskip", 0))
        skip = int(fields.get("byteskip", 0))
    except ValueError:
        raise request.error(
            "its header has an unreadable line skip or byte skip; the file is damaged."
        ) from None
    if lines > 0:
        start += _bytes_of_lines(files[0], start, lines, request)
    payload = RawPayload(files, shape, dtype, encoding=encoding)
    if encoding == "raw":
        return replace(payload, offset=-1 if skip < 0 else start + skip)
    if encoding == "text":
        return replace(payload, offset=start + max(skip, 0))
    return replace(payload, packed_offset=start, offset=max(skip, -1))


def _data_files(request: LoadRequest, detached: str, fields: dict[str, str]) -> tuple[Path, ...]:
    """The files a detached header names: one, a numbered pattern, or a list; relative to the header."""
    folder = request.path.parent
    words = detached.split()
    if words and words[0].upper() == "LIST":
        return tuple(folder / line.strip() for line in fields.get("list", "").splitlines() if line.strip())
    if re.search(r"%0?\d*d", detached) and len(words) >= 4:
        try:
            first, last, step = (int(word) for word in words[1:4])
            numbers = range(first, last + (1 if step > 0 else -1), step)
            if len(numbers) > FILES_AT_MOST:
                raise ValueError
        except (ValueError, OverflowError):
            raise request.error(
                "its header numbers the data files unreadably; the file is damaged."
            ) from None
        return tuple(folder / _numbered(words[0], n) for n in numbers)
    return (folder / detached,)


def _numbered(pattern: str, number: int) -> str:
    # not "%": a file name from a foreign header is no format string to trust
    found = re.search(r"%(0?)(\d*)d", pattern)
    assert found is not None
    width = int(found[2] or 0)
    digits = str(number).rjust(width, "0" if found[1] else " ")
    return pattern[: found.start()] + digits + pattern[found.end() :]


def _bytes_of_lines(file: Path, start: int, lines: int, request: LoadRequest) -> int:
    if not file.is_file():
        return 0
    with file.open("rb") as stream:
        stream.seek(start)
        for _ in range(lines):
            if not stream.readline(HEADER_BYTES):
                raise request.error("the file is cut off before its values begin; get it again.", file)
        return stream.tell() - start


def _axes(
    request: LoadRequest, fields: dict[str, str], sizes: list[int]
) -> tuple[Geometry, str, bool | None]:
    """Geometry, one letter an axis (fastest first), and whether the axis "S" holds colours."""
    kinds = fields.get("kinds", "").lower().split() or ["???"] * len(sizes)
    columns = _directions(request, fields, len(sizes))
    colour: bool | None = None
    letters = ""
    spatial = iter("XYZ")
    for axis in range(len(sizes)):
        kind = kinds[axis] if axis < len(kinds) else "???"
        in_space = columns[axis] is not None if columns is not None else kind in _SPACE_KINDS
        letter = next(spatial, None) if in_space else None
        if letter is None:
            is_time = kind in _TIME_KINDS or kind in _SPACE_KINDS or in_space
            letter = "T" if is_time and kind not in _COLOUR_KINDS else "S"
            if letter == "S" and axis > 0 and kind not in _COLOUR_KINDS:
                letter = "C"
        if letter == "S":
            colour = True if kind in _COLOUR_KINDS else None
        letters += letter
    if "Z" not in letters or any(letters.count(c) > 1 for c in "TCS"):
        raise request.error(
            f"its {len(sizes)} axes are not those of a volume; save it with three spatial axes."
        )
    order = [letters.index(c) for c in "XYZ"]
    if columns is not None:
        matrix = np.array([columns[axis] for axis in order], float).T
        if matrix.shape != (3, 3) or not is_usable(matrix):
            raise request.error("its space directions do not span space; the file is damaged.")
        turn = _TO_LPS.get(fields.get("space", "").lower().removesuffix("-time").removesuffix("t"), np.eye(3))
        origin = _vectors(fields.get("spaceorigin", ""))
        first = origin[0] if origin and origin[0] is not None and len(origin[0]) >= 3 else (0.0, 0.0, 0.0)
        start = np.nan_to_num(np.array(first[:3], float))
        return request.geometry(np.c_[turn @ matrix, turn @ start]), letters, colour
    spacing = _numbers(fields.get("spacings", ""), len(sizes))
    lowest = _numbers(fields.get("axismins", ""), len(sizes))
    highest = _numbers(fields.get("axismaxs", ""), len(sizes))
    centring = (fields.get("centers") or fields.get("centerings") or "").lower().split()
    steps, starts = [], []
    for axis in order:
        # samples lie in the middle of cells where the header does not say otherwise, as for other readers
        is_cell = centring[axis] != "node" if len(centring) == len(sizes) else True
        count = sizes[axis] if is_cell else sizes[axis] - 1
        step = spacing[axis]
        if not np.isfinite(step) and count > 0:
            step = (highest[axis] - lowest[axis]) / count
        if not np.isfinite(step) or step == 0:
            request.note("The file does not say how far its voxels lie apart along every axis; 1 is taken.")
            step = 1.0
        steps.append(step)
        starts.append(lowest[axis] + (step / 2 if is_cell else 0.0))
    return request.geometry(np.c_[np.diag(steps), np.nan_to_num(starts)]), letters, colour


def _times(fields: dict[str, str], letters: str, sizes: list[int]) -> list[float] | None:
    """Seconds of the time points of a four-dimensional space, whose fourth unit is one of time."""
    units = re.findall(r'"([^"]*)"', fields.get("spaceunits", ""))
    if "T" not in letters or len(units) != 4 or units[3] not in _SECONDS:
        return None
    at = letters.index("T")
    columns, origin = _vectors(fields.get("spacedirections", "")), _vectors(fields.get("spaceorigin", ""))
    column = columns[at] if at < len(columns) else None
    if column is None or len(column) != 4 or not np.isfinite(column[3]) or column[3] <= 0:
        return None
    first = origin[0][3] if origin and origin[0] is not None and len(origin[0]) == 4 else 0.0
    unit = _SECONDS[units[3]]
    return [unit * (first + index * column[3]) for index in range(sizes[at])] if np.isfinite(first) else None


def _labels(fields: dict[str, str]) -> list[tuple[int, Label]]:
    """Segments that 3D Slicer writes, as ``Segment0_Name:=liver`` and the like, each with the number of its layer."""
    found = []
    for number in sorted(int(m[1]) for m in map(re.compile(r"Segment(\d+)_ID").fullmatch, fields) if m):

        def said(name: str, number: int = number) -> str:
            return fields.get(f"Segment{number}_{name}", "")

        try:
            color = tuple(min(max(float(word), 0.0), 1.0) for word in said("Color").split())
            # every segment had a layer of its own before there were layers
            layer, value = int(said("Layer") or number), int(said("LabelValue") or 1)
        except ValueError:
            continue
        red, green, blue = color if len(color) == 3 else (0.0, 0.0, 0.0)
        name = said("Name") or said("ID")
        found.append((layer, Label(value, name, (red, green, blue) if len(color) == 3 else None)))
    return found


def _directions(
    request: LoadRequest, fields: dict[str, str], count: int
) -> list[tuple[float, ...] | None] | None:
    if "spacedirections" not in fields:
        return None
    columns = _vectors(fields["spacedirections"])
    if len(columns) > 3:
        # a four-dimensional space: the axis that leads nowhere in its first three dimensions is time
        columns = [None if c is None or not any(c[:3]) else c for c in columns]
    in_space = [c for c in columns if c is not None]
    if len(columns) != count or len(in_space) != 3 or min(len(c) for c in in_space) < 3:
        raise request.error("its space directions do not fit its axes; the file is damaged.")
    return [None if c is None else c[:3] for c in columns]


def _vectors(text: str) -> list[tuple[float, ...] | None]:
    """``none (1,0,0) (0,1,0)`` as numbers; unreadable ones are nan."""
    result: list[tuple[float, ...] | None] = []
    for found in re.finditer(r"\(([^)]*)\)|none", text, re.IGNORECASE):
        if found[1] is None:
            result.append(None)
        else:
            numbers = tuple(_number(word) for word in found[1].split(","))
            result.append(None if all(np.isnan(numbers)) else numbers)
    return result


def _numbers(text: str, count: int) -> list[float]:
    values = [_number(word) for word in text.split()]
    return values if len(values) == count else [float("nan")] * count


def _number(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        return float("nan")


def _quoted(text: str) -> str:
    try:
        words = shlex.split(text)
    except ValueError:
        return ""
    return words[0] if words and words[0] != "???" else ""


def _length_unit(fields: dict[str, str]) -> str:
    for key in ("spaceunits", "units"):
        unit = _quoted(fields.get(key, ""))
        if unit:
            return {"um": "µm", "micron": "µm", "microns": "µm"}.get(unit, unit)
    return "mm" if "space" in fields else ""
