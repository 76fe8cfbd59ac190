"""VTK's ray caster on the graphics card, to compare with."""

from __future__ import annotations

from typing import Any

from volviz.custom_gl.study import sample_distances
from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.vtk_gpu.matching import MATCHING
from volviz.custom_gl.vtk_props.settings import INERT, VtkGpuSettings


def _create() -> Any:
    # VTK is loaded when it is drawn with, not when techniques are listed
    from volviz.custom_gl.techniques.vtk_gpu.technique import VtkGpu

    return VtkGpu()


TECHNIQUE = TechniqueInfo(
    id="vtk_gpu",
    label="VTK: GPU ray caster",
    summary="VTK's own ray caster on the graphics card (vtkGPUVolumeRayCastMapper).",
    settings=VtkGpuSettings,
    create=_create,
    kind="prop",
    counterpart_of=("raycast", "two_pass_raycast", "slicing"),
    inert=INERT,
    order=200,
    matching=MATCHING,
    study=sample_distances(beside="raycast"),
)
