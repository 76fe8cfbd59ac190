"""Volumetric shadows by VTK's ray caster."""

from __future__ import annotations

from volviz.custom_gl.technique import Frame
from volviz.custom_gl.vtk_props.volumes import GpuVolumeProp


class VtkShadows(GpuVolumeProp):
    """`vtkGPUVolumeRayCastMapper` with shading, a reach of the global illumination and volumetric scattering."""

    always_lit = True

    def sample(self, frame: Frame) -> None:
        """The step, and how shadow rays are cast."""
        super().sample(frame)
        self.mapper.SetGlobalIlluminationReach(frame.settings.reach)
        self.mapper.SetVolumetricScatteringBlending(frame.settings.scattering)
        self.property.SetScatteringAnisotropy(frame.settings.anisotropy)
