"""Title and moment, written over the frames of a movie."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt


def captioned(
    image: npt.NDArray[np.uint8], title: str, seconds: float | None = None
) -> npt.NDArray[np.uint8]:
    """An image with a title at the top and a moment at the lower right, in white with a dark rim.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4), uint8
    title : str
        Empty for none.
    seconds : float, optional
        The moment.

    Returns
    -------
    ndarray of shape (H, W, 4), uint8
        The same image where there is nothing to write.
    """
    if not title and seconds is None:
        return image
    from PIL import Image, ImageDraw

    height, width = image.shape[:2]
    picture = Image.fromarray(image)
    draw = ImageDraw.Draw(picture)
    # what televisions and projectors cut off at the edges is kept free
    margin = round(0.05 * min(width, height))
    rim = {"fill": (255, 255, 255, 255), "stroke_width": max(height // 360, 1), "stroke_fill": (0, 0, 0, 255)}
    if title:
        draw.text((width / 2, margin), title, font=_font(max(height // 18, 10)), anchor="ma", **rim)
    if seconds is not None:
        place = (width - margin, height - margin)
        draw.text(place, f"{seconds:.1f} s", font=_font(max(height // 28, 9)), anchor="rd", **rim)
    return np.asarray(picture)


@cache
def _font(pixels: int) -> Any:
    from PIL import ImageFont

    return ImageFont.load_default(pixels)
