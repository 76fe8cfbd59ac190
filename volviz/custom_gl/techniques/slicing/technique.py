"""View-aligned slicing: textured polygons perpendicular to the view, blended by the hardware."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt

from volviz.custom_gl.gpu.programs import Program
from volviz.custom_gl.gpu.targets import Target, TargetPool
from volviz.custom_gl.ray_march import JOINT_COMPOSITES
from volviz.custom_gl.shader_source import GLSL
from volviz.custom_gl.technique import Frame
from volviz.custom_gl.techniques.slicing.polygons import SlicePolygons

_HERE = Path(__file__).parent

#: Fragments that one chunk may draw: about 20 ms on software OpenGL.
CHUNK_FRAGMENTS = 1_500_000

_OVER = (moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA)
_ADD = (moderngl.ONE, moderngl.ONE)

#: Per mode: blend file, blend function, blend equation, value the accumulation target starts with.
#: Compositing blends into the frame's own target, the others into one that is resolved at the end: of several layers
#: once for each, since each has a scalar of its own.
_MODES: dict[str, tuple[str, tuple[int, int], int, float | None]] = {
    "composite": ("composite", _OVER, moderngl.FUNC_ADD, None),
    "additive": ("additive", _ADD, moderngl.FUNC_ADD, 0.0),
    "average": ("average", _ADD, moderngl.FUNC_ADD, 0.0),
    "maximum": ("extreme", _ADD, moderngl.MAX, -1.0),
    "minimum": ("extreme", _ADD, moderngl.MIN, 2.0),
    "attenuated_maximum": ("attenuated", _ADD, moderngl.MAX, -1.0),
}


@dataclass(frozen=True)
class _Part:
    """Slices `start` to `stop` - 1 in a tile, of all layers together or of one of them.

    Attributes
    ----------
    layer : int
        Number of the layer; 0 where they are drawn together.
    first, last : bool
        Whether the layer begins or ends with this part.
    """

    layer: int
    tile: tuple[int, int, int, int]
    start: int
    stop: int
    first: bool
    last: bool


class Slicing:
    """Draws slices back to front, tile by tile and some slices at a time."""

    #: Nothing is drawn outside the frame's tiles.
    within_tiles = True

    def __init__(self) -> None:
        self.polygons = SlicePolygons()
        self._arrays: dict[int, tuple[Any, Any]] = {}
        self._parts: list[_Part] = []
        self._pool: TargetPool | None = None
        self._purposes: set[str] = set()

    def plan(self, frame: Frame) -> int:
        """One chunk for each part of a tile's slices, and a last one."""
        self.polygons.update(frame)
        self._parts = []
        if frame.settings.display != "wireframe":
            ranges = []
            for tile in frame.tiles:
                per_part = max(CHUNK_FRAGMENTS // (tile[2] * tile[3]), 1)
                starts = range(0, self.polygons.count, per_part)
                ranges += [(tile, start, min(start + per_part, self.polygons.count)) for start in starts]
            last = len(ranges) - 1
            self._parts = [
                _Part(layer, *part, first=n == 0, last=n == last)
                for layer in self._drawn_apart(frame)
                for n, part in enumerate(ranges)
            ]
        return len(self._parts) + 1

    @staticmethod
    def _drawn_apart(frame: Frame) -> list[int]:
        """Numbers of the layers that are drawn one after the other."""
        if frame.joint is None or frame.settings.mode in JOINT_COMPOSITES:
            return [0]
        return [n for n, layer in enumerate(frame.layers) if layer.labels is None and layer.mode == "add"]

    def draw(self, frame: Frame, chunk: int) -> None:
        """Some slices of one tile; the last chunk draws the outlines."""
        if chunk < len(self._parts):
            part = self._parts[chunk]
            if part.first:
                self._begin(frame)
            self._draw_part(frame, part)
            if part.last and frame.settings.mode != "composite":
                self._resolve(frame, part.layer)
            return
        if frame.settings.display != "image":
            self._draw_outlines(frame)

    # ------------------------------------------------------------------ slices

    def _begin(self, frame: Frame) -> None:
        start = _MODES[frame.settings.mode][3]
        if start is not None:
            self._accumulation(frame).fbo.clear(start, start, start, start)
        if frame.settings.mode == "attenuated_maximum":
            self._integral(frame).fbo.clear(0.0, 0.0, 0.0, 0.0)

    def _draw_part(self, frame: Frame, part: _Part) -> None:
        gl = frame.gpu.gl
        mode = frame.settings.mode
        blend, function, equation, first_value = _MODES[mode]
        program = self._program(frame, blend, part.layer)
        target = frame.target if first_value is None else self._accumulation(frame)
        target.fbo.use()
        gl.scissor = part.tile
        gl.enable_only(moderngl.BLEND)
        if mode == "attenuated_maximum":
            self._draw_attenuated(frame, program, part)
        else:
            gl.blend_func, gl.blend_equation = function, equation
            self._render(frame, program, part.start, part.stop)
        gl.blend_equation = moderngl.FUNC_ADD
        gl.scissor = None

    def _draw_attenuated(self, frame: Frame, program: Program, part: _Part) -> None:
        """Front to back, each slice first into the maximum and then into the integral it is weakened by."""
        gl = frame.gpu.gl
        adding = self._program(frame, "integral", part.layer)
        integral, extreme = self._integral(frame), self._accumulation(frame)
        count = self.polygons.count
        for step in range(part.start, part.stop):
            s = count - 1 - step
            for target, drawing, equation in (
                (extreme, program, moderngl.MAX), (integral, adding, moderngl.FUNC_ADD),
            ):  # fmt: skip
                target.fbo.use()
                gl.scissor = part.tile
                gl.blend_func, gl.blend_equation = _ADD, equation
                if target is extreme:
                    drawing.use_texture("t_integral", integral.color, part.layer)
                self._render(frame, drawing, s, s + 1)

    def _render(self, frame: Frame, program: Program, start: int, stop: int) -> None:
        first = self.polygons.first
        vertices = int(first[stop] - first[start])
        if vertices:
            self._array(frame, program).render(moderngl.TRIANGLES, vertices=vertices, first=int(first[start]))

    def _program(self, frame: Frame, blend: str, layer: int) -> Program:
        hooks: dict[str, str | Path] = {"blend": _HERE / "blends" / f"{blend}.glsl"}
        joint = None if frame.joint is None else JOINT_COMPOSITES.get(frame.settings.mode)
        if joint is not None:
            hooks["composite"] = joint
        samples = "volume" if frame.joint is None else "one_layer" if joint is None else "layers"
        hooks["samples"] = _HERE / "samples" / f"{samples}.glsl"
        program = frame.program(GLSL / "polygon.vert", _HERE / "slicing.frag", {"DRAWN": layer}, hooks)
        to_clip = frame.texture_to_clip
        program.set(
            {
                "u_near_plane": tuple(to_clip[2] + to_clip[3]),
                "u_slice_distance": self.polygons.distance,
                "u_perspective": not frame.camera.parallel,
                "u_eye_texture": tuple(self._eye(frame)),
                "u_direction_texture": tuple(frame.world_to_texture[:3, :3] @ frame.camera.direction),
                "u_texture_to_world_vector": frame.texture_to_world[:3, :3],
            }
        )
        return program

    @staticmethod
    def _eye(frame: Frame) -> npt.NDArray[np.float64]:
        """The eye in texture coordinates."""
        to_texture = frame.world_to_texture
        return np.asarray(to_texture[:3, :3] @ frame.camera.eye + to_texture[:3, 3])

    # ------------------------------------------------------------------ the other chunks

    def _resolve(self, frame: Frame, layer: int) -> None:
        gl = frame.gpu.gl
        mode = frame.settings.mode
        defines = {
            "RESOLVE_ADDITIVE": mode == "additive", "RESOLVE_AVERAGE": mode == "average", "DRAWN": layer,
        }  # fmt: skip
        program = frame.program(GLSL / "fullscreen.vert", _HERE / "resolve.frag", defines)
        frame.target.fbo.use()
        program.use_texture("t_accumulated", self._accumulation(frame).color)
        # colours of layers are added, up to white
        passes = [(program, moderngl.FUNC_ADD)]
        if frame.joint is not None:
            white = frame.program(GLSL / "fullscreen.vert", _HERE / "outline.frag")
            white.set({"u_outline_color": (1.0, 1.0, 1.0, 1.0)})
            passes.append((white, moderngl.MIN))
        gl.enable_only(moderngl.BLEND if frame.joint is not None else moderngl.NOTHING)
        gl.blend_func = _ADD
        for drawing, equation in passes:
            gl.blend_equation = equation
            for tile in frame.tiles:
                gl.scissor = tile
                frame.gpu.draw_fullscreen(drawing)
        gl.blend_equation = moderngl.FUNC_ADD
        gl.enable_only(moderngl.NOTHING)
        gl.scissor = None

    def _draw_outlines(self, frame: Frame) -> None:
        gl = frame.gpu.gl
        program = frame.program(GLSL / "polygon.vert", _HERE / "outline.frag")
        # the more slices, the fainter each: together they must not fill the image
        alpha = min(1.0, 0.12 + 8.0 / max(self.polygons.count, 1))
        program.set({"u_outline_color": (0.25 * alpha, 0.75 * alpha, 1.0 * alpha, alpha)})
        gl.enable_only(moderngl.BLEND)
        gl.blend_func = _OVER
        buffer, vertices = self.polygons.outlines(frame)
        array = gl.vertex_array(program.gl, [(buffer, "3f", "a_position")])
        array.render(moderngl.LINES, vertices=vertices)
        array.release()

    # ------------------------------------------------------------------ objects on the GPU

    def _accumulation(self, frame: Frame) -> Target:
        return self._target(frame, "accumulation")

    def _integral(self, frame: Frame) -> Target:
        return self._target(frame, "integral")

    def _target(self, frame: Frame, purpose: str) -> Target:
        self._pool = frame.gpu.targets
        name = f"slicing {purpose} {id(self)} {frame.interactive}"
        self._purposes.add(name)
        return self._pool.get(name, frame.size, depth=False)

    def _array(self, frame: Frame, program: Program) -> Any:
        """The vertex array of a program, remade when the buffer was."""
        buffer = self.polygons.buffer
        held = self._arrays.get(program.gl.glo)
        if held is not None and held[0] is buffer:
            return held[1]
        if held is not None:
            held[1].release()
        array = frame.gpu.gl.vertex_array(program.gl, [(buffer, "3f", "a_position")])
        self._arrays[program.gl.glo] = (buffer, array)
        return array

    def release(self) -> None:
        """Release buffers, vertex arrays and targets."""
        if self._pool is not None:
            for purpose in self._purposes:
                self._pool.drop(purpose)
            self._purposes.clear()
        for _, array in self._arrays.values():
            array.release()
        self._arrays.clear()
        self.polygons.release()
