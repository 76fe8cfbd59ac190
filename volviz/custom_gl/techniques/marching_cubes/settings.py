"""Settings of marching cubes."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.mesh_drawing import MeshSettings
from volviz.model.parameters import Cost, parameter


@dataclass(frozen=True)
class MarchingCubesSettings(MeshSettings):
    """Which surface is extracted, by which tables, and how its triangles look."""

    method: str = parameter(
        "lorensen",
        "Method",
        "The classic 256 cases, or the topology of the trilinear interpolant, which decides ambiguous cells as the "
        "data between the voxels do.",
        choices=(("lorensen", "Lorensen, 256 cases"), ("topological", "Topological")),
        group="Surface",
        cost=Cost.DATA,
    )
