"""Volumetric shadows by VTK's ray caster."""

from __future__ import annotations

from volviz.custom_gl.technique import Frame
from volviz.custom_gl.vtk_props.volume_props import GpuVolumeProp

#: Part of the reach of shadow rays that is left while something moves.
MOVING_REACH = 0.2


class VtkShadows(GpuVolumeProp):
    """`vtkGPUVolumeRayCastMapper` with shading, a reach of the global illumination and volumetric scattering."""

    always_lit = True
    #: A ray for every sample of every ray.
    seconds_per_pixel = 2.5e-4

    def sample(self, frame: Frame) -> None:
        """The step, and how shadow rays are cast."""
        super().sample(frame)
        # while something moves, shadows of what is near have to do
        reach = frame.settings.reach * (MOVING_REACH if frame.interactive else 1.0)
        self.mapper.SetGlobalIlluminationReach(reach)
        self.mapper.SetVolumetricScatteringBlending(frame.settings.scattering)
        self.property.SetScatteringAnisotropy(frame.settings.anisotropy)
