"""Images that hold the slices of a volume side by side: mosaics of Siemens, tiles of UIH.

Siemens writes the position of the large image: its corner lies half of the missing columns and rows outside of that
of a slice. The number of slices is a private attribute, or stands in the vendor's header (CSA), which also says on
which side of a slice the next one lies.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy.typing as npt

_MOSAIC_COUNT = (0x0019, 0x100A)
_CSA_HEADER = (0x0029, 0x1010)
_UIH_COUNT = (0x0065, 0x1050)
_UIH_PLACES = (0x0065, 0x1051)


@dataclass(frozen=True)
class Tiles:
    """How an image is divided.

    Attributes
    ----------
    count : int
        Number of slices; they fill a square of tiles row by row.
    places : tuple of positions, or None
        World position of every slice where the header gives them.
    normal : tuple of 3 floats, or None
        From one slice to the next, where the vendor's header says so.
    """

    count: int
    places: tuple[tuple[float, float, float], ...] | None = None
    normal: tuple[float, float, float] | None = None

    @property
    def across(self) -> int:
        """Tiles along a row and along a column."""
        return math.ceil(math.sqrt(self.count))

    def cut(self, image: npt.NDArray[Any], tile: int) -> npt.NDArray[Any]:
        """One slice out of an image of shape (rows, columns[, samples])."""
        rows, columns = image.shape[0] // self.across, image.shape[1] // self.across
        top, left = divmod(tile, self.across)
        return image[top * rows : (top + 1) * rows, left * columns : (left + 1) * columns]


def tiles_of(header: Any) -> Tiles | None:
    """How the images of a file are divided; None for ordinary ones."""
    kinds = [str(kind).upper() for kind in header.get("ImageType") or ()]
    if "MOSAIC" in kinds:
        csa = _csa(header)
        given = header.get(_MOSAIC_COUNT)
        count = (
            int(float(given.value)) if given is not None else int(csa.get("NumberOfImagesInMosaic", [0])[0])
        )
        normal = csa.get("SliceNormalVector")
        return (
            Tiles(count, normal=(normal[0], normal[1], normal[2]) if normal and len(normal) == 3 else None)
            if count > 0
            else None
        )
    if "VFRAME" in kinds and header.get(_UIH_COUNT) is not None:
        count = int(float(header[_UIH_COUNT].value))
        items = header[_UIH_PLACES].value if header.get(_UIH_PLACES) is not None else ()
        places = [tuple(float(v) for v in item.ImagePositionPatient) for item in items]
        full = count > 0 and len(places) == count and all(len(place) == 3 for place in places)
        return (
            Tiles(count, places=tuple((p[0], p[1], p[2]) for p in places) if full else None)
            if count > 0
            else None
        )
    return None


def _csa(header: Any) -> dict[str, list[float]]:
    """Numbers of Siemens' header that are needed here.

    A list of elements: name (64 bytes), multiplicity, type, number of items; an item is four lengths and text, padded
    to four bytes. The layout is described by nibabel's documentation of Siemens' DICOM files.
    """
    element = header.get(_CSA_HEADER)
    data = bytes(element.value) if element is not None and isinstance(element.value, bytes) else b""
    wanted = {"NumberOfImagesInMosaic", "SliceNormalVector"}
    found: dict[str, list[float]] = {}
    second = data[:4] == b"SV10"
    at = 8 if second else 0
    # the older form counts the items of its first element into every length
    surplus = 0
    try:
        (elements,) = struct.unpack_from("<I", data, at)
        at += 8
        for number in range(min(elements, 1000)):
            name = data[at : at + 64].split(b"\0")[0].decode("latin-1")
            (items,) = struct.unpack_from("<I", data, at + 76)
            at += 84
            surplus = items if number == 0 else surplus
            values: list[float] = []
            for _ in range(min(items, 10_000)):
                lengths = struct.unpack_from("<4I", data, at)
                length = lengths[1] if second else max(lengths[0] - surplus, 0)
                text = data[at + 16 : at + 16 + length].split(b"\0")[0].strip()
                at += 16 + (length + 3) // 4 * 4
                if name in wanted and text:
                    values.append(float(text))
            if name in wanted and values:
                found[name] = values
    except (struct.error, ValueError):
        return found
    return found
