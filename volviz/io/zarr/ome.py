"""OME-Zarr's description of an image: axes, levels, channels, labels.

Source: "OME-Zarr specification" 0.4 and 0.5 (ngff.openmicroscopy.org), sections "multiscales", "omero", "image-label".
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.units import converted, length_unit, seconds_per
from volviz.volume_data.description import Channel, Label

if TYPE_CHECKING:
    from volviz.io.geometry import Geometry
    from volviz.io.reader import LoadRequest

_LETTERS = {"t": "T", "c": "C", "z": "Z", "y": "Y", "x": "X"}

#: Axes of images that do not name them (before version 0.3).
_FIVE = "TCZYX"


@dataclass(frozen=True)
class Axis:
    """One axis: its letter ("-" when nothing is known of it) and its unit as it is written in the file."""

    letter: str
    unit: str = ""


@dataclass(frozen=True)
class Placed:
    """One level: the path of its array, and scale and translation along each axis, None where nothing is said."""

    path: str
    scale: tuple[float, ...] | None
    translation: tuple[float, ...]


def axes_of(multiscale: dict[str, Any], rank: int) -> tuple[Axis, ...]:
    """The axes of an image with so many."""
    listed = multiscale.get("axes")
    if not isinstance(listed, list) or len(listed) != rank:
        return tuple(Axis(letter) for letter in _FIVE[-rank:]) if rank <= len(_FIVE) else ()
    found: list[Axis] = []
    for each in listed:
        own = each if isinstance(each, dict) else {"name": each}
        name, kind = str(own.get("name", "")).lower(), own.get("type")
        letter = _LETTERS.get(name) or {"time": "T", "channel": "C"}.get(str(kind), "-")
        if any(axis.letter == letter for axis in found):
            letter = "-"
        found.append(Axis(letter, str(own.get("unit") or "")))
    return tuple(found)


def levels_of(request: LoadRequest, multiscale: dict[str, Any], rank: int) -> list[Placed]:
    """The levels in the order of the file, the finest first.

    Raises
    ------
    LoadError
        There is none, or its numbers are unusable.
    """
    datasets = multiscale.get("datasets")
    found = []
    for dataset in datasets if isinstance(datasets, list) else ():
        if not isinstance(dataset, dict) or not isinstance(dataset.get("path"), str):
            continue
        # the transformation of a level comes first, then that of the whole image
        steps = [*_steps(request, dataset), *_steps(request, multiscale)]
        scale, translation, said = np.ones(rank), np.zeros(rank), False
        for kind, numbers in steps:
            if len(numbers) != rank:
                raise request.error(
                    f"a {kind} of level '{dataset['path']}' has {len(numbers)} numbers for {rank} axes; "
                    "the store is damaged."
                )
            if kind == "scale":
                scale, translation, said = scale * numbers, translation * numbers, True
            else:
                translation = translation + numbers
        found.append(Placed(dataset["path"], tuple(scale) if said else None, tuple(translation)))
    if not found:
        raise request.error("its metadata lists no levels; the store is damaged.")
    return found


def _steps(request: LoadRequest, owner: dict[str, Any]) -> list[tuple[str, np.ndarray[Any, Any]]]:
    found = []
    steps = owner.get("coordinateTransformations")
    for step in steps if isinstance(steps, list) else ():
        kind = step.get("type") if isinstance(step, dict) else None
        if kind == "identity":
            continue
        numbers = step.get(kind) if isinstance(step, dict) and kind in ("scale", "translation") else None
        try:
            values = np.asarray(numbers, np.float64)
        except (TypeError, ValueError):
            values = np.asarray(np.nan)
        if numbers is None or values.ndim != 1:
            request.note(
                f"Its coordinate transformation of the kind {kind!r} is not understood and left out; "
                "only scales and translations are."
            )
            continue
        if not np.all(np.isfinite(values)) or (kind == "scale" and not np.all(values)):
            raise request.error(f"a {kind} of its metadata is unusable; the store is damaged.")
        found.append((str(kind), values))
    return found


def length_of_axes(request: LoadRequest, axes: tuple[Axis, ...]) -> tuple[str, dict[str, float]]:
    """The unit of x (or of the first axis of space that has one), and what turns other units into it.

    Returns
    -------
    unit : str
    factors : dict
        By the letter of an axis of space.
    """
    units: dict[str, str] = {}
    for axis in axes:
        if axis.letter not in "XYZ":
            continue
        known = length_unit(axis.unit)
        if known is None:
            request.note(
                f"The unit {axis.unit[:40]!r} of its axis {axis.letter.lower()} is not known; "
                "its numbers stay as they are."
            )
        units[axis.letter] = known or ""
    unit = next((units[letter] for letter in "XYZ" if units.get(letter)), "")
    factors = {letter: converted(1.0, own, unit) for letter, own in units.items()}
    if unit and "" in units.values():
        bare = " and ".join(letter.lower() for letter, own in units.items() if not own)
        request.note(f"Its axis {bare} has no unit; {unit} is assumed, as along the others.")
    return unit, factors


def geometries(
    request: LoadRequest,
    axes: tuple[Axis, ...],
    levels: list[Placed],
    shapes: list[tuple[int, ...]],
    factors: dict[str, float],
) -> list[Geometry]:
    """Where the lattices lie; a level without a scale spans what the finest one does."""
    at = {axis.letter: n for n, axis in enumerate(axes)}
    found = []
    if levels[0].scale is None:
        request.note("The store does not say how large its voxels are; they are taken for cubes of side 1.")
    elif any(level.scale is None for level in levels):
        request.note("The store does not place all of its levels; those span what the finest one does.")
    for level, shape in zip(levels, shapes, strict=True):
        matrix = np.zeros((3, 4))
        for row, letter in enumerate("XYZ"):
            n = at.get(letter, -1)
            if n < 0:
                # time points or channels that are stacked: as far apart as columns
                matrix[row, row] = abs(matrix[0, 0])
                continue
            base = levels[0].scale[n] if levels[0].scale is not None else 1.0
            if level.scale is None:
                ratio = shapes[0][n] / shape[n]
                step, start = base * ratio, levels[0].translation[n] + base * (ratio - 1.0) / 2.0
            else:
                step, start = level.scale[n], level.translation[n]
            matrix[row, row], matrix[row, 3] = step * factors[letter], start * factors[letter]
        found.append(request.geometry(matrix))
    return found


def times_of(axes: tuple[Axis, ...], level: Placed, count: int) -> list[float] | None:
    """Seconds of the time points, where the file gives a step with a unit of time."""
    n = next((n for n, axis in enumerate(axes) if axis.letter == "T"), None)
    unit = None if n is None else seconds_per(axes[n].unit)
    if n is None or unit is None or level.scale is None:
        return None
    return [unit * (level.translation[n] + index * level.scale[n]) for index in range(count)]


def channels_of(attributes: dict[str, Any]) -> list[Channel]:
    """Names, colours and windows that OMERO's part of the metadata gives."""
    omero = attributes.get("omero")
    listed = omero.get("channels") if isinstance(omero, dict) else None
    return [_channel(each) for each in listed] if isinstance(listed, list) else []


def _channel(described: Any) -> Channel:
    if not isinstance(described, dict):
        return Channel()
    window = described.get("window")
    ends = (
        (_number(window.get("start")), _number(window.get("end")))
        if isinstance(window, dict)
        else (None, None)
    )
    low, high = ends
    text = described.get("color")
    color = None
    if isinstance(text, str) and len(text.lstrip("#")) in (6, 8):
        try:
            red, green, blue = bytes.fromhex(text.lstrip("#")[:6])
            color = red / 255.0, green / 255.0, blue / 255.0
        except ValueError:
            color = None
    label = described.get("label")
    return Channel(
        label if isinstance(label, str) else "",
        color,
        (low, high) if low is not None and high is not None and low < high else None,
    )


def labels_of(described: dict[str, Any]) -> list[Label]:
    """What the numbers of a label image stand for."""
    colors: dict[int, tuple[float, float, float] | None] = {}
    names: dict[int, str] = {}
    for key, take in (("colors", _take_color), ("properties", _take_name)):
        listed = described.get(key)
        for each in listed if isinstance(listed, list) else ():
            number = each.get("label-value") if isinstance(each, dict) else None
            if isinstance(number, int) and not isinstance(number, bool):
                take(each, number, colors, names)
    return [
        Label(number, names.get(number, ""), colors.get(number))
        for number in sorted(colors.keys() | names.keys())
    ]


def _take_color(each: dict[str, Any], number: int, colors: dict[int, Any], _names: dict[int, str]) -> None:
    rgba = each.get("rgba")
    numbers = [_number(v) for v in rgba[:3]] if isinstance(rgba, list) else []
    known = [v for v in numbers if v is not None]
    if len(known) == 3:
        red, green, blue = (min(max(v / 255.0, 0.0), 1.0) for v in known)
        colors[number] = red, green, blue
    else:
        colors.setdefault(number, None)


def _take_name(each: dict[str, Any], number: int, _colors: dict[int, Any], names: dict[int, str]) -> None:
    texts = {key: value for key, value in each.items() if isinstance(value, str) and value}
    chosen = next((texts[key] for key in ("name", "label", "class", "type") if key in texts), None)
    names.setdefault(number, chosen or next(iter(texts.values()), ""))


def _number(value: Any) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return None
    return float(value)
