"""Settings of view-aligned slicing."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.settings import SamplingSettings, ShadingSettings
from volviz.model.parameters import Cost, parameter

MIN_SLICES, MAX_SLICES = 8, 2048

DEBUG_VIEWS = (("image", "Image"), ("wireframe", "Slice polygons"), ("both", "Image and polygons"))


@dataclass(frozen=True)
class SlicingSettings(ShadingSettings, SamplingSettings):
    """How the volume is sliced."""

    slices: int | None = parameter(
        None,
        "Slices",
        "Number of slices through the volume along the view; automatic follows the step. The keys + and - "
        "change it.",
        kind="int",
        optional=True,
        none_label="from the step",
        minimum=MIN_SLICES,
        maximum=MAX_SLICES,
        logarithmic=True,
        group="Sampling",
    )
    display: str = parameter(
        "image",
        "Show",
        "The picture, the polygons it is made of, or both.",
        choices=DEBUG_VIEWS,
        group="Machinery",
        cost=Cost.PROGRAM,
    )
