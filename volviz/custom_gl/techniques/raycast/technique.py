"""Single-pass ray casting: the whole ray in one fragment shader."""

from __future__ import annotations

from pathlib import Path

from volviz.custom_gl.ray_march import draw_tile, march_program
from volviz.custom_gl.shader_source import GLSL
from volviz.custom_gl.technique import Frame

_FRAGMENT = Path(__file__).parent / "raycast.frag"


class Raycast:
    """Marches one ray per pixel from the box's entry to its exit, tile by tile."""

    #: Nothing is drawn outside the frame's tiles.
    within_tiles = True

    def plan(self, frame: Frame) -> int:
        """One chunk per tile."""
        return max(len(frame.tiles), 1)

    def draw(self, frame: Frame, chunk: int) -> None:
        """March the rays of one tile."""
        if frame.tiles:
            draw_tile(frame, march_program(frame, GLSL / "fullscreen.vert", _FRAGMENT), chunk)

    def release(self) -> None:
        """It holds nothing of its own."""
