"""What ImageJ, OME and plain TIFF tags say beside the pixels: distances, times, channels."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from volviz.volume_data.description import Channel

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    import tifffile

    from volviz.io.geometry import Vector
    from volviz.io.reader import Job

#: Codes of tag 296 (ResolutionUnit): inch, centimetre, millimetre, micrometre; in micrometres.
_RESOLUTION_UNITS = {2: 25400.0, 3: 10000.0, 4: 1000.0, 5: 1.0}
_SAME_UNIT = dict.fromkeys(("micron", "microns", "um", "\\u00b5m", "\u03bcm", "micrometer"), "µm")
#: Seconds per unit of time, and nanometres per unit of a wavelength, as OME names them.
_SECONDS = {"s": 1.0, "ms": 1e-3, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0, "d": 86400.0}
_NANOMETRES = {"nm": 1.0, "µm": 1e3, "Å": 0.1}


def spacing_of(job: Job, file: tifffile.TiffFile, series: tifffile.TiffPageSeries) -> tuple[Vector, str]:
    """Spacing (x, y, z) and its unit, from OME, ImageJ or the resolution tags, in this order."""
    pixels = _ome_pixels(file)
    found = None if pixels is None else _ome_spacing(pixels)
    if found is not None:
        return found
    tags = series.keyframe.tags
    x, y = (_per_pixel(tags, name) for name in ("XResolution", "YResolution"))
    if file.is_imagej:
        info = file.imagej_metadata or {}
        unit = str(info.get("unit", "") or "")
        unit = _SAME_UNIT.get(unit.lower(), "" if unit in ("pixel", "pixels") else unit)
        z = abs(float(info.get("spacing", 0) or 0))
        return (x or 1.0, y or 1.0, z or x or 1.0), unit
    code = int(tags["ResolutionUnit"].value) if "ResolutionUnit" in tags else 1
    if not x or not y or code not in _RESOLUTION_UNITS or abs(x - y) < 1e-12:
        # 72 or 300 dots per inch are a printer's, no microscope's; without a z distance they would mislead
        job.note("The file does not say how far its pages lie apart; voxels are taken for cubes of side 1.")
        return (1.0, 1.0, 1.0), ""
    job.note("The file does not say how far its pages lie apart; the distance of its columns is taken.")
    micrometres = _RESOLUTION_UNITS[code]
    return (x * micrometres, y * micrometres, x * micrometres), "µm"


def _per_pixel(tags: Any, name: str) -> float | None:
    if name not in tags:
        return None
    above, below = tags[name].value
    return below / above if above and below else None


def channels_of(file: tifffile.TiffFile, count: int) -> list[Channel]:
    """What OME or ImageJ tell of so many channels; empty when they tell nothing, or of another number."""
    pixels = _ome_pixels(file)
    if pixels is not None:
        found = [_ome_channel(element) for element in _children(pixels, "Channel")]
    elif file.is_imagej:
        found = _imagej_channels(file.imagej_metadata or {}, count)
    else:
        found = []
    return found if len(found) == count and any(channel != Channel() for channel in found) else []


def times_of(file: tifffile.TiffFile, count: int) -> list[float] | None:
    """Seconds of so many time points by OME or ImageJ, None when they do not say it."""
    pixels = _ome_pixels(file)
    if pixels is not None:
        return _ome_times(pixels, count)
    step = _number((file.imagej_metadata or {}).get("finterval")) if file.is_imagej else None
    return None if not step else [step * index for index in range(count)]


def _imagej_channels(info: dict[str, Any], count: int) -> list[Channel]:
    ranges = info.get("Ranges") or [info.get("min"), info.get("max")]
    tables = info.get("LUTs") or []
    found = []
    for index in range(count):
        low, high = ([_number(v) for v in ranges[2 * index : 2 * index + 2]] + [None, None])[:2]
        window = (low, high) if low is not None and high is not None and low < high else None
        color = None
        if index < len(tables) and info.get("mode") != "grayscale":
            red, green, blue = (float(part[-1]) / 255.0 for part in tables[index][:3])
            color = red, green, blue
        found.append(Channel(color=color, window=window))
    return found


def _ome_pixels(file: tifffile.TiffFile) -> Element | None:
    """The first element Pixels of OME's description."""
    if not file.is_ome:
        return None
    # expat neither fetches external entities nor expands internal ones without bound
    import xml.etree.ElementTree as ET

    try:
        root = ET.fromstring(file.ome_metadata or "")  # noqa: S314
    except ET.ParseError:
        return None
    return next((e for e in root.iter() if e.tag.endswith("}Pixels")), None)


def _children(pixels: Element, name: str) -> list[Element]:
    return [e for e in pixels if e.tag.endswith("}" + name)]


def _ome_spacing(pixels: Element) -> tuple[Vector, str] | None:
    if "PhysicalSizeX" not in pixels.attrib:
        return None
    try:
        x, y, z = (float(pixels.get(f"PhysicalSize{c}", pixels.attrib["PhysicalSizeX"])) for c in "XYZ")
    except ValueError:
        return None
    unit = pixels.get("PhysicalSizeXUnit", "µm")
    return ((x, y, z), _SAME_UNIT.get(unit.lower(), unit)) if min(x, y, z) > 0 else None


def _ome_channel(element: Element) -> Channel:
    color = None
    packed = _number(element.get("Color"))
    if packed is not None and packed.is_integer() and abs(packed) < 2**32:
        # red, green, blue, alpha from the highest byte on, of a signed number of 32 bits
        red, green, blue, _ = (byte / 255.0 for byte in (int(packed) & 0xFFFFFFFF).to_bytes(4, "big"))
        color = red, green, blue
    length = _number(element.get("EmissionWavelength"))
    unit = _NANOMETRES.get(element.get("EmissionWavelengthUnit", "nm"))
    known = length is not None and unit is not None and length > 0
    return Channel(element.get("Name", ""), color, None, length * unit if known else None)  # type: ignore[operator]


def _ome_times(pixels: Element, count: int) -> list[float] | None:
    """Times of the planes of the first slice and channel, else multiples of the increment."""
    first: dict[int, float] = {}
    for plane in _children(pixels, "Plane"):
        time = _number(plane.get("DeltaT"))
        unit = _SECONDS.get(plane.get("DeltaTUnit", "s"))
        at = plane.get("TheT", "")
        if plane.get("TheC") == plane.get("TheZ") == "0" and at.isdigit() and time is not None and unit:
            first[int(at)] = time * unit
    if sorted(first) == list(range(count)):
        return [first[index] for index in range(count)]
    step = _number(pixels.get("TimeIncrement"))
    unit = _SECONDS.get(pixels.get("TimeIncrementUnit", "s"))
    return [step * unit * index for index in range(count)] if step and unit else None


def _number(value: Any) -> float | None:
    """A finite number, None for anything else."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        return None
    return number if math.isfinite(number) else None
