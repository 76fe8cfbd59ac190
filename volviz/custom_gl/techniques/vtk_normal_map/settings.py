"""Settings of VTK's normal-mapped cut; shared names are those of our bump mapping."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.counterpart_settings import CutSettings
from volviz.custom_gl.settings import taken_from
from volviz.model.parameters import Cost, parameter


@dataclass(frozen=True)
class VtkNormalMapSettings:
    """Which plane is shown, how high its relief is and how it is lit."""

    plane_origin: tuple[float, float, float] | None = taken_from(
        CutSettings,
        "plane_origin",
        cost=Cost.DATA,
    )
    plane_normal: tuple[float, float, float] | None = taken_from(
        CutSettings,
        "plane_normal",
        cost=Cost.DATA,
    )
    texels: int = parameter(
        512,
        "Texels",
        "Size of the pictures of colours and normals along the longer side of the plane.",
        group="Surface",
        minimum=16,
        maximum=4096,
        soft_minimum=64,
        soft_maximum=2048,
        logarithmic=True,
        cost=Cost.DATA,
    )
    bump_strength: float = taken_from(
        CutSettings,
        "bump_strength",
        cost=Cost.DATA,
    )
    gradient_delta: float = taken_from(
        CutSettings,
        "gradient_delta",
        cost=Cost.DATA,
    )
    color_source: str = taken_from(
        CutSettings,
        "color_source",
        cost=Cost.DATA,
    )
    flat_color: tuple[float, float, float] = taken_from(
        CutSettings,
        "flat_color",
        cost=Cost.DATA,
    )
    cut_out: bool = taken_from(
        CutSettings,
        "cut_out",
        cost=Cost.DATA,
    )
    ambient: float = taken_from(
        CutSettings,
        "ambient",
    )
    diffuse: float = taken_from(
        CutSettings,
        "diffuse",
        maximum=1.0,
    )
