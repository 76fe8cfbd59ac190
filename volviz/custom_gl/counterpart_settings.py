"""Settings that a technique of ours and VTK's counterpart have in common: neither knows the other."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.settings import INTERPOLATIONS
from volviz.errors import SettingError
from volviz.model.parameters import Cost, parameter

#: Number of surfaces that can be shown at once.
MAX_SURFACES = 4

#: Bone, blood, leaf, sky: distinct side by side, and bright enough for shading to show.
COLORS = ((0.87, 0.79, 0.65), (0.80, 0.34, 0.28), (0.45, 0.66, 0.36), (0.36, 0.58, 0.80))

COLOR_SOURCES = (("transfer_function", "Transfer function"), ("flat", "One colour"))


@dataclass(frozen=True)
class MeshMaterialSettings:
    """Which ray-cast isosurfaces are shown and how they look."""

    isovalues: tuple[float, ...] | None = parameter(
        None,
        "Isovalues",
        "Values at which the surfaces lie, in data units; up to four. Automatic takes the value that best "
        "splits the object from what surrounds it.",
        kind="floats",
        optional=True,
        none_label="from the histogram",
        group="Surfaces",
        cost=Cost.TEXTURE,
    )
    colors: tuple[tuple[float, float, float], ...] = parameter(
        COLORS,
        "Colours",
        "Colours of the surfaces, in the order of the isovalues; given fewer, they repeat.",
        kind="colors",
        group="Surfaces",
    )
    opacities: tuple[float, ...] = parameter(
        (1.0,),
        "Opacities",
        "Opacities of the surfaces, in the order of the isovalues; given fewer, the last counts for the "
        "rest. Below 1 the surfaces behind shine through.",
        kind="floats",
        minimum=0.0,
        maximum=1.0,
        group="Surfaces",
    )
    step: float = parameter(
        0.5,
        "Step",
        "Distance between samples, in voxels of the smallest spacing. Shells thinner than it can be missed.",
        unit="voxels",
        group="Sampling",
        minimum=0.02,
        maximum=8.0,
        soft_minimum=0.1,
        soft_maximum=2.0,
        logarithmic=True,
    )
    interpolation: str = parameter(
        "linear", "Interpolation", "Between voxel centres, or the nearest voxel as a block.",
        choices=INTERPOLATIONS, group="Sampling", cost=Cost.PROGRAM,
    )  # fmt: skip
    ambient: float = parameter(
        0.2, "Ambient", "Light that reaches every place.", group="Lighting", minimum=0.0, maximum=1.0
    )
    diffuse: float = parameter(
        0.7, "Diffuse", "Light scattered evenly from a lit surface.", group="Lighting", minimum=0.0,
        maximum=1.0,
    )  # fmt: skip
    specular: float = parameter(
        0.2, "Specular", "Strength of highlights.", group="Lighting", minimum=0.0, maximum=1.0
    )
    shininess: float = parameter(
        40.0, "Shininess", "Exponent of highlights: higher is smaller and sharper.", group="Lighting",
        minimum=1.0, maximum=1000.0, logarithmic=True,
    )  # fmt: skip

    def __post_init__(self) -> None:
        if self.isovalues is not None and not 1 <= len(self.isovalues) <= MAX_SURFACES:
            raise SettingError(
                f"isovalues must be 1 to {MAX_SURFACES} numbers in data units, got {len(self.isovalues)}."
            )
        if not self.colors or not self.opacities:
            raise SettingError("colors and opacities need at least one entry each, for every isovalue.")


@dataclass(frozen=True)
class SplatSettings:
    """Which voxels become splats, and of what kind."""

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


@dataclass(frozen=True)
class CutSettings:
    """A cut plane with relief: where it lies, how high it is and what colours it."""

    plane_origin: tuple[float, float, float] | None = parameter(
        None,
        "Plane origin",
        "A point of the cut plane in world space.",
        kind="vector",
        optional=True,
        none_label="middle of the box",
        group="Surface",
    )
    plane_normal: tuple[float, float, float] | None = parameter(
        None,
        "Plane normal",
        "Direction in which the cut plane faces.",
        kind="vector",
        optional=True,
        none_label="towards the first view",
        group="Surface",
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
    )
    color_source: str = parameter(
        "transfer_function",
        "Colour",
        "What the light is multiplied by: the transfer function's colour at each point, or one colour.",
        choices=COLOR_SOURCES,
        group="Colour",
        cost=Cost.PROGRAM,
    )
    flat_color: tuple[float, float, float] = parameter(
        (0.8, 0.74, 0.66), "One colour", "Colour of the whole surface.", kind="color", group="Colour",
        enabled_by=("color_source", ("flat",)),
    )  # fmt: skip
    cut_out: bool = parameter(
        True,
        "Cut out transparent",
        "Leaves out places that the transfer function makes fully transparent, such as air.",
        group="Colour",
        cost=Cost.PROGRAM,
    )
    ambient: float = parameter(
        0.15, "Ambient", "Light that reaches every place.", group="Lighting", minimum=0.0, maximum=1.0
    )
    diffuse: float = parameter(
        0.85, "Diffuse", "Light scattered evenly from a lit surface.", group="Lighting",
        minimum=0.0, maximum=2.0,
    )  # fmt: skip
