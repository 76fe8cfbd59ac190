"""Meshes on their way to a file: STL, PLY, OBJ, VTP, glTF, always in world coordinates."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from volviz import environment
from volviz.errors import Cancelled, InputError, VolvizError

environment.prepare()

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


def save_mesh(
    mesh: pyvista.PolyData,
    path: str | Path,
    *,
    overwrite: bool = True,
    progress: Callable[[float], object] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> None:
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
    with written_beside(target) as part:
        write_by_vtk(_writer(mesh, part.suffix.lower()), part, progress, cancel)
        if cancel is not None and cancel():
            raise Cancelled(f"Writing {target.name} was cancelled.")
        if not part.stat().st_size:
            raise VolvizError(f"{target}: nothing could be written; check the free space.")


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
