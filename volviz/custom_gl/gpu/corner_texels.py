"""Texels that hold all eight values around a place, for rasterisers that compute their filters on the processor.

There one lookup of eight packed values and an interpolation in the shader takes three fifths of the time of a filtered
lookup of 32-bit floats, which gathers them from four rows of memory (llvmpipe, 600 x 600 pixels, 250 samples a ray). It
takes eight times the memory of the values themselves, which is main memory there. A graphics card filters for nothing.
"""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt

from volviz.kernels.threads import map_ranges

#: Texels of a packed volume may take so many bytes; larger ones are filtered by OpenGL.
MOST_BYTES = 2**30
#: Values around a place.
CORNERS = 8


def holds_corners(voxels: int, itemsize: int, most_bytes: int) -> bool:
    """Whether so many whole numbers of so many bytes may be stored with their neighbours."""
    return itemsize <= 2 and CORNERS * itemsize * voxels <= min(MOST_BYTES, most_bytes)


def empty_corners(gl: Any, data: npt.NDArray[Any]) -> Any:
    """A texture for an array of shape (Z, Y, X) with the neighbours of each value: two or four 32-bit words a texel."""
    z, y, x = data.shape
    texture = gl.texture3d((x, y, z), 2 * data.dtype.itemsize, dtype="i4", alignment=1)
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    return texture


def with_neighbours(data: npt.NDArray[Any], start: int, stop: int) -> npt.NDArray[Any]:
    """Planes of values, each with its neighbours.

    Parameters
    ----------
    data : ndarray of shape (Z, Y, X), uint8 or uint16
    start, stop : int
        First plane and the one after the last.

    Returns
    -------
    ndarray of shape (stop - start, Y, X, 8), of the same type
        Element c is the value at (x + (c & 1), y + (c >> 1 & 1), z + (c >> 2)), the last one of a row beyond its end.
    """
    out = np.empty((stop - start, *data.shape[1:], CORNERS), data.dtype)

    def fill(first: int, last: int) -> None:
        for plane in range(first, last):
            for dz in range(2):
                source = data[min(start + plane + dz, len(data) - 1)]
                for dy in range(2):
                    rows = source if dy == 0 else np.concatenate([source[1:], source[-1:]])
                    corner = 4 * dz + 2 * dy
                    out[plane, :, :, corner] = rows
                    out[plane, :, :-1, corner + 1] = rows[:, 1:]
                    out[plane, :, -1, corner + 1] = rows[:, -1]

    map_ranges(fill, stop - start)
    return out
