"""Bump mapping: surfaces drawn back to front, lit per pixel in tangent space."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np
import numpy.typing as npt

from volviz.custom_gl.shader_source import GLSL
from volviz.custom_gl.technique import Frame, Tile
from volviz.custom_gl.techniques.bump_mapping.maps import MapTextures
from volviz.custom_gl.techniques.bump_mapping.mesh_surface import MeshData, file_mesh, isosurface_mesh
from volviz.custom_gl.techniques.bump_mapping.receivers import polygons, vertex_data
from volviz.custom_gl.techniques.bump_mapping.settings import DEBUG_VIEWS
from volviz.tasks import LatestResult, Work

if TYPE_CHECKING:
    from volviz.custom_gl.gpu.programs import Program
    from volviz.custom_gl.gpu.targets import Target

_HERE = Path(__file__).parent

#: Height of the whole range of the data at strength 1, in mean voxel spacings.
RELIEF_VOXELS = 6.0
#: Tiles along the longest edge of the box when no tile size is chosen.
TILES = 4
#: Vertices of a mesh that one chunk draws, three a triangle: about 20 ms on software OpenGL.
CHUNK_VERTICES = 3 * 40_000

_ENCODINGS = {"float": 0, "bytes": 1, "bytes_classic": 2}
_DEBUG_VIEWS = {name: number for number, (name, _) in enumerate(DEBUG_VIEWS)}
_OVER = (moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA)
_MODULATE = (moderngl.DST_COLOR, moderngl.ZERO)
_ATTRIBUTES = (("3f", "a_position"), ("3f", "a_normal"), ("4f", "a_tangent"), ("2f", "a_uv"))
_GL_TEXTURE_CUBE_MAP_SEAMLESS = 0x884F


@dataclass(frozen=True)
class _Part:
    """What one chunk draws.

    Attributes
    ----------
    stage : str
        "surface" draws layer by layer, one after the other. A mesh is drawn stage by stage: "depth" of what is
        nearest, then "once" in one pass, or "light", "color" and "over" in two.
    first, count : int
        Vertices of the surface or of a part of the mesh.
    band : Tile
        Part of the image.
    """

    stage: str
    first: int
    count: int
    band: Tile


class BumpMapping:
    """Draws flat surfaces in bands of the image, and meshes some triangles at a time.

    Attributes
    ----------
    notice : str
        What people should know of the last image; empty when it is as they would expect.
    """

    writes_depth = True

    def __init__(self) -> None:
        self._maps = MapTextures()
        self._geometry: _Geometry | None = None
        self._ranges: list[tuple[int, int, int]] = []
        self._parts: list[_Part] = []
        self._targets: Any = None
        self._isovalue = 0.0
        self._mesh: LatestResult[Any, MeshData] = LatestResult("mesh")
        self._own_uv = False
        self.notice = ""

    def plan(self, frame: Frame) -> int:
        """One chunk per row of tiles; for a mesh, one per stage and part of its triangles, 0 while it is made."""
        if not self._update_geometry(frame):
            return 0
        if frame.settings.surface != "mesh":
            self._parts = [_Part("surface", 0, 0, band) for band in bands(frame.tiles)]
        else:
            whole = (0, 0, *frame.size)
            stages = ("light", "color") if frame.settings.two_passes else ("once",)
            self._parts = [
                _Part(stage, first, min(CHUNK_VERTICES, count - first), whole)
                for stage in ("depth", *stages)
                for _, start, count in self._ranges
                for first in range(start, start + count, CHUNK_VERTICES)
            ]
            if frame.settings.two_passes:
                self._parts.append(_Part("over", 0, 0, whole))
                self._layer(frame).clear()
        return max(len(self._parts), 1)

    def draw(self, frame: Frame, chunk: int) -> None:
        """One band, or one part of the mesh."""
        if self._geometry is None or not self._parts:
            return
        part = self._parts[chunk]
        frame.gpu.gl.enable_direct(_GL_TEXTURE_CUBE_MAP_SEAMLESS)
        if part.stage != "surface":
            self._draw_stage(frame, part.stage, part)
            return
        stages = ("light", "color", "over") if frame.settings.two_passes else ("once",)
        for _, first, count in self._ranges:
            if frame.settings.two_passes:
                self._layer(frame).fbo.clear(0.0, 0.0, 0.0, 0.0, depth=1.0, viewport=part.band)
            for stage in stages:
                self._draw_stage(frame, stage, _Part(stage, first, count, part.band))

    # ------------------------------------------------------------------ stages

    def _draw_stage(self, frame: Frame, stage: str, part: _Part) -> None:
        """Draw a part of a surface; in two passes into a target of its own, so that nothing behind is multiplied."""
        gl = frame.gpu.gl
        own = frame.settings.two_passes and stage != "over"
        fbo = self._layer(frame).fbo if own else frame.target.fbo
        fbo.use()
        gl.viewport = (0, 0, *frame.size)
        gl.scissor = part.band
        gl.depth_func = "<="
        gl.enable_only(
            moderngl.DEPTH_TEST if stage in {"depth", "light"} else moderngl.DEPTH_TEST | moderngl.BLEND
        )
        gl.blend_func = _MODULATE if stage == "color" else _OVER
        if stage == "over":
            program = frame.program(GLSL / "fullscreen.vert", _HERE / "layer.frag")
            program.use_texture("t_layer", self._layer(frame).color)
            program.use_texture("t_layer_depth", self._layer(frame).depth)
            frame.gpu.draw_fullscreen(program)
        else:
            assert self._geometry is not None
            array = self._geometry.array(self._program(frame, stage))
            fbo.color_mask = (stage != "depth",) * 4
            array.render(moderngl.TRIANGLES, vertices=part.count, first=part.first)
            fbo.color_mask = (True,) * 4
        gl.scissor = None

    # ------------------------------------------------------------------ what is drawn

    def _update_geometry(self, frame: Frame) -> bool:
        """Have what is drawn on the GPU; False while a task makes it."""
        s = frame.settings
        self.notice = ""
        if s.surface == "mesh":
            return self._update_mesh(frame)
        middle = np.asarray(frame.volume.center)
        pieces = polygons(
            frame.box_corners,
            frame.volume.direction,
            surface=s.surface,
            plane=(s.plane_origin, s.plane_normal),
            up=s.plane_up,
            eye=frame.viewpoint,
        )
        data, self._ranges = vertex_data(pieces, middle, s.subdivisions if s.lighting == "vertex" else 1)
        key = ("polygons", data.tobytes())
        if self._geometry is None or self._geometry.key != key:
            self._replace(_Geometry(frame, key, data) if len(data) else None)
        return True

    def _update_mesh(self, frame: Frame) -> bool:
        s = frame.settings
        key, make = self._request(frame)
        mesh = self._mesh.get(frame.tasks, key, make)
        held = self._geometry
        if mesh is None:
            # while something moves, the mesh that was shown does for the new one
            shows_mesh = held is not None and held.key[:2] == ("mesh", frame.volume)
            return frame.interactive and shows_mesh
        self._isovalue = 0.0 if s.mesh_file else key[2]
        self._own_uv, self.notice = mesh.own_uv, mesh.notice
        if held is None or held.key != key:
            self._replace(_Geometry(frame, key, mesh.data, mesh.faces))
            self._ranges = [(0, 0, mesh.faces.size)]
        return True

    def _request(self, frame: Frame) -> tuple[Any, Work[MeshData]]:
        """What identifies the mesh that is wanted, and how it is made; neither refers to the frame."""
        s, volume = frame.settings, frame.volume
        if s.mesh_file:
            file = Path(s.mesh_file).expanduser()
            changed = file.stat().st_mtime_ns if file.is_file() else 0

            def from_file(_progress: Any, cancel: Any) -> MeshData:
                # here, on a thread that nobody waits for: VTK's readers
                from volviz.meshes.reading import read_triangles

                return file_mesh(volume, read_triangles(str(file), cancel=cancel), file.name)

            return ("mesh", volume, str(file), changed), from_file
        isovalue, stride = frame.isovalues[0], int(s.stride)
        return (
            ("mesh", volume, isovalue, stride),
            lambda _progress, cancel: isosurface_mesh(volume, isovalue, stride, cancel),
        )

    def _replace(self, geometry: _Geometry | None) -> None:
        if self._geometry is not None:
            self._geometry.release()
        self._geometry = geometry

    def _program(self, frame: Frame, stage: str) -> Program:
        """The program of a stage with its textures and uniforms."""
        s = frame.settings
        program = frame.program(
            _HERE / "relief.vert",
            _HERE / ("mesh_depth.frag" if stage == "depth" else "relief.frag"),
            {
                "PASS": {"light": 1, "color": 2}.get(stage, 0),
                "MESH": s.surface == "mesh",
                "MESH_FILE": s.surface == "mesh" and bool(s.mesh_file),
                "SOURCE_DATA": s.normal_source == "data",
                "COLOR_TABLE": s.color_source == "transfer_function",
                "CUT_OUT": bool(s.cut_out),
                "CUBE_MAP": s.normalization == "cube_map",
                "ENCODING": _ENCODINGS[s.encoding],
                "DOT3_ALPHA": s.dot3 == "rgba" and s.display in {"image", "diffuse"},
                "VERTEX_LIGHTING": s.lighting == "vertex" and stage != "depth",
                "SELF_SHADOWING": bool(s.self_shadowing),
                "DISPLAY": _DEBUG_VIEWS[s.display],
            },
            many_vertices=True,
        )
        if "t_normal_map" in program.units:
            texture = self._maps.normal_map(frame.gpu, s.normal_source, s.normal_image, s.encoding)
            program.use_texture("t_normal_map", texture)
        if "t_normalization" in program.units:
            program.use_texture(
                "t_normalization", self._maps.cube_map(frame.gpu, s.cube_map_size, s.encoding)
            )
        program.set(self._uniforms(frame))
        return program

    def _uniforms(self, frame: Frame) -> dict[str, Any]:
        s, volume = frame.settings, frame.volume
        middle = np.asarray(volume.center)
        to_world = np.eye(4)
        to_world[:3, 3] = middle
        low, high = volume.bulk_range
        extent = np.ptp(np.asarray(frame.crop).reshape(3, 2), axis=1) * volume.spacing
        tile = s.tile_size if s.tile_size is not None else float(extent.max()) / TILES
        return {
            "u_relative_to_clip": frame.camera.view_projection @ to_world,
            "u_relative_to_texture": frame.world_to_texture @ to_world,
            "u_relative_light": tuple(frame.light_source - middle),
            "u_relative_eye": tuple(frame.viewpoint - middle),
            "u_tiles_per_world": 1.0 if s.surface == "mesh" and self._own_uv else 1.0 / tile,
            "u_bump_strength": s.bump_strength,
            "u_relief_height": s.bump_strength * RELIEF_VOXELS * volume.mean_spacing,
            "u_green": -1.0 if s.normal_source == "image" and s.flip_green else 1.0,
            "u_lighting": (s.ambient, s.diffuse),
            "u_flat_color": s.flat_color,
            "u_mesh_fraction": (self._isovalue - low) / (high - low) if high > low else 0.0,
            "u_mesh_reach": 0.75 * s.stride * volume.mean_spacing,
        }

    # ------------------------------------------------------------------ objects on the GPU

    def _layer(self, frame: Frame) -> Target:
        self._targets = frame.gpu.targets
        return frame.gpu.targets.get(_purpose(self, interactive=frame.interactive), frame.size)

    def release(self) -> None:
        """Release buffers, textures and the target of two passes; forget the mesh."""
        self._mesh.clear()
        self._replace(None)
        self._maps.release()
        if self._targets is not None:
            for interactive in (False, True):
                self._targets.drop(_purpose(self, interactive=interactive))
            self._targets = None


class _Geometry:
    """Vertices and, for a mesh, triangles on the GPU, with one vertex array per program."""

    def __init__(
        self,
        frame: Frame,
        key: Any,
        data: npt.NDArray[np.float32],
        faces: npt.NDArray[np.int32] | None = None,
    ) -> None:
        self.key = key
        self.elements = len(data) if faces is None else faces.size
        self._gl = frame.gpu.gl
        self._vertices = self._gl.buffer(data.tobytes() or b"\0" * 48)
        self._faces = None if faces is None else self._gl.buffer(faces.tobytes() or b"\0" * 12)
        self._arrays: dict[int, Any] = {}

    def array(self, program: Program) -> Any:
        """The vertex array of a program, with the attributes that it has."""
        array = self._arrays.get(program.gl.glo)
        if array is None:
            layout, names = [], []
            for kind, name in _ATTRIBUTES:
                layout.append(kind if name in program else f"{int(kind[0]) * 4}x")
                names += [name] if name in program else []
            content = [(self._vertices, " ".join(layout), *names)]
            array = self._gl.vertex_array(program.gl, content, self._faces)
            self._arrays[program.gl.glo] = array
        return array

    def release(self) -> None:
        """Release buffers and vertex arrays."""
        for array in self._arrays.values():
            array.release()
        self._arrays.clear()
        self._vertices.release()
        if self._faces is not None:
            self._faces.release()


def bands(tiles: tuple[Tile, ...]) -> list[Tile]:
    """The rows of tiles, each as one rectangle: a polygon costs little, so a single tile is too small a piece."""
    rows: dict[int, Tile] = {}
    for x, y, width, height in tiles:
        left, _, held, _ = rows.get(y, (x, y, 0, height))
        rows[y] = (min(left, x), y, max(left + held, x + width) - min(left, x), height)
    return list(rows.values())


def _purpose(technique: BumpMapping, *, interactive: bool) -> str:
    return f"bump_mapping layer {id(technique)} {'interactive' if interactive else 'full'}"
