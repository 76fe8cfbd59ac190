"""The isosurface as a mesh, by VTK's classic filter (vtkMarchingCubes)."""

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
    from volviz.custom_gl.techniques.vtk_marching_cubes.technique import VtkMarchingCubes

    return VtkMarchingCubes()


TECHNIQUE = TechniqueInfo(
    id="vtk_marching_cubes",
    label="VTK: Marching cubes",
    summary="The isosurface as a mesh, by VTK's classic filter (vtkMarchingCubes).",
    settings=VtkMeshSettings,
    create=_create,
    pick=on_isovalue,
    isovalue_setting="isovalue",
    colors_surface=True,
    kind="prop",
    counterpart_of=("marching_cubes", "marching_tetrahedra"),
    uses_transfer_function=False,
    order=230,
    extraction="vtkMarchingCubes",
    matching=MESHES,
    study=mesh_strides,
    oracle=isosurfaces,
)
