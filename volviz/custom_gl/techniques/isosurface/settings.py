"""Settings of ray-cast isosurfaces."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.counterpart_settings import MeshMaterialSettings
from volviz.model.parameters import Cost, parameter

#: Longest step in voxels, while something moves as well: with longer ones than a brick, the test for empty bricks
#: would miss surfaces between two samples.
MAX_STEP = 8.0

DEBUG_VIEWS = (
    ("image", "Image"),
    ("positions", "Positions"),
    ("normals", "Normals"),
    ("samples", "Samples per ray"),
)


@dataclass(frozen=True)
class IsosurfaceSettings(MeshMaterialSettings):
    """Which surfaces are shown, how they look and how exactly they are found."""

    bisections: int = parameter(
        4,
        "Bisections",
        "How often the piece of ray that holds the surface is halved before the point is interpolated in it.",
        group="Sampling",
        minimum=0,
        maximum=16,
    )
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
        choices=DEBUG_VIEWS,
        group="Machinery",
        cost=Cost.PROGRAM,
    )
