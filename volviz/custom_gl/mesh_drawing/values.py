"""Values of a surface on the meshes that are drawn of it, and their colours on the GPU."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import moderngl
import numpy as np
import numpy.typing as npt

from volviz.custom_gl.mesh_drawing.mesh import ReadyMesh, world_places
from volviz.model.surface_values import SurfaceColors, SurfaceValues
from volviz.tasks import LatestResult, Tasks

if TYPE_CHECKING:
    from volviz.custom_gl.gpu.context import Gpu
    from volviz.custom_gl.gpu.programs import Program

Floats = npt.NDArray[np.float32]

#: Meshes whose values are kept: the full one and the LOD meshes of a drag.
KEPT = 4
#: Ambient, diffuse, specular, exponent: shape is to be seen, and colours are to be compared.
MATERIAL = (0.45, 0.55, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class MeshValues:
    """Numbers on one mesh.

    Attributes
    ----------
    at_vertices : ndarray of shape (V,), float32
    at_middles : ndarray of shape (F,), float32, or None
        At the middles of triangles; None for an LOD mesh, whose vertices have means of what is around.
    """

    at_vertices: Floats
    at_middles: Floats | None = None


class _ValueRequest(NamedTuple):
    """Which values on which mesh; all three are compared by identity."""

    mesh: ReadyMesh
    values: SurfaceValues
    lod_mesh: bool


class ValueColors:
    """Finds the values of the meshes of one technique, in the background, and brings their colours to a shader."""

    def __init__(self) -> None:
        self._found: LatestResult[_ValueRequest, MeshValues] = LatestResult(
            "values", keeps=KEPT, cancels=False
        )
        self._table: Any = None
        self._texture: Any = None

    def get(
        self, tasks: Tasks, mesh: ReadyMesh, values: SurfaceValues, *, lod_mesh: bool
    ) -> MeshValues | None:
        """Values on a mesh, or None while they are looked for.

        Parameters
        ----------
        tasks : Tasks
            Where they are looked for.
        mesh : ReadyMesh
            What is drawn.
        values : SurfaceValues
            Of the surface that it shows, or stands for.
        lod_mesh : bool
            Give the vertices means of what is around them, and triangles nothing.
        """
        request = _ValueRequest(mesh, values, lod_mesh)
        return self._found.get(tasks, request, lambda _progress, _cancel: _looked_up(request))

    def set(self, gpu: Gpu, program: Program, colors: SurfaceColors) -> None:
        """Give a program the colours."""
        if self._table is not colors.table:
            self._drop_texture()
            data = (colors.table.astype(np.float32) / np.float32(255)).tobytes()
            self._texture = gpu.gl.texture((len(colors.table), 1), 3, data, dtype="f4")
            self._texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
            self._texture.repeat_x = self._texture.repeat_y = False
            self._table = colors.table
        program.use_texture("t_value_colors", self._texture)
        # low and high lie in the middles of the first and the last texel
        count = len(colors.table)
        scale = (count - 1) / count / (colors.high - colors.low)
        program.set(
            {
                "u_value_scale": scale,
                "u_value_offset": 0.5 / count - colors.low * scale,
                "u_material": MATERIAL,
            }
        )

    def _drop_texture(self) -> None:
        if self._texture is not None:
            self._texture.release()
        self._texture = self._table = None

    def release(self) -> None:
        """Release the colours and forget the values; the context is current."""
        self._found.clear()
        self._drop_texture()


def _looked_up(request: _ValueRequest) -> MeshValues:
    vertices, faces = world_places(request.mesh)
    if request.lod_mesh:
        return MeshValues(request.values.around(vertices))
    return MeshValues(*request.values.at(vertices, faces))
