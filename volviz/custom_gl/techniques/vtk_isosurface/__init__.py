"""Isosurfaces found by VTK's ray caster (vtkGPUVolumeRayCastMapper, isosurface blend mode)."""

from __future__ import annotations

from typing import Any

from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.vtk_isosurface.settings import VtkIsosurfaceSettings


def _create() -> Any:
    # VTK is loaded when it is drawn with, not when techniques are listed
    from volviz.custom_gl.techniques.vtk_isosurface.technique import VtkIsosurface

    return VtkIsosurface()


TECHNIQUE = TechniqueInfo(
    id="vtk_isosurface",
    label="VTK: Isosurface along rays",
    summary="Isosurfaces found by VTK's ray caster (vtkGPUVolumeRayCastMapper, isosurface blend mode).",
    settings=VtkIsosurfaceSettings,
    create=_create,
    kind="prop",
    counterpart_of=("isosurface",),
    uses_transfer_function=False,
    order=220,
)
