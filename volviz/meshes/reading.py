"""Meshes from files as plain arrays: VTK's and PyVista's readers, off the GUI thread."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz import environment
from volviz.errors import Cancelled, LoadError
from volviz.io.vtk_messages import vtk_complaints

environment.prepare()

import pyvista  # noqa: E402


class FileTriangles(NamedTuple):
    """The surface in a file.

    Attributes
    ----------
    vertices : ndarray of shape (V, 3), float64
        World positions (x, y, z), as they stand in the file.
    faces : ndarray of shape (F, 3), int64
        Vertex numbers.
    normals : ndarray of shape (V, 3), float64
        Unit vectors; those of the file, or the mean of the triangles around.
    uv : ndarray of shape (V, 2), float64, or None
        Texture coordinates of the file.
    """

    vertices: npt.NDArray[np.float64]
    faces: npt.NDArray[np.int64]
    normals: npt.NDArray[np.float64]
    uv: npt.NDArray[np.float64] | None


def read_triangles(path: str, *, cancel: Callable[[], bool] | None = None) -> FileTriangles:
    """The surface in a mesh file: STL, OBJ, PLY, VTK, VTP, VTU, GLB and whatever else PyVista reads.

    Parameters
    ----------
    path : str
        The file.
    cancel : callable, optional
        Asked between the steps; when it returns True the work ends with `Cancelled`.

    Raises
    ------
    LoadError
        There is no such file, it cannot be read, or it holds no surface.
    Cancelled
        `cancel` said so.
    """
    file = Path(path).expanduser()
    if not file.is_file():
        raise LoadError(f"there is no file {path} to take a mesh from; choose another mesh_file.")

    def check() -> None:
        if cancel is not None and cancel():
            raise Cancelled(f"reading {file.name} was cancelled.")

    try:
        with vtk_complaints() as complaints:
            data: Any = pyvista.read(file)
            check()
            surface = _surface(data)
            words = complaints.GetOutput()
    except (Cancelled, LoadError):
        raise
    except Exception:  # noqa: BLE001 - readers raise what they like; the sentence is what people need
        raise LoadError(
            f"{file.name} cannot be read as a mesh; choose an STL, OBJ, PLY or VTK file, or save it anew."
        ) from None
    if surface is None or not surface.n_cells:
        why = "is damaged or cut off" if words else "holds no surface"
        raise LoadError(f"{file.name} {why}; choose a file with triangles or polygons as mesh_file.")
    vertices = np.asarray(surface.points, np.float64)
    if not np.isfinite(vertices).all():
        raise LoadError(
            f"{file.name} has vertices that are no finite numbers; repair the mesh and choose it again."
        )
    check()
    normals = surface.point_data.active_normals
    if normals is None:
        surface = surface.compute_normals(
            cell_normals=False, split_vertices=False, auto_orient_normals=False, consistent_normals=True
        )
        vertices = np.asarray(surface.points, np.float64)
        normals = surface.point_data.active_normals
    check()
    uv = surface.active_texture_coordinates
    return FileTriangles(
        vertices,
        np.asarray(surface.regular_faces, np.int64),
        np.asarray(normals, np.float64),
        None if uv is None or uv.shape != (len(vertices), 2) else np.asarray(uv, np.float64),
    )


def _surface(data: Any) -> Any:
    """The triangles of any data set of VTK; None where there are none."""
    if isinstance(data, pyvista.MultiBlock):
        data = data.combine() if data.n_blocks else None
    if data is None or not data.n_cells:
        return None
    if isinstance(data, pyvista.ImageData | pyvista.RectilinearGrid):
        return None
    surface = (
        data if isinstance(data, pyvista.PolyData) else data.extract_surface(algorithm="dataset_surface")
    )
    # lines and points are no surface, and triangulate keeps them
    return surface.triangulate(pass_verts=False, pass_lines=False)
