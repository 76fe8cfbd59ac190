"""Marching tetrahedra: the isosurface as a mesh of triangles, each cell cut into six tetrahedra."""

from __future__ import annotations

from volviz.custom_gl.mesh_drawing import CLASSIC, INERT
from volviz.custom_gl.oracles import isosurfaces
from volviz.custom_gl.picking import on_isovalue
from volviz.custom_gl.study import mesh_strides
from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.marching_tetrahedra.settings import MarchingTetrahedraSettings
from volviz.custom_gl.techniques.marching_tetrahedra.technique import MarchingTetrahedra

TECHNIQUE = TechniqueInfo(
    id="marching_tetrahedra",
    label="Marching tetrahedra",
    summary="The isosurface as a mesh of triangles, each cell cut into six tetrahedra.",
    settings=MarchingTetrahedraSettings,
    create=MarchingTetrahedra,
    pick=on_isovalue,
    isovalue_setting="isovalue",
    colors_surface=True,
    classic=CLASSIC,
    inert=INERT,
    order=75,
    extraction="tetrahedra",
    study=mesh_strides,
    oracle=isosurfaces,
)
