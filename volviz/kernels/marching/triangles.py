"""Second pass, triangles: walking the active cells with running vertex numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.kernels.compiled import compiled
from volviz.kernels.marching.bits import step_counters

Array = npt.NDArray[Any]


def _make(lanes: int) -> Callable[..., None]:
    """Compile the walk for tables with this many lanes."""

    @compiled
    def number_triangles(
        configurations: Array,
        cell_counts: Array,
        triangle_starts: Array,
        vertex_starts: Array,
        channel_rows: Array,
        triangle_count: Array,
        triangles: Array,
        shift: Array,
        advance: Array,
        faces: Array,
        first: int,
        stop: int,
    ) -> None:
        counters = np.zeros(lanes, faces.dtype)
        numbers = np.zeros(lanes, faces.dtype)
        flat = triangles.reshape(triangles.size)
        width = np.uintp(triangles.shape[1])
        cell = np.uintp(0)
        # behind the triangles of these planes: those of the next ones are written by another thread
        limit = np.uintp(faces.size)
        if stop < triangle_starts.shape[0]:
            limit = np.uintp(3 * triangle_starts[stop, 0])
        for z in range(first, stop):
            for y in range(cell_counts.shape[1]):
                cells = cell_counts[z, y]
                if cells == 0:
                    continue
                for lane in range(channel_rows.shape[0]):
                    counters[lane] = vertex_starts[
                        z + channel_rows[lane, 2], channel_rows[lane, 0], y + channel_rows[lane, 1]
                    ]
                out = np.uintp(3 * triangle_starts[z, y])
                for _ in range(cells):
                    configuration = np.uintp(configurations[cell])
                    cell += np.uintp(1)
                    step_counters(counters, numbers, shift, advance, configuration, lanes)
                    entry = configuration * width
                    count = np.uintp(triangle_count[configuration])
                    end = entry + np.uintp(3) * count
                    after = out + np.uintp(3) * count
                    if after + np.uintp(3) <= limit:
                        # Two triangles at a time, the second perhaps too much: a later cell overwrites it.
                        while entry < end:
                            for i in range(np.uintp(6)):
                                faces[out + i] = numbers[flat[entry + i]]
                            out += np.uintp(6)
                            entry += np.uintp(6)
                    else:
                        for i in range(np.uintp(3) * count):
                            faces[out + i] = numbers[flat[entry + i]]
                    out = after

    result: Callable[..., None] = number_triangles
    return result


#: Walks for the tables of `volviz.kernels.marching.tables`, by number of lanes. Arguments: the list of
#: configurations of these planes (uint8 or uint16), active cells of each row (Z - 1, Y - 1), number of the
#: first triangle of each row (Z - 1, Y - 1), number of the first vertex of each row of edges (Z, K, Y), for
#: each lane its kind, y and z offset (lanes, 3), the four tables, the triangles to write (3 F,) in the type
#: of the vertex numbers, first and last plane.
NUMBER_TRIANGLES = {lanes: _make(lanes) for lanes in (16, 32)}
