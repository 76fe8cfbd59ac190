"""The isosurface that VTK's vtkMarchingCubes extracts."""

from __future__ import annotations

from volviz.custom_gl.vtk_props.border import vtkMarchingCubes
from volviz.custom_gl.vtk_props.surfaces import SurfaceProp


class VtkMarchingCubes(SurfaceProp):
    """`vtkMarchingCubes` and VTK's polygon mapper."""

    def __init__(self) -> None:
        super().__init__(vtkMarchingCubes)
