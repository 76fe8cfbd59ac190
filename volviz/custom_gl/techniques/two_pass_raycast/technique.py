"""Two-pass ray casting: the first pass keeps one end of every ray, the second marches to it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import moderngl
import numpy as np

from volviz.custom_gl.ray_march import march_program
from volviz.custom_gl.shader_source import GLSL

if TYPE_CHECKING:
    from volviz.custom_gl.gpu.context import Gpu
    from volviz.custom_gl.gpu.programs import Program
    from volviz.custom_gl.gpu.targets import Target
    from volviz.custom_gl.technique import Frame

_HERE = Path(__file__).parent
_BOX = _HERE / "box.vert"

#: Twelve triangles.
BOX_VERTICES = 36


class TwoPassRaycast:
    """Draws the box's faces into a target of positions, then marches between them and the other faces."""

    def __init__(self) -> None:
        self._gpu: Gpu | None = None

    def plan(self, frame: Frame) -> int:
        """One chunk for the first pass, then one per tile."""
        self._gpu = frame.gpu
        return 1 + len(frame.tiles)

    def draw(self, frame: Frame, chunk: int) -> None:
        """The first pass, or one tile of the second."""
        if chunk == 0:
            self._draw_points(frame)
            return
        frame.gpu.gl.scissor = frame.tiles[chunk - 1]
        if frame.settings.display == "image":
            self._march(frame)
        else:
            self._display(frame)

    # ------------------------------------------------------------------ passes

    def _draw_points(self, frame: Frame) -> None:
        display = frame.settings.display
        entries = display == "entry" or (display == "image" and entries_first(frame))
        target = self._points(frame)
        target.clear()
        target.fbo.use()
        self._draw_faces(frame, frame.program(_BOX, _HERE / "points.frag"), front=entries)

    def _march(self, frame: Frame) -> None:
        reverse = entries_first(frame)
        program = march_program(frame, _BOX, _HERE / "two_pass.frag", {"REVERSE": reverse})
        program.use_texture("t_points", self._points(frame).color)
        self._draw_faces(frame, program, front=not reverse)

    def _display(self, frame: Frame) -> None:
        program = frame.program(GLSL / "fullscreen.vert", _HERE / "display.frag")
        program.set({"u_inside": frame.settings.display == "entry" and eye_is_inside(frame)})
        program.use_texture("t_points", self._points(frame).color)
        frame.gpu.draw_fullscreen(program)

    def _draw_faces(self, frame: Frame, program: Program, *, front: bool) -> None:
        """The faces of the box that look towards the eye, or those that look away from it."""
        gl = frame.gpu.gl
        left_handed = np.linalg.det(frame.volume.index_to_world[:3, :3]) < 0
        gl.enable_only(moderngl.CULL_FACE)
        gl.cull_face = "front" if front == left_handed else "back"
        frame.gpu.draw_triangles(program, BOX_VERTICES)
        gl.cull_face = "back"
        gl.enable_only(moderngl.NOTHING)

    # ------------------------------------------------------------------ objects on the GPU

    def _purpose(self, *, interactive: bool) -> str:
        return f"two_pass_raycast points {id(self)} {'interactive' if interactive else 'full'}"

    def _points(self, frame: Frame) -> Target:
        """Positions of the first pass: of the frame's size, so that the window's pixels are its texels."""
        purpose = self._purpose(interactive=frame.interactive)
        return frame.gpu.targets.get(purpose, frame.size, depth=False, half=frame.settings.half_float)

    def release(self) -> None:
        """Release the targets of the first pass."""
        if self._gpu is not None:
            for interactive in (False, True):
                self._gpu.targets.drop(self._purpose(interactive=interactive))
            self._gpu = None


def entries_first(frame: Frame) -> bool:
    """Whether the first pass draws the entry points: on request, and always from inside the box."""
    return bool(frame.settings.reverse) or eye_is_inside(frame)


def eye_is_inside(frame: Frame) -> bool:
    """Whether rays begin inside the cropped box because the eye is there.

    Parallel rays have no eye: the faces before the near plane are drawn as well and the rays are cut there.
    """
    if frame.camera.parallel:
        return False
    matrix = frame.volume.world_to_index
    index = matrix[:3, :3] @ frame.camera.eye + matrix[:3, 3]
    low, high = np.array(frame.crop).reshape(3, 2).T
    return bool(np.all((index >= low) & (index <= high)))
