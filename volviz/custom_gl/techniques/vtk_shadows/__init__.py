"""VTK's GPU ray caster with a shadow ray from every sample (global illumination reach)."""

from __future__ import annotations

from typing import Any

from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.vtk_shadows.matching import MATCHING
from volviz.custom_gl.techniques.vtk_shadows.settings import VtkShadowsSettings
from volviz.custom_gl.techniques.vtk_shadows.study import study


def _create() -> Any:
    # VTK is loaded when it is drawn with, not when techniques are listed
    from volviz.custom_gl.techniques.vtk_shadows.technique import VtkShadows

    return VtkShadows()


TECHNIQUE = TechniqueInfo(
    id="vtk_shadows",
    label="VTK: Volumetric shadows",
    summary="VTK's GPU ray caster with a shadow ray from every sample (global illumination reach).",
    settings=VtkShadowsSettings,
    create=_create,
    kind="prop",
    counterpart_of=("half_angle",),
    manipulators=("light",),
    inert={"ambient": "VTK has an ambient part only while the light sits at the eye"},
    order=260,
    matching=MATCHING,
    study=study,
)
