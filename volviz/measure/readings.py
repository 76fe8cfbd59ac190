"""The numbers of measurements of a scene, and tables of them."""

from __future__ import annotations

import csv
import io
import json
import math
import re
from collections.abc import Mapping, Sequence
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from volviz.errors import InputError
from volviz.measure.areas import Area, area, ellipse
from volviz.measure.lengths import angle, distance, polyline
from volviz.measure.noise import noise_of
from volviz.measure.results import Measured, length_unit
from volviz.model.measurements import COVERAGE, Measurement, Point
from volviz.reference.slices import resample
from volviz.volume_data.volume import Volume

Readings = Mapping[str, Measured]
"""From what is measured, in words, to the number; the first one is the main one."""

#: Measurements whose numbers are remembered for a volume.
MOST_KNOWN = 256
_known: WeakKeyDictionary[Volume, dict[Measurement, Readings]] = WeakKeyDictionary()


def readings(measurement: Measurement, volumes: Sequence[Volume] = ()) -> Readings:
    """What a measurement says.

    Parameters
    ----------
    measurement : Measurement
    volumes : sequence of Volume
        What is seen; the first one gives the unit of lengths.

    Returns
    -------
    mapping of str to Measured
        Empty for an arrow.

    Raises
    ------
    InputError
        Its points define nothing: they coincide, lie on one line, or sides cross.
    """
    points, first = measurement.points, volumes[0] if volumes else None
    match measurement.kind:
        case "distance" | "profile":
            return {"Distance": distance(points[0], points[1], first)}
        case "polyline":
            return {"Length": polyline(points, first)}
        case "angle":
            return {"Angle": angle(points[0], points[1], points[2], first)}
        case "polygon":
            return _of_area(area(points, volumes))
        case "ellipse":
            return _of_area(ellipse(points[0], points[1], points[2], volumes))
        case "point":
            return {
                f"Value in {volume.name}": found
                for volume in volumes
                if (found := value_at(points[0], volume)) is not None
            }
        case _:
            return {}


def words_beside(measurement: Measurement, volume: Volume) -> str:
    """What stands beside a measurement in a picture: its number, its name where somebody gave it one.

    Points and arrows have their name; a point has the value there as well.
    """
    named = not re.fullmatch(rf"{measurement.kind.capitalize()} \d+", measurement.name)
    if measurement.kind == "arrow":
        return measurement.name
    try:
        found = str(next(iter(known_readings(measurement, volume).values()), ""))
    except InputError:
        return measurement.name
    return f"{measurement.name}: {found}" if named and found else found or measurement.name


def known_readings(measurement: Measurement, volume: Volume) -> Readings:
    """`readings` in one volume, found once for as long as that volume lives."""
    known = _known.setdefault(volume, {})
    if measurement not in known:
        if len(known) >= MOST_KNOWN:
            known.clear()
        known[measurement] = readings(measurement, [volume])
    return known[measurement]


def value_at(point: Point, volume: Volume) -> Measured | None:
    """The interpolated value at a point, with the noise of the voxels around and what the place leaves open."""
    index = volume.world_to_index[:3, :3] @ np.asarray(point.position) + volume.world_to_index[:3, 3]
    value = float(resample(volume.array, index, "linear"))
    if math.isnan(value):
        return None
    middle = np.rint(index).astype(int)[::-1]
    around = volume.array[tuple(slice(max(int(m) - 6, 0), int(m) + 7) for m in middle)]
    spread = np.asarray(volume.world_to_index[:3, :3]) @ np.asarray(point.covariance)
    deviations = np.sqrt(np.maximum(np.einsum("ij,ij->i", spread, volume.world_to_index[:3, :3]), 0.0))
    ends = index + np.concatenate([np.diag(deviations), -np.diag(deviations)])
    moved = resample(volume.array, np.clip(ends, 0.0, np.asarray(volume.dimensions) - 1.0), "linear")
    away = np.nan_to_num(np.abs(moved - value)).reshape(2, 3).max(axis=0)
    return Measured(value, volume.unit, COVERAGE * math.hypot(noise_of(around), *away))


def to_dict(measurement: Measurement, volumes: Sequence[Volume] = ()) -> dict[str, Any]:
    """A measurement with its numbers as plain values, for JSON."""
    return {
        "name": measurement.name,
        "kind": measurement.kind,
        "points": [
            {"position": list(p.position), "error": p.error, "rule": p.rule, "number": p.number}
            for p in measurement.points
        ],
        "length_unit": length_unit(volumes[0] if volumes else None),
        "values": {words: found.to_dict() for words, found in readings(measurement, volumes).items()},
    }


def to_json(measurements: Sequence[Measurement], volumes: Sequence[Volume] = ()) -> str:
    """Measurements with their numbers as JSON."""
    return json.dumps([to_dict(each, volumes) for each in measurements], indent=2, allow_nan=False) + "\n"


def to_csv(measurements: Sequence[Measurement], volumes: Sequence[Volume] = ()) -> str:
    """Measurements as a table: a row for each number; what has none has one row with its points."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["name", "kind", "quantity", "value", "error (95 %)", "unit", "points (x y z)", "rules"])
    for each in measurements:
        points = "; ".join(" ".join(f"{v:.9g}" for v in point.position) for point in each.points)
        rules = "; ".join(rule_words(point) for point in each.points)
        numbers: list[list[str]] = [
            [words, f"{found.value:.9g}", f"{found.error:.3g}", found.unit]
            for words, found in readings(each, volumes).items()
        ]
        for row in numbers or [["", "", "", ""]]:
            writer.writerow([each.name, each.kind, *row, points, rules])
    return text.getvalue()


def rule_words(point: Point) -> str:
    """By which rule a point was found, with the number that tells it."""
    number = "" if point.number is None else f" {point.number:g}"
    words = {
        "isovalue": "first place of the value", "opacity": "half of the opacity, at the value", "maximum": "maximum",
        "label": "surface of label",
    }  # fmt: skip
    return words.get(point.rule, point.rule) + number


def _of_area(found: Area) -> dict[str, Measured]:
    result: dict[str, Measured] = {
        "Area": Measured(found.value, found.unit, found.error),
        "Perimeter": found.perimeter,
    }
    for each in found.statistics:
        if not each.voxels:
            continue
        unit, of = each.mean.unit, f"in {each.name}"
        doubt = COVERAGE * each.deviation / math.sqrt(2 * max(each.voxels - 1, 1))
        result |= {
            f"Mean {of}": each.mean,
            f"Standard deviation {of}": Measured(each.deviation, unit, doubt),
            f"Minimum {of}": Measured(each.minimum, unit, 0.0),
            f"Median {of}": Measured(each.median, unit, 1.2533 * each.mean.error),
            f"Maximum {of}": Measured(each.maximum, unit, 0.0),
            f"Voxels {of}": Measured(float(each.voxels), "", 0.0),
        }
    return result
