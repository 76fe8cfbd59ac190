"""Isosurfaces found by VTK's ray caster (vtkGPUVolumeRayCastMapper, isosurface blend mode)."""

from __future__ import annotations

from typing import Any

from volviz.custom_gl.oracles import isosurfaces
from volviz.custom_gl.picking import Picked, Sight, surface
from volviz.custom_gl.study import sample_distances
from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.vtk_isosurface.matching import MATCHING
from volviz.custom_gl.techniques.vtk_isosurface.settings import VtkIsosurfaceSettings
from volviz.model.auto_isovalue import auto_isovalue


def _create() -> Any:
    # VTK is loaded when it is drawn with, not when techniques are listed
    from volviz.custom_gl.techniques.vtk_isosurface.technique import VtkIsosurface

    return VtkIsosurface()


def _pick(sight: Sight) -> Picked | None:
    """The surface point that is seen along a ray: where half of the light is stopped, else the nearest."""
    settings = sight.settings
    isovalues = settings.isovalues or (auto_isovalue(sight.volume),)
    opacities = [settings.opacities[min(n, len(settings.opacities) - 1)] for n in range(len(isovalues))]
    return surface(
        sight, isovalues, opacities=opacities, step=settings.step, interpolation=settings.interpolation
    )


TECHNIQUE = TechniqueInfo(
    id="vtk_isosurface",
    label="VTK: Isosurface along rays",
    summary="Isosurfaces found by VTK's ray caster (vtkGPUVolumeRayCastMapper, isosurface blend mode).",
    settings=VtkIsosurfaceSettings,
    create=_create,
    pick=_pick,
    kind="prop",
    counterpart_of=("isosurface",),
    uses_transfer_function=False,
    order=220,
    matching=MATCHING,
    study=sample_distances(),
    oracle=isosurfaces,
)
