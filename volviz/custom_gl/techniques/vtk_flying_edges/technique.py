"""The isosurface that VTK's vtkFlyingEdges3D extracts."""

from __future__ import annotations

from volviz.custom_gl.vtk_props.border import vtkFlyingEdges3D
from volviz.custom_gl.vtk_props.surfaces import SurfaceProp


class VtkFlyingEdges(SurfaceProp):
    """`vtkFlyingEdges3D` and VTK's polygon mapper."""

    def __init__(self) -> None:
        super().__init__(vtkFlyingEdges3D)
