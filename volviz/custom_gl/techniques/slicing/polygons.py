"""Slice polygons of a frame in vertex buffers, remade only when the slices move."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.technique import Frame
from volviz.custom_gl.techniques.slicing.settings import MAX_SLICES, MIN_SLICES
from volviz.kernels.slices import box_distance_range, fan_triangles, outline_segments, slice_polygons

#: Share of the box's depth that is added at both ends, so that rounding never drops a face that a slice lies
#: in.
EPSILON = 1e-7


class SlicePolygons:
    """Triangles and outlines of view-aligned slices, back to front.

    Attributes
    ----------
    count : int
        Number of slices.
    distance : float
        Between slices, in world units.
    first : ndarray of shape (count + 1,)
        Slice s occupies the vertices ``first[s] .. first[s + 1] - 1``.
    """

    def __init__(self) -> None:
        self.count = 0
        self.distance = 1.0
        self.first: npt.NDArray[np.int64] = np.zeros(1, np.int64)
        self.remade = 0
        self._key: Any = None
        self._polygons: Any = None
        self._triangles: Any = None
        self._outlines: tuple[Any, int] | None = None

    def update(self, frame: Frame) -> None:
        """Compute the polygons again when view direction, box, count or sample position have changed."""
        corners, direction = frame.box_corners, frame.camera.direction
        low, high, count = view_slices(frame.settings, corners, direction, frame.step_world)
        if frame.interactive:
            count = max(round(count / frame.step_scale), MIN_SLICES) if frame.settings.slices else count
        position = frame.settings.first_sample
        to_texture = frame.world_to_texture
        key = (corners.tobytes(), direction.tobytes(), count, position, to_texture.tobytes())
        if key == self._key:
            return
        self.count, self.distance = count, (high - low) / count
        distances = low + (np.arange(count)[::-1] + position) * self.distance
        vertices, corners_per_slice = slice_polygons(corners, direction, distances)
        vertices = vertices @ to_texture[:3, :3].T + to_texture[:3, 3]
        positions, self.first = fan_triangles(vertices, corners_per_slice)
        self._polygons = (vertices, corners_per_slice)
        self._write(frame, positions)
        self._key = key
        self.remade += 1

    def _write(self, frame: Frame, positions: npt.NDArray[np.float32]) -> None:
        needed = max(positions.nbytes, 4096)
        if self._triangles is None or self._triangles.size < needed:
            if self._triangles is not None:
                self._triangles.release()
            # room for some growth, so that turning the view does not allocate anew each time
            self._triangles = frame.gpu.gl.buffer(reserve=needed * 3 // 2, dynamic=True)
        self._triangles.write(positions.tobytes())
        self._drop_outlines()

    @property
    def buffer(self) -> Any:
        """Vertex buffer of triangles, three float32 a vertex."""
        return self._triangles

    def outlines(self, frame: Frame) -> tuple[Any, int]:
        """Vertex buffer of the polygons' edges as lines, and its number of vertices."""
        if self._outlines is None:
            positions, _ = outline_segments(*self._polygons)
            self._outlines = frame.gpu.gl.buffer(positions.tobytes() or b"\0" * 12), len(positions)
        return self._outlines

    def _drop_outlines(self) -> None:
        if self._outlines is not None:
            self._outlines[0].release()
            self._outlines = None

    def release(self) -> None:
        """Release the buffers."""
        self._drop_outlines()
        if self._triangles is not None:
            self._triangles.release()
            self._triangles = None
        self._key = None


def view_slices(
    settings: Any, corners: npt.NDArray[np.float64], direction: npt.NDArray[np.float64], step: float
) -> tuple[float, float, int]:
    """Where slices lie along the view, and how many there are.

    Parameters
    ----------
    settings : SlicingSettings
    corners : ndarray of shape (8, 3)
        World corners of what is shown.
    direction : ndarray of shape (3,)
        Unit vector along the view.
    step : float
        Largest distance of slices in world units, unless their number is set.

    Returns
    -------
    low, high : float
        Distances along the view, from the world's origin, between which they lie.
    count : int
        Their number.
    """
    low, high = box_distance_range(corners, direction)
    padding = EPSILON * (high - low)
    low, high = low - padding, high + padding
    return low, high, settings.slices or requested_slices(high - low, step)


def requested_slices(depth: float, step: float) -> int:
    """Number of slices over a depth that are no farther apart than the step, within the limits."""
    return min(max(math.ceil(depth / step - 1e-9), MIN_SLICES), MAX_SLICES)
