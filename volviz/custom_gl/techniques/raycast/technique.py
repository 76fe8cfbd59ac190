"""Single-pass ray casting: the whole ray in one fragment shader."""

from __future__ import annotations

from pathlib import Path

from volviz.custom_gl.gpu.programs import Program
from volviz.custom_gl.shader_source import GLSL
from volviz.custom_gl.technique import Frame
from volviz.custom_gl.tiled import draw_tile

_FRAGMENT = Path(__file__).parent / "raycast.frag"


class Raycast:
    """Marches one ray per pixel from the box's entry to its exit, tile by tile."""

    def plan(self, frame: Frame) -> int:
        """One chunk per tile."""
        return max(len(frame.tiles), 1)

    def draw(self, frame: Frame, chunk: int) -> None:
        """March the rays of one tile."""
        if frame.tiles:
            draw_tile(frame, self._program(frame), chunk)

    def _program(self, frame: Frame) -> Program:
        settings = frame.settings
        mode = settings.mode
        if mode == "composite" and settings.preintegrated:
            mode = "preintegrated"
        defines = {
            "NEAREST": settings.interpolation == "nearest",
            "SHADING": settings.shading,
            "GRADIENT_OPACITY": settings.gradient_opacity > 0,
        }
        return frame.gpu.programs.get(
            GLSL / "fullscreen.vert", _FRAGMENT, defines, {"mode": f"modes/{mode}.glsl"}
        )

    def release(self) -> None:
        """It holds nothing of its own."""
