"""Settings of ray-cast isosurfaces."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.settings import INTERPOLATIONS
from volviz.errors import SettingError
from volviz.model.parameters import Cost, parameter

#: Number of surfaces that can be shown at once.
MAX_SURFACES = 4

#: Longest step in voxels, while something moves as well: with longer ones than a brick, the test for empty bricks
#: would miss surfaces between two samples.
MAX_STEP = 8.0

DISPLAYS = (
    ("image", "Image"),
    ("positions", "Positions"),
    ("normals", "Normals"),
    ("samples", "Samples per ray"),
)

#: Bone, blood, leaf, sky: distinct side by side, and bright enough for shading to show.
COLORS = ((0.87, 0.79, 0.65), (0.80, 0.34, 0.28), (0.45, 0.66, 0.36), (0.36, 0.58, 0.80))


@dataclass(frozen=True)
class IsosurfaceSettings:
    """Which surfaces are shown, how they look and how exactly they are found."""

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
        maximum=MAX_STEP,
        soft_minimum=0.1,
        soft_maximum=2.0,
        logarithmic=True,
    )
    bisections: int = parameter(
        4,
        "Bisections",
        "How often the piece of ray that holds the surface is halved before the point is interpolated in it.",
        group="Sampling",
        minimum=0,
        maximum=16,
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
    gradient_delta: float = parameter(
        1.0,
        "Gradient delta",
        "Distance of the central differences to either side of the surface: larger smooths the shading.",
        unit="voxels",
        group="Lighting",
        minimum=0.05,
        maximum=8.0,
        soft_minimum=0.25,
        soft_maximum=4.0,
    )
    display: str = parameter(
        "image",
        "Show",
        "The picture; the points of the nearest surface as texture coordinates; its world normals, 0.5 being "
        "zero; or how many samples each ray took, from black to white.",
        choices=DISPLAYS,
        group="Machinery",
        cost=Cost.PROGRAM,
    )

    def __post_init__(self) -> None:
        if self.isovalues is not None and not 1 <= len(self.isovalues) <= MAX_SURFACES:
            raise SettingError(
                f"isovalues must be 1 to {MAX_SURFACES} numbers in data units, got {len(self.isovalues)}."
            )
        if not self.colors or not self.opacities:
            raise SettingError("colors and opacities need at least one entry each, for every isovalue.")
