"""NIfTI-1, or NIfTI-2 where a size exceeds it; the header by nibabel, the values one volume after another.

Lengths are written in mm, the frame is RAS; sform and qform say the same, as far as a quaternion can (not a shear).
"""

from __future__ import annotations

import gzip
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.geometry import RAS_TO_LPS

if TYPE_CHECKING:
    from volviz.io.writers.content import Content
    from volviz.io.writers.request import SaveRequest

#: Largest size of an axis in NIfTI-1.
_LARGEST = 2**15 - 1
_LABELS = "label"


def write(content: Content, request: SaveRequest) -> None:
    """Write what there is: time is the fourth axis, channels the fifth, colours are values of three or four bytes."""
    header = _header(content, request)
    with request.path.open("wb") as file:
        if request.target.name.lower().endswith(".gz"):
            with gzip.GzipFile("", "wb", 4, file, 0) as packed:
                _write(content, request, header, packed)
        else:
            _write(content, request, header, file)


def _write(content: Content, request: SaveRequest, header: Any, stream: Any) -> None:
    # behind the header four zeros: no extensions
    stream.write(header.binaryblock.ljust(int(header["vox_offset"]), b"\0"))
    if content.is_colour:
        for time in content.frames:
            array = content.all_channels(time, request)
            request.write(stream, array, *content.span(time, len(content.frames)))
        return
    number = 0
    for channel in range(content.channel_count or 1):
        for time in content.frames:
            request.write(stream, content.array(time, channel, request), *content.span(number))
            number += 1


def _header(content: Content, request: SaveRequest) -> Any:
    import nibabel

    sizes = [*content.lattice.dimensions]
    if content.time_count or (content.channel_count and not content.is_colour):
        sizes.append(content.time_count or 1)
    if content.channel_count and not content.is_colour:
        sizes.append(content.channel_count)
    is_large = max(sizes) > _LARGEST
    # in the file itself, not beside it
    header: Any = nibabel.Nifti2Header() if is_large else nibabel.Nifti1Header()
    if content.is_colour:
        names = ["R", "G", "B", "A"][: content.channel_count]
        header.set_data_dtype(np.dtype([(name, "u1") for name in names]))
    else:
        header.set_data_dtype(content.dtype)
    header.set_data_shape(tuple(sizes))
    factor = content.to_millimetres(request)
    matrix = np.eye(4)
    matrix[:3, :3] = RAS_TO_LPS @ (np.asarray(content.lattice.direction) * content.lattice.spacing) * factor
    matrix[:3, 3] = RAS_TO_LPS @ np.asarray(content.lattice.origin) * factor
    header.set_qform(matrix, code="scanner", strip_shears=True)
    header.set_sform(matrix, code="scanner")
    times = content.even_times
    header.set_xyzt_units("mm", "sec" if times else None)
    if times:
        header["toffset"], header["pixdim"][4] = times
    if content.is_labels:
        header.set_intent(_LABELS)
    window = content.channels[0].window if content.channel_count is None else None
    if window is not None:
        header["cal_min"], header["cal_max"] = window
    header["descrip"] = content.unit.encode("ascii", "ignore")[:79]
    header["vox_offset"] = 544 if is_large else 352
    header["magic"] = b"n+2" if is_large else b"n+1"
    # nibabel leaves slope and intercept undefined for its own use
    header["scl_slope"], header["scl_inter"] = 1.0, 0.0
    return header
