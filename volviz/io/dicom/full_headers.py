"""Headers of DICOM files by pydicom: whatever `quick_headers` leaves to it."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import IO, Any

_TAGS: tuple[str | int, ...] = (
    "SOPClassUID", "SeriesInstanceUID", "Modality", "ImageType", "InstanceNumber", "AcquisitionNumber",
    "TemporalPositionIdentifier", "TriggerTime", "FrameReferenceTime", "EchoTime", "EchoNumbers", "DiffusionBValue",
    "DiffusionGradientOrientation", "Rows", "Columns", "NumberOfFrames", "SamplesPerPixel", "BitsAllocated",
    "PixelRepresentation", "PhotometricInterpretation", "ImagePositionPatient", "ImageOrientationPatient",
    "PixelSpacing", "ImagerPixelSpacing", "SliceThickness", "SpacingBetweenSlices", "RescaleSlope",
    "RescaleIntercept", "RescaleType", "BitsStored", "Units", "SharedFunctionalGroupsSequence",
    "PerFrameFunctionalGroupsSequence", "DimensionIndexSequence", "GridFrameOffsetVector", "DoseGridScaling",
    "DoseUnits", "DetectorInformationSequence", "SliceVector", "EnergyWindowVector", "TimeSlotVector",
    "SegmentationType", "MaximumFractionalValue", "SegmentSequence",
    # NumberOfImagesInMosaic and Siemens' header; numbers and places of UIH's tiles; each with its private creator
    0x00190010, 0x0019100A, 0x00290010, 0x00291010, 0x00650010, 0x00651050, 0x00651051,
)  # fmt: skip

#: Keywords by their tags; pydicom, which knows them, is imported when the first file is read.
_KEYWORDS: dict[int, str] = {}
_WANTED: list[Any] = []


class FullHeader:
    """What pydicom has read, with a quick answer for what is not there: most of what is asked for.

    Attributes
    ----------
    is_compressed, is_deflated, is_implicit, is_little : bool
        Of the transfer syntax: pixels are packed by a codec; the whole file is; elements name no types; byte order.
    pixels : int
        Byte of the file at which the element of the pixels begins.
    """

    def __init__(self, data: Any, pixels: int) -> None:
        self._data = data
        self._names = {_KEYWORDS[tag] for tag in data.keys() if tag in _KEYWORDS}  # noqa: SIM118 - a data set iterates over its elements
        self._found: dict[str, Any] = {}
        syntax = getattr(data.file_meta, "TransferSyntaxUID", None)
        self.is_deflated = bool(syntax is not None and syntax.is_deflated)
        self.is_compressed = bool(syntax is not None and syntax.is_compressed) and not self.is_deflated
        implicit, little = data.original_encoding
        self.is_implicit, self.is_little = bool(implicit), bool(little)
        self.pixels = pixels

    def __contains__(self, name: str) -> bool:
        return name in self._names

    def __getitem__(self, tag: int) -> Any:
        return self._data[tag]

    def __getattr__(self, name: str) -> Any:
        if name not in self._names:
            raise AttributeError(name)
        return self.get(name)

    def get(self, name: str | int | tuple[int, int], default: Any = None) -> Any:
        """Value of a keyword, or element of a tag."""
        if not isinstance(name, str):
            return self._data.get(name, default)
        if name not in self._names:
            return default
        if name not in self._found:
            self._found[name] = self._data.get(name, default)
        return self._found[name]


@contextmanager
def full_header(stream: IO[bytes]) -> Iterator[FullHeader]:
    """The header of a file as far as it is wanted; a damaged one raises whatever the library does.

    Values are made of it when they are asked for, and may raise as well; the library's warnings are no matter.
    """
    import pydicom
    from pydicom.config import disable_value_validation
    from pydicom.tag import Tag

    if not _KEYWORDS:
        _WANTED.extend(Tag(name) for name in _TAGS)
        _KEYWORDS.update({int(Tag(name)): name for name in _TAGS if isinstance(name, str)})
    stream.seek(0)
    with warnings.catch_warnings(), disable_value_validation():
        warnings.simplefilter("ignore")
        data = pydicom.dcmread(stream, stop_before_pixels=True, specific_tags=_WANTED, force=True)
        yield FullHeader(data, stream.tell())
