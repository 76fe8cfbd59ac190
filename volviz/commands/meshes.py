"""Commands that make meshes: ``isosurface`` and ``crosscheck``."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from volviz.commands.inputs import add_input, load_input
from volviz.errors import InputError


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
        "-o", "--output", required=True, metavar="FILE", help=".stl, .ply, .obj, .vtp, .gltf"
    )
    isosurface.set_defaults(run=run_isosurface)

    crosscheck = commands.add_parser(
        "crosscheck", help="our mesh against VTK's",
        description="Compares our marching cubes with vtkMarchingCubes and vtkFlyingEdges3D, with times.",
    )  # fmt: skip
    add_input(crosscheck)
    crosscheck.add_argument(
        "--isovalue", type=float, required=True, help="value of the surface, in data units"
    )
    crosscheck.set_defaults(run=run_crosscheck)


def run_isosurface(options: argparse.Namespace) -> int:
    """Extract, filter and write a mesh."""
    from volviz.mesh import extract_isosurface, mesh_area_volume, save_mesh

    output = Path(options.output).expanduser()
    if not output.absolute().parent.is_dir():
        raise InputError(f"{output}: there is no folder {output.absolute().parent}; make it first.")
    volume = load_input(options)
    mesh = extract_isosurface(
        volume, options.isovalue, method=options.method, stride=options.stride, largest_part=options.largest_part,
        min_triangles=options.min_triangles, smooth=options.smooth, decimate=options.decimate,
    )  # fmt: skip
    if mesh.n_cells == 0:
        low, high = volume.range
        raise InputError(
            f"{volume.name} has no surface at {options.isovalue:g}; its values lie between {low:g} and {high:g}."
        )
    save_mesh(mesh, output)
    area, enclosed = mesh_area_volume(mesh)
    _say(f"{output}: {mesh.n_cells} triangles, {mesh.n_points} vertices, area {area:g}, volume {enclosed:g}")
    return 0


def run_crosscheck(options: argparse.Namespace) -> int:
    """Compare with VTK; the status is 1 when the meshes differ without an explanation."""
    from volviz.compare.crosscheck import crosscheck

    report = crosscheck(load_input(options), options.isovalue)
    _say(report.format())
    return 0 if report.is_explained else 1


def _say(text: str) -> None:
    print(text)
