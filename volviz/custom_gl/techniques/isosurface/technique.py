"""Isosurfaces by ray casting in a single pass."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import moderngl

from volviz.custom_gl.picking import Picked, Sight, surface
from volviz.custom_gl.ray_march import draw_tile
from volviz.custom_gl.shader_source import GLSL
from volviz.custom_gl.techniques.isosurface.isovalues import shown_surfaces
from volviz.custom_gl.techniques.isosurface.settings import MAX_STEP

if TYPE_CHECKING:
    from volviz.custom_gl.technique import Frame

_FRAGMENT = Path(__file__).parent / "isosurface.frag"


class Isosurface:
    """Finds the surfaces along one ray per pixel, tile by tile, and writes their depth."""

    #: The host puts the depth of the surfaces into VTK's depth buffer.
    writes_depth = True

    def plan(self, frame: Frame) -> int:
        """One chunk per tile."""
        return max(len(frame.tiles), 1)

    def draw(self, frame: Frame, chunk: int) -> None:
        """Find the surfaces in one tile."""
        if not frame.tiles:
            return
        gl = frame.gpu.gl
        gl.enable_only(moderngl.DEPTH_TEST)
        # depth is written only while it is tested
        gl.depth_func = "1"
        draw_tile(frame, self._program(frame), chunk)
        gl.depth_func = "<"
        gl.enable_only(moderngl.NOTHING)

    def _program(self, frame: Frame) -> Any:
        surfaces = shown_surfaces(frame.isovalues, frame.settings)
        display = frame.settings.display
        program = frame.program(
            GLSL / "fullscreen.vert",
            _FRAGMENT,
            {
                "SURFACES": len(surfaces.isovalues),
                "DISPLAY_POSITIONS": display == "positions",
                "DISPLAY_NORMALS": display == "normals",
                "DISPLAY_SAMPLES": display == "samples",
            },
        )
        program.use_texture("t_distance", frame.resources.isovalue_distance(surfaces.isovalues))
        program.set(
            {
                "u_isovalues": surfaces.fractions(frame.volume.bulk_range),
                "u_surface_colors": surfaces.looks(),
                "u_bisections": frame.settings.bisections,
                "u_step": min(frame.step_world, MAX_STEP * min(frame.volume.spacing)),
            }
        )
        return program

    def release(self) -> None:
        """It holds nothing of its own."""


def pick(sight: Sight) -> Picked | None:
    """The surface point that is seen along a ray: where half of the light is stopped, else the nearest."""
    surfaces = shown_surfaces(sight.isovalues, sight.settings)
    return surface(
        sight,
        surfaces.isovalues,
        opacities=surfaces.opacities,
        step=sight.settings.step,
        interpolation=sight.settings.interpolation,
    )
