"""What ImageJ, OME and plain TIFF tags say beside the pixels: distances, times, channels."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any

from volviz.io.units import converted, length_unit, seconds_per
from volviz.volume_data.description import Channel

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    import tifffile

    from volviz.io.geometry import Vector
    from volviz.io.reader import LoadRequest

#: Codes of tag 296 (ResolutionUnit): inch, centimetre, millimetre, micrometre; in micrometres.
_RESOLUTION_UNITS = {2: 25400.0, 3: 10000.0, 4: 1000.0, 5: 1.0}
#: Nanometres per unit of a wavelength, as OME names them.
_NANOMETRES = {"nm": 1.0, "µm": 1e3, "Å": 0.1}


def spacing_of(
    request: LoadRequest, file: tifffile.TiffFile, series: tifffile.TiffPageSeries
) -> tuple[Vector, str]:
    """Spacing (x, y, z) and its unit, from OME, ImageJ, LSM or the resolution tags, in this order."""
    pixels = _ome_pixels(file, series)
    found = None if pixels is None else _ome_spacing(request, pixels)
    if found is not None:
        return found
    tags = series.keyframe.tags
    x, y = (_per_pixel(tags, name) for name in ("XResolution", "YResolution"))
    if file.is_imagej:
        return _imagej_spacing(request, file.imagej_metadata or {}, x, y)
    if file.is_lsm:
        metres = [_number((file.lsm_metadata or {}).get(f"VoxelSize{axis}")) for axis in "XYZ"]
        if all(size is not None and size > 0 for size in metres):
            x, y, z = (size * 1e6 for size in metres if size is not None)
            return (x, y, z), "µm"
    code = int(tags["ResolutionUnit"].value) if "ResolutionUnit" in tags else 1
    if not x or not y or code not in _RESOLUTION_UNITS or abs(x - y) < 1e-12:
        # 72 or 300 dots per inch are a printer's, no microscope's; without a z distance they would mislead
        request.note(
            "The file does not say how far its pages lie apart; voxels are taken for cubes of side 1."
        )
        return (1.0, 1.0, 1.0), ""
    request.note("The file does not say how far its pages lie apart; the distance of its columns is taken.")
    micrometres = _RESOLUTION_UNITS[code]
    return (x * micrometres, y * micrometres, x * micrometres), "µm"


def _imagej_spacing(
    request: LoadRequest, info: dict[str, Any], x: float | None, y: float | None
) -> tuple[Vector, str]:
    """ImageJ leaves out a distance of slices that is 1, and their unit where it is that of the pixels."""
    unit = _unit(info.get("unit"))
    given = info.get("spacing")
    # some versions wrote a comma
    z = _number(str(given).replace(",", ".")) if given is not None else 1.0
    if z is None or z == 0:
        request.note("Its distance of slices is no number; that of its columns is taken.")
        return (x or 1.0, y or 1.0, x or 1.0), unit
    return (x or 1.0, y or 1.0, converted(abs(z), _unit(info.get("zunit") or unit), unit)), unit


def calibration_of(request: LoadRequest, file: tifffile.TiffFile) -> tuple[float, float, str]:
    """Slope, intercept and unit of ImageJ's calibrated values; (1, 0, "") where there are none."""
    info = (file.imagej_metadata or {}) if file.is_imagej else {}
    if "c0" not in info and "c1" not in info:
        return 1.0, 0.0, ""
    intercept, slope = _number(info.get("c0", 0.0)), _number(info.get("c1", 1.0))
    unit = str(info.get("vunit", "") or "")
    unit = "" if unit.lower() in ("gray value", "pixel", "none") else unit
    if int(_number(info.get("cf", 0)) or 0) != 0 or slope is None or intercept is None:
        request.note(
            "ImageJ calibrates its values by a curve that is not applied; the stored values are shown."
        )
        return 1.0, 0.0, ""
    return slope, intercept, unit


def missing_files(request: LoadRequest, file: tifffile.TiffFile) -> list[str]:
    """Names of files of an OME set that do not lie beside the opened one."""
    names = {e.get("FileName") for e in _ome_elements(file, "UUID")}
    folder = request.path.parent
    return sorted(name for name in names if name and not (folder / name).exists())


def _unit(text: Any) -> str:
    """A unit of length as it is written here: escapes and both letters mu resolved; empty for pixels."""
    name = re.sub(r"\\u([0-9a-fA-F]{4})", lambda code: chr(int(code[1], 16)), str(text or "")).strip()
    known = length_unit(name)
    return name if known is None else known


def _per_pixel(tags: Any, name: str) -> float | None:
    if name not in tags:
        return None
    above, below = tags[name].value
    return below / above if above and below else None


def channels_of(file: tifffile.TiffFile, series: tifffile.TiffPageSeries, count: int) -> list[Channel]:
    """What OME or ImageJ tell of so many channels; empty when they tell nothing, or of another number."""
    pixels = _ome_pixels(file, series)
    if pixels is not None:
        found = [_ome_channel(element) for element in _children(pixels, "Channel")]
    elif file.is_imagej:
        found = _imagej_channels(file.imagej_metadata or {}, count)
    else:
        found = []
    return found if len(found) == count and any(channel != Channel() for channel in found) else []


def times_of(file: tifffile.TiffFile, series: tifffile.TiffPageSeries, count: int) -> list[float] | None:
    """Seconds of so many time points by OME or ImageJ, None when they do not say it."""
    pixels = _ome_pixels(file, series)
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


def _ome_elements(file: tifffile.TiffFile, name: str) -> list[Element]:
    """Elements of OME's description, in its order; none where there is no readable one."""
    if not file.is_ome:
        return []
    # expat neither fetches external entities nor expands internal ones without bound
    import xml.etree.ElementTree as ET

    try:
        root = ET.fromstring(file.ome_metadata or "")  # noqa: S314
    except ET.ParseError:
        return []
    return [e for e in root.iter() if e.tag.endswith("}" + name)]


def _ome_pixels(file: tifffile.TiffFile, series: tifffile.TiffPageSeries) -> Element | None:
    """The element Pixels of OME's description that belongs to one of the images in the file."""
    every = _ome_elements(file, "Pixels")
    number = next((n for n, each in enumerate(file.series) if each is series), 0)
    return every[number if number < len(every) else 0] if every else None


def _children(pixels: Element, name: str) -> list[Element]:
    return [e for e in pixels if e.tag.endswith("}" + name)]


def _ome_spacing(request: LoadRequest, pixels: Element) -> tuple[Vector, str] | None:
    """Every axis has a unit of its own; what one axis lacks is taken from another, with a note."""
    found = {axis: _number(pixels.get(f"PhysicalSize{axis}")) for axis in "XYZ"}
    sizes = {axis: size for axis, size in found.items() if size is not None and size > 0}
    if not sizes:
        return None
    units = {axis: _unit(pixels.get(f"PhysicalSize{axis}Unit", "µm")) for axis in sizes}
    unit = units[next(iter(sizes))]
    lengths = {axis: converted(size, units[axis], unit) for axis, size in sizes.items()}
    in_plane = lengths.get("X") or lengths.get("Y") or lengths["Z"]
    if "Z" not in lengths and int(_number(pixels.get("SizeZ")) or 1) > 1:
        request.note("OME does not say how far its slices lie apart; the distance of its columns is taken.")
    if "X" not in lengths and "Y" not in lengths:
        request.note("OME gives the distance of slices alone; pixels are taken to be as large.")
    return (lengths.get("X", in_plane), lengths.get("Y", in_plane), lengths.get("Z", in_plane)), unit


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
        unit = seconds_per(plane.get("DeltaTUnit", "s"))
        at = plane.get("TheT", "")
        if plane.get("TheC") == plane.get("TheZ") == "0" and at.isdigit() and time is not None and unit:
            first[int(at)] = time * unit
    if sorted(first) == list(range(count)):
        return [first[index] for index in range(count)]
    step = _number(pixels.get("TimeIncrement"))
    unit = seconds_per(pixels.get("TimeIncrementUnit", "s"))
    return [step * unit * index for index in range(count)] if step and unit else None


def _number(value: Any) -> float | None:
    """A finite number, None for anything else."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        return None
    return number if math.isfinite(number) else None
