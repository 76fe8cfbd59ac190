"""Settings of VTK's ray-cast isosurfaces; the names are those of our technique."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.counterpart_settings import MeshMaterialSettings
from volviz.custom_gl.settings import taken_from


@dataclass(frozen=True)
class VtkIsosurfaceSettings(MeshMaterialSettings):
    """Which surfaces are shown and how they look."""

    step: float = taken_from(
        MeshMaterialSettings,
        "step",
        tooltip="Distance between samples, in voxels of the smallest spacing. VTK interpolates once between the two "
        "samples around the surface.",
    )
    opacities: tuple[float, ...] = taken_from(
        MeshMaterialSettings,
        "opacities",
        tooltip="Opacities of the surfaces, in the order of the isovalues; given fewer, the last counts for the rest.",
    )
