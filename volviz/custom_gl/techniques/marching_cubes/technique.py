"""Marching cubes, drawn by our own pass."""

from __future__ import annotations

from typing import TYPE_CHECKING

from volviz.custom_gl.mesh_drawing import MeshTechnique

if TYPE_CHECKING:
    from volviz.custom_gl.techniques.marching_cubes.settings import MarchingCubesSettings


class MarchingCubes(MeshTechnique):
    """The mesh of the classic cases or of the trilinear interpolant's topology."""

    def method(self, settings: MarchingCubesSettings) -> str:
        """The chosen method."""
        return settings.method
