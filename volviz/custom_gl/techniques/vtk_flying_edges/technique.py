"""The isosurface that VTK's vtkFlyingEdges3D extracts."""

from __future__ import annotations

from volviz.custom_gl.vtk_props.mesh_props import MeshProp
from volviz.custom_gl.vtk_props.vtk_imports import vtkFlyingEdges3D


class VtkFlyingEdges(MeshProp):
    """`vtkFlyingEdges3D` and VTK's polygon mapper."""

    def __init__(self) -> None:
        super().__init__(vtkFlyingEdges3D)
