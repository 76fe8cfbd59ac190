"""Normal maps: made from heights, kept as bytes; and the cube map that normalises vectors.

A normal map is periodic and indexed ``[v, u]``: row 0 lies at v = 0, v grows along the binormal b = n x t, u
along the tangent t. Its vectors are in tangent space (t, b, n); the undisturbed normal is (0, 0, 1).
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError

Array = npt.NDArray[Any]
Float64Array = npt.NDArray[np.float64]

#: "centred": byte = 255 (0.5 + 0.5 v), the symmetric one; "classic": byte = 128 + 127 v.
Encoding = Literal["centred", "classic"]

#: Bricks of one tile: rows, and bricks a row.
BRICK_ROWS, BRICK_COLUMNS = 4, 2
#: Share of a row's height that the mortar takes, and the bevel beside it.
MORTAR, BEVEL = 0.12, 0.1
#: How far bricks stand out of the mortar, in tiles.
BRICK_HEIGHT = 0.018
#: Bumps a tile and direction, and the height of their tops in tiles.
BUMPS, BUMP_HEIGHT = 4, 0.035

# Major axis and the axes of s and t on each face, as in the OpenGL specification (section "Cube Map Texture
# Selection"): +x, -x, +y, -y, +z, -z.
_FACES = (
    ((1, 0, 0), (0, 0, -1), (0, -1, 0)),
    ((-1, 0, 0), (0, 0, 1), (0, -1, 0)),
    ((0, 1, 0), (1, 0, 0), (0, 0, 1)),
    ((0, -1, 0), (1, 0, 0), (0, 0, -1)),
    ((0, 0, 1), (1, 0, 0), (0, -1, 0)),
    ((0, 0, -1), (-1, 0, 0), (0, -1, 0)),
)


def encoded(vectors: npt.ArrayLike, encoding: Encoding = "centred") -> npt.NDArray[np.uint8]:
    """Vectors as bytes.

    Parameters
    ----------
    vectors : array_like of shape (..., 3)
        Components -1..1; beyond that they are clamped.
    encoding : {"centred", "classic"}
        Zero becomes 127.5, rounded to 128, or exactly 128.

    Returns
    -------
    ndarray of shape (..., 3), uint8
    """
    v = np.clip(np.asarray(vectors, np.float64), -1.0, 1.0)
    values = 128.0 + 127.0 * v if encoding == "classic" else 255.0 * (0.5 + 0.5 * v)
    return np.floor(values + 0.5).astype(np.uint8)


def decoded(data: npt.NDArray[np.uint8], encoding: Encoding = "centred") -> Float64Array:
    """Vectors from bytes, as they are: rounding leaves their length a little off 1.

    Parameters
    ----------
    data : ndarray of shape (..., 3), uint8
    encoding : {"centred", "classic"}
        How the bytes were made.

    Returns
    -------
    ndarray of shape (..., 3), float64
    """
    values = np.asarray(data, np.float64)
    return np.asarray((values - 128.0) / 127.0 if encoding == "classic" else values / 127.5 - 1.0)


def normals_from_heights(heights: npt.ArrayLike) -> Float64Array:
    """Normals of a periodic height field.

    Parameters
    ----------
    heights : array_like of shape (H, W)
        In units of the tile's edge, indexed ``[v, u]``.

    Returns
    -------
    ndarray of shape (H, W, 3), float64
        Unit vectors norm(-dh/du, -dh/dv, 1), from central differences (Blinn 1978, for a flat surface).
    """
    h = np.asarray(heights, np.float64)
    if h.ndim != 2 or min(h.shape) < 2:
        raise InputError(f"a height field needs two dimensions of at least 2 samples, got {h.shape}.")
    rows, columns = h.shape
    du = (np.roll(h, -1, axis=1) - np.roll(h, 1, axis=1)) * (columns / 2.0)
    dv = (np.roll(h, -1, axis=0) - np.roll(h, 1, axis=0)) * (rows / 2.0)
    normals = np.stack([-du, -dv, np.ones_like(h)], axis=-1)
    return np.asarray(normals / np.linalg.norm(normals, axis=-1, keepdims=True))


def brick_heights(size: int = 256) -> Float64Array:
    """A tile of brickwork: rows of bricks, every other one shifted by half a brick, mortar between them.

    Parameters
    ----------
    size : int
        Samples along each edge, at least 2.

    Returns
    -------
    ndarray of shape (size, size), float64
        Heights in tiles, 0 in the mortar.
    """
    v, u = _centres(size)
    row = v * BRICK_ROWS
    column = u * BRICK_COLUMNS + 0.5 * (np.floor(row) % 2)
    # distances to the nearest joint, both in heights of a row: a brick is twice as wide as high
    across = np.minimum(row % 1.0, 1.0 - row % 1.0)
    along = np.minimum(column % 1.0, 1.0 - column % 1.0) * (BRICK_ROWS / BRICK_COLUMNS)
    edge = np.clip((np.minimum(across, along) - MORTAR / 2) / BEVEL, 0.0, 1.0)
    return np.asarray(BRICK_HEIGHT * edge * edge * (3.0 - 2.0 * edge))


def bump_heights(size: int = 256) -> Float64Array:
    """A tile of round bumps in rows, without an edge anywhere.

    Parameters
    ----------
    size : int
        Samples along each edge, at least 2.

    Returns
    -------
    ndarray of shape (size, size), float64
        Heights in tiles.
    """
    v, u = _centres(size)
    x, y = u * BUMPS % 1.0 - 0.5, v * BUMPS % 1.0 - 0.5
    near = np.clip(np.hypot(x, y) / 0.46, 0.0, 1.0)
    return np.asarray(BUMP_HEIGHT * (1.0 - near * near) ** 2)


def cube_map_directions(size: int) -> Float64Array:
    """Unit vector that belongs to the centre of each texel of a cube map.

    Parameters
    ----------
    size : int
        Texels along an edge of a face, at least 1.

    Returns
    -------
    ndarray of shape (6, size, size, 3), float64
        Faces +x, -x, +y, -y, +z, -z, rows and columns in the order in which OpenGL takes them. Looked up with
        any vector, the map gives that vector's direction (Kilgard 2000).
    """
    if size < 1:
        raise InputError(f"a cube map needs at least one texel a face, got {size}.")
    place = 2.0 * (np.arange(size) + 0.5) / size - 1.0
    t, s = np.meshgrid(place, place, indexing="ij")
    faces = []
    for major, along_s, along_t in _FACES:
        vectors = np.asarray(major, float) + s[..., None] * along_s + t[..., None] * along_t
        faces.append(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))
    return np.stack(faces)


def _centres(size: int) -> tuple[Float64Array, Float64Array]:
    if size < 2:
        raise InputError(f"a tile needs at least 2 samples along an edge, got {size}.")
    place = (np.arange(size) + 0.5) / size
    v, u = np.meshgrid(place, place, indexing="ij")
    return v, u
