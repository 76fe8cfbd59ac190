"""Isosurfaces by ray casting in a single pass."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import moderngl

from volviz.custom_gl.picking import Picked, Sight, surface
from volviz.custom_gl.ray_march import draw_tile
from volviz.custom_gl.shader_source import GLSL, layer_name
from volviz.custom_gl.techniques.isosurface.isovalues import layer_surfaces, shown_surfaces
from volviz.custom_gl.techniques.isosurface.settings import MAX_STEP

if TYPE_CHECKING:
    from volviz.custom_gl.technique import Frame

_FRAGMENT = Path(__file__).parent / "isosurface.frag"
_OF_LAYERS = Path(__file__).parent / "surfaces_of_layers.frag"


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
        display = frame.settings.display
        displays = {
            "DISPLAY_POSITIONS": display == "positions",
            "DISPLAY_NORMALS": display == "normals",
            "DISPLAY_SAMPLES": display == "samples",
        }
        if frame.joint is not None:
            return self._joint_program(frame, displays)
        surfaces = shown_surfaces(frame.isovalues, frame.settings)
        defines = {"SURFACES": len(surfaces.isovalues)} | displays
        program = frame.program(GLSL / "fullscreen.vert", _FRAGMENT, defines)
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

    @staticmethod
    def _joint_program(frame: Frame, displays: dict[str, bool]) -> Any:
        """The program of several layers."""
        defines: dict[str, object] = dict(displays)
        shown = {
            n: layer_surfaces(layer.isovalues, frame.settings, layer.transfer_function, leads=layer.leads)
            for n, layer in enumerate(frame.layers)
            if layer.labels is None and layer.mode == "add"
        }
        for n, surfaces in shown.items():
            defines[layer_name("SURFACES", n)] = len(surfaces.isovalues)
        program = frame.program(GLSL / "fullscreen.vert", _OF_LAYERS, defines, {"shade": "shade/lit.glsl"})
        for n, surfaces in shown.items():
            of = frame.layers[n].volume
            program.set(
                {"u_isovalues": surfaces.fractions(of.bulk_range), "u_surface_colors": surfaces.looks()}, n
            )
        finest = min(min(layer.volume.spacing) for layer in frame.layers)
        program.set(
            {"u_bisections": frame.settings.bisections, "u_step": min(frame.step_world, MAX_STEP * finest)}
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
