"""MetaImage: header and values in one file (.mha), the values packed by zlib or plain; lengths in mm."""

from __future__ import annotations

import zlib
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from volviz.io.writers.content import Content
    from volviz.io.writers.request import SaveRequest

_TYPES = {
    "i1": "MET_CHAR", "u1": "MET_UCHAR", "i2": "MET_SHORT", "u2": "MET_USHORT", "i4": "MET_INT", "u4": "MET_UINT",
    "i8": "MET_LONG_LONG", "u8": "MET_ULONG_LONG", "f4": "MET_FLOAT", "f8": "MET_DOUBLE",
}  # fmt: skip

#: Digits of a size that is known when the values have been packed.
_DIGITS = 20


def write(content: Content, request: SaveRequest) -> None:
    """Write what there is; channels lie side by side."""
    header = _header(content, request)
    with request.path.open("wb") as file:
        file.write(header.encode("ascii"))
        begin = file.tell()
        packer = zlib.compressobj(4) if request.compress else None
        for time in content.frames:
            one = (
                content.all_channels(time, request)
                if content.channel_count
                else content.array(time, 0, request)
            )
            for block in request.blocks(one, *content.span(time, len(content.frames))):
                file.write(block if packer is None else packer.compress(block))
        if packer is not None:
            file.write(packer.flush())
            size = file.tell() - begin
            file.seek(header.index("CompressedDataSize = ") + len("CompressedDataSize = "))
            file.write(f"{size:0{_DIGITS}d}".encode("ascii"))


def _header(content: Content, request: SaveRequest) -> str:
    factor = content.to_millimetres(request)
    sizes = [*content.lattice.dimensions]
    spacing = [s * factor for s in content.lattice.spacing]
    origin = [v * factor for v in content.lattice.origin]
    matrix: Any = np.asarray(content.lattice.direction)
    if content.time_count:
        sizes.append(content.time_count)
        spacing.append(1.0)
        origin.append(0.0)
        matrix = np.block([[matrix, np.zeros((3, 1))], [np.zeros((1, 3)), np.ones((1, 1))]])
    lines = [
        "ObjectType = Image",
        f"NDims = {len(sizes)}",
        "BinaryData = True",
        "BinaryDataByteOrderMSB = False",
        f"CompressedData = {request.compress}",
        # the rows of the file are the columns of `direction`
        f"TransformMatrix = {_numbers(matrix.T.flat)}",
        f"Offset = {_numbers(origin)}",
        f"CenterOfRotation = {_numbers([0.0] * len(sizes))}",
        f"ElementSpacing = {_numbers(spacing)}",
        f"DimSize = {' '.join(map(str, sizes))}",
        f"ElementType = {_TYPES[content.dtype.str[1:]]}",
        "ElementDataFile = LOCAL",
    ]
    if request.compress:
        lines.insert(5, f"CompressedDataSize = {'0' * _DIGITS}")
    if content.channel_count:
        lines.insert(-1, f"ElementNumberOfChannels = {content.channel_count}")
    return "\n".join(lines) + "\n"


def _numbers(values: Any) -> str:
    return " ".join(format(float(v), ".17g") for v in values)
