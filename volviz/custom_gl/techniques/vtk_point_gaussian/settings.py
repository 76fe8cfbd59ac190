"""Settings of VTK's point Gaussians; the names are those of our splatting."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.counterpart_settings import SplatSettings
from volviz.custom_gl.settings import taken_from


@dataclass(frozen=True)
class VtkPointGaussianSettings(SplatSettings):
    """Which voxels become splats and how they look."""

    footprint: str = taken_from(
        SplatSettings,
        "footprint",
        tooltip="Discs are opaque and hide one another. Gaussian footprints are translucent, with the opacity of the "
        "transfer function; VTK blends them in the order of the voxels, not from back to front.",
    )
