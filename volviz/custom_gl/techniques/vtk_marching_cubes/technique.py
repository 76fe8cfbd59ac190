"""The isosurface that VTK's vtkMarchingCubes extracts."""

from __future__ import annotations

from volviz.custom_gl.vtk_props.mesh_props import MeshProp
from volviz.custom_gl.vtk_props.vtk_imports import vtkMarchingCubes


class VtkMarchingCubes(MeshProp):
    """`vtkMarchingCubes` and VTK's polygon mapper."""

    def __init__(self) -> None:
        super().__init__(vtkMarchingCubes)
