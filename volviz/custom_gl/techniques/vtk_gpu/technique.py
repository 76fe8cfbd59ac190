"""VTK's ray caster on the graphics card."""

from __future__ import annotations

from volviz.custom_gl.vtk_props.volume_props import GpuVolumeProp


class VtkGpu(GpuVolumeProp):
    """`vtkGPUVolumeRayCastMapper` with the transfer function."""
