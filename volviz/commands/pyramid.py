"""``volviz pyramid``: a volume of any size as OME-Zarr in several resolutions."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from volviz.commands.inputs import add_input, open_input, part_of
from volviz.commands.progress import ProgressLine
from volviz.volume_data.budgets import parsed_bytes


def add_commands(commands: Any) -> None:
    """Add ``pyramid``."""
    parser = commands.add_parser(
        "pyramid", help="write a volume as OME-Zarr in several resolutions",
        description="Writes FILE to OUTPUT (.zarr) in several resolutions, block by block, so that volumes larger than "
        "memory open at once. What was stopped or killed goes on where it was when the command is given again.",
    )  # fmt: skip
    add_input(parser, part=False)
    parser.add_argument("output", metavar="OUTPUT", help="folder that is written, .zarr or .ome.zarr")
    parser.add_argument(
        "--labels", action="store_true", default=None,
        help="values are labels: coarser voxels get the most frequent one instead of the mean",
    )  # fmt: skip
    parser.add_argument("--memory", metavar="SIZE", help="memory that blocks in work may take, 2GiB say")
    parser.add_argument("--workers", type=int, metavar="N", help="threads (default: one for each processor)")
    parser.add_argument("--overwrite", action="store_true", help="replace an existing folder")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Write the pyramid and tell what could not be kept."""
    from volviz.io.writers.streamed_pyramid import write_pyramid

    output = Path(options.output).expanduser()
    memory = None if options.memory is None else parsed_bytes(options.memory, "--memory")
    with ProgressLine() as line:
        source = open_input(options, line)
        notes = write_pyramid(
            source, output, **part_of(options), labels=options.labels, workers=options.workers, memory=memory,
            overwrite=options.overwrite, progress=line.show, cancel=lambda: line.is_stopping,
        )  # fmt: skip
    print(f"{output}: written")
    for note in (*source.metadata.get("notes", ()), *notes):
        print(f"note: {note}")
    return 0
