"""A mesh on the GPU, cut into blocks that are uploaded and drawn one by one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np

if TYPE_CHECKING:
    from volviz.custom_gl.gpu.context import Gpu
    from volviz.custom_gl.gpu.programs import Program
    from volviz.custom_gl.mesh_drawing.store import ReadyMesh

#: Triangles of a block: 5 to 10 ms on software OpenGL. Larger blocks take longer *per triangle* there.
BLOCK = 16384

_ATTRIBUTES = (("a_index", "3f", "12x"), ("a_normal", "3f", "12x"))


class MeshBlocks:
    """Vertex and index buffers of a mesh.

    Extraction walks through the volume plane by plane, so that consecutive triangles use neighbouring vertices:
    each block has its own short range of them.

    Attributes
    ----------
    count : int
        Number of blocks; at least two for more than one triangle, so that drawing can always be interrupted.
    """

    def __init__(self, gpu: Gpu, mesh: ReadyMesh) -> None:
        self._gpu = gpu
        self.mesh = mesh
        triangles = mesh.triangles
        self._size = max(min(BLOCK, -(-triangles // 2)), 1)
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
        layout = " ".join(used if name in program else unused for name, used, unused in _ATTRIBUTES)
        names = [name for name, _, _ in _ATTRIBUTES if name in program]
        array = self._gpu.gl.vertex_array(program.gl, [(vertices, layout, *names)], indices)
        self._arrays[block] = (array, program)
        return array

    def _uploaded(self, block: int) -> tuple[Any, Any]:
        buffers = self._buffers.get(block)
        if buffers is None:
            faces = self.mesh.faces[block * self._size : (block + 1) * self._size]
            first, last = int(faces.min()), int(faces.max())
            packed = np.empty((last + 1 - first, 6), np.float32)
            packed[:, :3] = self.mesh.vertices[first : last + 1]
            packed[:, 3:] = self.mesh.normals[first : last + 1]
            indices = (faces - first).astype(np.uint32)
            gl = self._gpu.gl
            buffers = self._buffers[block] = (gl.buffer(packed), gl.buffer(indices))
            self._gpu.uploads += 1
        return buffers

    def release(self) -> None:
        """Release everything on the GPU; the context must be current."""
        for array, _ in self._arrays.values():
            array.release()
        for buffers in self._buffers.values():
            for buffer in buffers:
                buffer.release()
        self._arrays.clear()
        self._buffers.clear()
