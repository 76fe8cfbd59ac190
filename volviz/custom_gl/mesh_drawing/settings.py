"""Settings that all techniques with a polygonal isosurface share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from volviz.model.parameters import Cost, parameter

COLORINGS = (
    ("color", "One colour"),
    ("normal", "Normal as colour"),
    ("transfer_function", "Transfer function"),
)
_LIT = ("color_by", ("color", "transfer_function"))


@dataclass(frozen=True)
class MeshSettings:
    """Which surface is extracted and how its triangles look."""

    isovalue: float | None = parameter(
        None,
        "Isovalue",
        "Value at which the surface lies, in data units. Automatic takes the value that best splits the object "
        "from what surrounds it.",
        kind="float",
        optional=True,
        none_label="from the histogram",
        # the range of bytes; in the window the slider has that of the volume
        soft_minimum=0.0,
        soft_maximum=255.0,
        unit="data",
        group="Surface",
        cost=Cost.DATA,
    )
    stride: int = parameter(
        1,
        "Stride",
        "Uses every n-th voxel along each axis: 2 gives about a quarter of the triangles.",
        unit="voxels",
        group="Surface",
        minimum=1,
        maximum=64,
        soft_maximum=8,
        cost=Cost.DATA,
    )
    normals: str = parameter(
        "gradient",
        "Normals",
        "From the gradient of the data at the vertices, which looks smooth; or one for each triangle, which shows "
        "the facets.",
        choices=(("gradient", "From the data"), ("flat", "One for each triangle")),
        group="Surface",
        cost=Cost.PROGRAM,
    )
    wireframe: bool = parameter(
        False,
        "Wireframe",
        "Shows the edges of the triangles instead of their faces.",
        group="Surface",
        cost=Cost.PROGRAM,
    )
    parts: str = parameter(
        "all",
        "Parts",
        "Which connected parts are kept: all, the one with the most triangles, or those that are not specks.",
        choices=(("all", "All"), ("largest", "Largest part"), ("large", "Large parts")),
        group="Filters",
        cost=Cost.DATA,
    )
    part_triangles: int = parameter(
        100,
        "Triangles",
        "How many a part must have to be kept; parts with fewer are left out.",
        group="Filters",
        minimum=1,
        soft_maximum=100_000,
        logarithmic=True,
        cost=Cost.DATA,
        enabled_by=("parts", ("large",)),
    )
    smoothing: int = parameter(
        0,
        "Smoothing",
        "Iterations of a smoothing that does not shrink the surface; 20 take the steps of a mask away.",
        group="Filters",
        minimum=0,
        maximum=500,
        soft_maximum=60,
        cost=Cost.DATA,
    )
    decimation: float = parameter(
        0.0,
        "Decimation",
        "Share of the triangles that is removed, those first that change the shape least.",
        group="Filters",
        minimum=0.0,
        maximum=0.99,
        cost=Cost.DATA,
    )
    color_by: str = parameter(
        "color",
        "Colour by",
        "One colour, lit; the direction of the normal as red, green and blue, 0.5 being zero, unlit; or the "
        "transfer function's colour of the data below the surface, lit.",
        choices=COLORINGS,
        group="Colour",
        cost=Cost.PROGRAM,
    )
    color: tuple[float, float, float] = parameter(
        (0.87, 0.79, 0.65),
        "Colour",
        "Colour of the surface.",
        kind="color",
        group="Colour",
        enabled_by=("color_by", ("color",)),
    )
    color_depth: float = parameter(
        1.0,
        "Colour depth",
        "How far below the surface the data are read that the transfer function colours; on the surface itself "
        "they all are the isovalue.",
        unit="voxels",
        group="Colour",
        minimum=-20.0,
        maximum=20.0,
        soft_minimum=0.0,
        soft_maximum=5.0,
        enabled_by=("color_by", ("transfer_function",)),
    )
    ambient: float = parameter(
        0.2, "Ambient", "Light that reaches every place.", group="Lighting", minimum=0.0, maximum=1.0,
        enabled_by=_LIT,
    )  # fmt: skip
    diffuse: float = parameter(
        0.7, "Diffuse", "Light scattered evenly from a lit surface.", group="Lighting", minimum=0.0,
        maximum=1.0, enabled_by=_LIT,
    )  # fmt: skip
    specular: float = parameter(
        0.2,
        "Specular",
        "Strength of highlights.",
        group="Lighting",
        minimum=0.0,
        maximum=1.0,
        enabled_by=_LIT,
    )
    shininess: float = parameter(
        40.0, "Shininess", "Exponent of highlights: higher is smaller and sharper.", group="Lighting",
        minimum=1.0, maximum=1000.0, logarithmic=True, enabled_by=_LIT,
    )  # fmt: skip

    @property
    def extraction_options(self) -> dict[str, Any]:
        """What the settings say of the extraction, as keywords of `volviz.meshes.extraction.extract_triangles`."""
        return {
            "stride": int(self.stride),
            "largest_part": self.parts == "largest",
            "min_triangles": self.part_triangles if self.parts == "large" else 0,
            "smoothing": self.smoothing,
            "decimation": self.decimation,
        }


#: Values of the well-known teaching program: every second voxel of 256^3 bytes, normal as colour.
CLASSIC: Mapping[str, Any] = {"isovalue": 48.0, "stride": 2, "color_by": "normal"}

#: Settings without an effect on the default image.
INERT: Mapping[str, str] = {
    "color_depth": "acts when the transfer function colours the surface",
    "parts": "all give the same mesh when it has one part only",
    "part_triangles": "acts when only large parts are kept",
}
