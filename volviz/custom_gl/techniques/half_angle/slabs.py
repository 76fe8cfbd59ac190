"""Slice polygons of a frame in a vertex buffer, remade only when the slices move."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.technique import Frame
from volviz.custom_gl.techniques.half_angle.blocks import Visible, block_polygons, grown_box
from volviz.custom_gl.techniques.half_angle.light_path import Array, Slicing, smallest_cosine
from volviz.custom_gl.techniques.half_angle.settings import MAX_SLICES, MIN_SLICES
from volviz.kernels.slices import box_distance_range, crop_corners, fan_triangles, slab_centres

#: Edge of the blocks that are drawn or left out, in voxels: fine ones cost time to cut, coarse ones to draw.
BLOCK, BLOCK_WHILE_MOVING = 32, 64


class Slabs:
    """Triangles of slices in the order away from the light, in texture coordinates.

    The polygons lie in the middle of their slabs and are a little larger than the box: a ray that crosses
    only a corner of a slab meets its polygon too, and the shader finds how much of the slab it crosses.

    Attributes
    ----------
    count : int
        Number of slices.
    thickness : float
        Of a slab, in world units.
    corners : ndarray of shape (8, 3)
        World corners of the enlarged part of the box that holds anything visible.
    """

    def __init__(self) -> None:
        self.count = 0
        self.thickness = 1.0
        self.corners: Array = np.zeros((8, 3))
        self._first: npt.NDArray[np.int64] = np.zeros(1, np.int64)
        self._key: Any = None
        self._buffer: Any = None
        self._arrays: dict[int, tuple[Any, Any]] = {}

    def update(
        self,
        frame: Frame,
        slicing: Slicing,
        view: Array,
        visible: Visible,
        eye_rays: Array,
        light_rays: Array,
        *,
        eye_inside: bool,
    ) -> None:
        """Compute the polygons again when direction, box or count have changed.

        Parameters
        ----------
        frame : Frame
            The image to draw.
        slicing : Slicing
            Normal of the slices.
        view : ndarray of shape (3,)
            Unit viewing direction: slices are one step apart along it.
        visible : Visible
            What is to be seen of the volume.
        eye_rays, light_rays : ndarray of shape (N, 3)
            Extreme rays, which say how far a slab reaches beside its polygon.
        eye_inside : bool
            The eye is in the box: a border of two slabs then goes through it, so that none is half behind it.
        """
        low, high = box_distance_range(frame.box_corners, -slicing.half_vector)
        step = frame.step_world * max(abs(float(view @ slicing.half_vector)), 0.5)
        count = frame.settings.slices or math.ceil((high - low) / step - 1e-9)
        count = min(max(count, MIN_SLICES), MAX_SLICES)
        if frame.interactive:
            # coarse pixels need no finer slices, and every slice has a price of its own
            fraction = frame.size[1] / frame.window_size[1]
            count = max(round(count * min(max(2 * fraction, 0.25), 0.5)), min(count, 2 * MIN_SLICES))
        thickness = (high - low) / count
        if eye_inside:
            low -= float((low + frame.camera.eye @ slicing.half_vector) % thickness)
            count += 1
            high = low + count * thickness
        cosine = min(smallest_cosine(slicing.half_vector, rays) for rays in (eye_rays, light_rays))
        volume = frame.volume
        margin = 0.5 * thickness / cosine / np.array(volume.spacing)
        key = (
            visible,
            margin.tobytes(),
            slicing.half_vector.tobytes(),
            low,
            count,
            thickness,
            frame.interactive,
        )
        if self._key is not None and all(a is b or a == b for a, b in zip(self._key, key, strict=True)):
            return
        self.count, self.thickness = count, thickness
        self.corners = crop_corners(volume.index_to_world, grown_box(visible, margin), volume.dimensions)
        vertices, sides, polygons = block_polygons(
            volume,
            visible,
            margin,
            BLOCK_WHILE_MOVING if frame.interactive else BLOCK,
            -slicing.half_vector,
            slab_centres(low, high, count),
        )
        to_texture = frame.world_to_texture
        # in float64: world coordinates may be large against the volume's size
        vertices = vertices @ to_texture[:3, :3].T + to_texture[:3, 3]
        positions, first = fan_triangles(vertices, sides)
        self._first = first[polygons]
        self._write(frame, positions)
        self._key = key

    def _write(self, frame: Frame, positions: npt.NDArray[np.float32]) -> None:
        if self._buffer is None or self._buffer.size < positions.nbytes:
            self._release_arrays()
            if self._buffer is not None:
                self._buffer.release()
            # room for some growth, so that turning the view does not allocate anew each time
            self._buffer = frame.gpu.gl.buffer(reserve=max(positions.nbytes * 3 // 2, 4096), dynamic=True)
        self._buffer.write(positions.tobytes())

    def array(self, frame: Frame, program: Any) -> Any:
        """The vertex array that feeds a program."""
        held = self._arrays.get(program.glo)
        if held is None:
            array = frame.gpu.gl.vertex_array(program, [(self._buffer, "3f", "a_texture")])
            # the program is kept as well: its number must not be given to another one meanwhile
            held = self._arrays[program.glo] = (array, program)
        return held[0]

    def vertices(self, index: int) -> tuple[int, int]:
        """First vertex and number of vertices of a slice."""
        first = int(self._first[index])
        return first, int(self._first[index + 1]) - first

    def release(self) -> None:
        """Release buffer and vertex arrays; the context must be current."""
        self._release_arrays()
        if self._buffer is not None:
            self._buffer.release()
            self._buffer = None
        self._key = None

    def _release_arrays(self) -> None:
        for array, _ in self._arrays.values():
            array.release()
        self._arrays.clear()
