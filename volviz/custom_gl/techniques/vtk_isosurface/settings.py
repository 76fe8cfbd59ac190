"""Settings of VTK's ray-cast isosurfaces; the names are those of our technique."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.settings import INTERPOLATIONS
from volviz.errors import SettingError
from volviz.model.parameters import parameter

#: Number of surfaces that can be shown at once, as many as ours.
MAX_SURFACES = 4


@dataclass(frozen=True)
class VtkIsosurfaceSettings:
    """Which surfaces are shown and how they look."""

    isovalues: tuple[float, ...] | None = parameter(
        None,
        "Isovalues",
        "Values at which the surfaces lie, in data units; up to four. Automatic takes the value that best "
        "splits the object from what surrounds it.",
        kind="floats",
        optional=True,
        none_label="from the histogram",
        group="Surfaces",
    )
    colors: tuple[tuple[float, float, float], ...] = parameter(
        ((0.87, 0.79, 0.65), (0.80, 0.34, 0.28), (0.45, 0.66, 0.36), (0.36, 0.58, 0.80)),
        "Colours",
        "Colours of the surfaces, in the order of the isovalues; given fewer, they repeat.",
        kind="colors",
        group="Surfaces",
    )
    opacities: tuple[float, ...] = parameter(
        (1.0,),
        "Opacities",
        "Opacities of the surfaces, in the order of the isovalues; given fewer, the last counts for the rest.",
        kind="floats",
        minimum=0.0,
        maximum=1.0,
        group="Surfaces",
    )
    step: float = parameter(
        0.5,
        "Step",
        "Distance between samples, in voxels of the smallest spacing. VTK interpolates once between the two "
        "samples around the surface.",
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
        choices=INTERPOLATIONS, group="Sampling",
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
