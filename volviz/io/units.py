"""Units of length and time as files name them, and how they are written here."""

from __future__ import annotations

#: Metres in a unit that is shown as it is.
_METRES = {
    "pm": 1e-12, "Å": 1e-10, "nm": 1e-9, "µm": 1e-6, "mm": 1e-3, "cm": 1e-2, "m": 1.0, "km": 1e3,
    "in": 0.0254, "ft": 0.3048,
}  # fmt: skip

_LENGTHS = {
    "pm": "picometer picometre",
    "Å": "angstrom angstroms \u212b",
    "nm": "nanometer nanometre nanometers nanometres",
    "µm": "micrometer micrometre micrometers micrometres micron microns um \u03bcm",
    "mm": "millimeter millimetre millimeters millimetres",
    "cm": "centimeter centimetre centimeters centimetres",
    "m": "meter metre meters metres",
    "km": "kilometer kilometre",
    "in": "inch inches",
    "ft": "foot feet",
}
_LENGTH_NAMES = {name: unit for unit, names in _LENGTHS.items() for name in (unit.lower(), *names.split())}

#: What stands for "no unit".
_NONE = ("", "pixel", "pixels", "px", "voxel", "voxels", "reference frame", "null", "none")

_SECONDS = {
    **dict.fromkeys(("s", "sec", "second", "seconds"), 1.0),
    **dict.fromkeys(("ms", "millisecond", "milliseconds"), 1e-3),
    **dict.fromkeys(("us", "µs", "\u03bcs", "microsecond", "microseconds"), 1e-6),
    **dict.fromkeys(("ns", "nanosecond", "nanoseconds"), 1e-9),
    **dict.fromkeys(("min", "minute", "minutes"), 60.0),
    **dict.fromkeys(("h", "hr", "hour", "hours"), 3600.0),
    **dict.fromkeys(("d", "day", "days"), 86400.0),
}


def length_unit(text: object) -> str | None:
    """A unit of length as it is written here ("µm" for "micrometer"), empty for pixels, None for an unknown one."""
    name = ("" if text is None else str(text)).strip()
    if name.lower() in _NONE:
        return ""
    return _LENGTH_NAMES.get(name.lower())


def seconds_per(text: object) -> float | None:
    """Seconds in a unit of time, None for an unknown one."""
    return _SECONDS.get(("" if text is None else str(text)).strip().lower())


def converted(length: float, unit: str, into: str) -> float:
    """A length in another unit; as it is where one of the two is not known."""
    if unit == into or unit not in _METRES or into not in _METRES:
        return length
    return length * (_METRES[unit] / _METRES[into])
