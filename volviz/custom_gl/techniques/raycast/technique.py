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
        # opacities per step in the table save a power per sample; gradient opacity must act before the correction
        per_step = mode == "composite" and not settings.gradient_opacity
        program = frame.program(
            GLSL / "fullscreen.vert",
            _FRAGMENT,
            {"TABLE_PER_STEP": per_step},
            {"mode": f"modes/{mode}.glsl"},
        )
        if per_step:
            length = frame.step_world / frame.unit_distance
            table = frame.resources.table_per_length(frame.transfer_function, length)
            program.use_texture("t_table", table)
            program.set({"u_inverse_unit_distance": 1.0 / frame.step_world})
        return program

    def release(self) -> None:
        """It holds nothing of its own."""
