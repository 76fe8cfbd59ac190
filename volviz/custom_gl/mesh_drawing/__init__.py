"""Triangle meshes drawn by our own pass: extraction on a worker, upload and drawing in blocks, LOD meshes."""

from __future__ import annotations

from volviz.custom_gl.mesh_drawing.mesh import MeshRequest, ReadyMesh, world_triangles
from volviz.custom_gl.mesh_drawing.settings import CLASSIC, INERT, MeshSettings
from volviz.custom_gl.mesh_drawing.technique import MeshTechnique

__all__ = ["CLASSIC", "INERT", "MeshSettings", "MeshTechnique", "MeshRequest", "ReadyMesh", "world_triangles"]
