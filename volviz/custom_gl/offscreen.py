"""What images without a window need beside drawing: sizes, colours, tiles, cameras."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.model.camera import Camera

MAX_SIZE = 16384


def finished(
    premultiplied: npt.NDArray[np.float32], background: tuple[float, float, float] | None, dtype: str
) -> npt.NDArray[Any]:
    """A premultiplied float image over a background (or with straight alpha), as uint8 or float32."""
    alpha = premultiplied[..., 3:]
    image = np.empty_like(premultiplied)
    if background is not None:
        image[..., :3] = premultiplied[..., :3] + (1.0 - alpha) * np.asarray(background, np.float32)
        image[..., 3] = 1.0
    else:
        # where next to nothing is seen, colours become 0
        np.divide(premultiplied[..., :3], np.where(alpha > 1e-6, alpha, np.inf), out=image[..., :3])
        image[..., 3:] = alpha
    if dtype == "float32":
        return image
    np.clip(image, 0.0, 1.0, out=image)
    image *= 255.0
    return np.rint(image, out=image).astype(np.uint8)


def apply_camera(target: Any, camera: Camera) -> None:
    """Give a `vtkCamera` the values of a `Camera`; the clipping range is left to the renderer."""
    target.SetPosition(*camera.position)
    target.SetFocalPoint(*camera.focal_point)
    target.SetViewUp(*camera.view_up)
    target.SetViewAngle(camera.view_angle)
    target.SetParallelProjection(camera.parallel)
    target.SetParallelScale(camera.scale)


def look_at_tile(
    camera: Any, size: tuple[int, int], tile: tuple[int, int, int, int] | None, window: tuple[int, int]
) -> None:
    """Let a `vtkCamera` look at a part of an image, with the pixels of the whole.

    Parameters
    ----------
    camera : vtkCamera
        As it looks at the whole image.
    size : tuple of 2 ints
        Of the whole image in pixels.
    tile : tuple of 4 ints or None
        Left, top, width and height of the part; None for the whole.
    window : tuple of 2 ints
        Of the window, into whose upper left corner the part is drawn.
    """
    from volviz.custom_gl.vtk.vtk_imports import vtkMatrix4x4

    camera.UseExplicitProjectionTransformMatrixOff()
    if tile is None or (tile[:2] == (0, 0) and window == size):
        return
    whole = camera.GetProjectionTransformMatrix(size[0] / size[1], -1, 1)
    scale = np.array(size) / np.array(window)
    # middle of the window in normalised device coordinates of the whole image
    middle = np.array(
        [2 * (tile[0] + window[0] / 2) / size[0] - 1, 1 - 2 * (tile[1] + window[1] / 2) / size[1]]
    )
    cut = np.eye(4)
    cut[0, 0], cut[1, 1] = scale
    cut[:2, 3] = -scale * middle
    values = cut @ np.array([[whole.GetElement(i, j) for j in range(4)] for i in range(4)])
    matrix = vtkMatrix4x4()
    for i in range(4):
        for j in range(4):
            matrix.SetElement(i, j, float(values[i, j]))
    camera.SetExplicitProjectionTransformMatrix(matrix)
    camera.UseExplicitProjectionTransformMatrixOn()


def tiles_of(size: tuple[int, int], edge: tuple[int, int]) -> list[tuple[int, int, int, int]]:
    """Left, top, width and height of the parts of an image that are at most so large, row by row."""
    (width, height), (most_wide, most_high) = size, edge
    return [
        (x, y, min(most_wide, width - x), min(most_high, height - y))
        for y in range(0, height, most_high)
        for x in range(0, width, most_wide)
    ]


def checked_dtype(dtype: str) -> None:
    """Refuse what images are not made of.

    Raises
    ------
    InputError
        It is neither "uint8" nor "float32".
    """
    if dtype not in ("uint8", "float32"):
        raise InputError(f'dtype of a picture is "uint8" or "float32", got {dtype!r}.')


def checked_size(size: Sequence[int]) -> tuple[int, int]:
    """Width and height of an image in pixels.

    Raises
    ------
    InputError
        Not two numbers, or more than `MAX_SIZE`.
    """
    try:
        width, height = (int(n) for n in size)
    except (TypeError, ValueError):
        raise InputError(f"size must be two whole numbers (width, height) in pixels, got {size!r}.") from None
    if not (1 <= width <= MAX_SIZE and 1 <= height <= MAX_SIZE):
        raise InputError(f"size must lie between 1 and {MAX_SIZE} pixels each way, got {width} x {height}.")
    return width, height


def background_color(background: Sequence[float] | str | None) -> tuple[float, float, float] | None:
    """A colour from three floats 0..1, a name or #rrggbb; None stays None.

    Raises
    ------
    InputError
        It is none of these.
    """
    if background is None:
        return None
    if isinstance(background, str):
        from volviz.custom_gl.vtk.vtk_imports import pyvista

        try:
            r, g, b = pyvista.Color(background).float_rgb
        except ValueError:
            raise InputError(
                f"background {background!r} is no colour; use a name, #rrggbb or three floats."
            ) from None
        return r, g, b
    try:
        r, g, b = (float(c) for c in background)
    except (TypeError, ValueError):
        raise InputError(f"background must be three numbers between 0 and 1, got {background!r}.") from None
    if not all(0.0 <= c <= 1.0 for c in (r, g, b)):
        raise InputError(f"background must be three numbers between 0 and 1, got {background!r}.")
    return r, g, b
