"""Voxels above an isovalue as discs or Gaussians, by VTK's point mapper (vtkPointGaussianMapper)."""

from __future__ import annotations

from typing import Any

from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.vtk_point_gaussian.settings import VtkPointGaussianSettings


def _create() -> Any:
    # VTK is loaded when it is drawn with, not when techniques are listed
    from volviz.custom_gl.techniques.vtk_point_gaussian.technique import VtkPointGaussian

    return VtkPointGaussian()


TECHNIQUE = TechniqueInfo(
    id="vtk_point_gaussian",
    label="VTK: Point Gaussians",
    summary="Voxels above an isovalue as discs or Gaussians, by VTK's point mapper (vtkPointGaussianMapper).",
    settings=VtkPointGaussianSettings,
    create=_create,
    kind="prop",
    counterpart_of=("splatting",),
    order=250,
)
