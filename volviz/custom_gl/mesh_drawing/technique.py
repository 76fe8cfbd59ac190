"""A polygonal isosurface as an image: what to extract, which mesh to show now, how to draw it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np
import numpy.typing as npt

from volviz.custom_gl.mesh_drawing.blocks import MeshBlocks
from volviz.custom_gl.mesh_drawing.mesh import MeshRequest, ReadyMesh, extracted
from volviz.custom_gl.mesh_drawing.values import MeshValues, ValueColors
from volviz.custom_gl.shader_source import GLSL
from volviz.tasks import LatestResult

if TYPE_CHECKING:
    from volviz.custom_gl.gpu.programs import Program
    from volviz.custom_gl.technique import Frame
    from volviz.model.surface_values import SurfaceValues

#: Triangles of the LOD mesh that is drawn while something moves: about 30 ms on software OpenGL.
LOD_MESH_TRIANGLES = 60_000
#: The same for graphics cards.
LOD_MESH_TRIANGLES_HARDWARE = 1_500_000
#: Edges take so many times as long as faces.
WIREFRAME_COST = 4
#: By how much the stride of an LOD mesh may be larger than that of the mesh.
COARSER = (1, 2, 4, 8)
#: LOD meshes that are kept.
LOD_MESHES = 3
#: Before any mesh of a volume is known.
FIRST_COARSER = 4


class _UploadedMeshes:
    """The last meshes of one kind of frame on the GPU, the one that is shown at the end."""

    def __init__(self, keeps: int) -> None:
        self._keeps = keeps
        self._held: list[MeshBlocks] = []

    @property
    def blocks(self) -> MeshBlocks | None:
        """The mesh that is shown."""
        return self._held[-1] if self._held else None

    def take(self, frame: Frame, mesh: ReadyMesh, values: MeshValues | None) -> MeshBlocks:
        """Show this mesh, and release the one that was not shown for the longest time."""
        found = next((b for b in self._held if b.mesh is mesh and b.values is values), None)
        if found is None:
            found = MeshBlocks(frame.gpu, mesh, values)
        else:
            self._held.remove(found)
        self._held.append(found)
        while len(self._held) > self._keeps:
            self._held.pop(0).release()
        return found

    def release(self) -> None:
        """Release all of them; the context must be current."""
        for blocks in self._held:
            blocks.release()
        self._held.clear()


class MeshTechnique:
    """Extracts a surface in the background and draws it block by block; a coarser LOD mesh while something moves."""

    #: The host puts the depth of the surface into VTK's depth buffer.
    writes_depth = True
    #: Triangles cost more than pixels: below this, detail is given up by coarser LOD meshes.
    least_resolution = 0.375

    def __init__(self) -> None:
        self._full: LatestResult[MeshRequest, ReadyMesh] = LatestResult("mesh")
        # those of neighbouring strides are at hand when time gets short, and again when it does not
        self._lod_mesh: LatestResult[MeshRequest, ReadyMesh] = LatestResult(
            "coarse mesh", keeps=LOD_MESHES, cancels=False
        )
        self._shown = {False: _UploadedMeshes(1), True: _UploadedMeshes(LOD_MESHES)}
        self._values = ValueColors()
        self._known: MeshRequest | None = None
        self._known_triangles = 0

    def method(self, settings: Any) -> str:
        """Which method of `volviz.marching_cubes` extracts the surface."""
        raise NotImplementedError

    @property
    def mesh(self) -> ReadyMesh | None:
        """The mesh that the last full image showed, None before the first one."""
        return self._full.last

    # ------------------------------------------------------------------ which mesh

    def plan(self, frame: Frame) -> int:
        """One chunk per block of triangles; 0 while the mesh is being extracted."""
        request = self._request(frame)
        mesh = self._lod_mesh_for(frame, request) if frame.interactive else _made(self._full, frame, request)
        if mesh is None:
            return 0
        if not frame.interactive:
            self._note(mesh)
        values = None
        if frame.surface_colors is not None and mesh.triangles:
            # the surface of before must not get the colours of this one
            if (mesh.request.isovalue, mesh.request.method) == (request.isovalue, request.method):
                values = self._values_of(frame, mesh, frame.surface_colors.values)
            if values is None:
                return 0
        return max(self._shown[frame.interactive].take(frame, mesh, values).count, 1)

    def _values_of(self, frame: Frame, mesh: ReadyMesh, values: SurfaceValues) -> MeshValues | None:
        """What its colours stand for, None while it is looked for; a triangle with a value of its own becomes three."""
        fits = not frame.interactive or (
            self._full.last is mesh and 3 * mesh.triangles <= _moving_triangles(frame)
        )
        return self._values.get(frame.tasks, mesh, values, lod_mesh=frame.settings.wireframe or not fits)

    def _request(self, frame: Frame) -> MeshRequest:
        settings = frame.settings
        return MeshRequest(
            frame.volume, frame.isovalues[0], self.method(settings), **settings.extraction_options
        )

    def _lod_mesh_for(self, frame: Frame, request: MeshRequest) -> ReadyMesh | None:
        """A mesh that is drawn quickly: of this isovalue if possible, else the last one."""
        limit = _moving_triangles(frame)
        full = self._full.held(request)
        if full is not None and full.triangles <= limit:
            return full
        coarse = request.coarser(self._coarser(request, limit))
        mesh = _made(self._lod_mesh, frame, coarse)
        if mesh is not None:
            self._note(mesh)
            return mesh
        last = self._lod_mesh.last
        return last if last is not None and last.request.volume is request.volume else None

    def _note(self, mesh: ReadyMesh) -> None:
        """Remember how many triangles a stride gives, to choose that of the next LOD mesh."""
        self._known, self._known_triangles = mesh.request, mesh.triangles

    def _coarser(self, request: MeshRequest, limit: int) -> int:
        known = self._known
        if known is None or known.volume is not request.volume or known.method != request.method:
            return FIRST_COARSER
        for factor in COARSER:
            # a surface: the number of triangles falls with the square of the stride
            if self._known_triangles * (known.stride / (request.stride * factor)) ** 2 <= limit:
                return factor
        return COARSER[-1]

    # ------------------------------------------------------------------ drawing

    def draw(self, frame: Frame, chunk: int) -> None:
        """Draw one block of triangles."""
        blocks = self._shown[frame.interactive].blocks
        if blocks is None or chunk >= blocks.count or not frame.tiles:
            return
        gl = frame.gpu.gl
        program = self._program(frame)
        gl.enable_only(moderngl.DEPTH_TEST)
        gl.depth_func = "<"
        gl.wireframe = frame.settings.wireframe
        blocks.draw(chunk, program)
        gl.wireframe = False
        gl.enable_only(moderngl.NOTHING)

    def _program(self, frame: Frame) -> Program:
        settings, volume, colors = frame.settings, frame.volume, frame.surface_colors
        whole = frame.crop == tuple(float(v) for n in volume.dimensions for v in (0, n - 1))
        program = frame.program(
            GLSL / "mesh.vert",
            GLSL / "mesh.frag",
            {
                "NEAREST": False,
                "CUT": not whole or bool(frame.planes),
                # a line has no face that could be measured
                "FACETS": settings.normals == "flat" and not settings.wireframe,
                "COLOR_VALUE": colors is not None,
                "COLOR_NORMAL": colors is None and settings.color_by == "normal",
                "COLOR_TRANSFER_FUNCTION": colors is None and settings.color_by == "transfer_function",
            },
            many_vertices=True,
        )
        matrix = volume.index_to_world
        program.set(
            {
                "u_index_to_clip": frame.camera.view_projection @ matrix,
                "u_index_to_world_vector": matrix[:3, :3],
                "u_near_index": tuple(_near_index(frame)),
                "u_mirrored": bool(np.linalg.det(matrix[:3, :3]) < 0),
                "u_surface_color": settings.color,
                "u_color_depth": settings.color_depth * min(volume.spacing),
            }
        )
        if colors is not None:
            self._values.set(frame.gpu, program, colors)
        return program

    def release(self) -> None:
        """Release the meshes on the GPU, and forget those that they were made of."""
        for shown in self._shown.values():
            shown.release()
        self._values.release()
        for meshes in (self._full, self._lod_mesh):
            meshes.clear()


def _made(
    meshes: LatestResult[MeshRequest, ReadyMesh], frame: Frame, request: MeshRequest
) -> ReadyMesh | None:
    """The mesh of a request, or None while a task makes it."""
    return meshes.get(frame.tasks, request, lambda progress, cancel: extracted(request, progress, cancel))


def _moving_triangles(frame: Frame) -> int:
    """How many triangles an image may have while something moves."""
    limit = LOD_MESH_TRIANGLES if frame.gpu.limits.software else LOD_MESH_TRIANGLES_HARDWARE
    if frame.settings.wireframe:
        limit //= WIREFRAME_COST
    return int(limit / frame.step_scale)


def _near_index(frame: Frame) -> npt.NDArray[np.float64]:
    """Voxel index of the eye, or of the point of the box that is nearest to it."""
    index = frame.volume.world_to_index @ np.append(frame.camera.eye, 1.0)
    return np.asarray(np.clip(index[:3], 0.0, np.array(frame.volume.dimensions) - 1.0))
