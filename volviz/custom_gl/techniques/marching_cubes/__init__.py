"""Marching cubes: the isosurface as a mesh of triangles."""

from __future__ import annotations

from volviz.custom_gl.mesh_drawing import CLASSIC, INERT
from volviz.custom_gl.oracles import isosurfaces
from volviz.custom_gl.picking import on_isovalue
from volviz.custom_gl.study import mesh_strides
from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.marching_cubes.settings import MarchingCubesSettings
from volviz.custom_gl.techniques.marching_cubes.technique import MarchingCubes

TECHNIQUE = TechniqueInfo(
    id="marching_cubes",
    label="Marching cubes",
    summary="The isosurface as a mesh of triangles, cell by cell.",
    settings=MarchingCubesSettings,
    create=MarchingCubes,
    pick=on_isovalue,
    isovalue_setting="isovalue",
    colors_surface=True,
    classic=CLASSIC,
    inert={**INERT, "method": "both give the same mesh unless a cell is ambiguous"},
    order=70,
    extraction="lorensen",
    study=mesh_strides,
    oracle=isosurfaces,
)
