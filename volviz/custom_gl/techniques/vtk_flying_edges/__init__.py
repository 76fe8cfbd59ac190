"""The isosurface as a mesh, by VTK's fastest filter (vtkFlyingEdges3D)."""

from __future__ import annotations

from typing import Any

from volviz.custom_gl.oracles import isosurfaces
from volviz.custom_gl.picking import on_isovalue
from volviz.custom_gl.study import mesh_strides
from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.vtk_props.matching import MESHES
from volviz.custom_gl.vtk_props.settings import VtkMeshSettings


def _create() -> Any:
    # VTK is loaded when it is drawn with, not when techniques are listed
    from volviz.custom_gl.techniques.vtk_flying_edges.technique import VtkFlyingEdges

    return VtkFlyingEdges()


TECHNIQUE = TechniqueInfo(
    id="vtk_flying_edges",
    label="VTK: Flying edges",
    summary="The isosurface as a mesh, by VTK's fastest filter (vtkFlyingEdges3D).",
    settings=VtkMeshSettings,
    create=_create,
    pick=on_isovalue,
    isovalue_setting="isovalue",
    colors_surface=True,
    kind="prop",
    counterpart_of=("marching_cubes", "marching_tetrahedra"),
    uses_transfer_function=False,
    order=240,
    extraction="vtkFlyingEdges3D",
    matching=MESHES,
    study=mesh_strides,
    oracle=isosurfaces,
)
