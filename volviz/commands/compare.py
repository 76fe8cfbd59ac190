"""``volviz compare``: techniques beside one another, as a report."""

from __future__ import annotations

import argparse
import math
import shlex
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from volviz.commands.drawing import parse_size, parse_values, transfer_function
from volviz.commands.inputs import add_input, hints_of, load_input, source_of
from volviz.commands.progress import ProgressLine
from volviz.errors import InputError, VolvizError

if TYPE_CHECKING:
    from volviz.compare.results import Comparison
    from volviz.compare.run import ComparisonRun, Side
    from volviz.custom_gl.technique import TechniqueInfo
    from volviz.model.camera import Camera
    from volviz.model.render_spec import RenderSpec, View
    from volviz.volume_data.volume import Volume

#: Images of a suite are many: small ones do.
SIZE, SUITE_SIZE = "600x450", "320x240"
#: Seconds for the frame times of each side; a suite has some two hundred of them.
TIMEOUT, SUITE_TIMEOUT = 20.0, 3.0


def add_commands(commands: Any) -> None:
    """Add ``compare``."""
    parser = commands.add_parser(
        "compare",
        help="techniques beside one another, measured, as a report",
        description="Draws a volume with two or more techniques, measures how far their pictures are apart and how "
        "long they take, and writes a report: a page (.html), or the figures (.json, .csv).",
    )
    add_input(parser, optional=True)
    parser.add_argument(
        "-t", "--technique", action="append", default=[], metavar="ID[:NAME=VALUE]", dest="techniques",
        help="a technique, with settings of its own after colons; given twice or more (see volviz techniques)",
    )  # fmt: skip
    parser.add_argument("-o", "--output", required=True, metavar="FILE", help="report: .html, .json or .csv")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="values",
                        help="a setting of every technique that has it, of light, crop box or clip planes")  # fmt: skip
    parser.add_argument(
        "--isovalue", type=float, metavar="VALUE", help="of surfaces and meshes, in data units"
    )
    parser.add_argument("--preset", metavar="NAME", help="transfer function, see volviz presets")
    parser.add_argument("--transfer-function", metavar="FILE", help="transfer function from a file")
    parser.add_argument(
        "--size", metavar="WxH", help=f"in pixels (default {SIZE}; {SUITE_SIZE} with --suite)"
    )
    parser.add_argument(
        "--azimuth", type=float, default=0.0, metavar="DEG", help="turn about the upright axis"
    )
    parser.add_argument("--elevation", type=float, default=0.0, metavar="DEG", help="turn above the horizon")
    parser.add_argument("--camera", metavar="NUMBERS", help="position, focal point and view up: nine numbers")
    parser.add_argument("--view-angle", type=float, metavar="DEG", help="full vertical angle of view")
    parser.add_argument("--parallel", action="store_true", help="parallel projection")
    parser.add_argument("--background", default="black", metavar="COLOUR", help="name or #rrggbb")
    parser.add_argument(
        "--frames", type=int, default=7, metavar="N", help="measured frames of each side, 0 = none"
    )
    parser.add_argument(
        "--patience", type=float, metavar="SECONDS",
        help=f"for frame times of each side, slow ones in fewer frames ({TIMEOUT:g}; {SUITE_TIMEOUT:g} with --suite)",
    )  # fmt: skip
    parser.add_argument(
        "--convergence",
        action="store_true",
        help="also errors over step, splats or cells, with fitted slopes",
    )
    parser.add_argument(
        "--distance-limit", type=float, metavar="LENGTH",
        help="distance of the strongest colour where meshes are coloured by their distance (default: the largest)",
    )  # fmt: skip
    parser.add_argument("--unmatched", action="store_true", help="leave each technique its own defaults")
    parser.add_argument(
        "--suite", action="store_true", help="all counterparts on all bundled samples, or on FILE"
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Compare and write the report; with ``--suite`` what is finished is written even when stopped."""
    from volviz.compare.report import check_report_name, save_reports

    output = check_report_name(options.output)
    if options.frames < 0:
        raise InputError(f"--frames takes a number of frames, 0 for none, got {options.frames}.")
    if options.patience is not None and not options.patience > 0:
        raise InputError(f"--patience takes a number of seconds above 0, got {options.patience:g}.")
    if options.distance_limit is not None and not 0.0 < options.distance_limit < math.inf:
        raise InputError(f"--distance-limit takes a length above 0, got {options.distance_limit:g}.")
    if options.suite:
        return _run_suite(options, output)
    if len(options.techniques) < 2:
        raise InputError(
            "give two techniques or more, as in -t raycast -t slicing; volviz techniques lists them."
        )
    parse_size(options.size or SIZE)
    chosen = [technique_and_values(text) for text in options.techniques]
    # every mistake is found before the volume is read
    sides = sides_of(chosen, options)
    comparison = _compare(load_input(options), sides, options)
    save_reports([comparison], output)
    print(summary(comparison))
    print(f"{output}: {len(comparison.sides)} techniques, {_count(len(comparison.pairs), 'pair')}")
    return 0


def technique_and_values(text: str) -> tuple[TechniqueInfo, dict[str, Any]]:
    """A technique and its own settings from "raycast:step=0.25:shading=true"."""
    from volviz.custom_gl.registry import technique

    ident, *values = text.split(":")
    info = technique(ident.strip())
    return info, parse_values(info, values)


def sides_of(
    chosen: Sequence[tuple[TechniqueInfo, dict[str, Any]]], options: argparse.Namespace
) -> list[Side]:
    """Sides with the settings that are meant for all, the isovalue, and those of their own."""
    from volviz.compare.run import Side

    known = {p.name for info, _ in chosen for p in info.parameters} | _shared_names()
    for text in options.values:
        name, equals, _ = text.partition("=")
        if not equals:
            raise InputError(f"--set takes NAME=VALUE, got {text!r}.")
        if name.strip() not in known:
            idents = " and ".join(dict.fromkeys(info.id for info, _ in chosen))
            raise InputError(f"neither {idents} nor the light and clipping have a setting {name.strip()!r}.")
    sides = []
    for info, own in chosen:
        values = {
            k: v
            for k, v in parse_values(info, options.values, lenient=True).items()
            if k not in _shared_names()
        }
        if options.isovalue is not None:
            values |= info.isovalue_values([options.isovalue])
        shared = [name for name in own if name in _shared_names()]
        if shared:
            raise InputError(f"{shared[0]} is the same for all sides; give it by --set.")
        sides.append(Side(info.id, values | own))
    return sides


def _shared_names() -> set[str]:
    from volviz.custom_gl.settings import SharedSettings
    from volviz.model.parameters import parameters_of

    return {p.name for p in parameters_of(SharedSettings)}


def _compare(volume: Volume, sides: Sequence[Side], options: argparse.Namespace) -> Comparison:
    from volviz.compare.run import ComparisonRun

    work = ComparisonRun(
        *spec_and_view(volume, sides, options), sides, frames=options.frames, matched=not options.unmatched,
        convergence=options.convergence, command=command_line(options), patience=_patience(options),
        distance_limit=options.distance_limit,
    )  # fmt: skip
    with ProgressLine() as line:
        line.follow(work.steps())
    assert work.result is not None
    return work.result


def spec_and_view(
    volume: Volume, sides: Sequence[Side], options: argparse.Namespace, preset: str | None = None
) -> tuple[RenderSpec, View]:
    """What all sides show, and from where: transfer function, light, clipping and camera from the options."""
    from volviz.custom_gl.arguments import split_values
    from volviz.custom_gl.offscreen import background_color
    from volviz.custom_gl.registry import technique
    from volviz.model.clipping import Clipping
    from volviz.model.layers import ImageLayer
    from volviz.model.light import Light
    from volviz.model.render_spec import RenderSpec, View
    from volviz.model.transfer.function import TransferFunction
    from volviz.model.transfer.presets import preset_for

    size = parse_size(options.size or (SUITE_SIZE if options.suite else SIZE))
    function = transfer_function(options, volume)
    if function is None:
        function = preset_for(preset, volume) if preset else TransferFunction.auto(volume)
    infos = [technique(side.technique) for side in sides]
    shared = parse_values(infos[0], [v for v in options.values if v.split("=")[0].strip() in _shared_names()])
    # techniques with a light to be dragged show little under a light at the eye
    light = Light(headlight=not any("light" in info.manipulators for info in infos))
    light, clipping, _ = split_values(shared, light, Clipping())
    clipping.crop_within(volume.dimensions)
    background = background_color(options.background) or (0.0, 0.0, 0.0)
    spec = RenderSpec((ImageLayer(volume, function),), light=light, clipping=clipping)
    return spec, View(_camera(options, volume, size, function), size, background)


def _camera(options: argparse.Namespace, volume: Volume, size: tuple[int, int], function: Any) -> Camera:
    from volviz.custom_gl.framing import default_camera
    from volviz.model.camera import Camera

    if options.camera:
        try:
            numbers = [float(part) for part in options.camera.split(",")]
            camera = Camera.coerce([numbers[:3], numbers[3:6], numbers[6:]])
        except ValueError:
            raise InputError(
                f"--camera takes nine numbers (position, focal point, view up), got {options.camera!r}."
            ) from None
    else:
        camera = default_camera(volume, size, options.azimuth, options.elevation, function)
    if options.view_angle is not None:
        camera = replace(camera, view_angle=options.view_angle)
    return replace(camera, parallel=options.parallel)


def command_line(options: argparse.Namespace) -> str:
    """The command that makes the report again; files by their names alone, since folders are nobody's business."""
    words = ["volviz", "compare"]
    if options.file is not None or not options.suite:
        words.append(bare(source_of(options)))
    for text in options.techniques:
        words += ["-t", ":".join(_bare_setting(part) for part in text.split(":"))]
    for text in options.values:
        words += ["--set", _bare_setting(text)]
    for name in ("isovalue", "preset", "size", "camera", "view_angle", "patience", "distance_limit"):
        value = getattr(options, name)
        if value is not None:
            words.append(f"--{name.replace('_', '-')}={value}")
    if options.transfer_function:
        words += ["--transfer-function", bare(options.transfer_function)]
    for name, usual in (("azimuth", 0.0), ("elevation", 0.0), ("background", "black"), ("frames", 7)):
        value = getattr(options, name)
        if value != usual:
            words.append(f"--{name}={value:g}" if isinstance(value, float) else f"--{name}={value}")
    words += [
        f"--{name}" for name in ("parallel", "convergence", "unmatched", "suite") if getattr(options, name)
    ]
    for name, hint in hints_of(options).items():
        words += [f"--{name}", ",".join(map(str, hint)) if isinstance(hint, tuple) else str(hint)]
    return shlex.join([*words, "-o", Path(options.output).name])


def _bare_setting(text: str) -> str:
    """NAME=VALUE with a file by its name alone."""
    from volviz.custom_gl.registry import techniques

    name, equals, value = text.partition("=")
    paths = {p.name for info in techniques().values() for p in info.parameters if p.kind == "path"}
    return name + equals + (bare(value) if name.strip() in paths and value else value)


def bare(source: str) -> str:
    """A file's name without its folder; samples as they are."""
    return source if source.startswith("sample:") else Path(source).name


def summary(comparison: Comparison) -> str:
    """A line for each pair, for the terminal."""
    lines = []
    for pair in comparison.pairs:
        m = pair.metrics
        line = (
            f"{pair.first} against {pair.second}: PSNR {m.psnr:.1f} dB, SSIM {m.ssim:.4f}, difference mean "
            f"{m.mean_difference:.2f}, largest {m.max_difference:.0f} of 255"
        )
        if pair.distance is not None:
            line += f", Hausdorff distance {pair.distance.hausdorff:.3g}"
        lines.append(line)
    for side in comparison.sides:
        if side.times is not None:
            low, high = side.times.quartiles
            lines.append(
                f"{side.name}: {1000 * side.times.median:.1f} ms a frame ({1000 * low:.1f} to {1000 * high:.1f})"
            )
    lines += [f"{c.name}: order of convergence {c.slope:.2f}" for c in comparison.convergence]
    lines += comparison.without_curve
    return "\n".join(lines)


def _patience(options: argparse.Namespace) -> float:
    given: float | None = options.patience
    return given if given is not None else SUITE_TIMEOUT if options.suite else TIMEOUT


def _run_suite(options: argparse.Namespace, output: Path) -> int:
    from volviz.compare.report import save_reports
    from volviz.compare.suite import suite_groups, suite_volumes

    if options.techniques:
        raise InputError("--suite chooses the techniques itself; leave -t out.")
    if options.distance_limit is not None:
        raise InputError("--suite draws no meshes in the colours of distances; leave --distance-limit out.")
    volumes = [lambda: (load_input(options), None)] if options.file is not None else suite_volumes()
    groups = suite_groups()
    finished: list[Comparison] = []
    stopped, failed, total = False, None, len(volumes) * len(groups)
    notes: list[str] = []
    with ProgressLine() as line:
        try:
            for number, loaded in enumerate(volumes):
                volume, preset = loaded()
                for place, group in enumerate(groups, number * len(groups)):
                    sides = sides_of([(info, {}) for info in group], options)
                    try:
                        work = _suite_entry(volume, preset, sides, options)
                        line.follow(
                            ((place + fraction) / total, f"{volume.name}: {words}")
                            for fraction, words in work.steps()
                        )
                    except VolvizError as error:
                        # what one group cannot show must not cost the figures of the others
                        line.clear()
                        print(f"volviz: {volume.name}, {group[0].id}: {error}", file=sys.stderr)
                        failed = error
                        notes.append(f"{volume.name}: {group[0].id} could not be compared: {error}")
                        continue
                    assert work.result is not None
                    finished.append(work.result)
                    line.clear()
                    print(f"{volume.name}\n{summary(work.result)}", flush=True)
        except KeyboardInterrupt:
            stopped = True
            if not finished:
                raise
    if not finished and failed is not None:
        raise failed
    if stopped:
        notes.append(f"Stopped before the end: {len(finished)} of {total} comparisons are here.")
    save_reports(finished, output, notes)
    print(
        f"{output}: {_count(len(finished), 'comparison')}"
        + (f" of {total}, stopped before the end" if stopped else "")
    )
    return 130 if stopped else 0


def _count(number: int, thing: str) -> str:
    return f"{number} {thing}" + ("" if number == 1 else "s")


def _suite_entry(
    volume: Volume, preset: str | None, sides: Sequence[Side], options: argparse.Namespace
) -> ComparisonRun:
    from volviz.compare.run import ComparisonRun

    return ComparisonRun(
        *spec_and_view(volume, sides, options, preset), sides, frames=options.frames, matched=not options.unmatched,
        convergence=options.convergence, command=command_line(options), patience=_patience(options),
        surface_images=False,
    )  # fmt: skip
