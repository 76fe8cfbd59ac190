"""Marching tetrahedra, drawn by our own pass."""

from __future__ import annotations

from typing import TYPE_CHECKING

from volviz.custom_gl.mesh_drawing import MeshTechnique

if TYPE_CHECKING:
    from volviz.custom_gl.techniques.marching_tetrahedra.settings import MarchingTetrahedraSettings


class MarchingTetrahedra(MeshTechnique):
    """The mesh of six tetrahedra a cell."""

    def method(self, settings: MarchingTetrahedraSettings) -> str:
        """Tetrahedra, whatever the settings."""
        return "tetrahedra"
