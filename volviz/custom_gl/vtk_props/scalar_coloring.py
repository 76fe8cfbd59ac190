"""Values of a surface on VTK's meshes, and their colours in VTK's mapper."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.mesh_drawing.values import MATERIAL
from volviz.custom_gl.vtk_props import vtk_imports as vtk
from volviz.model.surface_values import SurfaceColors, SurfaceValues
from volviz.tasks import LatestResult, Tasks

Array = npt.NDArray[Any]


class _ColorRequest(NamedTuple):
    """Which values on which mesh; all three are compared by identity."""

    mesh: Any
    values: SurfaceValues
    lod_mesh: bool


class ScalarColoring:
    """Gives copies of meshes the values of a surface, in the background; the last copy is kept.

    Parameters
    ----------
    key : str
        Of its tasks.
    """

    def __init__(self, key: str) -> None:
        self._copy: LatestResult[_ColorRequest, Any] = LatestResult(key, cancels=False)

    def get(self, tasks: Tasks, mesh: Any, to_world: Array, values: SurfaceValues, *, lod_mesh: bool) -> Any:
        """A copy of a mesh with values as its scalars, or None while it is made.

        Parameters
        ----------
        tasks : Tasks
            Where it is made.
        mesh : vtkPolyData
            Triangles in coordinates of their own.
        to_world : ndarray of shape (4, 4)
            Takes them to the world.
        values : SurfaceValues
            Of the surface that it shows, or stands for.
        lod_mesh : bool
            Give the vertices means of what is around them; else each triangle becomes three that meet at its middle,
            where it has a value of its own.
        """
        request = _ColorRequest(mesh, values, lod_mesh)
        return self._copy.get(tasks, request, lambda _progress, _cancel: _colored(request, to_world))

    def clear(self) -> None:
        """Forget the copy."""
        self._copy.clear()


def show_colors(mapper: Any, colors: SurfaceColors) -> None:
    """Let a vtkPolyDataMapper colour by its scalars."""
    table = vtk.vtkLookupTable()
    table.SetNumberOfTableValues(len(colors.table))
    for number, color in enumerate(colors.table):
        table.SetTableValue(number, *(color / 255.0), 1.0)
    table.SetTableRange(colors.low, colors.high)
    mapper.SetLookupTable(table)
    mapper.UseLookupTableScalarRangeOn()
    mapper.SetScalarModeToUsePointData()
    mapper.SetColorModeToMapScalars()
    # values are interpolated, not their colours
    mapper.InterpolateScalarsBeforeMappingOn()
    mapper.ScalarVisibilityOn()


def set_material(look: Any) -> None:
    """Give a vtkProperty the material under which our own techniques show values."""
    ambient, diffuse, specular, exponent = MATERIAL
    look.SetAmbient(ambient)
    look.SetDiffuse(diffuse)
    look.SetSpecular(specular)
    look.SetSpecularPower(exponent)


def _colored(request: _ColorRequest, to_world: Array) -> Any:
    mesh, values = request.mesh, request.values
    points, faces, normals = _arrays(mesh)
    places = points.astype(np.float64) @ to_world[:3, :3].T + to_world[:3, 3]
    if request.lod_mesh:
        painted = vtk.vtkPolyData()
        painted.ShallowCopy(mesh)
        painted.GetPointData().SetScalars(_array(values.around(places)))
        return painted
    at_vertices, at_middles = values.at(places, faces)
    numbers = np.arange(len(points), len(points) + len(faces))
    sides = [np.stack([faces[:, i], faces[:, (i + 1) % 3], numbers], axis=1) for i in range(3)]
    painted = vtk.vtkPolyData()
    where = vtk.vtkPoints()
    where.SetData(_array(np.concatenate([points, points[faces].mean(axis=1)])))
    painted.SetPoints(where)
    cells = vtk.vtkCellArray()
    cells.SetData(3, _array(np.stack(sides, axis=1).reshape(-1)))
    painted.SetPolys(cells)
    painted.GetPointData().SetScalars(_array(np.concatenate([at_vertices, at_middles])))
    if normals is not None:
        painted.GetPointData().SetNormals(_array(np.concatenate([normals, normals[faces].mean(axis=1)])))
    return painted


def _arrays(mesh: Any) -> tuple[Array, Array, Array | None]:
    """Points (V, 3), triangles (F, 3) and normals (V, 3) of a mesh."""
    points = vtk.vtk_to_numpy(mesh.GetPoints().GetData())
    faces = vtk.vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    normals = mesh.GetPointData().GetNormals()
    return points, faces, None if normals is None else vtk.vtk_to_numpy(normals)


def _array(values: Array) -> Any:
    """An array of VTK that keeps what it holds."""
    return vtk.numpy_to_vtk(np.ascontiguousarray(values), deep=True)
