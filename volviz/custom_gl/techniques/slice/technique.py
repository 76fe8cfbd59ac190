"""Slices: the polygons in which planes cut the volume, textured with the values on them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np

from volviz.custom_gl.picking import Picked, Sight
from volviz.custom_gl.shader_source import GLSL
from volviz.custom_gl.techniques.slice.planes import shown_planes
from volviz.custom_gl.techniques.slice.spline import SplineTexture
from volviz.kernels.slices import crop_corners, fan_triangles, slice_polygons
from volviz.model.transfer.first_look import grey_window
from volviz.reference.slices import SLAB_MODES, slab_offsets, whole_crop

if TYPE_CHECKING:
    from volviz.custom_gl.gpu.programs import Program
    from volviz.custom_gl.technique import Frame
    from volviz.model.slice_plane import SlicePlane

_HERE = Path(__file__).parent


class Slice:
    """Draws each plane as one polygon, and writes its depth."""

    #: The host puts the depth of the planes into VTK's depth buffer.
    writes_depth = True

    def __init__(self) -> None:
        self._spline = SplineTexture()
        self._planes: tuple[SlicePlane, ...] = ()
        self._buffers: list[tuple[Any, Any]] = []
        self._uploads = 0

    def plan(self, frame: Frame) -> int:
        """One chunk for each plane, after those that upload what cubic interpolation needs."""
        self._planes = shown_planes(frame.settings, frame.volume.center)
        self._uploads = 0
        if frame.settings.interpolation == "cubic":
            needed = self._spline.chunks(frame)
            if needed is None:
                return 0
            self._uploads = needed
        return self._uploads + len(self._planes)

    def draw(self, frame: Frame, chunk: int) -> None:
        """Upload a part of the spline's coefficients, or draw one plane."""
        if chunk < self._uploads:
            self._spline.upload(frame)
            return
        if chunk == self._uploads:
            self._drop_buffers()
        plane = self._planes[chunk - self._uploads]
        crop = whole_crop(frame.volume.dimensions, frame.crop)
        corners = crop_corners(frame.volume.index_to_world, crop, frame.volume.dimensions)
        normal = np.asarray(plane.normal)
        vertices, counts = slice_polygons(corners, normal, [normal @ np.asarray(plane.point)])
        to_texture = frame.world_to_texture
        positions, first = fan_triangles(vertices @ to_texture[:3, :3].T + to_texture[:3, 3], counts)
        if not first[-1]:
            return
        gl = frame.gpu.gl
        program = self._program(frame, plane, crop)
        buffer = gl.buffer(positions.tobytes())
        array = gl.vertex_array(program.gl, [(buffer, "3f", "a_position")])
        self._buffers.append((buffer, array))
        frame.target.fbo.use()
        gl.enable_only(moderngl.DEPTH_TEST)
        array.render(moderngl.TRIANGLES)
        gl.enable_only(moderngl.NOTHING)

    def _program(self, frame: Frame, plane: SlicePlane, crop: tuple[float, ...]) -> Program:
        settings, texels = frame.settings, frame.resources.texels
        defines: dict[str, object] = {
            f"SLAB_{mode.upper()}": settings.slab_mode == mode for mode in SLAB_MODES
        }
        defines |= {"GREY": settings.coloring == "window", "CUBIC": settings.interpolation == "cubic"}
        program = frame.program(GLSL / "polygon.vert", _HERE / "slice.frag", defines)
        if settings.interpolation == "cubic":
            program.use_texture("t_coefficients", self._spline.texture)
        offsets = slab_offsets(settings.slab, frame.step_world)
        # from the eye on, whichever side of the plane it sees
        along = np.asarray(plane.normal)
        if frame.camera.parallel:
            towards = -float(frame.camera.direction @ along)
        else:
            towards = float((frame.camera.eye - np.asarray(plane.point)) @ along)
        along = along if towards < 0 else -along
        step = frame.world_to_texture[:3, :3] @ along
        spacing = settings.slab / len(offsets)
        limits = np.asarray(crop).reshape(3, 2).T
        scale, offset = texels.index_to_texture
        low, high = frame.volume.bulk_range
        black, white = grey_window(frame.volume, settings.window_level, settings.window_width)
        program.set(
            {
                "u_low": tuple(limits[0] * scale + offset),
                "u_high": tuple(limits[1] * scale + offset),
                "u_samples": len(offsets),
                "u_first": tuple(step * offsets[0]),
                "u_next": tuple(step * spacing),
                "u_segment": spacing or frame.volume.mean_spacing,
                "u_grey": ((high - low) / (white - black), (low - black) / (white - black)),
            }
        )
        return program

    def _drop_buffers(self) -> None:
        for buffer, array in self._buffers:
            array.release()
            buffer.release()
        self._buffers = []

    def release(self) -> None:
        """Release buffers and texture."""
        self._drop_buffers()
        self._spline.release()


def pick(sight: Sight) -> Picked | None:
    """The nearest of the planes that the ray meets within what is shown."""
    found = []
    for plane in shown_planes(sight.settings, sight.volume.center):
        normal = np.asarray(plane.normal)
        slope = float(normal @ sight.ray.direction)
        if slope == 0.0:
            continue
        t = float(normal @ (np.asarray(plane.point) - sight.ray.start)) / slope
        if _is_shown(sight, t):
            found.append(t)
    return sight.picked(min(found)) if found else None


def _is_shown(sight: Sight, t: float) -> bool:
    if not 0.0 <= t <= sight.ray.length:
        return False
    limits = np.asarray(whole_crop(sight.volume.dimensions, sight.crop)).reshape(3, 2)
    index, point = sight.indices(t)[0], sight.point(t)
    if np.any(index < limits[:, 0]) or np.any(index > limits[:, 1]):
        return False
    return all(np.dot(normal, point - np.asarray(origin)) >= 0 for origin, normal in sight.planes)
