"""Commands that make meshes: ``isosurface`` and ``crosscheck``."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from volviz.commands.inputs import add_input, load_input, open_input, part_of, source_of
from volviz.errors import InputError, VolvizError


def add_commands(commands: Any) -> None:
    """Add the commands of this file."""
    isosurface = commands.add_parser(
        "isosurface", help="extract a surface into a mesh file",
        description="Extracts the surface of one value by marching cubes or tetrahedra, in world coordinates.",
    )  # fmt: skip
    add_input(isosurface)
    isosurface.add_argument(
        "--isovalue", type=float, required=True, help="value of the surface, in data units"
    )
    isosurface.add_argument("--method", choices=("lorensen", "topological", "tetrahedra"), default="lorensen")
    isosurface.add_argument("--stride", type=int, default=1, metavar="VOXELS", help="take every n-th voxel")
    isosurface.add_argument(
        "--largest-part", action="store_true", help="keep the largest connected part only"
    )
    isosurface.add_argument(
        "--min-triangles", type=int, default=0, metavar="N", help="drop parts with fewer triangles"
    )
    isosurface.add_argument("--smooth", type=int, default=0, metavar="N", help="smoothing iterations")
    isosurface.add_argument(
        "--decimate", type=float, default=0.0, metavar="SHARE", help="triangles to remove, 0..1"
    )
    isosurface.add_argument(
        "-o", "--output", required=True, metavar="FILE", help=".stl, .ply, .obj, .vtp, .gltf, .glb"
    )
    isosurface.add_argument(
        "--blocks", type=int, metavar="VOXELS",
        help="read and extract block by block, 256 say: for volumes larger than memory; the mesh is the same",
    )  # fmt: skip
    isosurface.add_argument("--overwrite", action="store_true", help="replace an existing file")
    isosurface.set_defaults(run=run_isosurface)

    crosscheck = commands.add_parser(
        "crosscheck", help="our mesh against VTK's",
        description="Compares our marching cubes with vtkMarchingCubes and vtkFlyingEdges3D, with times.",
    )  # fmt: skip
    add_input(crosscheck)
    crosscheck.add_argument(
        "--isovalue", type=float, required=True, help="value of the surface, in data units"
    )
    crosscheck.add_argument("--method", choices=("lorensen", "topological", "tetrahedra"), default="lorensen")
    crosscheck.add_argument("--json", metavar="FILE", help="write the report as JSON as well")
    crosscheck.set_defaults(run=run_crosscheck)


def run_isosurface(options: argparse.Namespace) -> int:
    """Extract, filter and write a mesh."""
    from volviz.meshes.files import check_mesh_target, save_mesh
    from volviz.meshes.polydata import extract_isosurface, mesh_area_volume

    output = check_mesh_target(Path(options.output).expanduser(), overwrite=options.overwrite)
    progress = Progress(output.name)
    if options.blocks is not None:
        mesh = _by_blocks(options, progress.part(0.0, 0.8))
        if mesh.n_cells == 0:
            raise InputError(f"{source_of(options)} has no surface at {options.isovalue:g}.")
    else:
        volume = load_input(options)
        mesh = extract_isosurface(
            volume, options.isovalue, method=options.method, stride=options.stride,
            largest_part=options.largest_part, min_triangles=options.min_triangles, smooth=options.smooth,
            decimate=options.decimate, progress=progress.part(0.0, 0.8),
        )  # fmt: skip
        if mesh.n_cells == 0:
            low, high = volume.range
            raise InputError(
                f"{volume.name} has no surface at {options.isovalue:g}; its values lie between {low:g} and {high:g}."
            )
    note = save_mesh(mesh, output, overwrite=options.overwrite, progress=progress.part(0.8, 1.0))
    progress.end()
    if note:
        print(note, file=sys.stderr)
    area, enclosed = mesh_area_volume(mesh)
    _say(f"{output}: {mesh.n_cells} triangles, {mesh.n_points} vertices, area {area:g}, volume {enclosed:g}")
    return 0


def _by_blocks(options: argparse.Namespace, progress: Callable[[float], None]) -> Any:
    """The mesh of a volume that need not fit into memory."""
    from volviz.kernels.marching import keep_components
    from volviz.meshes.blocks import isosurface_by_blocks
    from volviz.meshes.polydata import polydata

    given = {
        "--stride": options.stride != 1, "--smooth": options.smooth, "--decimate": options.decimate,
        "--box": options.box is not None,
    }  # fmt: skip
    for name, value in given.items():
        if value:
            raise InputError(f"--blocks goes without {name}; leave out one of them.")
    vertices, faces, normals = isosurface_by_blocks(
        open_input(options), options.isovalue, options.method, block=options.blocks, level=options.level or 0,
        **part_of(options), progress=progress,
    )  # fmt: skip
    if len(faces) and (options.largest_part or options.min_triangles):
        vertices, faces, normals = keep_components(
            vertices, faces, normals, largest_only=options.largest_part, min_triangles=options.min_triangles
        )
    mesh = polydata(vertices, faces, normals)
    mesh.field_data["isovalue"] = [float(options.isovalue)]
    return mesh


def run_crosscheck(options: argparse.Namespace) -> int:
    """Compare with VTK; the status is 1 when the meshes differ without an explanation."""
    from volviz.compare.crosscheck import crosscheck

    progress = Progress("cross-check")
    report = crosscheck(
        load_input(options), options.isovalue, options.method, progress=progress.part(0.0, 1.0)
    )
    progress.end()
    _say(report.format())
    if options.json:
        target = Path(options.json).expanduser()
        try:
            target.write_text(json.dumps(report.to_dict(), indent=1), encoding="utf-8")
        except OSError as error:
            raise VolvizError(f"{target}: the report cannot be written ({error.strerror}).") from None
    return 0 if report.is_explained else 1


class Progress:
    """How far a command is, on one line of a terminal that nobody reads by a program.

    Parameters
    ----------
    what : str
        What is being made.
    """

    def __init__(self, what: str) -> None:
        self._what = what
        self._shown = -1
        self._seen = sys.stderr.isatty()

    def part(self, begin: float, end: float) -> Callable[[float], None]:
        """Progress of a part of the work, for whoever does it."""
        return lambda fraction: self._show(begin + (end - begin) * fraction)

    def _show(self, fraction: float) -> None:
        percent = round(100 * fraction)
        if self._seen and percent != self._shown:
            self._shown = percent
            print(f"\r{self._what}: {percent:3d} %", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        """Take the line away."""
        if self._seen and self._shown >= 0:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def _say(text: str) -> None:
    print(text)
