"""Meshes on their way to a file: STL, PLY, OBJ, VTP, glTF, in world coordinates.

STL, PLY and glTF are written with 32-bit floats. A mesh so far from the origin that these would spoil it is moved
nearer for them, and the caller is told by how much.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz import environment
from volviz.errors import Cancelled, InputError, VolvizError

environment.prepare()

from vtkmodules.util.numpy_support import numpy_to_vtk  # noqa: E402
from vtkmodules.vtkCommonCore import vtkPoints  # noqa: E402
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet  # noqa: E402
from vtkmodules.vtkIOGeometry import vtkGLTFWriter, vtkOBJWriter, vtkSTLWriter  # noqa: E402
from vtkmodules.vtkIOPLY import vtkPLYWriter  # noqa: E402
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter  # noqa: E402

from volviz.io.vtk_writing import write_by_vtk  # noqa: E402
from volviz.new_files import check_target, written_beside  # noqa: E402

if TYPE_CHECKING:
    import pyvista

#: Endings that `save_mesh` knows, and what they are called.
FORMAT_NAMES = {
    ".stl": "STL, binary",
    ".ply": "PLY, binary",
    ".obj": "Wavefront OBJ",
    ".vtp": "VTK PolyData",
    ".gltf": "glTF, one text file",
    ".glb": "glTF, binary",
}
MESH_FORMATS = tuple(FORMAT_NAMES)

#: Relative rounding of a 32-bit float, and what of it is bearable, as a share of the size of the mesh.
RELATIVE_ROUNDING, BEARABLE = 2.0**-24, 1e-6


def save_mesh(
    mesh: pyvista.PolyData,
    path: str | Path,
    *,
    overwrite: bool = True,
    progress: Callable[[float], object] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> str:
    """Write a mesh to a file in world coordinates; the ending chooses the format.

    Parameters
    ----------
    mesh : pyvista.PolyData
        Triangles.
    path : str or Path
        Ends in .stl, .ply, .glb (binary), .obj, .vtp or .gltf (one file, its data inside).
    overwrite : bool, default: True
        Whether an existing file is replaced; an empty one always is.
    progress : callable, optional
        Called with the written fraction, 0..1, as far as VTK's writer of the format tells it.
    cancel : callable, optional
        When it returns True the work ends with `Cancelled` and without a file.

    Returns
    -------
    str
        A sentence for the user where the mesh had to be moved for a format of 32-bit floats; nearly always empty.

    Raises
    ------
    InputError
        Another ending, a mesh without triangles, or an existing file that is not to be replaced.
    VolvizError
        The file cannot be written.
    Cancelled
        `cancel` returned True.
    """
    target = check_mesh_target(path, overwrite=overwrite)
    if not mesh.n_cells:
        raise InputError(
            f"{target.name}: the mesh is empty, so nothing was written; choose another isovalue."
        )
    near, note = _near_origin(mesh, target)
    with written_beside(target) as part:
        write_by_vtk(_writer(near, part.suffix.lower()), part, progress, cancel)
        if cancel is not None and cancel():
            raise Cancelled(f"Writing {target.name} was cancelled.")
        if not part.stat().st_size:
            raise VolvizError(f"{target}: nothing could be written; check the free space.")
    return note


def check_mesh_target(path: str | Path, *, overwrite: bool = True) -> Path:
    """The path, if a mesh can be written there; asked before long work as well.

    Raises
    ------
    InputError
        An unknown ending, or an existing file that is not to be replaced.
    VolvizError
        There is no such folder, or it cannot be written to.
    """
    target = Path(path)
    if target.suffix.lower() not in MESH_FORMATS:
        raise InputError(
            f"{target.name}: a mesh is written as {', '.join(MESH_FORMATS)}; choose one of these endings."
        )
    return check_target(target, overwrite=overwrite)


def _near_origin(mesh: pyvista.PolyData, target: Path) -> tuple[pyvista.PolyData, str]:
    """The mesh as the format can hold it, and what to tell: moved where 32-bit floats would spoil it."""
    if target.suffix.lower() in (".obj", ".vtp"):
        return mesh, ""
    points = np.asarray(mesh.points)
    extent = float(np.ptp(points, axis=0).max())
    if (
        points.dtype != np.float64
        or extent == 0.0
        or np.abs(points).max() * RELATIVE_ROUNDING <= BEARABLE * extent
    ):
        return mesh, ""
    # by round numbers, which people can type
    unit = 10.0 ** math.ceil(math.log10(extent))
    shift = np.floor(points.min(axis=0) / unit) * unit
    near = mesh.copy(deep=False)
    # not by the property, which writes into the points that both share
    moved = vtkPoints()
    moved.SetData(numpy_to_vtk((points - shift).astype(np.float32), deep=True))
    near.SetPoints(moved)
    numbers = ", ".join(f"{v:.15g}" for v in shift)
    return near, (
        f"{target.name}: the format holds 32-bit floats, too coarse for positions so far from the origin; the mesh was "
        f"moved by the negative of ({numbers}). As .obj or .vtp it keeps its place."
    )


def _writer(mesh: pyvista.PolyData, ending: str) -> Any:
    """VTK's writer of a format, with the mesh as its input."""
    if ending in (".gltf", ".glb"):
        # it wants blocks of blocks, and writes binary files by their ending
        inner, outer = vtkMultiBlockDataSet(), vtkMultiBlockDataSet()
        inner.SetBlock(0, mesh)
        outer.SetBlock(0, inner)
        scene = vtkGLTFWriter()
        scene.SetInputData(outer)
        scene.SetInlineData(True)
        scene.SetSaveNormal(mesh.GetPointData().GetNormals() is not None)
        scene.SetSaveTextures(False)
        return scene
    writer: Any
    if ending == ".vtp":
        writer = vtkXMLPolyDataWriter()
        # the higher levels take several times as long for a tenth less
        writer.SetCompressionLevel(1)
    elif ending == ".obj":
        writer = vtkOBJWriter()
    else:
        writer = vtkSTLWriter() if ending == ".stl" else vtkPLYWriter()
        writer.SetFileTypeToBinary()
    writer.SetInputData(mesh)
    return writer
