"""Shows images of the float64 oracle, computed in the background."""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np

from volviz.custom_gl.shader_source import GLSL
from volviz.custom_gl.technique import Frame
from volviz.custom_gl.techniques.reference.computing import Image, OracleRequest, computed
from volviz.tasks import LatestResult

#: Rows of an image while something moves.
MOVING_ROWS = 64


class Reference:
    """The image of `volviz.reference.image`, one block for each of its pixels."""

    within_tiles = True
    #: The image is the exact one of its rays, and takes long.
    accumulates = False

    def __init__(self) -> None:
        self._images: LatestResult[OracleRequest, Image] = LatestResult("reference")
        self._texture: Any = None
        self._shown: Any = None

    def plan(self, frame: Frame) -> int:
        """One chunk per tile when the image is there, 0 while it is computed."""
        request = self._request(frame)
        image = self._images.get(
            frame.tasks, request, lambda progress, cancel: computed(request, progress, cancel)
        )
        if image is None:
            return 0
        if self._shown is not image:
            self._release_texture()
            height, width, _ = image.shape
            # row 0 of the oracle is the top, of a texture the bottom
            data = np.ascontiguousarray(image[::-1], np.float32)
            self._texture = frame.gpu.gl.texture((width, height), 4, data.tobytes(), dtype="f4")
            self._texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
            self._shown = image
            frame.gpu.uploads += 1
        return max(len(frame.tiles), 1)

    def draw(self, frame: Frame, chunk: int) -> None:
        """Put a tile of the image into the target, enlarged as it is."""
        if not frame.tiles:
            return
        gpu = frame.gpu
        program = gpu.programs.get(
            GLSL / "fullscreen.vert", GLSL / "composite.frag", {"ENLARGE": False, "SCENE_DEPTH": False}
        )
        program.set({"u_image_size": tuple(float(n) for n in self._texture.size), "u_weight": 1.0})
        program.use_texture("t_image", self._texture)
        gpu.gl.scissor = frame.tiles[chunk]
        gpu.draw_fullscreen(program)
        gpu.gl.scissor = None

    def release(self) -> None:
        """Release the texture and forget the image; the context is current."""
        self._images.clear()
        self._release_texture()

    def _release_texture(self) -> None:
        if self._texture is not None:
            self._texture.release()
        self._texture = self._shown = None

    @staticmethod
    def _request(frame: Frame) -> OracleRequest:
        width, height = frame.size
        limit = frame.settings.resolution
        rows = height if limit is None else min(limit, height)
        if frame.interactive:
            rows = min(rows, MOVING_ROWS)
        return OracleRequest(
            volume=frame.volume,
            function=frame.transfer_function,
            settings=frame.settings,
            view=tuple(frame.camera.view.ravel()),
            projection=tuple(frame.camera.projection.ravel()),
            size=(max(round(width * rows / height), 1), rows),
            step=frame.step_world,
            unit_distance=frame.unit_distance,
            crop=frame.crop,
            planes=frame.planes,
            light=None if frame.headlight else tuple(frame.light_position),
            light_color=frame.light_color,
        )
