"""Everything we hold in one OpenGL context: programs, textures, targets, and what the driver can do."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt

from volviz.custom_gl.gpu.programs import Program, ProgramCache
from volviz.custom_gl.gpu.targets import TargetPool
from volviz.custom_gl.shader_source import GLSL
from volviz.errors import RenderError
from volviz.volume_data.budgets import budgets

#: Words in the renderer's name that give software OpenGL away.
_SOFTWARE = ("llvmpipe", "softpipe", "swrast", "swiftshader", "software", "swr")

#: Set to anything, every OpenGL counts as a graphics card's: the code for those can be run and tested without one.
PRETEND_HARDWARE = "VOLVIZ_PRETEND_HARDWARE"


@dataclass(frozen=True)
class Limits:
    """What the driver says of itself."""

    vendor: str
    renderer: str
    version: str
    max_3d_texture: int
    max_texture: int
    max_point_size: float

    @property
    def software(self) -> bool:
        """Whether the image is computed on the CPU: the one answer that all code for software OpenGL asks for."""
        return not os.environ.get(PRETEND_HARDWARE) and any(
            word in self.renderer.lower() for word in _SOFTWARE
        )


class Gpu:
    """Resources of one OpenGL context, made for the context that is current.

    moderngl keeps a process-wide default context; this object keeps the one that belongs to *its* OpenGL
    context and never asks for the default again.
    """

    def __init__(self) -> None:
        try:
            moderngl.init_context()
            self.gl: Any = moderngl.get_context()
        except Exception as error:  # noqa: BLE001 - moderngl raises plain ones
            raise RenderError(
                f"OpenGL 3.3 is needed to draw, and this system has none that works: {error}."
            ) from None
        info = self.gl.info
        self.limits = Limits(
            vendor=str(info["GL_VENDOR"]),
            renderer=str(info["GL_RENDERER"]),
            version=str(info["GL_VERSION"]),
            max_3d_texture=int(info["GL_MAX_3D_TEXTURE_SIZE"]),
            max_texture=int(info["GL_MAX_TEXTURE_SIZE"]),
            max_point_size=float(info["GL_POINT_SIZE_RANGE"][1]),
        )
        if self.gl.version_code < 330:
            raise RenderError(
                f"OpenGL 3.3 is needed, this system has {self.limits.version}; update the graphics driver."
            )
        self.programs = ProgramCache(self.gl, forwards_uniforms=self.limits.software)
        self.targets = TargetPool(self.gl)
        self._bufferless: dict[int, Any] = {}
        self._blank: Any = None
        #: Number of uploads to textures and tables since the start; tests read it.
        self.uploads = 0

    @property
    def max_texture_bytes(self) -> int:
        """Largest size of one volume texture in bytes, as the user allows (`volviz.volume_data.budgets`)."""
        return budgets().texture_bytes

    @cached_property
    def filters_bytes_precisely(self) -> bool:
        """Whether linear filtering between two bytes gives more than the bytes' own 256 steps.

        A strip is drawn from a two-texel texture with the neighbouring values 100 and 110 and compared with
        exact interpolation. Who pretends to have a graphics card gets its 8-bit textures, however they are filtered.
        """
        if os.environ.get(PRETEND_HARDWARE):
            return True
        texture = self.gl.texture3d((2, 1, 1), 1, bytes([100, 110]), alignment=1)
        texture.repeat_x = texture.repeat_y = texture.repeat_z = False
        target = self.gl.texture((256, 1), 4, dtype="f4")
        fbo = self.gl.framebuffer([target])
        program = self.programs.get(GLSL / "fullscreen.vert", GLSL / "filter_probe.frag")
        try:
            fbo.use()
            self.gl.viewport = (0, 0, 256, 1)
            program.use_texture("t_probe", texture)
            self.draw_fullscreen(program)
            strip = np.frombuffer(target.read(), np.float32).reshape(256, 4)[:, 0] * 255
        finally:
            for item in (fbo, target, texture):
                item.release()
        x = np.clip((np.arange(256) + 0.5) / 256 * 2 - 0.5, 0, 1)
        # graphics cards interpolate with 8-bit weights: 10/256 of a byte
        return bool(np.abs(strip - (100 + 10 * x)).max() < 0.1)

    def draw_fullscreen(self, program: Program) -> None:
        """Draw one triangle over the whole viewport; the vertex shader is ``glsl/fullscreen.vert``."""
        self.draw_triangles(program, 3)

    def draw_triangles(self, program: Program, vertices: int) -> None:
        """Draw triangles whose vertex shader makes the positions from ``gl_VertexID`` alone."""
        key = program.gl.glo
        array = self._bufferless.get(key)
        if array is None:
            array = self._bufferless[key] = self.gl.vertex_array(program.gl, [])
        array.render(moderngl.TRIANGLES, vertices=vertices)

    def blank_texture(self) -> Any:
        """A 1 x 1 texture for samplers that have nothing to read."""
        if self._blank is None:
            self._blank = self.gl.texture((1, 1), 4, b"\0" * 4)
        return self._blank

    def forget_programs(self) -> None:
        """Release all programs and what hangs on them, after shader text has changed."""
        for array in self._bufferless.values():
            array.release()
        self._bufferless.clear()
        self.programs.forget()

    def table_texture(self, table: npt.NDArray[np.float32]) -> Any:
        """A clamped RGBA32F texture from an array of shape (H, W, 4), with a linear filter when it has two rows."""
        height, width, _ = table.shape
        texture = self.gl.texture(
            (width, height), 4, np.ascontiguousarray(table, np.float32).tobytes(), dtype="f4"
        )
        kind = moderngl.LINEAR if height > 1 else moderngl.NEAREST
        texture.filter = (kind, kind)
        texture.repeat_x = texture.repeat_y = False
        self.uploads += 1
        return texture

    def segments_texture(self, texels: npt.NDArray[np.int32]) -> Any:
        """A texture of `segment_texels`, perhaps in several rows."""
        height, width, _ = texels.shape
        texture = self.gl.texture((width, height), 4, np.ascontiguousarray(texels).tobytes(), dtype="i4")
        texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        texture.repeat_x = texture.repeat_y = False
        self.uploads += 1
        return texture

    def release(self) -> None:
        """Release everything; the context must be current."""
        self.forget_programs()
        self.targets.release()
        if self._blank is not None:
            self._blank.release()
            self._blank = None


def segment_texels(table: npt.NDArray[np.float32]) -> npt.NDArray[np.int32]:
    """A table of colours as segments between neighbouring entries: both ends in one texel, which one lookup reads.

    Parameters
    ----------
    table : ndarray of shape (1, N, 4), float32
        Straight red, green, blue, opacity in 0..1; at least two entries.

    Returns
    -------
    ndarray of shape (1, N - 1, 4), int32
        For the first and the second end: red in the lowest 13 bits, then 13 of green and the lower 6 of blue; for both
        ends: the bits of the opacity as a 32-bit float, in whose lowest 7 stand the upper ones of blue.
    """
    colors = np.rint(np.clip(table[..., :3], 0.0, 1.0) * 8191.0).astype(np.uint32)
    red, green, blue = np.moveaxis(colors, -1, 0)
    words = red | green << np.uint32(13) | (blue & np.uint32(63)) << np.uint32(26)
    opacities = np.ascontiguousarray(table[..., 3], np.float32).view(np.uint32)
    # to the nearest of those that are left
    opacities = (opacities + np.uint32(64)) & ~np.uint32(127) | blue >> np.uint32(6)
    ends = [words[:, :-1], words[:, 1:], opacities[:, :-1], opacities[:, 1:]]
    return np.stack(ends, axis=-1).view(np.int32)
