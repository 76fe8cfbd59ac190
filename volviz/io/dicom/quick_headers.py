"""Headers of ordinary DICOM files, read without pydicom.

pydicom takes longer to be imported than a folder of slices to be read, and a millisecond or more for each header. Most
files need none of what it knows: their header is a run of elements with a number or a word each. Whatever is not quite
so (sequences among what is wanted, other byte orders, a file without meta information, anything odd) is left to
pydicom, and `tests/unit/io/test_dicom_headers.py` compares both. Source: DICOM PS3.5, 7.1 and 7.5; PS3.10, 7.1.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from typing import IO, Any

#: Elements that are read, by group and element: keyword, and type of the value as PS3.6 says it.
_ELEMENTS: dict[int, tuple[str, str]] = {
    0x00080008: ("ImageType", "CS"), 0x00080016: ("SOPClassUID", "UI"), 0x00080060: ("Modality", "CS"),
    0x00180050: ("SliceThickness", "DS"), 0x00180081: ("EchoTime", "DS"), 0x00180086: ("EchoNumbers", "IS"),
    0x00180088: ("SpacingBetweenSlices", "DS"), 0x00181060: ("TriggerTime", "DS"),
    0x00181164: ("ImagerPixelSpacing", "DS"), 0x00189087: ("DiffusionBValue", "FD"),
    0x00189089: ("DiffusionGradientOrientation", "FD"), 0x0020000E: ("SeriesInstanceUID", "UI"),
    0x00200012: ("AcquisitionNumber", "IS"), 0x00200013: ("InstanceNumber", "IS"),
    0x00200032: ("ImagePositionPatient", "DS"), 0x00200037: ("ImageOrientationPatient", "DS"),
    0x00200100: ("TemporalPositionIdentifier", "IS"), 0x00280002: ("SamplesPerPixel", "US"),
    0x00280004: ("PhotometricInterpretation", "CS"), 0x00280008: ("NumberOfFrames", "IS"),
    0x00280010: ("Rows", "US"), 0x00280011: ("Columns", "US"), 0x00280030: ("PixelSpacing", "DS"),
    0x00280100: ("BitsAllocated", "US"), 0x00280101: ("BitsStored", "US"),
    0x00280103: ("PixelRepresentation", "US"), 0x00281052: ("RescaleIntercept", "DS"),
    0x00281053: ("RescaleSlope", "DS"), 0x00281054: ("RescaleType", "LO"),
    0x00540010: ("EnergyWindowVector", "US"), 0x00540070: ("TimeSlotVector", "US"),
    0x00540080: ("SliceVector", "US"), 0x00541001: ("Units", "CS"), 0x00541300: ("FrameReferenceTime", "DS"),
    0x30040002: ("DoseUnits", "CS"), 0x3004000C: ("GridFrameOffsetVector", "DS"),
    0x3004000E: ("DoseGridScaling", "DS"),
}  # fmt: skip

#: Files with one of these are left to pydicom: functional groups, detectors, segments, dimensions, float pixels.
_BEYOND = {
    0x52009229, 0x52009230, 0x00540022, 0x00620001, 0x00620002, 0x00209222, 0x7FE00008, 0x7FE00009,
}  # fmt: skip
_PIXELS = 0x7FE00010
_META_SYNTAX = 0x00020010

_IMPLICIT = "1.2.840.10008.1.2"
_EXPLICIT = "1.2.840.10008.1.2.1"
#: Syntaxes of compressed pixels, whose headers are explicit and little-endian.
_COMPRESSED = ("1.2.840.10008.1.2.4.", "1.2.840.10008.1.2.5")

#: Types with a length of four bytes.
_LONG = (b"OB", b"OD", b"OF", b"OL", b"OV", b"OW", b"SQ", b"SV", b"UC", b"UN", b"UR", b"UT", b"UV")
_UNDEFINED = 0xFFFFFFFF
_ITEM, _SEQUENCE_END = 0xFFFEE000, 0xFFFEE0DD
#: Bytes of a header that are read at once, and at most.
_FIRST, _MOST = 16 << 10, 4 << 20


class QuickHeader:
    """The values of a header by their keywords, as `volviz.io.dicom.full_headers.FullHeader` gives them.

    Attributes
    ----------
    is_compressed, is_deflated, is_implicit, is_little, pixels
        As in `volviz.io.dicom.full_headers.FullHeader`.
    """

    is_deflated = False
    is_little = True

    def __init__(self, values: dict[str, Any], syntax: str, pixels: int) -> None:
        self._values = values
        self.is_implicit = syntax == _IMPLICIT
        self.is_compressed = syntax.startswith(_COMPRESSED)
        self.pixels = pixels

    def __contains__(self, name: str) -> bool:
        return name in self._values

    def __getattr__(self, name: str) -> Any:
        try:
            return self._values[name]
        except KeyError:
            raise AttributeError(name) from None

    def get(self, name: str | int | tuple[int, int], default: Any = None) -> Any:
        """Value of a keyword; private elements are not read."""
        return self._values.get(name, default) if isinstance(name, str) else default


class _Unusual(Exception):
    """Something that is left to pydicom."""


class _Short(Exception):
    """More of the file is needed."""


def quick_header(stream: IO[bytes]) -> QuickHeader | None:
    """The header of a file, None where pydicom is to read it."""
    size = _FIRST
    while size <= _MOST:
        stream.seek(0)
        data = stream.read(size)
        try:
            return _header(data)
        except (_Short, struct.error):
            if len(data) < size:
                return None
            size *= 16
        except (_Unusual, ValueError):
            return None
    return None


def _header(data: bytes) -> QuickHeader:
    if data[128:132] != b"DICM":
        raise _Unusual
    syntax, at = "", 132
    while data[at : at + 2] == b"\x02\0":
        tag, _, start, at = next(_elements(data, at, is_implicit=False))
        if tag == _META_SYNTAX:
            syntax = data[start:at].decode("ascii").strip("\0 ")
    if syntax not in (_IMPLICIT, _EXPLICIT) and not syntax.startswith(_COMPRESSED):
        raise _Unusual
    is_implicit = syntax == _IMPLICIT
    # some files do not keep to the syntax that they name
    if (data[at + 4 : at + 6].isalpha() and data[at + 4 : at + 6].isupper()) == is_implicit:
        raise _Unusual
    values: dict[str, Any] = {}
    last = 0
    for tag, kind, start, end in _elements(data, at, is_implicit=is_implicit):
        if tag <= last or tag in _BEYOND:
            raise _Unusual
        last = tag
        if tag == _PIXELS:
            break
        if tag in _ELEMENTS:
            name, wanted = _ELEMENTS[tag]
            if kind not in (b"", wanted.encode()):
                raise _Unusual
            values[name] = _VALUES[wanted](data[start:end])
        at = end
    else:
        raise _Short
    kinds = values.get("ImageType") or ()
    # images that hold several slices are described in private elements
    if "MOSAIC" in kinds or "VFRAME" in kinds:
        raise _Unusual
    return QuickHeader(values, syntax, at)


def _elements(data: bytes, at: int, *, is_implicit: bool) -> Iterator[tuple[int, bytes, int, int]]:
    """Tag, type (empty in the implicit form), and where value begins and ends, of one element after another.

    Of pixels, whose value need not be there, the end is the beginning.
    """
    while at < len(data):
        group, element = struct.unpack_from("<HH", data, at)
        tag = group << 16 | element
        kind = b"" if is_implicit else data[at + 4 : at + 6]
        if is_implicit or kind in _LONG:
            start = at + (8 if is_implicit else 12)
            (length,) = struct.unpack_from("<I", data, start - 4)
        else:
            start = at + 8
            (length,) = struct.unpack_from("<H", data, at + 6)
            if not kind.isalpha():
                raise _Unusual
        if tag == _PIXELS:
            yield tag, kind, start, start
            return
        if length == _UNDEFINED:
            # of unknown values those in the file are implicit, whatever the rest is
            end = _end_of_sequence(data, start, is_implicit=is_implicit or kind == b"UN")
        else:
            end = start + length
        if end > len(data):
            raise _Short
        yield tag, kind, start, end
        at = end
    raise _Short


def _end_of_sequence(data: bytes, at: int, *, is_implicit: bool) -> int:
    """Where a sequence without a length ends."""
    while True:
        group, element, length = struct.unpack_from("<HHI", data, at)
        tag = group << 16 | element
        at += 8
        if tag == _SEQUENCE_END:
            return at
        if tag != _ITEM:
            raise _Unusual
        at = at + length if length != _UNDEFINED else _end_of_item(data, at, is_implicit=is_implicit)


def _end_of_item(data: bytes, at: int, *, is_implicit: bool) -> int:
    while data[at : at + 4] != b"\xfe\xff\x0d\xe0":
        _, _, _, at = next(_elements(data, at, is_implicit=is_implicit))
    return at + 8


def _texts(value: bytes) -> str | list[str]:
    parts = [part.strip("\0 ") for part in value.decode("ascii").split("\\")]
    return parts[0] if len(parts) == 1 else parts


def _numbers_in_text(kind: type[int | float]) -> Callable[[bytes], Any]:
    def convert(value: bytes) -> Any:
        parts = [
            kind(part) if part.strip("\0 ") else None
            for part in value.decode("ascii").strip("\0 ").split("\\")
        ]
        return parts[0] if len(parts) == 1 else parts

    return convert


def _binary(code: str, width: int) -> Callable[[bytes], Any]:
    def convert(value: bytes) -> Any:
        numbers = struct.unpack(f"<{len(value) // width}{code}", value)
        return None if not numbers else numbers[0] if len(numbers) == 1 else list(numbers)

    return convert


_VALUES: dict[str, Callable[[bytes], Any]] = {
    "CS": _texts, "LO": _texts, "UI": _texts, "DS": _numbers_in_text(float), "IS": _numbers_in_text(int),
    "US": _binary("H", 2), "FD": _binary("d", 8),
}  # fmt: skip
