"""Half-angle slicing: each slice is drawn for the eye and then for the light (Kniss et al. 2003)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import moderngl
import numpy as np

from volviz.custom_gl.gpu.programs import Program
from volviz.custom_gl.gpu.targets import Target
from volviz.custom_gl.shader_source import GLSL
from volviz.custom_gl.technique import Frame
from volviz.custom_gl.techniques.half_angle.blocks import Visible, VisiblePart
from volviz.custom_gl.techniques.half_angle.light_path import (
    Array,
    Slicing,
    choose_slicing,
    is_inside,
    light_matrix,
    rays_from,
    unit,
)
from volviz.custom_gl.techniques.half_angle.slabs import Slabs

_HERE = Path(__file__).parent

#: Fragments of eye and light together that one chunk may draw: about 20 ms on software OpenGL.
CHUNK_FRAGMENTS = 1_500_000

_FRONT_TO_BACK = (moderngl.ONE_MINUS_DST_ALPHA, moderngl.ONE)
_BACK_TO_FRONT = (moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA)
_ATTENUATE = (moderngl.ZERO, moderngl.SRC_COLOR)

INSIDE = (
    "The light is inside the volume, where half-angle slicing cannot work; it shines from the eye meanwhile."
)
INEXACT = "Light or eye are so close to the volume that some rays meet the slices in the wrong order."


class HalfAngle:
    """Carries the light through the volume in a buffer of its own.

    Attributes
    ----------
    notice : str
        What people should know of the last image; empty when it is as they would expect.
    """

    def __init__(self) -> None:
        self.notice = ""
        self._slabs = Slabs()
        self._visible = VisiblePart()
        self._slicing = Slicing(np.array([0.0, 0.0, 1.0]), True, True)
        self._uniforms: dict[str, Any] = {}
        self._ranges: list[tuple[int, int]] = []
        self._pool: Any = None
        self._eye_inside = False

    # ------------------------------------------------------------------ planning

    def plan(self, frame: Frame) -> int:
        """Ranges of slices; one more chunk shows the light buffer."""
        self._pool = frame.gpu.targets
        self._ranges = []
        visible = self._visible.of(frame)
        if visible is not None and frame.tiles:
            self._arrange(frame, visible)
            self._ranges = self._chunks(frame)
        self._light_buffer(frame).fbo.clear(1.0, 1.0, 1.0, 1.0)
        return len(self._ranges) + 1

    def _arrange(self, frame: Frame, visible: Visible) -> None:
        """Where light and slices are."""
        corners = frame.box_corners
        camera = frame.camera
        eye = _homogeneous(-camera.direction, 0.0) if camera.parallel else _homogeneous(camera.eye, 1.0)
        crop = np.array(frame.crop).reshape(3, 2)
        self._eye_inside = not camera.parallel and is_inside(
            eye, corners, frame.volume.world_to_index, crop[:, 0], crop[:, 1]
        )
        light = _homogeneous(frame.light_position, 1.0)
        self.notice = ""
        headlight = frame.headlight
        if not headlight and is_inside(light, corners, frame.volume.world_to_index, crop[:, 0], crop[:, 1]):
            headlight = True
            self.notice = INSIDE
        # from inside, only the rays of the window count; from outside, those to the box
        eye_rays = _window_rays(frame) if self._eye_inside else rays_from(eye, corners)
        if headlight:
            light, view = eye, camera.direction
            light_rays = eye_rays
            self._slicing = Slicing(-view, True, True)
        else:
            light_rays = rays_from(light, corners)
            center = corners.mean(axis=0)
            view = camera.direction if self._eye_inside else unit(rays_from(eye, center[None])[0])
            self._slicing = choose_slicing(view, light, eye_rays, corners)
        if not self._slicing.exact:
            self.notice = INEXACT
        self._slabs.update(
            frame, self._slicing, view, visible, eye_rays, light_rays, eye_inside=self._eye_inside
        )
        if headlight:
            # what the window does not show casts no visible shadow either
            to_light = camera.view_projection
        else:
            to_light = light_matrix(light, self._slabs.corners, self._buffer_size(frame))
        self._uniforms = self._uniforms_of(frame, eye, light, to_light, headlight=headlight)

    def _uniforms_of(
        self, frame: Frame, eye: Array, light: Array, to_light: Array, *, headlight: bool
    ) -> dict[str, Any]:
        settings = frame.settings
        to_texture = frame.world_to_texture
        return {
            "u_slab": self._slabs.thickness,
            "u_half_vector": tuple(self._slicing.half_vector),
            "u_eye_from": tuple(_through(to_texture, eye)),
            "u_light_from": tuple(_through(to_texture, light)),
            "u_texture_to_light": to_light @ frame.texture_to_world,
            "u_kappa": settings.attenuation_color,
            "u_material_tint": settings.material_tint,
            "u_ambient": settings.ambient,
            "u_scattering": settings.scattering,
            "u_light_centred": tuple((frame.viewpoint if headlight else frame.light_source) - frame.center),
        }

    def _chunks(self, frame: Frame) -> list[tuple[int, int]]:
        count = min(self._slabs.count, frame.settings.slices_shown or self._slabs.count)
        fragments = self._buffer_size(frame) ** 2
        if frame.settings.display == "image":
            fragments += sum(width * height for _, _, width, height in frame.tiles)
        per_chunk = max(CHUNK_FRAGMENTS // fragments, 1)
        return [(start, min(start + per_chunk, count)) for start in range(0, count, per_chunk)]

    # ------------------------------------------------------------------ drawing

    def draw(self, frame: Frame, chunk: int) -> None:
        """A range of slices; the last chunk puts the light buffer into the image when it is to be shown."""
        if chunk < len(self._ranges):
            self._draw_slices(frame, *self._ranges[chunk])
        elif frame.settings.display == "light_buffer":
            program = frame.program(GLSL / "fullscreen.vert", _HERE / "light_buffer.frag")
            program.use_texture("t_light", self._light_buffer(frame).color)
            frame.gpu.draw_fullscreen(program)

    def _draw_slices(self, frame: Frame, start: int, stop: int) -> None:
        gl = frame.gpu.gl
        buffer = self._light_buffer(frame)
        classic = frame.settings.light_blend == "over"
        # with the eye inside, rays begin on the near plane, perhaps between a slab's face and its polygon
        inside = {"EYE_INSIDE": self._eye_inside, "CLIPS_DEPTH": not self._eye_inside}
        scattering = frame.settings.scattering > 0
        eye = self._program(frame, "eye.frag", {"CLASSIC_LIGHT": classic, "SCATTERING": scattering} | inside)
        eye.set({"u_texture_to_pass": frame.texture_to_clip})
        eye.use_texture("t_light", buffer.color)
        light = self._program(frame, "light.frag", {"CLASSIC_LIGHT": classic, "CLIPS_DEPTH": False})
        light.set({"u_texture_to_pass": self._uniforms["u_texture_to_light"]})
        eye_array = self._slabs.array(frame, eye.gl)
        light_array = self._slabs.array(frame, light.gl)
        eye_blend = _FRONT_TO_BACK if self._slicing.front_to_back else _BACK_TO_FRONT
        light_blend = _BACK_TO_FRONT if classic else _ATTENUATE
        visible = frame.settings.display == "image"
        gl.enable_only(moderngl.BLEND)
        gl.blend_equation = moderngl.FUNC_ADD
        for index in range(start, stop):
            first, count = self._slabs.vertices(index)
            if count == 0:
                continue
            if visible:
                frame.target.fbo.use()
                gl.blend_func = eye_blend
                if frame.joint is not None:
                    # the two programs find textures of layers in other units
                    frame.joint.bind(eye, frame)
                    eye.use_texture("t_light", buffer.color)
                eye_array.render(moderngl.TRIANGLES, vertices=count, first=first)
            buffer.fbo.use()
            gl.blend_func = light_blend
            if frame.joint is not None:
                frame.joint.bind(light, frame)
            light_array.render(moderngl.TRIANGLES, vertices=count, first=first)

    def _program(self, frame: Frame, fragment: str, defines: dict[str, object]) -> Program:
        matter = "volume" if frame.joint is None else "layers"
        hooks = {"matter": _HERE / "matter" / f"{matter}.glsl"}
        program = frame.program(_HERE / "slab.vert", _HERE / fragment, defines, hooks)
        program.set(self._uniforms)
        for number in range(1, len(frame.layers)):
            # each layer is lit by the same light
            program.set({"u_light_centred": self._uniforms["u_light_centred"]}, number)
        return program

    # ------------------------------------------------------------------ the light buffer

    def _buffer_size(self, frame: Frame) -> int:
        size = int(frame.settings.light_buffer_size)
        return max(round(size * frame.size[1] / frame.window_size[1]), 32) if frame.interactive else size

    def _light_buffer(self, frame: Frame) -> Target:
        """Light that is left after the slices so far, with linear filter.

        The box's image leaves the outermost pixels white, so that clamped look-ups beside it find white, as
        a white border colour would give.
        """
        size = self._buffer_size(frame)
        target = frame.gpu.targets.get(
            self._purpose(interactive=frame.interactive),
            (size, size),
            depth=False,
            half=frame.settings.light_buffer_precision == "float16",
        )
        target.color.filter = (moderngl.LINEAR, moderngl.LINEAR)
        return target

    def _purpose(self, *, interactive: bool) -> str:
        return f"half_angle light {'interactive' if interactive else 'full'} {id(self)}"

    def release(self) -> None:
        """Release slices and light buffers."""
        self._slabs.release()
        if self._pool is not None:
            for interactive in (False, True):
                self._pool.drop(self._purpose(interactive=interactive))
            self._pool = None


def _homogeneous(vector: Array, w: float) -> Array:
    return np.append(np.asarray(vector, np.float64), w)


def _through(matrix: Array, point: Array) -> Array:
    """A homogeneous point in other coordinates."""
    return np.asarray(matrix @ point)


def _window_rays(frame: Frame) -> Array:
    """World directions of the rays through the corners of the window, shape (4, 3)."""
    inverse = np.linalg.inv(frame.camera.view_projection)
    ends = [np.array([[x, y, z, 1.0] for x in (-1, 1) for y in (-1, 1)]) @ inverse.T for z in (-1, 1)]
    near, far = (points[:, :3] / points[:, 3:] for points in ends)
    return np.asarray(far - near)
