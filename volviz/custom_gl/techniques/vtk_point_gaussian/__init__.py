"""Voxels above an isovalue as discs or Gaussians, by VTK's point mapper (vtkPointGaussianMapper)."""

from __future__ import annotations

from typing import Any

from volviz.custom_gl.oracles import isosurfaces
from volviz.custom_gl.picking import Picked, Sight, first_visible, on_isovalue
from volviz.custom_gl.study import splat_lattices
from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.vtk_point_gaussian.matching import MATCHING
from volviz.custom_gl.techniques.vtk_point_gaussian.settings import VtkPointGaussianSettings


def _create() -> Any:
    # VTK is loaded when it is drawn with, not when techniques are listed
    from volviz.custom_gl.techniques.vtk_point_gaussian.technique import VtkPointGaussian

    return VtkPointGaussian()


def _pick(sight: Sight) -> Picked | None:
    """Discs cover the surface at the isovalue; Gaussians are looked through."""
    return on_isovalue(sight) if sight.settings.footprint == "disc" else first_visible(sight)


TECHNIQUE = TechniqueInfo(
    id="vtk_point_gaussian",
    label="VTK: Point Gaussians",
    summary="Voxels above an isovalue as discs or Gaussians, by VTK's point mapper (vtkPointGaussianMapper).",
    settings=VtkPointGaussianSettings,
    create=_create,
    pick=_pick,
    isovalue_setting="isovalue",
    kind="prop",
    counterpart_of=("splatting",),
    order=250,
    matching=MATCHING,
    study=splat_lattices,
    oracle=isosurfaces,
)
