"""The command ``measure``: distances, angles, areas, profiles and volumes with their errors, as JSON or CSV."""

from __future__ import annotations

import argparse
import json
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from volviz.commands.inputs import add_hints, hints_of, load_input, numbers
from volviz.errors import InputError, LoadError

if TYPE_CHECKING:
    from volviz.measure.results import Measured
    from volviz.model.measurements import Kind, Point
    from volviz.volume_data.volume import Volume

#: What is measured by points, in words.
_BY_POINTS: dict[str, str] = {
    "distance": "distance of two points",
    "angle": "angle at the second of three points",
    "polyline": "length of a line through points",
    "polygon": "area, perimeter and statistics of a polygon",
    "ellipse": "the same of an ellipse: its middle, and two points on its outline, at the ends of its axes",
    "point": "value at a point",
    "profile": "values along a line from one point to another",
}


def add_commands(commands: Any) -> None:
    """Add the command of this file."""
    measure = commands.add_parser(
        "measure", help="distances, angles, areas, volumes, profiles, with their errors",
        description="Measures in a volume. Every number comes with the half-width of its 95 % interval.",
    )  # fmt: skip
    kinds = measure.add_subparsers(title="what is measured", metavar="WHAT", required=True)
    for kind, words in _BY_POINTS.items():
        parser = _kind(kinds, kind, words)
        parser.add_argument(
            "points", nargs="+", metavar="(X,Y,Z)",
            help="world points; brackets keep minus signs from being taken for options",
        )  # fmt: skip
        parser.add_argument("--voxels", action="store_true", help="points are voxel indices I,J,K from 0")
        parser.set_defaults(run=run_profile if kind == "profile" else run_points, kind=kind)
    isosurface = _kind(kinds, "isosurface", "volume within the surface of one value")
    isosurface.add_argument("--isovalue", type=float, required=True, help="in data units")
    isosurface.add_argument(
        "--isovalue-error", type=float, default=0.0, metavar="HALF_WIDTH", help="how well it is known"
    )
    isosurface.add_argument("--largest-part", action="store_true", help="of the largest connected part only")
    isosurface.set_defaults(run=run_isosurface)
    threshold = _kind(kinds, "threshold", "volume of the voxels between two values")
    threshold.add_argument("--low", type=float, default=-math.inf, help="lowest value, in data units")
    threshold.add_argument("--high", type=float, default=math.inf, help="highest value")
    threshold.add_argument("--crop", metavar="I0,I1,J0,J1,K0,K1", help="only this box, in voxels from 0")
    threshold.set_defaults(run=run_threshold)
    labels = _kind(kinds, "labels", "volume of every label")
    labels.set_defaults(run=run_labels)


def _kind(kinds: Any, name: str, words: str) -> argparse.ArgumentParser:
    parser: argparse.ArgumentParser = kinds.add_parser(name, help=words, description=f"Measures: {words}.")
    parser.add_argument(
        "file", metavar="FILE", help="a volume file, a folder of DICOM slices, or sample:NAME"
    )
    parser.add_argument(
        "--format", choices=("json", "csv"), help="default: by the name of the file, else JSON"
    )
    parser.add_argument(
        "-o", "--output", metavar="FILE", help="write a .json or .csv file instead of printing"
    )
    add_hints(parser)
    return parser


def run_points(options: argparse.Namespace) -> int:
    """Measure by points."""
    from volviz.measure.readings import to_csv, to_json
    from volviz.model.measurements import Measurement

    volume = load_input(options)
    kind: Kind = options.kind
    measurement = Measurement(kind, _points(options, volume), kind.capitalize())
    make = to_csv if _is_table(options) else to_json
    _write(options, make([measurement], [volume]))
    return 0


def run_profile(options: argparse.Namespace) -> int:
    """Values along a line."""
    from volviz.measure import profile
    from volviz.model.measurements import Measurement

    volume = load_input(options)
    points = Measurement("profile", _points(options, volume)).points
    found = profile(points[0], points[1], volume)
    if _is_table(options):
        _write(options, found.to_csv())
        return 0
    values = {
        "unit": found.unit, "distance": found.distance.tolist(), "points": found.points.tolist(),
        "values": {
            name: {"unit": unit, "value": _plain(value), "error": _plain(error)}
            for name, unit, value, error in zip(found.names, found.units, found.values, found.errors, strict=True)
        },
    }  # fmt: skip
    _write(options, json.dumps(values, indent=2) + "\n")
    return 0


def run_isosurface(options: argparse.Namespace) -> int:
    """Volume within an isosurface."""
    from volviz.measure import isosurface_volume

    found = isosurface_volume(
        load_input(options), options.isovalue, isovalue_error=options.isovalue_error,
        part="largest" if options.largest_part else "all",
    )  # fmt: skip
    _write_values(options, {"Volume": found})
    return 0


def run_threshold(options: argparse.Namespace) -> int:
    """Volume between two values."""
    from volviz.measure import threshold_volume

    crop = None if options.crop is None else numbers(options.crop, "crop", float, 6)
    _write_values(
        options, {"Volume": threshold_volume(load_input(options), options.low, options.high, crop=crop)}
    )
    return 0


def run_labels(options: argparse.Namespace) -> int:
    """Volume of every label."""
    import volviz.io
    from volviz.measure import label_volumes

    hints = hints_of(options)
    chosen = {name: hints.pop(name) for name in ("time", "channel") if name in hints}
    source = volviz.io.open(options.file, **hints)
    names = {label.number: label.name for label in source.labels}
    found = label_volumes(source.read(**chosen))
    _write_values(options, {f"{label} {names.get(label, '')}".strip(): each for label, each in found.items()})
    return 0


def _points(options: argparse.Namespace, volume: Volume) -> tuple[Point, ...]:
    """The points of the command line, known to a voxel."""
    from volviz.measure.results import as_point

    found = []
    for text in options.points:
        try:
            x, y, z = (float(part) for part in text.strip("()[]").split(","))
        except ValueError:
            raise InputError(f"points are written as (X,Y,Z), such as (-12.5,40,7), got {text!r}.") from None
        if options.voxels:
            x, y, z = volume.index_to_world[:3, :3] @ (x, y, z) + volume.index_to_world[:3, 3]
        found.append(as_point((x, y, z), volume, "a point"))
    return tuple(found)


def _write_values(options: argparse.Namespace, values: dict[str, Measured]) -> None:
    if _is_table(options):
        rows = [f'"{name}",{v.value:.9g},{v.error:.3g},{v.unit}' for name, v in values.items()]
        _write(options, "\n".join(["quantity,value,error (95 %),unit", *rows, ""]))
        return
    _write(options, json.dumps({name: v.to_dict() for name, v in values.items()}, indent=2) + "\n")


def _is_table(options: argparse.Namespace) -> bool:
    suffix = "" if options.output is None else Path(options.output).suffix.lower()
    if options.format is None and suffix not in ("", ".json", ".csv"):
        raise InputError(f"{options.output}: measurements are written as .json or .csv.")
    return bool((options.format or suffix[1:]) == "csv")


def _write(options: argparse.Namespace, text: str) -> None:
    if options.output is None:
        sys.stdout.write(text)
        return
    try:
        Path(options.output).expanduser().write_text(text, encoding="utf-8")
    except OSError as error:
        raise LoadError(f"{options.output} cannot be written: {error.strerror or error}.") from error


def _plain(values: Any) -> list[float | None]:
    return [None if math.isnan(value) else value for value in values.tolist()]
