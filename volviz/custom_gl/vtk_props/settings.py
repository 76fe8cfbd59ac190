"""Settings of VTK's mappers: the names and meanings are those of our techniques, so that matching copies values."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.mesh_drawing import MeshSettings
from volviz.custom_gl.settings import MODES, SamplingSettings, ShadingSettings, taken_from
from volviz.model.parameters import Cost, parameter

#: Modes that VTK's ray casters know.
VTK_MODES = tuple(choice for choice in MODES if choice[0] != "attenuated_maximum")

#: Those of its ray caster on the processor.
FIXED_POINT_MODES = tuple(choice for choice in VTK_MODES if choice[0] != "average")


@dataclass(frozen=True)
class VtkShadingSettings:
    """Material of VTK's volumes; the gradient is always taken over one voxel."""

    shading: bool = taken_from(ShadingSettings, "shading")
    ambient: float = taken_from(ShadingSettings, "ambient")
    diffuse: float = taken_from(ShadingSettings, "diffuse")
    specular: float = taken_from(ShadingSettings, "specular")
    shininess: float = taken_from(ShadingSettings, "shininess")


@dataclass(frozen=True)
class VtkSamplingSettings:
    """How VTK's ray casters sample."""

    mode: str = taken_from(
        SamplingSettings,
        "mode",
        choices=VTK_MODES,
        tooltip="What is made of the samples along a ray. Average and additive are mean and sum of scalar times "
        "opacity, in grey and opaque, other than ours.",
    )
    step: float = taken_from(SamplingSettings, "step")
    opacity_unit_distance: float | None = taken_from(SamplingSettings, "opacity_unit_distance")
    interpolation: str = taken_from(SamplingSettings, "interpolation")


@dataclass(frozen=True)
class VtkGpuSettings(VtkShadingSettings, VtkSamplingSettings):
    """How VTK's ray caster on the graphics card samples and lights."""

    jitter: bool = parameter(
        False,
        "Jitter",
        "Shifts the samples of each ray by a pseudo-random fraction of a step, VTK's own noise.",
        group="Sampling",
    )


@dataclass(frozen=True)
class VtkFixedPointSettings(VtkShadingSettings, VtkSamplingSettings):
    """How VTK's ray caster on the processor samples and lights."""

    mode: str = taken_from(VtkSamplingSettings, "mode", choices=FIXED_POINT_MODES)


@dataclass(frozen=True)
class VtkMeshSettings:
    """Which surface VTK's filters extract and how its triangles look."""

    isovalue: float | None = taken_from(MeshSettings, "isovalue")
    stride: int = taken_from(MeshSettings, "stride")
    normals: str = taken_from(MeshSettings, "normals", cost=Cost.DATA)
    wireframe: bool = taken_from(MeshSettings, "wireframe", cost=Cost.VALUE)
    color: tuple[float, float, float] = taken_from(MeshSettings, "color", enabled_by=None)
    ambient: float = taken_from(MeshSettings, "ambient", enabled_by=None)
    diffuse: float = taken_from(MeshSettings, "diffuse", enabled_by=None)
    specular: float = taken_from(MeshSettings, "specular", enabled_by=None)
    shininess: float = taken_from(MeshSettings, "shininess", enabled_by=None)


#: Settings without an effect on the default image.
INERT = {
    "ambient": "acts with shading",
    "diffuse": "acts with shading",
    "specular": "acts with shading",
    "shininess": "acts with shading",
}
