"""``volviz bench``: frame times of techniques over volume size, window size and step."""

from __future__ import annotations

import argparse
import csv
import io
import json
import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from volviz.commands.compare import bare
from volviz.commands.drawing import parse_size, transfer_function
from volviz.commands.inputs import add_input, load_input, source_of
from volviz.commands.progress import ProgressLine
from volviz.errors import InputError, VolvizError

if TYPE_CHECKING:
    from volviz.compare.bench import BenchCase, BenchRun

SUFFIXES = (".json", ".csv")
#: A volume that fills the image and has empty parts, with the function that shows it well.
SAMPLE, PRESET = "sample:mri-head", "mri"


def add_commands(commands: Any) -> None:
    """Add ``bench``."""
    parser = commands.add_parser(
        "bench",
        help="frame times of techniques, ours and VTK's",
        description="Measures complete frames of all techniques and their counterparts in one process, in turn, "
        "for every combination of volume size, window size and step. Ctrl+C ends it and keeps what is measured.",
    )
    add_input(parser, optional=True)
    parser.add_argument("--techniques", metavar="ID,ID", help="default: all, but the oracle")
    parser.add_argument(
        "--sizes", default="64,128", metavar="N,N", help="voxels along the longest axis (64,128)"
    )
    parser.add_argument("--windows", default="400x300,800x600", metavar="WxH,WxH", help="(400x300,800x600)")
    parser.add_argument(
        "--steps", default="0.5,1", metavar="N,N", help="distance of samples in voxels (0.5,1)"
    )
    parser.add_argument("--frames", type=int, default=5, metavar="N", help="measured frames of each (5)")
    parser.add_argument("--preset", metavar="NAME", help="transfer function, see volviz presets")
    parser.add_argument("--transfer-function", metavar="FILE", help="transfer function from a file")
    parser.add_argument("-o", "--output", metavar="FILE", help="figures as .json or .csv")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Measure, print a table, write the figures; 130 when stopped before the end."""
    from volviz.compare.bench import BenchRun
    from volviz.custom_gl.registry import technique
    from volviz.model.transfer.function import TransferFunction
    from volviz.model.transfer.presets import preset_for

    output = _checked_output(options.output)
    idents = [technique(ident).id for ident in _techniques(options.techniques)]
    sizes = numbers(options.sizes, "sizes", int)
    windows = [parse_size(part) for part in options.windows.split(",")]
    steps = numbers(options.steps, "steps", float)
    if options.file is None:
        options.file = SAMPLE
        if not options.preset and not options.transfer_function:
            options.preset = PRESET
    volume = load_input(options)
    function = transfer_function(options, volume) or TransferFunction.auto(volume)
    if options.preset:
        function = preset_for(options.preset, volume)
    work = BenchRun(volume, function, idents, sizes, windows, steps, options.frames)
    stopped = False
    with ProgressLine() as line:
        try:
            line.follow(work.steps())
        except KeyboardInterrupt:
            stopped = True
    print(table(work))
    if output is not None:
        _write(output, work, command_line(options))
        print(f"{output}: {len(work.entries)} results" + (", stopped before the end" if stopped else ""))
    return 130 if stopped else 0


def table(work: BenchRun) -> str:
    """Medians, spread and ratios as text, a line for each technique in each case."""
    ratios = work.ratios()
    lines: list[str] = []
    shown: BenchCase | None = None
    for entry in work.entries:
        if entry.case != shown:
            shown = entry.case
            dims = " x ".join(map(str, entry.dimensions))
            width, height = entry.case.window
            lines += ["", f"{dims} voxels, {width} x {height} pixels, step {entry.case.step:g}"]
        low, high = entry.times.quartiles
        words = [
            f"{found.median:.2f} x {base} ({found.low:.2f} to {found.high:.2f})"
            for case, ident, base, found in ratios
            if case == entry.case and ident == entry.technique
        ]
        measured = len(entry.times.seconds)
        if measured < work.frames:
            words.append(f"{measured} of {work.frames} frames")
        times = f"{1000 * entry.times.median:9.1f} ms ({1000 * low:.1f} to {1000 * high:.1f})"
        lines.append(f"  {entry.technique:<20}{times:<34}{', '.join(words)}".rstrip())
    return "\n".join(lines[1:])


def numbers(text: str, name: str, kind: type[int | float]) -> list[Any]:
    """Numbers separated by commas."""
    try:
        return [kind(part) for part in text.split(",")]
    except ValueError:
        raise InputError(f"--{name} takes numbers separated by commas, got {text!r}.") from None


def command_line(options: argparse.Namespace) -> str:
    """The command that measures the same again; files by their names alone."""
    words = ["volviz", "bench", bare(source_of(options))]
    names = ("techniques", "sizes", "windows", "steps", "frames", "preset")
    words += [f"--{name}={getattr(options, name)}" for name in names if getattr(options, name) is not None]
    if options.transfer_function:
        words += ["--transfer-function", bare(options.transfer_function)]
    if options.output:
        words += ["-o", Path(options.output).name]
    return shlex.join(words)


def csv_text(work: BenchRun) -> str:
    """A row for each technique in each case; times in seconds."""
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(("volume", "size", "width", "height", "step", "technique", "median", "quartile_low",
                     "quartile_high", "spread", "first", "gpu_median", "frames", "ratios"))  # fmt: skip
    writer.writerows(_rows(work))
    return text.getvalue()


def _rows(work: BenchRun) -> Iterator[Sequence[Any]]:
    data = work.to_dict()
    for result in data["results"]:
        ratios = [
            f"{r['median']:.4g} {r['base']}"
            for r in data["ratios"]
            if all(r[key] == result[key] for key in ("size", "window", "step", "technique"))
        ]
        cells = [
            result[key]
            for key in ("median", "quartile_low", "quartile_high", "spread", "first", "gpu_median")
        ]
        yield (
            data["volume"], result["size"], *result["window"], result["step"], result["technique"],
            *("" if cell is None else cell for cell in cells), len(result["frames"]), "; ".join(ratios),
        )  # fmt: skip


def _techniques(text: str | None) -> list[str]:
    from volviz.custom_gl.registry import techniques

    if text is not None:
        return [part.strip() for part in text.split(",") if part.strip()]
    return [ident for ident, info in techniques().items() if not info.is_oracle]


def _checked_output(text: str | None) -> Path | None:
    if text is None:
        return None
    output = Path(text).expanduser()
    if output.suffix.lower() not in SUFFIXES:
        raise InputError(f"{text}: figures of a benchmark are written to .json or .csv.")
    if not output.absolute().parent.is_dir():
        raise InputError(f"{text}: there is no folder {output.parent}; make it first.")
    return output


def _write(output: Path, work: BenchRun, command: str) -> None:
    is_csv = output.suffix.lower() == ".csv"
    text = (
        csv_text(work) if is_csv else json.dumps(work.to_dict(command), indent=2, ensure_ascii=False) + "\n"
    )
    try:
        output.write_text(text, encoding="utf-8", errors="backslashreplace", newline="" if is_csv else None)
    except OSError as error:
        raise VolvizError(f"{output}: the figures cannot be written ({error.strerror or error}).") from None
