"""Makes the frame that a technique draws: what is shown, seen by the camera, at a level of quality."""

from __future__ import annotations

from typing import Any, cast

import numpy as np

from volviz.custom_gl.gpu.context import Gpu
from volviz.custom_gl.gpu.resources import VolumeResources
from volviz.custom_gl.gpu.targets import Target
from volviz.custom_gl.resolve import ResolvedSpec
from volviz.custom_gl.technique import Frame
from volviz.custom_gl.vtk.frame_scheduling import FULL, QualityLevel
from volviz.custom_gl.vtk.frame_uniforms import box_tiles, level_of_detail, shared_uniforms
from volviz.custom_gl.vtk.progressive import jittered_camera
from volviz.custom_gl.vtk.renderer_view import RendererView
from volviz.custom_gl.vtk.window_gpu import NoTextures
from volviz.tasks import Tasks


def frame_size(view: RendererView, level: QualityLevel) -> tuple[int, int]:
    """Width and height of an image of that level, in pixels."""
    width, height, _, _ = view.rectangle()
    return max(round(width * level.fraction), 1), max(round(height * level.fraction), 1)


def make_frame(
    shown: ResolvedSpec,
    view: RendererView,
    gpu: Gpu,
    target: Target,
    textures: VolumeResources | NoTextures,
    *,
    scene_depth: Any,
    level: QualityLevel,
    tile: tuple[int, int],
    tasks: Tasks,
    sequence: int = 0,
) -> Frame:
    """A frame, complete with tiles and uniforms; the target is not cleared.

    Parameters
    ----------
    shown : ResolvedSpec
        What is to be drawn.
    view : RendererView
        Where it is seen from.
    gpu : Gpu
        Of the window, whose context is current.
    target : Target
        Of the size `frame_size` gives for the level.
    textures : VolumeResources or NoTextures
        Of the volume, uploaded.
    scene_depth : moderngl.Texture or None
        Of the opaque geometry.
    level : QualityLevel
        Quality.
    tile : tuple of 2 ints
        Largest width and height of the tiles.
    tasks : Tasks
        Of the technique.
    sequence : int, default: 0
        Number of an image that follows the full one.
    """
    width, height, _, _ = view.rectangle()
    frame = Frame(
        gpu=gpu,
        target=target,
        size=target.size,
        window_size=(width, height),
        volume=shown.volume,
        resources=cast(VolumeResources, textures),
        transfer_function=shown.drawn_function,
        settings=shown.settings,
        common=shown.common,
        isovalues=shown.isovalues,
        unit_distance=shown.unit_distance,
        camera=jittered_camera(view.camera(), target.size, sequence),
        light_position=np.array(shown.light_position),
        light_color=shown.light.color,
        headlight=shown.light.headlight,
        crop=shown.crop,
        planes=shown.clipping.planes,
        scene_depth=scene_depth,
        step_scale=level.step_scale,
        level=0,
        sequence=sequence,
        interactive=level != FULL,
        tiles=(),
        uniforms={},
        tasks=tasks,
        surface_colors=shown.surface_colors,
    )
    frame.level = level_of_detail(frame)
    frame.resources.select(frame.level)
    frame.tiles = box_tiles(frame.box_corners, frame.camera.view_projection, frame.size, tile)
    if shown.info.uses_textures:
        frame.uniforms = shared_uniforms(frame)
    return frame
