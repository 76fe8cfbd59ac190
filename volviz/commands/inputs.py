"""Arguments that several commands share: which volume, and how to read it."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from volviz.errors import InputError
from volviz.volume_data.budgets import parsed_bytes, set_budgets

if TYPE_CHECKING:
    from volviz.commands.progress import ProgressLine
    from volviz.volume_data.source import VolumeSource
    from volviz.volume_data.volume import Volume


def add_input(
    parser: argparse.ArgumentParser,
    *,
    optional: bool = False,
    several_channels: bool = False,
    part: bool = True,
) -> None:
    """FILE and the hints for reading it; with several channels each may have a look."""
    parser.add_argument(
        "file", metavar="FILE", nargs="?" if optional else None,
        help="a volume file, a folder of DICOM slices, or sample:NAME",
    )  # fmt: skip
    add_hints(parser, several_channels=several_channels, part=part)


def add_hints(parser: argparse.ArgumentParser, *, several_channels: bool = False, part: bool = True) -> None:
    """The hints for reading alone; with `part` also which level and box are read."""
    hints = parser.add_argument_group("reading raw files and choosing from larger ones")
    hints.add_argument("--dims", metavar="X,Y,Z", help="voxels along each axis of a raw file")
    hints.add_argument("--dtype", help="type of raw values, for example uint16")
    hints.add_argument("--endian", choices=("little", "big"), help="byte order of raw values")
    hints.add_argument("--header", type=int, help="bytes before the first raw value")
    hints.add_argument("--spacing", metavar="X,Y,Z", help="distance of voxels, instead of the file's")
    hints.add_argument(
        "--orientation", metavar="LPS", help="where the axes of the voxels lead, instead of the file's"
    )
    hints.add_argument("--length-unit", metavar="UNIT", help="unit of lengths, instead of the file's")
    hints.add_argument("--time", type=int, help="time point, from 0")
    if several_channels:
        hints.add_argument(
            "--channel", action="append", default=[], metavar="CHANNEL[:LOOK]",
            help="channel, from 0, or its name; with a colour, colour map or preset, or more than once: channels drawn "
            "together",
        )  # fmt: skip
    else:
        hints.add_argument(
            "--channel", metavar="CHANNEL", type=number_or_name, help="channel, from 0, or its name"
        )
    if part:
        hints.add_argument(
            "--level", type=int, metavar="N",
            help="level of resolution, 0 is the finest (default: the finest that fits into memory)",
        )  # fmt: skip
        hints.add_argument(
            "--box", metavar="I0,I1,J0,J1,K0,K1",
            help="voxels of that level to read, from I0 to before I1, from J0 to before J1, from K0 to before K1",
        )  # fmt: skip
    hints.add_argument("--series", type=number_or_name, help="series of a DICOM folder or TIFF file")
    limits = parser.add_argument_group("limits for large volumes")
    limits.add_argument(
        "--memory-budget",
        metavar="SIZE",
        help="memory that a volume may take, 512MiB say (default: what is free)",
    )
    limits.add_argument(
        "--texture-budget", metavar="SIZE", help="memory of textures that a volume may take (default 2GiB)"
    )


@contextmanager
def budgets_of(options: argparse.Namespace) -> Iterator[None]:
    """Allow as much memory as the options of a command say, while it runs."""
    given = {
        name: parsed_bytes(text, f"--{name}-budget")
        for name in ("memory", "texture")
        if (text := getattr(options, f"{name}_budget", None)) is not None
    }
    before = set_budgets(**given)
    try:
        yield
    finally:
        set_budgets(memory=before.memory, texture=before.texture)


def hints_of(options: argparse.Namespace) -> dict[str, Any]:
    """The hints that were given, as keywords of `volviz.load`."""
    hints: dict[str, Any] = {}
    for name, kind in (("dims", int), ("spacing", float)):
        text = getattr(options, name)
        if text is not None:
            hints[name] = numbers(text, name, kind)
    if getattr(options, "box", None) is not None:
        hints["box"] = numbers(options.box, "box", int, 6)
    for name in (
        "orientation",
        "length_unit",
        "dtype",
        "endian",
        "header",
        "time",
        "channel",
        "level",
        "series",
    ):
        value = getattr(options, name, None)
        if value is not None:
            hints[name] = value
    return hints


def numbers(text: str, name: str, kind: type[int | float], count: int = 3) -> tuple[Any, ...]:
    """So many numbers separated by commas or x."""
    try:
        found = tuple(kind(part) for part in text.lower().replace("x", ",").split(","))
        if len(found) != count:
            raise ValueError
    except ValueError:
        words = {3: "three", 6: "six"}[count]
        example = "256,256,128" if count == 3 else "0,256,0,256,10,40"
        raise InputError(f"--{name} takes {words} numbers such as {example}, got {text!r}.") from None
    return found


def part_of(options: argparse.Namespace) -> dict[str, Any]:
    """The time point and channel that were chosen, as keywords of `volviz.save`."""
    return {
        name: getattr(options, name) for name in ("time", "channel") if getattr(options, name) is not None
    }


def open_input(options: argparse.Namespace, line: ProgressLine | None = None) -> VolumeSource:
    """The source that FILE names, with the other hints; see `part_of` for time point and channel."""
    from volviz.io import open as open_source
    from volviz.io.reader import PART

    hints = {name: hint for name, hint in hints_of(options).items() if name not in PART}
    return open_source(source_of(options), progress=None if line is None else line.show, **hints)


def load_input(options: argparse.Namespace) -> Volume:
    """The volume that FILE names, the default sample when there is none."""
    from volviz.io import load

    return load(source_of(options), **hints_of(options))


def number_or_name(text: str) -> int | str:
    """What is all digits is a number, anything else a name."""
    return int(text) if text.isascii() and text.isdigit() else text


def source_of(options: argparse.Namespace) -> str:
    """FILE, or the default sample."""
    if options.file is not None:
        return str(options.file)
    from volviz.io.samples import default_sample

    return f"sample:{default_sample().id}"
