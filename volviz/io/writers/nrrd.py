"""NRRD: header and values in one file, the values packed by gzip or plain.

Source: "Definition of NRRD File Format" (teem.sourceforge.net/nrrd/format.html). Colours are the fastest axis, channels
an axis of kind "list" behind those of space, time the fourth axis of a space that has one.
"""

from __future__ import annotations

import gzip
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from volviz.io.writers.content import Content
    from volviz.io.writers.request import SaveRequest

_TYPES = {
    "i1": "int8", "u1": "uint8", "i2": "int16", "u2": "uint16", "i4": "int32", "u4": "uint32", "i8": "int64",
    "u8": "uint64", "f4": "float", "f8": "double",
}  # fmt: skip


def write(content: Content, request: SaveRequest) -> None:
    """Write what there is, one time point and channel after another."""
    with request.path.open("wb") as file:
        file.write(_header(content, request).encode("utf-8"))
        if not request.compress:
            _values(content, request, file)
            return
        # without a name and a time: the same values give the same file
        with gzip.GzipFile("", "wb", 4, file, 0) as packed:
            _values(content, request, packed)


def _values(content: Content, request: SaveRequest, stream: object) -> None:
    for array, span in content.pieces(request):
        request.write(stream, array, *span)


def _header(content: Content, request: SaveRequest) -> str:
    x, y, z = content.lattice.dimensions
    times, channels = content.time_count, content.channel_count
    steps = np.asarray(content.lattice.direction).T * np.reshape(content.lattice.spacing, (3, 1))
    start, step = content.even_times or (0.0, 1.0)
    last = (0.0,) if times else ()
    vectors = [_vector((*row, *last)) for row in steps]
    sizes, kinds = [x, y, z], ["domain"] * 3
    if content.is_colour and channels:
        sizes.insert(0, channels)
        kinds.insert(0, "RGB-color" if channels == 3 else "RGBA-color")
        vectors.insert(0, "none")
    elif channels:
        sizes.append(channels)
        kinds.append("list")
        vectors.append("none")
    if times:
        sizes.append(times)
        kinds.append("time")
        vectors.append(_vector((0.0, 0.0, 0.0, step)))
    unit = content.length_unit.replace("µ", "u")
    units = [unit or "???"] * 3 + (["s" if content.even_times else "???"] if times else [])
    lines = [
        "NRRD0005",
        f"type: {_TYPES[content.dtype.str[1:]]}",
        f"dimension: {len(sizes)}",
        f"space: left-posterior-superior{'-time' if times else ''}",
        f"sizes: {' '.join(map(str, sizes))}",
        f"space directions: {' '.join(vectors)}",
        f"kinds: {' '.join(kinds)}",
        "endian: little",
        f"encoding: {'gzip' if request.compress else 'raw'}",
        f"space origin: {_vector((*content.lattice.origin, *((start,) if times else ())))}",
    ]
    if unit or content.even_times:
        lines.append("space units: " + " ".join(f'"{name}"' for name in units))
    if content.unit:
        plain = content.unit.replace("\\", "").replace('"', "")
        lines.append(f'sample units: "{plain}"')
    return "\n".join(lines) + "\n\n"


def _vector(numbers: tuple[float, ...]) -> str:
    # 17 digits give the same double again
    return f"({','.join(format(float(n), '.17g') for n in numbers)})"
