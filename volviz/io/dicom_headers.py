"""What DICOM headers say about slices: what is needed to stack them, and nothing about a patient."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from volviz.io.geometry import Vector

#: Files that are looked at before a folder without any DICOM file is given up; a home folder must not take
#: minutes.
FILES_TO_TRY = 500
FILES_AT_MOST = 20_000
FOLDERS_DEEP = 6

_TAGS = [
    "SeriesInstanceUID", "Modality", "InstanceNumber", "AcquisitionNumber", "TemporalPositionIdentifier",
    "EchoNumbers", "Rows", "Columns", "NumberOfFrames", "SamplesPerPixel", "BitsAllocated",
    "PixelRepresentation", "PhotometricInterpretation", "TriggerTime", "FrameReferenceTime",
    "ImagePositionPatient", "ImageOrientationPatient", "PixelSpacing", "ImagerPixelSpacing", "SliceThickness",
    "SpacingBetweenSlices", "RescaleSlope", "RescaleIntercept", "RescaleType", "Units",
    "SharedFunctionalGroupsSequence", "PerFrameFunctionalGroupsSequence",
]  # fmt: skip


@dataclass(frozen=True)
class Slice:
    """One image file of a series.

    Attributes
    ----------
    position : tuple of 3 floats or None
        World position (LPS, mm) of the centre of the first pixel.
    orientation : tuple of 6 floats or None
        World directions of a row (towards higher columns) and of a column (towards higher rows).
    pixel_spacing : tuple of 2 floats or None
        Distance of rows and of columns, in that order, mm.
    step : float or None
        Distance of slices as the header claims it, mm.
    order : tuple of 4 ints
        Temporal position, acquisition, echo, instance number: what tells slices at one position apart.
    slope, intercept : float
        Rescaling of the stored values.
    frames : tuple of positions
        Of a multi-frame file: positions of the frames, in their order; empty when not given.
    time : float or None
        Seconds from the start of the measurement or the last heartbeat, where the header says it.
    frame : int
        Number of the frame, in a slice that is one frame of its file.
    cut_off : bool
        The file ends before its pixels do.
    """

    path: Path
    series: str
    modality: str
    rows: int
    columns: int
    count: int
    samples: int
    bits: int
    signed: bool
    compressed: bool
    position: Vector | None
    orientation: tuple[float, ...] | None
    pixel_spacing: tuple[float, float] | None
    step: float | None
    order: tuple[int, int, int, int]
    slope: float
    intercept: float
    unit: str
    frames: tuple[Vector, ...] = ()
    time: float | None = None
    frame: int = 0
    cut_off: bool = False


def looks_like_dicom(head: bytes) -> bool:
    """Whether these first bytes belong to a DICOM file, with or without its preamble."""
    if head[128:132] == b"DICM":
        return True
    # without preamble: group 0008 in little endian, an element of identification, explicit or implicit length
    return head[:2] == b"\x08\x00" and head[2:4] in (b"\x00\x00", b"\x05\x00", b"\x08\x00", b"\x16\x00")


def dicom_files(folder: Path, at_most: int = FILES_AT_MOST) -> Iterator[Path]:
    """Files below a folder that look like DICOM, folders in order, without following links in circles.

    Gives up after `FILES_TO_TRY` files when none of them was DICOM.
    """
    tried = found = 0
    base = len(folder.parts)
    for place, folders, names in os.walk(folder):
        here = Path(place)
        folders[:] = sorted(folders) if len(here.parts) - base < FOLDERS_DEEP else []
        for name in sorted(names):
            if tried >= at_most or (not found and tried >= FILES_TO_TRY):
                return
            path = here / name
            if name.startswith(".") or name.upper() == "DICOMDIR" or not path.is_file():
                continue
            tried += 1
            try:
                with path.open("rb") as stream:
                    head = stream.read(132)
            except OSError:
                continue
            if looks_like_dicom(head):
                found += 1
                yield path


def read_header(path: Path) -> Slice | None:
    """The header of one file, or None when it is no image or is damaged."""
    import pydicom
    from pydicom.config import disable_value_validation

    with warnings.catch_warnings(), disable_value_validation(), path.open("rb") as stream:
        warnings.simplefilter("ignore")
        try:
            header = pydicom.dcmread(stream, stop_before_pixels=True, specific_tags=list(_TAGS), force=True)
            syntax = getattr(header.file_meta, "TransferSyntaxUID", None)
            compressed = bool(syntax is not None and syntax.is_compressed)
            deflated = bool(syntax is not None and syntax.is_deflated)
            found = _slice(path, header, compressed=compressed)
        except OSError:
            raise
        except Exception:  # noqa: BLE001 - what a damaged header raises inside the library has no end
            return None
        # pydicom stops at the tag of the pixel data: 2 + 2 bytes of tag, then VR and length, or the length
        # alone
        if not compressed and not deflated and found is not None:
            there = path.stat().st_size - stream.tell() - 8
            if there < _bytes_of_pixels(found, str(header.get("PhotometricInterpretation", ""))):
                return replace(found, cut_off=True)
    return found


def _bytes_of_pixels(item: Slice, interpretation: str) -> int:
    """Bytes of uncompressed pixels. In YBR_FULL_422 two pixels share their colour (DICOM PS3.3, C.7.6.3.1.2)."""
    samples = 2 if interpretation == "YBR_FULL_422" else item.samples
    return item.rows * item.columns * samples * item.count * item.bits // 8


def _slice(path: Path, header: Any, *, compressed: bool) -> Slice | None:
    if "Rows" not in header or "Columns" not in header:
        return None
    shared = _group(header, "SharedFunctionalGroupsSequence", 0)
    first = _group(header, "PerFrameFunctionalGroupsSequence", 0)

    def find(sequence: str, name: str) -> Any:
        for place in (first, shared):
            inner = _group(place, sequence, 0)
            if inner is not None and name in inner:
                return inner[name].value
        return header.get(name)

    values = "PixelValueTransformationSequence"
    slope, intercept = find(values, "RescaleSlope"), find(values, "RescaleIntercept")
    modality = str(header.get("Modality", "") or "")
    measures = "PixelMeasuresSequence"
    spacing = _floats(find(measures, "PixelSpacing") or header.get("ImagerPixelSpacing"), 2)
    step = _floats([find(measures, "SpacingBetweenSlices") or find(measures, "SliceThickness")], 1)
    frames = tuple(
        position
        for item in header.get("PerFrameFunctionalGroupsSequence", ())
        if (position := _position(_group(item, "PlanePositionSequence", 0))) is not None
    )
    time = header.get("FrameReferenceTime")
    milliseconds = _floats([header.get("TriggerTime") if time is None else time], 1)
    return Slice(
        path=path,
        series=str(header.get("SeriesInstanceUID", "")),
        modality=modality,
        rows=int(header.Rows),
        columns=int(header.Columns),
        count=int(header.get("NumberOfFrames", 1) or 1),
        samples=int(header.get("SamplesPerPixel", 1) or 1),
        bits=int(header.get("BitsAllocated", 16) or 16),
        signed=bool(header.get("PixelRepresentation", 0)),
        compressed=compressed,
        position=frames[0] if frames else _position(header),
        orientation=_floats(find("PlaneOrientationSequence", "ImageOrientationPatient"), 6),
        pixel_spacing=(spacing[0], spacing[1]) if spacing and min(spacing) > 0 else None,
        step=abs(step[0]) if step and step[0] else None,
        order=(
            _integer(header, "TemporalPositionIdentifier"), _integer(header, "AcquisitionNumber"),
            _integer(header, "EchoNumbers"), _integer(header, "InstanceNumber"),
        ),
        slope=1.0 if slope is None else float(slope),
        intercept=0.0 if intercept is None else float(intercept),
        unit=_unit(modality, header, find(values, "RescaleType"), scaled=slope is not None),
        frames=frames,
        time=milliseconds[0] / 1000.0 if milliseconds else None,
    )  # fmt: skip


def _unit(modality: str, header: Any, kind: Any, *, scaled: bool) -> str:
    """Hounsfield units for rescaled CT, becquerel for PET; nothing where the header does not say."""
    if modality == "CT" and scaled and str(kind or "HU").upper() == "HU":
        return "HU"
    if modality == "PT":
        units = str(header.get("Units", "") or "")
        return {"BQML": "Bq/ml", "GML": "g/ml", "CNTS": "counts"}.get(units, units)
    return ""


def _group(item: Any, name: str, index: int) -> Any:
    sequence = item.get(name) if item is not None else None
    return sequence[index] if sequence and len(sequence) > index else None


def _position(item: Any) -> Vector | None:
    values = _floats(item.get("ImagePositionPatient"), 3) if item is not None else None
    return (values[0], values[1], values[2]) if values else None


def _floats(values: Sequence[Any] | None, count: int) -> tuple[float, ...] | None:
    if values is None or len(values) != count or any(v is None for v in values):
        return None
    result = tuple(float(v) for v in values)
    return result if np.all(np.isfinite(result)) else None


def _integer(header: Any, name: str) -> int:
    try:
        return int(header.get(name) or 0)
    except (TypeError, ValueError):
        return 0
