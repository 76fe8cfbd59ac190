"""VTK's ray caster on the processor."""

from __future__ import annotations

from volviz.custom_gl.technique import Frame
from volviz.custom_gl.vtk_props.volume_props import VolumeProp
from volviz.custom_gl.vtk_props.vtk_imports import vtkFixedPointVolumeRayCastMapper


class VtkFixedPoint(VolumeProp):
    """`vtkFixedPointVolumeRayCastMapper`, a ray for each pixel."""

    #: It computes the whole image and then shows it as one texture.
    by_tiles = False

    def __init__(self) -> None:
        mapper = vtkFixedPointVolumeRayCastMapper()
        mapper.AutoAdjustSampleDistancesOff()
        mapper.LockSampleDistanceToInputSpacingOff()
        for set_pixels in (
            mapper.SetImageSampleDistance,
            mapper.SetMinimumImageSampleDistance,
            mapper.SetMaximumImageSampleDistance,
        ):
            set_pixels(1.0)
        super().__init__(mapper)

    def sample(self, frame: Frame) -> None:
        """The step, also where VTK thinks that something moves."""
        self.mapper.SetSampleDistance(frame.step_world)
        self.mapper.SetInteractiveSampleDistance(frame.step_world)
        # also without meshes: else the image is put at the depth of the volume's middle, and is lost with the
        # middle behind the eye
        self.mapper.IntermixIntersectingGeometryOn()
