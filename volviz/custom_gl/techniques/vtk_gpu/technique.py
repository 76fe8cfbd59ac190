"""VTK's ray caster on the graphics card, with nothing left to its own choice."""

from __future__ import annotations

from volviz.custom_gl.technique import Frame
from volviz.custom_gl.vtk_props.border import vtkOpenGLGPUVolumeRayCastMapper
from volviz.custom_gl.vtk_props.volumes import VolumeProp


class VtkGpu(VolumeProp):
    """`vtkGPUVolumeRayCastMapper`."""

    def __init__(self) -> None:
        mapper = vtkOpenGLGPUVolumeRayCastMapper()
        mapper.AutoAdjustSampleDistancesOff()
        mapper.LockSampleDistanceToInputSpacingOff()
        mapper.SetImageSampleDistance(1.0)
        super().__init__(mapper)

    def sample(self, frame: Frame) -> None:
        """The step, and VTK's own jitter."""
        self.mapper.SetSampleDistance(frame.step_world)
        self.mapper.SetUseJittering(frame.settings.jitter)
