"""Settings of single-pass ray casting."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.settings import PreintegrationSettings, SamplingSettings, ShadingSettings


@dataclass(frozen=True)
class RaycastSettings(PreintegrationSettings, ShadingSettings, SamplingSettings):
    """How rays are cast."""
