"""What DICOM headers say about images: what is needed to stack them, and nothing about a patient."""

from __future__ import annotations

import gzip
import io
import math
import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Literal

import numpy as np

from volviz.io.dicom.finding import opened
from volviz.io.dicom.full_headers import full_header
from volviz.io.dicom.quick_headers import quick_header
from volviz.io.dicom.tiles import Tiles, tiles_of
from volviz.volume_data.description import Label

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from volviz.io.dicom.full_headers import FullHeader
    from volviz.io.dicom.quick_headers import QuickHeader
    from volviz.io.geometry import Vector

    AnyHeader = QuickHeader | FullHeader

WHOLE_SLIDE = "1.2.840.10008.5.1.4.1.1.77.1.6"
PARAMETRIC_MAP = "1.2.840.10008.5.1.4.1.1.30"
#: Dimensions of a multi-frame file that only repeat where a frame lies.
_PLACE_POINTERS = {
    0x00209057,
    0x00200032,
    0x00209113,
    0x0020930E,
    0x00209301,
    0x0020000A,
    0x0048021E,
    0x0048021F,
}


@dataclass(frozen=True)
class PlainPixels:
    """Pixels of one component that lie uncompressed in a file: first byte, type with byte order, used bits of each.

    That holds for the file as it was then: its size in bytes, and when it was written, in nanoseconds.
    """

    offset: int
    dtype: str
    used_bits: int
    size: int
    modified: int

    def are_in(self, path: Path) -> bool:
        """Whether the file is still the one that was looked at."""
        now = path.stat()
        return (now.st_size, now.st_mtime_ns) == (self.size, self.modified)


@dataclass(frozen=True)
class ImageFile:
    """What one file says about all of its frames.

    Attributes
    ----------
    series : str
        Series instance UID.
    rows, columns, samples, bits : int
        Size of the stored images, components and bits of a pixel.
    is_signed : bool
        Pixels are numbers with a sign.
    compressed : bool
        By a codec, pixel by pixel.
    interpretation : str
        Photometric interpretation.
    labels : tuple of Label, or None
        Segments of a segmentation; None for images.
    fractional : float
        Value that stands for a whole voxel in a segmentation of fractions, 0 in others.
    tiles : Tiles or None
        How an image is divided that holds several slices side by side.
    is_flat : bool
        Its frames are tiles of one flat image, a slide under the microscope.
    cut_off : bool
        The file ends before its pixels do.
    plain : PlainPixels or None
        Where the pixels lie when they can be taken from the file as they are.
    """

    path: Path
    series: str
    modality: str
    rows: int
    columns: int
    count: int
    samples: int
    bits: int
    is_signed: bool
    compressed: bool
    interpretation: str
    unit: str
    labels: tuple[Label, ...] | None = None
    fractional: float = 0.0
    tiles: Tiles | None = None
    is_flat: bool = False
    cut_off: bool = False
    plain: PlainPixels | None = None


@dataclass(frozen=True)
class Frame:
    """One slice: the image of its own file, a frame of a file of many, or a tile of an image.

    Attributes
    ----------
    number : int
        Which frame of the file, counted from 0.
    tile : int
        Which tile of the frame, counted from 0.
    rows, columns : int
        Size of this slice.
    position : tuple of 3 floats or None
        World position (LPS, mm) of the centre of the first pixel.
    orientation : tuple of 6 floats or None
        World directions of a row (towards higher columns) and of a column (towards higher rows).
    pixel_spacing : tuple of 2 floats or None
        Distance of rows and of columns, in that order, mm.
    step : float or None
        Distance of slices as the header claims it, mm; negative against the normal.
    slope, intercept : float
        Rescaling of the stored values.
    dimensions : tuple of (word, value)
        What may tell frames at one place apart, strongest first: index values of the file, time point, echo time ...
    instance : int
        Number of the image in its series.
    time : float or None
        Seconds from the start of the measurement or the last heartbeat, where the header says it.
    segment : int
        Number of the segment that a frame of a segmentation belongs to.
    """

    file: ImageFile
    number: int
    tile: int
    rows: int
    columns: int
    position: Vector | None
    orientation: tuple[float, ...] | None
    pixel_spacing: tuple[float, float] | None
    step: float | None
    slope: float
    intercept: float
    dimensions: tuple[tuple[str, Any], ...]
    instance: int
    time: float | None = None
    segment: int = 0

    @property
    def normal(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        """Unit vector across the slice, row direction times column direction."""
        rows = np.array(self.orientation or (1, 0, 0, 0, 1, 0), np.float64).reshape(2, 3)
        normal = np.cross(rows[0], rows[1])
        length = float(np.linalg.norm(normal))
        return normal / length if length > 0 else np.array([0.0, 0.0, 1.0])


def read_frames(path: Path) -> tuple[Frame, ...]:
    """Frames of one file; none when it is no image or its header is damaged."""
    try:
        stream = opened(path)
    except gzip.BadGzipFile:
        return ()
    with stream:
        quick = quick_header(stream)
        try:
            if quick is not None:
                return _frames_of(path, quick, stream)
            with full_header(stream) as full:
                return _frames_of(path, full, stream)
        except OSError:
            raise
        except Exception:  # noqa: BLE001 - what a damaged header raises inside the library has no end
            return ()


def _frames_of(path: Path, header: AnyHeader, stream: IO[bytes]) -> tuple[Frame, ...]:
    if "Rows" not in header or "Columns" not in header:
        return ()
    file = _file(path, header)
    if not file.compressed and not header.is_deflated:
        size = stream.seek(0, os.SEEK_END)
        if not isinstance(stream, io.BytesIO):
            file = replace(file, plain=_plain_pixels(file, header, stream))
        # behind the tag of the pixels stand their type and length, or the length alone
        if size - header.pixels - 8 < _bytes_of_pixels(file):
            file = replace(file, cut_off=True)
    return tuple(_frames(file, header))


def _plain_pixels(file: ImageFile, header: AnyHeader, stream: IO[bytes]) -> PlainPixels | None:
    """Where uncompressed pixels begin; None where they need pydicom."""
    used = int(header.get("BitsStored", file.bits) or file.bits)
    grey = file.interpretation in ("MONOCHROME1", "MONOCHROME2")
    if not grey or file.samples != 1 or file.bits not in (8, 16, 32) or not 0 < used <= file.bits:
        return None
    stream.seek(header.pixels)
    element = stream.read(12)
    order: Literal["little", "big"] = "little" if header.is_little else "big"
    tag = tuple(int.from_bytes(element[at : at + 2], order) for at in (0, 2))
    length = int.from_bytes(element[4:8] if header.is_implicit else element[8:12], order)
    if tag != (0x7FE0, 0x0010) or not _bytes_of_pixels(file) <= length < 0xFFFFFFFF:
        return None
    kind = f"{'<' if header.is_little else '>'}{'i' if file.is_signed else 'u'}{file.bits // 8}"
    now = file.path.stat()
    start = header.pixels + (8 if header.is_implicit else 12)
    return PlainPixels(start, kind, used, now.st_size, now.st_mtime_ns)


def _bytes_of_pixels(file: ImageFile) -> int:
    """Bytes of uncompressed pixels. In YBR_FULL_422 two pixels share their colour (DICOM PS3.3, C.7.6.3.1.2)."""
    samples = 2 if file.interpretation == "YBR_FULL_422" else file.samples
    return file.rows * file.columns * samples * file.count * file.bits // 8


def _file(path: Path, header: AnyHeader) -> ImageFile:
    modality = str(header.get("Modality", "") or "")
    segments = header.get("SegmentSequence") if "SegmentationType" in header else None
    fractional = str(header.get("SegmentationType", "")) == "FRACTIONAL"
    return ImageFile(
        path=path,
        series=str(header.get("SeriesInstanceUID", "")),
        modality=modality,
        rows=int(header.Rows),
        columns=int(header.Columns),
        count=int(header.get("NumberOfFrames", 1) or 1),
        samples=int(header.get("SamplesPerPixel", 1) or 1),
        bits=int(header.get("BitsAllocated", 16) or 16),
        is_signed=bool(header.get("PixelRepresentation", 0)),
        compressed=header.is_compressed,
        interpretation=str(header.get("PhotometricInterpretation", "")),
        unit=_unit(modality, header),
        labels=None
        if segments is None
        else tuple(Label(int(s.SegmentNumber), str(s.get("SegmentLabel", ""))) for s in segments),
        fractional=float(header.get("MaximumFractionalValue", 255) or 255) if fractional else 0.0,
        tiles=tiles_of(header),
        is_flat=str(header.get("SOPClassUID", "")) == WHOLE_SLIDE,
    )


class _Finder:
    """Attributes of one frame: from its own functional groups, those that all share, or the header itself."""

    def __init__(self, header: Any, number: int) -> None:
        self.header = header
        self._groups = (
            item_of(header, "PerFrameFunctionalGroupsSequence", number),
            item_of(header, "SharedFunctionalGroupsSequence", 0),
        )

    def __call__(self, sequence: str, name: str) -> Any:
        found = self.inner(sequence, name)
        return self.header.get(name) if found is None else found

    def inner(self, sequence: str, name: str) -> Any:
        """The same without the header itself."""
        for group in self._groups:
            inner = item_of(group, sequence, 0)
            if inner is not None and name in inner:
                return inner[name].value
        return None


def _frames(file: ImageFile, header: Any) -> Iterator[Frame]:
    offsets = _floats(header.get("GridFrameOffsetVector"), file.count)
    for number in range(file.count):
        find = _Finder(header, number)
        spacing = _spacing(find)
        orientation = _floats(
            find("PlaneOrientationSequence", "ImageOrientationPatient")
            or find.inner("PlaneOrientationVolumeSequence", "ImageOrientationVolume"),
            6,
        )
        position = _vector(
            find.inner("PlanePositionSequence", "ImagePositionPatient")
            or find.inner("PlanePositionVolumeSequence", "ImagePositionVolume")
        )
        if position is None and file.count == 1:
            position = _vector(header.get("ImagePositionPatient"))
        step = find("PixelMeasuresSequence", "SpacingBetweenSlices")
        step = step or find("PixelMeasuresSequence", "SliceThickness")
        values = _floats([step], 1) if step is not None else None
        slope, intercept = _scale(find, header)
        frame = Frame(
            file, number, 0, file.rows, file.columns, position, orientation, spacing,
            values[0] if values and values[0] else None,
            slope, intercept, tuple(_dimensions(find, number)), _integer(header, "InstanceNumber"),
            time=_seconds(find, header),
            segment=int(find("SegmentIdentificationSequence", "ReferencedSegmentNumber") or 0),
        )  # fmt: skip
        if file.count > 1 and position is None:
            frame = _placed(frame, header, offsets)
        yield from [frame] if file.tiles is None else _tiles(frame, file.tiles)


def _placed(frame: Frame, header: Any, offsets: tuple[float, ...] | None) -> Frame:
    """The frame where the grid of a dose or the detector of nuclear medicine puts it."""
    start = _vector(header.get("ImagePositionPatient"))
    if offsets is not None and start is not None:
        # offsets are counted from the first frame, or are coordinates themselves (DICOM PS3.3, C.8.8.3.2)
        along = offsets[frame.number] - offsets[0]
        return replace(frame, position=_moved(start, frame.normal, along))
    detector = item_of(header, "DetectorInformationSequence", 0)
    if detector is not None:
        start = _vector(detector.get("ImagePositionPatient")) or start
        orientation = _floats(detector.get("ImageOrientationPatient"), 6) or frame.orientation
        frame = replace(frame, orientation=orientation)
        if start is not None and orientation is not None and frame.step:
            slices = header.get("SliceVector")
            number = int(slices[frame.number]) - 1 if slices and len(slices) > frame.number else frame.number
            return replace(frame, position=_moved(start, frame.normal, number * frame.step))
    return frame


def _tiles(frame: Frame, tiles: Tiles) -> Iterator[Frame]:
    """The slices of an image that holds several side by side."""
    rows, columns = frame.rows // tiles.across, frame.columns // tiles.across
    normal = frame.normal
    if tiles.normal is not None and np.dot(normal, tiles.normal) < 0:
        normal = -normal
    spacing = frame.pixel_spacing or (1.0, 1.0)
    for tile in range(tiles.count):
        place = None if tiles.places is None else tiles.places[tile]
        if place is None and frame.position is not None and frame.orientation is not None:
            row, column = np.array(frame.orientation).reshape(2, 3)
            corner = np.array(frame.position) + row * spacing[1] * (frame.columns - columns) / 2
            corner += column * spacing[0] * (frame.rows - rows) / 2
            place = _vector((corner + normal * tile * abs(frame.step or 1.0)).tolist())
        yield replace(frame, tile=tile, rows=rows, columns=columns, position=place)


def _moved(start: Vector, direction: Any, length: float) -> Vector:
    x, y, z = (float(s + length * d) for s, d in zip(start, direction, strict=True))
    return x, y, z


def _spacing(find: _Finder) -> tuple[float, float] | None:
    given = find("PixelMeasuresSequence", "PixelSpacing") or find.header.get("ImagerPixelSpacing")
    spacing = _floats(given, 2)
    return (spacing[0], spacing[1]) if spacing and min(spacing) > 0 else None


def _scale(find: _Finder, header: Any) -> tuple[float, float]:
    """Slope and intercept from stored values to those they stand for."""
    if "DoseGridScaling" in header:
        return float(header.DoseGridScaling), 0.0
    slope = find("PixelValueTransformationSequence", "RescaleSlope")
    intercept = find("PixelValueTransformationSequence", "RescaleIntercept")
    if slope is None and str(header.get("SOPClassUID", "")) == PARAMETRIC_MAP:
        slope = find.inner("RealWorldValueMappingSequence", "RealWorldValueSlope")
        intercept = find.inner("RealWorldValueMappingSequence", "RealWorldValueIntercept")
    return 1.0 if slope is None else float(slope), 0.0 if intercept is None else float(intercept)


def _dimensions(find: _Finder, number: int) -> Iterator[tuple[str, Any]]:
    """What may tell this frame from others at its place, strongest first."""
    header = find.header
    pointers = [int(item.DimensionIndexPointer) for item in header.get("DimensionIndexSequence", ())]
    values = find.inner("FrameContentSequence", "DimensionIndexValues")
    values = [values] if isinstance(values, int) else list(values or ())
    for pointer, value in zip(pointers, values, strict=False):
        if pointer not in _PLACE_POINTERS:
            yield "frame set", int(value)
    time = find.inner("FrameContentSequence", "TemporalPositionIndex")
    yield "time point", _number(time if time is not None else header.get("TemporalPositionIdentifier"))
    echo = find.inner("MREchoSequence", "EffectiveEchoTime")
    yield "echo time", _number(echo if echo is not None else header.get("EchoTime"))
    yield "echo", _number(header.get("EchoNumbers"))
    yield "b value", _number(find("MRDiffusionSequence", "DiffusionBValue"))
    kind = header.get("ImageType")
    yield "kind of image", str(kind[2]) if kind is not None and len(kind) > 2 else ""
    for word, name in (("energy window", "EnergyWindowVector"), ("time point", "TimeSlotVector")):
        vector = header.get(name)
        yield word, int(vector[number]) if isinstance(vector, list) and len(vector) > number else 0
    delay = find.inner("CardiacSynchronizationSequence", "NominalCardiacTriggerDelayTime")
    yield "phase", _number(delay if delay is not None else header.get("TriggerTime"))
    yield "acquisition", _number(header.get("AcquisitionNumber"))


def _seconds(find: _Finder, header: Any) -> float | None:
    time = find.inner("CardiacSynchronizationSequence", "NominalCardiacTriggerDelayTime")
    for name in ("FrameReferenceTime", "TriggerTime"):
        time = header.get(name) if time is None else time
    milliseconds = _floats([time], 1)
    return milliseconds[0] / 1000.0 if milliseconds else None


def _unit(modality: str, header: Any) -> str:
    """Hounsfield units for rescaled CT, becquerel for PET; nothing where the header does not say."""
    find = _Finder(header, 0)
    scaled = find("PixelValueTransformationSequence", "RescaleSlope") is not None
    kind = find("PixelValueTransformationSequence", "RescaleType")
    if modality == "CT" and scaled and str(kind or "HU").upper() == "HU":
        return "HU"
    if modality == "PT":
        units = str(header.get("Units", "") or "")
        return {"BQML": "Bq/ml", "GML": "g/ml", "CNTS": "counts"}.get(units, units)
    if modality == "RTDOSE":
        return {"GY": "Gy", "RELATIVE": ""}.get(str(header.get("DoseUnits", "")), "")
    if str(header.get("SOPClassUID", "")) == PARAMETRIC_MAP:
        codes = find.inner("RealWorldValueMappingSequence", "MeasurementUnitsCodeSequence")
        code = str(codes[0].get("CodeValue", "")) if codes else ""
        return "" if code == "1" else code
    return ""


def item_of(item: Any, name: str, index: int) -> Any:
    """An item of a sequence, None where there is none."""
    sequence = item.get(name) if item is not None else None
    return sequence[index] if sequence and len(sequence) > index else None


def _vector(values: Any) -> Vector | None:
    found = _floats(values, 3)
    return (found[0], found[1], found[2]) if found else None


def _floats(values: Sequence[Any] | None, count: int) -> tuple[float, ...] | None:
    if values is None or isinstance(values, (str, int, float)) or len(values) != count:
        return None
    if any(v is None or v == "" for v in values):
        return None
    result = tuple(float(v) for v in values)
    return result if all(map(math.isfinite, result)) else None


def _number(value: Any) -> float:
    try:
        return float(value or 0)
    except (TypeError, ValueError):
        return 0.0


def _integer(header: Any, name: str) -> int:
    return int(_number(header.get(name)))
