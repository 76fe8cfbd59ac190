"""What lies behind the volume: a colour, or the gradient of the window."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Color = tuple[float, float, float]

#: Colours of the gradient at the upper and the lower edge.
TOP, BOTTOM = "#3b4450", "#14171b"


def _rgb(code: str) -> Color:
    red, green, blue = (int(code[i : i + 2], 16) / 255 for i in (1, 3, 5))
    return red, green, blue


#: Colour of the gradient as far as that of letters asks for it.
GROUND = _rgb(BOTTOM)


def background_image(color: Color | None, size: tuple[int, int]) -> npt.NDArray[np.float32]:
    """The background as an array of shape (H, W, 3), 0..1: one colour, or the gradient for None."""
    width, height = size
    if color is not None:
        return np.broadcast_to(np.asarray(color, np.float32), (height, width, 3))
    top, bottom = (np.asarray(_rgb(code), np.float32) for code in (TOP, BOTTOM))
    t = np.linspace(0.0, 1.0, height, dtype=np.float32)[:, None, None]
    return np.broadcast_to((1 - t) * top + t * bottom, (height, width, 3))
