"""Techniques that compute every pixel for itself share this: one full-screen draw, cut into tiles by the scissor."""

from __future__ import annotations

from volviz.custom_gl.gpu.programs import Program
from volviz.custom_gl.technique import Frame


def draw_tile(frame: Frame, program: Program, tile: int) -> None:
    """Draw the pixels of one of the frame's tiles with a program from `Frame.program` with ``fullscreen.vert``."""
    gl = frame.gpu.gl
    gl.scissor = frame.tiles[tile]
    frame.gpu.draw_fullscreen(program)
    gl.scissor = None
