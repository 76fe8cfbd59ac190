"""Settings of splatting."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.counterpart_settings import SplatSettings
from volviz.custom_gl.settings import SamplingSettings, ShadingSettings, taken_from
from volviz.model.parameters import parameter

DEBUG_VIEWS = (("image", "Image"), ("splats", "Splats before the blur"))


@dataclass(frozen=True)
class SplattingSettings(SplatSettings):
    """Which voxels become splats and how they look."""

    splat_color: str = parameter(
        "transfer_function",
        "Colour",
        "Colour of the splats: by the transfer function at the voxel's value, or the classic light red.",
        choices=(("transfer_function", "Transfer function"), ("classic", "Classic")),
        group="Splats",
    )
    blur_radius: float = parameter(
        1.0,
        "Blur",
        "Standard deviation of the Gaussian that melts opaque discs into a surface; 0 leaves them as they are.",
        unit="pixels",
        group="Splats",
        minimum=0.0,
        maximum=32.0,
        soft_maximum=8.0,
        enabled_by=("footprint", ("disc",)),
    )
    opacity_unit_distance: float | None = taken_from(
        SamplingSettings, "opacity_unit_distance", enabled_by=("footprint", ("gaussian",))
    )
    shading: bool = taken_from(
        ShadingSettings,
        "shading",
        default=True,
        tooltip="Lights every splat by the gradient of the data at its voxel (Blinn-Phong).",
    )
    ambient: float = taken_from(ShadingSettings, "ambient")
    diffuse: float = taken_from(ShadingSettings, "diffuse")
    specular: float = taken_from(ShadingSettings, "specular")
    shininess: float = taken_from(ShadingSettings, "shininess")
    display: str = parameter(
        "image",
        "Show",
        "The picture, or the splats before they are blurred.",
        choices=DEBUG_VIEWS,
        group="Machinery",
    )
