"""A cut plane with a normal texture of VTK's."""

from __future__ import annotations

from typing import Any

from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.vtk_normal_map.matching import MATCHING
from volviz.custom_gl.techniques.vtk_normal_map.settings import VtkNormalMapSettings


def _create() -> Any:
    # VTK is loaded when it is drawn with, not when techniques are listed
    from volviz.custom_gl.techniques.vtk_normal_map.technique import VtkNormalMap

    return VtkNormalMap()


TECHNIQUE = TechniqueInfo(
    id="vtk_normal_map",
    label="VTK: Normal-mapped cut",
    summary="A cut plane lit by VTK with a normal texture of the data (vtkProperty::SetNormalTexture).",
    settings=VtkNormalMapSettings,
    create=_create,
    kind="prop",
    manipulators=("light", "plane"),
    inert={"flat_color": "acts with the flat colour"},
    counterpart_of=("bump_mapping",),
    order=270,
    matching=MATCHING,
)
