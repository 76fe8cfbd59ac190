"""A mesh on the GPU, cut into blocks that are uploaded and drawn one by one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np

if TYPE_CHECKING:
    from volviz.custom_gl.gpu.context import Gpu
    from volviz.custom_gl.gpu.programs import Program
    from volviz.custom_gl.mesh_drawing.mesh import ReadyMesh
    from volviz.custom_gl.mesh_drawing.values import MeshValues

#: Triangles of a block: 5 to 10 ms on software OpenGL. Larger blocks take longer *per triangle* there.
BLOCK = 16384

_ATTRIBUTES = (("a_index", "3f", "12x"), ("a_normal", "3f", "12x"), ("a_value", "1f", "4x"))


class MeshBlocks:
    """Vertex and index buffers of a mesh.

    Extraction walks through the volume plane by plane, so that consecutive triangles use neighbouring vertices:
    each block has its own short range of them.

    Parameters
    ----------
    gpu : Gpu
        Of the current context.
    mesh : ReadyMesh
        What to draw.
    values : MeshValues, optional
        Numbers that colours stand for. Those at the middles of triangles cut each triangle into three.

    Attributes
    ----------
    count : int
        Number of blocks; at least two for more than one triangle, so that drawing can always be interrupted.
    """

    def __init__(self, gpu: Gpu, mesh: ReadyMesh, values: MeshValues | None = None) -> None:
        self._gpu = gpu
        self.mesh = mesh
        self.values = values
        triangles = mesh.triangles
        block = BLOCK if values is None or values.at_middles is None else BLOCK // 3
        self._size = max(min(block, -(-triangles // 2)), 1)
        self.count = -(-triangles // self._size)
        self._buffers: dict[int, tuple[Any, Any]] = {}
        self._arrays: dict[int, tuple[Any, Program]] = {}

    def draw(self, block: int, program: Program) -> None:
        """Draw one block, uploading it when it is not yet there."""
        self._array(block, program).render(moderngl.TRIANGLES)

    def _array(self, block: int, program: Program) -> Any:
        held = self._arrays.get(block)
        if held is not None and held[1] is program:
            return held[0]
        if held is not None:
            held[0].release()
        vertices, indices = self._uploaded(block)
        # attributes that a variant does not use are removed by the driver, their room in the buffer is not
        attributes = _ATTRIBUTES if self.values is not None else _ATTRIBUTES[:2]
        layout = " ".join(used if name in program else unused for name, used, unused in attributes)
        names = [name for name, _, _ in attributes if name in program]
        array = self._gpu.gl.vertex_array(program.gl, [(vertices, layout, *names)], indices)
        self._arrays[block] = (array, program)
        return array

    def _uploaded(self, block: int) -> tuple[Any, Any]:
        buffers = self._buffers.get(block)
        if buffers is None:
            packed, indices = self._packed(slice(block * self._size, (block + 1) * self._size))
            gl = self._gpu.gl
            buffers = self._buffers[block] = (gl.buffer(packed), gl.buffer(indices))
            self._gpu.uploads += 1
        return buffers

    def _packed(self, block: slice) -> tuple[Any, Any]:
        """Rows of vertices, and their numbers in triangles."""
        faces, values = self.mesh.faces[block], self.values
        first, last = int(faces.min()), int(faces.max())
        packed = np.empty((last + 1 - first, 6 if values is None else 7), np.float32)
        packed[:, :3] = self.mesh.vertices[first : last + 1]
        packed[:, 3:6] = self.mesh.normals[first : last + 1]
        indices = (faces - first).astype(np.uint32)
        if values is None:
            return packed, indices
        packed[:, 6] = values.at_vertices[first : last + 1]
        if values.at_middles is None:
            return packed, indices
        middles = packed[indices].mean(axis=1)
        middles[:, 6] = values.at_middles[block]
        numbers = np.arange(len(packed), len(packed) + len(middles), dtype=np.uint32)
        sides = [np.stack([indices[:, i], indices[:, (i + 1) % 3], numbers], axis=1) for i in range(3)]
        return np.concatenate([packed, middles]), np.stack(sides, axis=1).reshape(-1, 3)

    def release(self) -> None:
        """Release everything on the GPU; the context must be current."""
        for array, _ in self._arrays.values():
            array.release()
        for buffers in self._buffers.values():
            for buffer in buffers:
                buffer.release()
        self._arrays.clear()
        self._buffers.clear()
