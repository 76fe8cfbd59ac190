"""Triangle meshes drawn by our own pass: extraction on a worker, upload and drawing in blocks, stand-ins."""

from __future__ import annotations

from volviz.custom_gl.mesh_drawing.settings import CLASSIC, INERT, MeshSettings
from volviz.custom_gl.mesh_drawing.store import MeshWish, ReadyMesh
from volviz.custom_gl.mesh_drawing.technique import MeshTechnique
from volviz.custom_gl.mesh_drawing.world import world_triangles

__all__ = ["CLASSIC", "INERT", "MeshSettings", "MeshTechnique", "MeshWish", "ReadyMesh", "world_triangles"]
