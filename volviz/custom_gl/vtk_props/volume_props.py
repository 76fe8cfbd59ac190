"""What VTK's volume mappers have in common as techniques."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from volviz.custom_gl.vtk_props import vtk_imports as vtk
from volviz.custom_gl.vtk_props.clipping import Plane, clip_planes_of, image_box, set_planes
from volviz.custom_gl.vtk_props.errors import ErrorWords
from volviz.custom_gl.vtk_props.functions import set_functions
from volviz.custom_gl.vtk_props.images import PlacedImage
from volviz.errors import RenderError

if TYPE_CHECKING:
    from volviz.custom_gl.technique import Frame

#: Clip planes that the mappers take.
MAX_PLANES = 8

_BLEND = {"composite": 0, "maximum": 1, "minimum": 2, "average": 3, "additive": 4, "isosurface": 5}


class VolumeProp:
    """A `vtkVolume` with one of VTK's mappers.

    Parameters
    ----------
    mapper : vtkVolumeMapper
        Draws it.
    """

    writes_depth = False
    within_tiles = True
    #: The host may draw it piece by piece, through a scissor box.
    by_tiles = True
    ambient_from_light = True
    seconds_per_pixel = 4e-6
    #: Lit, where the settings have no say in it.
    always_lit = False
    #: What is made of the samples, where the settings have no say in it.
    only_mode: str | None = None

    def __init__(self, mapper: Any) -> None:
        self.mapper = mapper
        self.prop = vtk.vtkVolume()
        self.property = vtk.vtkVolumeProperty()
        self.prop.SetMapper(mapper)
        self.prop.SetProperty(self.property)
        self.errors = ErrorWords(mapper, self.prop)
        self._placed: PlacedImage | None = None
        self._function: Any = None
        self._planes: list[Plane] = []

    @property
    def props(self) -> tuple[Any, ...]:
        """The volume."""
        return (self.prop,)

    def prepare(self, frame: Frame) -> bool:
        """Take the values of a frame; always ready."""
        placed = self._place(frame)
        self.classify(frame, placed)
        settings = frame.settings
        self.property.SetScalarOpacityUnitDistance(frame.unit_distance)
        self.property.SetInterpolationType(0 if settings.interpolation == "nearest" else 1)
        self.property.SetShade(self.always_lit or frame.common.shading)
        self.property.SetAmbient(settings.ambient)
        self.property.SetDiffuse(settings.diffuse)
        self.property.SetSpecular(settings.specular)
        self.property.SetSpecularPower(settings.shininess)
        self.mapper.SetBlendMode(_BLEND[self.only_mode or frame.common.mode])
        self._clip(frame, placed)
        self.sample(frame)
        return True

    def classify(self, frame: Frame, placed: PlacedImage) -> None:
        """Set colours and opacities: the transfer function."""
        if self._function is not frame.transfer_function:
            self._function = frame.transfer_function
            set_functions(self.property, placed.function(frame.transfer_function), placed.range)

    def sample(self, frame: Frame) -> None:
        """Set what is special to the mapper: where it samples."""
        raise NotImplementedError

    def check(self) -> None:
        """Raise what VTK complained about while it drew."""
        self.errors.raise_any(self.mapper.GetClassName())

    def release(self, window: Any) -> None:
        """Release what lies on the GPU; the context is current."""
        self.prop.ReleaseGraphicsResources(window)
        self.mapper.RemoveAllInputs()
        self._placed = None

    def _place(self, frame: Frame) -> PlacedImage:
        if self._placed is None or self._placed.volume is not frame.volume:
            self._placed = PlacedImage(frame.volume, for_tables=True)
            self._function = None
            self.mapper.SetInputData(self._placed.image)
            self.prop.SetUserMatrix(self._placed.matrix)
        return self._placed

    def _clip(self, frame: Frame, placed: PlacedImage) -> None:
        """Planes where they suffice: rays begin at them. The cropping region only leaves samples out."""
        planes = clip_planes_of(frame)
        cropping = len(planes) > MAX_PLANES
        self.mapper.SetCropping(cropping)
        if cropping:
            planes = list(frame.planes)
            self.mapper.SetCroppingRegionPlanes(*image_box(frame, mirrored=placed.mirrored))
            self.mapper.SetCroppingRegionFlagsToSubVolume()
        if planes != self._planes:
            # only then: VTK makes its shader anew
            set_planes(self.mapper, planes)
            self._planes = planes


class GpuVolumeProp(VolumeProp):
    """`vtkGPUVolumeRayCastMapper`, with nothing left to its own choice."""

    #: With a placed light it would add the ambient part in white, without the colour of the sample.
    ambient_from_light = False

    def __init__(self) -> None:
        mapper = vtk.vtkOpenGLGPUVolumeRayCastMapper()
        mapper.AutoAdjustSampleDistancesOff()
        mapper.LockSampleDistanceToInputSpacingOff()
        mapper.SetImageSampleDistance(1.0)
        super().__init__(mapper)

    def prepare(self, frame: Frame) -> bool:
        """Take the values of a frame.

        Raises
        ------
        RenderError
            The volume is too long for a texture; VTK would show nothing.
        """
        longest, limit = max(frame.volume.dimensions), frame.gpu.limits.max_3d_texture
        if longest > limit:
            raise RenderError(
                f"VTK's ray caster takes at most {limit} voxels along an axis with this driver, this volume has "
                f"{longest}; crop the file, or take vtk_fixed_point."
            )
        return super().prepare(frame)

    def sample(self, frame: Frame) -> None:
        """The step, and VTK's own jitter on request."""
        self.mapper.SetSampleDistance(frame.step_world)
        self.mapper.SetUseJittering(frame.common.jitter)
