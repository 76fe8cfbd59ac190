"""Settings of the reference; those of ray casting, as far as they make sense without shortcuts."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.settings import PreintegrationSettings, SamplingSettings, ShadingSettings, taken_from
from volviz.model.parameters import parameter


@dataclass(frozen=True)
class ReferenceSettings(PreintegrationSettings, ShadingSettings):
    """How rays are cast, and how many."""

    mode: str = taken_from(SamplingSettings, "mode")
    attenuation: float = taken_from(SamplingSettings, "attenuation")
    step: float = taken_from(SamplingSettings, "step")
    first_sample: float = taken_from(SamplingSettings, "first_sample")
    opacity_unit_distance: float | None = taken_from(SamplingSettings, "opacity_unit_distance")
    density_threshold: float = taken_from(SamplingSettings, "density_threshold")
    interpolation: str = taken_from(SamplingSettings, "interpolation")
    early_termination: float = taken_from(SamplingSettings, "early_termination", default=1.0)
    resolution: int | None = parameter(
        None,
        "Resolution",
        "Rows of pixels that are computed; fewer are quicker, and shown as visible blocks.",
        kind="int",
        unit="rows",
        optional=True,
        none_label="every pixel",
        minimum=4,
        maximum=16384,
        soft_minimum=32,
        soft_maximum=1024,
        logarithmic=True,
        group="Sampling",
    )
