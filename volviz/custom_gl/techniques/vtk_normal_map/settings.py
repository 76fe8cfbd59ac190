"""Settings of VTK's normal-mapped cut; shared names are those of our bump mapping."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.model.parameters import Cost, parameter

COLOR_SOURCES = (("transfer_function", "Transfer function"), ("flat", "One colour"))


@dataclass(frozen=True)
class VtkNormalMapSettings:
    """Which plane is shown, how high its relief is and how it is lit."""

    plane_origin: tuple[float, float, float] | None = parameter(
        None,
        "Plane origin",
        "A point of the cut plane in world space.",
        kind="vector",
        optional=True,
        none_label="middle of the box",
        group="Surface",
        cost=Cost.DATA,
    )
    plane_normal: tuple[float, float, float] | None = parameter(
        None,
        "Plane normal",
        "Direction in which the cut plane faces.",
        kind="vector",
        optional=True,
        none_label="towards the first view",
        group="Surface",
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
    bump_strength: float = parameter(
        1.0,
        "Bump strength",
        "Height of the relief: 0 is smooth, negative turns hills into hollows. At 1 the whole range of the "
        "data is six voxels high.",
        group="Relief",
        minimum=-100.0,
        maximum=100.0,
        soft_minimum=-3.0,
        soft_maximum=3.0,
        cost=Cost.DATA,
    )
    gradient_delta: float = parameter(
        1.0,
        "Gradient delta",
        "Distance of the differences to either side of a point; larger is smoother.",
        unit="voxels",
        group="Relief",
        minimum=0.05,
        maximum=8.0,
        soft_minimum=0.25,
        soft_maximum=4.0,
        cost=Cost.DATA,
    )
    color_source: str = parameter(
        "transfer_function",
        "Colour",
        "What the light is multiplied by: the transfer function's colour at each point, or one colour.",
        choices=COLOR_SOURCES,
        group="Colour",
        cost=Cost.DATA,
    )
    flat_color: tuple[float, float, float] = parameter(
        (0.8, 0.74, 0.66), "One colour", "Colour of the whole surface.", kind="color", group="Colour",
        enabled_by=("color_source", ("flat",)), cost=Cost.DATA,
    )  # fmt: skip
    cut_out: bool = parameter(
        True,
        "Cut out transparent",
        "Leaves out places that the transfer function makes fully transparent, such as air.",
        group="Colour",
        cost=Cost.DATA,
    )
    ambient: float = parameter(
        0.15, "Ambient", "Light that reaches every place.", group="Lighting", minimum=0.0, maximum=1.0
    )
    diffuse: float = parameter(
        0.85, "Diffuse", "Light scattered evenly from a lit surface.", group="Lighting",
        minimum=0.0, maximum=1.0,
    )  # fmt: skip
