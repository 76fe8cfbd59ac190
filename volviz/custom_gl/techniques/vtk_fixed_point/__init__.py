"""VTK's own ray caster on the processor, in fixed-point numbers (vtkFixedPointVolumeRayCastMapper)."""

from __future__ import annotations

from typing import Any

from volviz.custom_gl.study import sample_distances
from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.vtk_fixed_point.matching import MATCHING
from volviz.custom_gl.vtk_props.settings import INERT, VtkFixedPointSettings


def _create() -> Any:
    # VTK is loaded when it is drawn with, not when techniques are listed
    from volviz.custom_gl.techniques.vtk_fixed_point.technique import VtkFixedPoint

    return VtkFixedPoint()


TECHNIQUE = TechniqueInfo(
    id="vtk_fixed_point",
    label="VTK: CPU ray caster",
    summary="VTK's own ray caster on the processor, in fixed-point numbers (vtkFixedPointVolumeRayCastMapper).",
    settings=VtkFixedPointSettings,
    create=_create,
    kind="prop",
    counterpart_of=("raycast", "two_pass_raycast", "slicing"),
    inert=INERT,
    order=210,
    matching=MATCHING,
    study=sample_distances(converged="raycast"),
)
