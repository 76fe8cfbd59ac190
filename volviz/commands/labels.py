"""``volviz labels``: labels of a file as a table, with what an image has under them."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from volviz.commands.inputs import add_input, open_input, part_of
from volviz.errors import VolvizError


def add_commands(commands: Any) -> None:
    """Add the command of this file."""
    parser = commands.add_parser(
        "labels", help="voxels and volume of each label, and values of an image under it",
        description="Lists the labels of a file: number, name, voxels, volume, and of an image mean, standard "
        "deviation, minimum and maximum under each.",
    )  # fmt: skip
    add_input(parser)
    parser.add_argument("--image", metavar="FILE", help="image whose values are told under each label")
    parser.add_argument("--names", metavar="FILE", help="names: ITK-SNAP, FreeSurfer, 3D Slicer or CSV")
    parser.add_argument("-o", "--output", metavar="FILE.csv", help="write the table as CSV")
    parser.add_argument(
        "--meshes",
        metavar="FOLDER",
        help="write the surface of each label into this folder, closed, without gaps",
    )
    parser.add_argument(
        "--mesh-type", default="stl", metavar="TYPE", help="stl, ply, obj, vtp, gltf or glb (default stl)"
    )
    parser.add_argument("--overwrite", action="store_true", help="replace an existing file")
    parser.add_argument("--json", action="store_true", help="as JSON")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Print or write the table."""
    from volviz.io import load
    from volviz.io.label_files import read_label_file
    from volviz.measure.label_table import label_statistics
    from volviz.new_files import check_target, written_beside

    target = None
    if options.output is not None:
        target = check_target(Path(options.output).expanduser(), overwrite=options.overwrite)
    source = open_input(options)
    known = read_label_file(options.names) if options.names else source.labels
    names = {label.number: label.name for label in known}
    image = None if options.image is None else load(options.image)
    volume = source.read(**part_of(options))
    if options.meshes is not None:
        from volviz.meshes.label_surfaces import label_surfaces, save_label_surfaces

        written = save_label_surfaces(
            label_surfaces(volume), Path(options.meshes).expanduser(), names,
            suffix=f".{options.mesh_type.lower().lstrip('.')}", overwrite=options.overwrite,
        )  # fmt: skip
        print(f"{options.meshes}: {len(written)} meshes")
        return 0
    table = label_statistics(volume, image)
    if not len(table.labels):
        raise VolvizError(f"{source.name}: it holds no label, 0 stands for nothing.")
    if target is not None:
        with written_beside(target) as part:
            part.write_text(table.to_csv(names), encoding="utf-8")
        print(f"{target}: {len(table.labels)} labels")
    elif options.json:
        print(json.dumps([_without_nan(row) for row in table.rows(names)], indent=2, ensure_ascii=False))
    else:
        rows = [{key: _short(value) for key, value in row.items()} for row in table.rows(names)]
        widths = {key: max(len(key), *(len(row[key]) for row in rows)) for key in rows[0]}
        for cells in ({key: key for key in widths}, *rows):
            print("  ".join(f"{cells[key]:<{width}}" for key, width in widths.items()).rstrip())
    return 0


def _short(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _without_nan(row: dict[str, Any]) -> dict[str, Any]:
    """JSON knows no NaN: what is not there is null."""
    return {key: None if isinstance(v, float) and v != v else v for key, v in row.items()}  # noqa: PLR0124
