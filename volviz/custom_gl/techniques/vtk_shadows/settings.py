"""Settings of VTK's volumetric shadows; shared names are those of our techniques."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.settings import SamplingSettings, ShadingSettings, taken_from
from volviz.model.parameters import parameter


@dataclass(frozen=True)
class VtkShadowsSettings:
    """How VTK samples, lights and casts shadow rays."""

    reach: float = parameter(
        1.0,
        "Shadow reach",
        "Length of the shadow rays: 0 looks at the neighbourhood only, 1 through all of the volume.",
        group="Shadows",
        minimum=0.0,
        maximum=1.0,
    )
    scattering: float = parameter(
        1.0,
        "Volumetric scattering",
        "Blends from lighting by the gradient (0) to scattering in the volume with shadows (2).",
        group="Shadows",
        minimum=0.0,
        maximum=2.0,
    )
    anisotropy: float = parameter(
        0.0,
        "Anisotropy",
        "Scatters light forwards (above 0) or backwards (below 0), as the phase function of Henyey and Greenstein.",
        group="Shadows",
        minimum=-1.0,
        maximum=1.0,
    )
    step: float = taken_from(SamplingSettings, "step")
    opacity_unit_distance: float | None = taken_from(SamplingSettings, "opacity_unit_distance")
    interpolation: str = taken_from(SamplingSettings, "interpolation")
    ambient: float = taken_from(ShadingSettings, "ambient", enabled_by=None)
    diffuse: float = taken_from(ShadingSettings, "diffuse", enabled_by=None)
    specular: float = taken_from(ShadingSettings, "specular", enabled_by=None)
    shininess: float = taken_from(ShadingSettings, "shininess", enabled_by=None)
