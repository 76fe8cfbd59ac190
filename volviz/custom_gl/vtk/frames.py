"""Makes the frame that a technique draws: what is shown, seen by the camera, at a level of quality."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

import numpy as np

from volviz.custom_gl.gpu.context import Gpu
from volviz.custom_gl.gpu.layer_resources import LayerResources
from volviz.custom_gl.gpu.resources import VolumeResources
from volviz.custom_gl.gpu.targets import Target
from volviz.custom_gl.layer_set import ResolvedLabels, ResolvedLayer
from volviz.custom_gl.resolve import ResolvedSpec
from volviz.custom_gl.technique import Frame
from volviz.custom_gl.vtk.frame_scheduling import FULL, QualityLevel
from volviz.custom_gl.vtk.frame_uniforms import box_tiles, box_uniforms, level_of_detail, shared_uniforms
from volviz.custom_gl.vtk.progressive import jittered_camera
from volviz.custom_gl.vtk.renderer_view import RendererView
from volviz.custom_gl.vtk.window_gpu import Textures
from volviz.model.clipping import Clipping
from volviz.tasks import Tasks
from volviz.volume_data.brick_cache.selection import BrickView


def frame_size(view: RendererView, level: QualityLevel) -> tuple[int, int]:
    """Width and height of an image of that level, in pixels."""
    width, height, _, _ = view.rectangle()
    return max(round(width * level.fraction), 1), max(round(height * level.fraction), 1)


def brick_view(shown: ResolvedSpec, view: RendererView) -> BrickView:
    """From where the bricks of what is shown are seen, at full resolution."""
    camera, volume = view.camera(), shown.drawn_volume
    height = view.rectangle()[1]
    return BrickView(
        index_to_clip=camera.view_projection @ volume.index_to_world,
        eye=camera.eye,
        direction=camera.direction,
        index_to_world=volume.index_to_world,
        pixel=float(2.0 / (camera.projection[1, 1] * height)),
        parallel=camera.parallel,
        crop=np.array(shown.drawn_crop).reshape(3, 2),
        planes=shown.drawn_planes,
    )


def make_frame(
    shown: ResolvedSpec,
    view: RendererView,
    gpu: Gpu,
    target: Target,
    textures: Textures,
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
    textures : VolumeResources, LayerResources or NoTextures
        Of what is shown, uploaded.
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
    joint = textures if isinstance(textures, LayerResources) else None
    volume = shown.drawn_volume
    frame = Frame(
        gpu=gpu,
        target=target,
        size=target.size,
        window_size=(width, height),
        volume=volume,
        resources=cast(VolumeResources, textures if joint is None else joint.layers[0]),
        transfer_function=shown.layers[0].drawn_function if shown.layers else shown.drawn_function,
        settings=shown.settings,
        common=shown.common,
        isovalues=shown.isovalues,
        unit_distance=shown.unit_distance_of(shown.volumes[0]),
        camera=jittered_camera(view.camera(), target.size, sequence),
        light_position=np.array(shown.light_seen_from(view.camera().view)),
        light_color=shown.light.color,
        headlight=shown.light.headlight,
        crop=shown.drawn_crop,
        planes=shown.drawn_planes,
        scene_depth=scene_depth,
        step_scale=level.step_scale * textures.voxel_scale,
        level=0,
        sequence=sequence,
        interactive=level != FULL,
        tiles=(),
        uniforms={},
        tasks=tasks,
        surface_colors=shown.surface_colors,
        joint=joint,
    )
    frame.level = level_of_detail(frame)
    frame.resources.select(frame.level)
    frame.tiles = box_tiles(frame.box_corners, frame.camera.view_projection, frame.size, tile)
    if joint is not None:
        _add_layers(frame, shown, joint)
    elif shown.info.uses_textures:
        frame.uniforms = shared_uniforms(frame)
    return frame


def _add_layers(frame: Frame, shown: ResolvedSpec, joint: LayerResources) -> None:
    """Give a frame its layers and all uniforms."""
    frame.layers = tuple(
        replace(
            frame,
            volume=layer.volume,
            resources=cast(VolumeResources, resources),
            transfer_function=layer.drawn_function if isinstance(layer, ResolvedLayer) else layer.FUNCTION,
            unit_distance=shown.unit_distance_of(layer.volume),
            crop=shown.crop if shown.is_one_lattice else Clipping().crop_within(layer.volume.dimensions),
            mode=layer.mode,
            isovalues=shown.isovalues_of(layer),
            leads=shown.leads(layer),
            labels=layer.shown if isinstance(layer, ResolvedLabels) else None,
            joined_to=frame,
            joint=None,
        )
        for layer, resources in zip(shown.all_layers, joint.layers, strict=True)
    )
    for layer_frame in frame.layers:
        own = shared_uniforms(layer_frame)
        layer_frame.uniforms = own | {"u_lattice_low": own["u_box_low"], "u_lattice_high": own["u_box_high"]}
    for layer_frame, shared in zip(frame.layers, joint.lattice_uniforms(frame), strict=True):
        layer_frame.uniforms |= shared
    frame.uniforms = frame.layers[0].uniforms | box_uniforms(frame)
