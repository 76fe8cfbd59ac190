"""Settings of marching tetrahedra."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.mesh_drawing import MeshSettings


@dataclass(frozen=True)
class MarchingTetrahedraSettings(MeshSettings):
    """Which surface is extracted and how its triangles look."""
