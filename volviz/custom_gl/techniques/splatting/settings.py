"""Settings of splatting."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.settings import SamplingSettings, ShadingSettings, taken_from
from volviz.model.parameters import Cost, parameter

DISPLAYS = (("image", "Image"), ("splats", "Splats before the blur"))


@dataclass(frozen=True)
class SplattingSettings:
    """Which voxels become splats and how they look."""

    isovalue: float | None = parameter(
        None,
        "Isovalue",
        "Voxels strictly above this value become splats.",
        kind="float",
        optional=True,
        none_label="from the histogram",
        group="Splats",
        cost=Cost.DATA,
    )
    splats_per_axis: int | None = parameter(
        None,
        "Splats per axis",
        "At most so many splats along each axis, on a regular lattice; automatic takes every voxel.",
        kind="int",
        optional=True,
        none_label="every voxel",
        minimum=1,
        maximum=4096,
        soft_minimum=16,
        soft_maximum=512,
        logarithmic=True,
        group="Splats",
        cost=Cost.DATA,
    )
    splat_size: float = parameter(
        1.5,
        "Splat size",
        "Diameter of a splat as a multiple of the largest distance between neighbours: below 1 they come apart.",
        group="Splats",
        minimum=0.05,
        maximum=20.0,
        soft_minimum=0.25,
        soft_maximum=4.0,
        logarithmic=True,
    )
    footprint: str = parameter(
        "disc",
        "Footprint",
        "Discs are opaque and hide one another. Gaussian footprints are translucent, with the opacity of the "
        "transfer function, and are blended from back to front.",
        choices=(("disc", "Opaque discs"), ("gaussian", "Gaussian")),
        group="Splats",
        cost=Cost.DATA,
    )
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
        choices=DISPLAYS,
        group="Machinery",
    )
