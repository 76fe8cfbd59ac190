"""Settings of single-pass ray casting."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.settings import SamplingSettings, ShadingSettings
from volviz.model.parameters import Cost, parameter


@dataclass(frozen=True)
class RaycastSettings(ShadingSettings, SamplingSettings):
    """How rays are cast."""

    preintegrated: bool = parameter(
        False,
        "Pre-integrated",
        "Colour and opacity of a piece of ray come from a table over the scalars at both its ends, so that thin "
        "features of the transfer function are not missed between samples.",
        group="Classification",
        cost=Cost.PROGRAM,
        enabled_by=("mode", ("composite",)),
    )
