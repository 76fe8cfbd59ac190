"""Isosurfaces found by VTK's ray caster (vtkGPUVolumeRayCastMapper, isosurface blend mode)."""

from __future__ import annotations

from typing import Any

from volviz.custom_gl.oracles import isosurfaces
from volviz.custom_gl.picking import Picked, Sight, surface
from volviz.custom_gl.study import sample_distances
from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.vtk_isosurface.matching import MATCHING
from volviz.custom_gl.techniques.vtk_isosurface.settings import VtkIsosurfaceSettings


def _create() -> Any:
    # VTK is loaded when it is drawn with, not when techniques are listed
    from volviz.custom_gl.techniques.vtk_isosurface.technique import VtkIsosurface

    return VtkIsosurface()


def _pick(sight: Sight) -> Picked | None:
    """The surface point that is seen along a ray: where half of the light is stopped, else the nearest."""
    settings = sight.settings
    count = len(sight.isovalues)
    opacities = [settings.opacities[min(n, len(settings.opacities) - 1)] for n in range(count)]
    return surface(
        sight, sight.isovalues, opacities=opacities, step=settings.step, interpolation=settings.interpolation
    )


TECHNIQUE = TechniqueInfo(
    id="vtk_isosurface",
    label="VTK: Isosurface along rays",
    summary="Isosurfaces found by VTK's ray caster (vtkGPUVolumeRayCastMapper, isosurface blend mode).",
    settings=VtkIsosurfaceSettings,
    create=_create,
    pick=_pick,
    isovalue_setting="isovalues",
    kind="prop",
    counterpart_of=("isosurface",),
    uses_transfer_function=False,
    order=220,
    matching=MATCHING,
    study=sample_distances(),
    oracle=isosurfaces,
)
