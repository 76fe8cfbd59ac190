"""Finished images: what they show, the targets that hold them, and how they come over what VTK has drawn."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import moderngl
import numpy as np

from volviz.custom_gl.gpu.context import Gpu
from volviz.custom_gl.gpu.targets import Target
from volviz.custom_gl.shader_source import GLSL
from volviz.custom_gl.technique import Frame
from volviz.custom_gl.vtk.frame_scheduling import QualityLevel

_PREMULTIPLIED = (moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA)


#: Targets of different sizes that are kept: full, and some levels of interaction.
KEPT = 3


class ImageKey(NamedTuple):
    """What an image shows: equal keys, equal images.

    Attributes
    ----------
    revision : int
        Of the values shown.
    size : tuple of 2 ints
        Width and height of the viewport.
    view, projection : bytes
        Matrices of the camera.
    scene : object
        Opaque geometry (`SceneDepth.key`).
    bricks : int
        Of a volume that is drawn brick by brick, which of them are there (`VolumeTextures.revision`).
    """

    revision: int
    size: tuple[int, int]
    view: bytes
    projection: bytes
    scene: Any
    bricks: int


@dataclass(frozen=True)
class RenderedImage:
    """A finished image and what it shows.

    Attributes
    ----------
    key : ImageKey
        What it shows.
    area : tuple of 4 floats
        Part of it that may hold anything, as fractions: left, bottom, right, top.
    """

    key: ImageKey
    target: Target
    level: QualityLevel
    area: tuple[float, float, float, float]


def area_of(frame: Frame, *, within_tiles: bool) -> tuple[float, float, float, float]:
    """`RenderedImage.area` of a frame; the whole for techniques that draw beyond the frame's tiles."""
    if not within_tiles:
        return 0.0, 0.0, 1.0, 1.0
    if not frame.tiles:
        return 0.0, 0.0, 0.0, 0.0
    tiles = np.array(frame.tiles, float)
    low = tiles[:, :2].min(axis=0) / frame.size
    high = (tiles[:, :2] + tiles[:, 2:]).max(axis=0) / frame.size
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def composite(
    gpu: Gpu,
    target: Target,
    framebuffer: Any,
    viewport: tuple[int, int, int, int],
    scene_depth: Any,
    depth_map: tuple[float, float],
    *,
    writes_depth: bool,
    area: tuple[float, float, float, float] = (0.0, 0.0, 1.0, 1.0),
    average: tuple[Target, int] | None = None,
) -> None:
    """Blend a premultiplied image into a framebuffer, enlarging it when it is smaller than the viewport.

    Parameters
    ----------
    gpu : Gpu
        Resources of the current context.
    target : Target
        The image.
    framebuffer : moderngl.Framebuffer
        VTK's.
    viewport : tuple of 4 ints
        x, y, width, height in it.
    scene_depth : moderngl.Texture or None
        Resolved depth of opaque geometry, for edges of enlarged images.
    depth_map : tuple of 2 floats
        Makes eye depth of window depth: z = a / (b - depth); a = 0 leaves it (parallel projection).
    writes_depth : bool
        Write the image's own depth where it has any.
    area : tuple of 4 floats
        Part of the image outside which it is empty: left, bottom, right, top in 0..1.
    average : (Target, int), optional
        Sum of so many images of the same size, whose mean is shown in the image's place; depths stay.
    """
    gl = gpu.gl
    shown, count = (target, 1) if average is None else average
    enlarge = shown.size != viewport[2:]
    program = gpu.programs.get(
        GLSL / "fullscreen.vert",
        GLSL / "composite.frag",
        {"ENLARGE": enlarge, "SCENE_DEPTH": scene_depth is not None},
    )
    program.set(
        {
            "u_image_size": tuple(float(n) for n in shown.size),
            "u_weight": 1.0 / count,
            "u_depth_map": depth_map,
        }
    )
    framebuffer.use()
    gl.viewport = viewport
    gl.scissor = _within(viewport, area, target.size)
    shown.color.filter = (
        (moderngl.LINEAR, moderngl.LINEAR) if enlarge else (moderngl.NEAREST, moderngl.NEAREST)
    )
    program.use_texture("t_image", shown.color)
    program.use_texture("t_scene_depth", scene_depth if scene_depth is not None else gpu.blank_texture())
    gl.enable_only(moderngl.BLEND)
    gl.blend_func = _PREMULTIPLIED
    gl.blend_equation = moderngl.FUNC_ADD
    framebuffer.depth_mask = False
    gpu.draw_fullscreen(program)
    shown.color.filter = (moderngl.NEAREST, moderngl.NEAREST)
    gl.scissor = viewport
    if writes_depth and target.depth is not None:
        _write_depth(gpu, target, framebuffer)
    gl.enable_only(moderngl.NOTHING)
    gl.scissor = None


def add_image(gpu: Gpu, image: Target, total: Target) -> None:
    """Add an image to a sum of images of the same size."""
    gl = gpu.gl
    program = gpu.programs.get(
        GLSL / "fullscreen.vert", GLSL / "composite.frag", {"ENLARGE": False, "SCENE_DEPTH": False}
    )
    program.set({"u_image_size": tuple(float(n) for n in image.size), "u_weight": 1.0})
    total.fbo.use()
    gl.viewport = (0, 0, *total.size)
    gl.scissor = None
    program.use_texture("t_image", image.color)
    gl.enable_only(moderngl.BLEND)
    gl.blend_func = (moderngl.ONE, moderngl.ONE)
    gl.blend_equation = moderngl.FUNC_ADD
    gpu.draw_fullscreen(program)
    gl.enable_only(moderngl.NOTHING)


def _within(
    viewport: tuple[int, int, int, int], area: tuple[float, float, float, float], size: tuple[int, int]
) -> tuple[int, int, int, int]:
    """The pixels of a viewport that a part of the image covers, and those that its outermost pixels reach."""
    x, y, width, height = viewport
    reach_x, reach_y = width / size[0], height / size[1]
    left = max(math.floor(area[0] * width - reach_x), 0)
    bottom = max(math.floor(area[1] * height - reach_y), 0)
    right = min(math.ceil(area[2] * width + reach_x), width)
    top = min(math.ceil(area[3] * height + reach_y), height)
    return x + left, y + bottom, max(right - left, 1), max(top - bottom, 1)


def _write_depth(gpu: Gpu, target: Target, framebuffer: Any) -> None:
    gl = gpu.gl
    program = gpu.programs.get(GLSL / "fullscreen.vert", GLSL / "depth_out.frag")
    program.use_texture("t_image_depth", target.depth)
    # colours stay by blending: a colour mask does not reach framebuffers that moderngl has only detected
    gl.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
    gl.blend_func = (moderngl.ZERO, moderngl.ONE)
    gl.depth_func = "<="
    framebuffer.depth_mask = True
    gpu.draw_fullscreen(program)
    framebuffer.depth_mask = False
    gl.depth_func = "<"


class PooledTargets:
    """The last few targets of one owner; older ones are dropped."""

    def __init__(self, owner: int) -> None:
        self._owner = owner
        self._names: dict[Target, str] = {}

    def get(self, gpu: Gpu, purpose: str, size: tuple[int, int], shown: Target | None) -> Target:
        """A target to draw into; `shown`, which holds the image now shown, is not dropped for it."""
        name = f"{purpose} {size[0]} x {size[1]} of {self._owner}"
        target = gpu.targets.get(name, size)
        # the one used last stands last
        self._names.pop(target, None)
        self._names[target] = name
        for old in list(self._names)[:-KEPT]:
            if old is not shown:
                gpu.targets.drop(self._names.pop(old))
        return target

    def release(self, gpu: Gpu) -> None:
        """Drop all."""
        for name in self._names.values():
            gpu.targets.drop(name)
        self._names.clear()
