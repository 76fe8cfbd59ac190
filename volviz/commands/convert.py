"""``volviz convert``: a volume, or a part of it, into a file of another format."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from volviz.commands.inputs import add_input, numbers, open_input, part_of
from volviz.commands.progress import ProgressLine


def add_commands(commands: Any) -> None:
    """Add ``convert``."""
    parser = commands.add_parser(
        "convert", help="write a volume to a file of another format",
        description="Writes all of FILE, or a part of it, to OUTPUT, whose ending chooses the format: .nrrd, .nii, "
        ".nii.gz, .mha, .vti, .tif (ImageJ), .ome.tif, .ome.zarr or .npy. What the format cannot say is told.",
    )  # fmt: skip
    add_input(parser, part=False)
    parser.add_argument("output", metavar="OUTPUT", help="what is written")
    parser.add_argument(
        "--level", type=int, default=0, metavar="N", help="level of resolution, 0 is the finest"
    )
    parser.add_argument(
        "--crop", metavar="I0,I1,J0,J1,K0,K1",
        help="voxels to write along x, y and z, from I0 to before I1, from J0 to before J1, from K0 to before K1",
    )  # fmt: skip
    parser.add_argument("--resample", metavar="X,Y,Z", help="distances of voxels to resample to")
    parser.add_argument("--format", metavar="NAME", help="imagej, ome-tiff, ome-zarr, ome-zarr-0.4, where the"
                        " ending leaves a choice")  # fmt: skip
    parser.add_argument("--no-compression", action="store_true", help="do not pack the values")
    parser.add_argument("--overwrite", action="store_true", help="replace an existing file")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Write the file and tell what lies in it, and what could not be kept."""
    from volviz.io import save
    from volviz.io.writers import check_volume_target

    output = check_volume_target(
        Path(options.output).expanduser(), options.format, overwrite=options.overwrite
    )
    box = None if options.crop is None else numbers(options.crop, "crop", int, 6)
    spacing = None if options.resample is None else numbers(options.resample, "resample", float)
    with ProgressLine() as line:
        source = open_input(options, line)
        notes = save(
            source, output, level=options.level, **part_of(options), box=box, spacing=spacing,
            format=options.format, compress=not options.no_compression, overwrite=options.overwrite,
            progress=line.show, cancel=lambda: line.is_stopping,
        )  # fmt: skip
    print(f"{output}: {_bytes_of(output) / 1e6:.3g} MB")
    for note in (*source.metadata.get("notes", ()), *notes):
        print(f"note: {note}")
    return 0


def _bytes_of(path: Path) -> int:
    if path.is_dir():
        return sum(each.stat().st_size for each in path.rglob("*") if each.is_file())
    return path.stat().st_size
