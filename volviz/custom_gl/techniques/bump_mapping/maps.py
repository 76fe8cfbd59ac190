"""Textures of normal vectors: patterns, images, and the cube map that normalises."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt

from volviz.custom_gl.gpu.context import Gpu
from volviz.errors import LoadError
from volviz.kernels.normal_maps import (
    Encoding,
    brick_heights,
    bump_heights,
    cube_map_directions,
    decoded,
    encoded,
    normals_from_heights,
)

#: Texels along the edge of a pattern's tile.
PATTERN_SIZE = 256
#: Longest edge of an image file's map; larger images are reduced.
MAX_IMAGE = 4096
#: Height of white above black in a grey image, in tiles.
IMAGE_HEIGHT = 0.05


class MapTextures:
    """One normal map and one cube map, remade when what they come from changes."""

    def __init__(self) -> None:
        self._held: dict[str, tuple[Any, Any]] = {}

    def normal_map(self, gpu: Gpu, source: str, path: str | None, encoding: str) -> Any:
        """Periodic texture of unit vectors for a pattern or an image file.

        As long as no image is chosen, the bumps stand for it.

        Raises
        ------
        LoadError
            There is no such image, or it cannot be read.
        """
        if source == "image" and not path:
            source = "bumps"
        key: Any = (source,)
        if source == "image":
            file = _checked_path(str(path))
            key = (source, str(file), file.stat().st_mtime_ns, _byte_encoding(encoding))

        def make() -> Any:
            if source == "image":
                return _periodic_texture(gpu, image_normals(file, _byte_encoding(encoding)))
            return _periodic_texture(gpu, pattern_normals(source))

        return self._kept("map", key, make)

    def cube_map(self, gpu: Gpu, size: int, encoding: str) -> Any:
        """Cube map of directions: floats, or 8-bit colours in the encoding asked for."""

        def make() -> Any:
            directions = cube_map_directions(size)
            gpu.uploads += 1
            if encoding == "float":
                data, dtype = directions.astype(np.float32).tobytes(), "f4"
            else:
                data, dtype = encoded(directions, _byte_encoding(encoding)).tobytes(), "f1"
            texture = gpu.gl.texture_cube((size, size), 3, data, alignment=1, dtype=dtype)
            texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
            return texture

        return self._kept("cube", (size, encoding), make)

    def _kept(self, slot: str, key: Any, make: Any) -> Any:
        held = self._held.get(slot)
        if held is not None and held[0] == key:
            return held[1]
        texture = make()
        if held is not None:
            held[1].release()
        self._held[slot] = (key, texture)
        return texture

    def release(self) -> None:
        """Release the textures; the context must be current."""
        for _, texture in self._held.values():
            texture.release()
        self._held.clear()


def pattern_normals(source: str) -> npt.NDArray[np.float64]:
    """Normals of one tile of a pattern, shape (H, W, 3), row 0 at the bottom."""
    heights = {"bricks": brick_heights, "bumps": bump_heights}[source](PATTERN_SIZE)
    return normals_from_heights(heights)


def image_normals(path: Path, encoding: Encoding = "centred") -> npt.NDArray[np.float64]:
    """Normals from an image file: colours are vectors, greys are heights.

    Parameters
    ----------
    path : Path
        Any format that Pillow reads.
    encoding : {"centred", "classic"}
        How colours hold vectors.

    Returns
    -------
    ndarray of shape (H, W, 3), float64
        Unit vectors in tangent space; row 0 is the image's lowest row.

    Raises
    ------
    LoadError
        The file is no image.
    """
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as image:
            image.thumbnail((MAX_IMAGE, MAX_IMAGE))
            grey = image.mode in {"1", "L", "LA", "I", "F"} or image.mode.startswith("I;16")
            deep = grey and image.mode not in {"1", "LA"}
            pixels = np.asarray(image if deep else image.convert("L" if grey else "RGB"))
    except (UnidentifiedImageError, OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        raise LoadError(
            f"{path.name} cannot be read as an image; choose a PNG, JPEG or TIFF file as normal map."
        ) from None
    pixels = pixels[::-1]
    if min(pixels.shape[:2]) < 2:
        raise LoadError(f"{path.name} has fewer than 2 x 2 pixels; choose a larger image as normal map.")
    if grey:
        heights = pixels.astype(np.float64)
        span = float(np.ptp(heights))
        return normals_from_heights((heights - heights.min()) * (IMAGE_HEIGHT / span if span > 0 else 0.0))
    vectors = decoded(pixels, encoding)
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    flat = np.array([0.0, 0.0, 1.0])
    return np.where(length > 1e-6, vectors / np.maximum(length, 1e-6), flat)


def _checked_path(path: str) -> Path:
    file = Path(path).expanduser()
    if not file.is_file():
        raise LoadError(f"there is no file {path} to take normals from; choose another normal_image.")
    return file


def _byte_encoding(encoding: str) -> Encoding:
    return "classic" if encoding == "bytes_classic" else "centred"


def _periodic_texture(gpu: Gpu, vectors: npt.NDArray[np.float64]) -> Any:
    height, width, _ = vectors.shape
    texels = np.zeros((height, width, 4), np.float16)
    texels[..., :3] = vectors
    texture = gpu.gl.texture((width, height), 4, texels.tobytes(), dtype="f2")
    texture.repeat_x = texture.repeat_y = True
    texture.build_mipmaps()
    texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    gpu.uploads += 1
    return texture
