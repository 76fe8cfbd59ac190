"""Two images subtracted and coloured fast enough to follow a drag. Plain arrays."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
from PySide6.QtGui import QImage

from volviz.compare.image_metrics import color_table as made_color_table
from volviz.compare.image_metrics import similarity_image, ssim_map
from volviz.model.comparison import Comparison

Bytes = npt.NDArray[np.uint8]

WEIGHTS = np.array([0.2126, 0.7152, 0.0722], np.float32)
"""Luma of Rec. ITU-R BT.709, as in `volviz.compare.image_metrics`."""


@lru_cache(maxsize=2)
def color_table(kind: Literal["absolute", "signed"]) -> Bytes:
    """The colours of differences, made once."""
    return made_color_table(kind)


def array_of(qimage: QImage) -> Bytes:
    """An image of Qt as an array of shape (H, W, 3), uint8, row 0 at the top; a copy."""
    rgb = qimage.convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(rgb.constBits(), np.uint8).reshape(rgb.height(), rgb.bytesPerLine())
    return rows[:, : 3 * rgb.width()].reshape(rgb.height(), rgb.width(), 3).copy()


def image_of(image: Bytes, ratio: float = 1.0) -> QImage:
    """An array of shape (H, W, 3), uint8, as an image of Qt that owns its bytes."""
    data = np.ascontiguousarray(image)
    height, width, _ = data.shape
    qimage = QImage(data.data, width, height, 3 * width, QImage.Format.Format_RGB888).copy()
    qimage.setDevicePixelRatio(ratio)
    return qimage


def over(image: npt.NDArray[Any], background: npt.NDArray[Any]) -> Bytes:
    """What is seen of a premultiplied image (H, W, 4) over a background (H, W, 3), rounded as in an export."""
    seen = image[..., :3] + (1 - image[..., 3:]) * background
    return np.rint(np.clip(seen, 0, 1) * 255).astype(np.uint8)


def differences(first: Bytes, second: Bytes, channel: str) -> npt.NDArray[np.float32]:
    """Second minus first in levels (-255..255): shape (H, W), or (H, W, 3) for "rgb"."""
    if channel in ("red", "green", "blue"):
        at = ("red", "green", "blue").index(channel)
        return second[..., at].astype(np.float32) - first[..., at]
    difference = second.astype(np.float32)
    difference -= first
    return difference if channel == "rgb" else difference @ WEIGHTS


def coloured(values: npt.NDArray[np.float32], kind: str, limit: float) -> Bytes:
    """Differences in colours, shape (H, W, 3), as `volviz.compare.image_metrics.difference_image` draws them."""
    if kind == "absolute":
        share = np.abs(values) * np.float32(255.0 / limit)
    else:
        share = values * np.float32(127.5 / limit) + np.float32(127.5)
    index = np.rint(np.clip(share, 0, 255)).astype(np.uint8)
    return index if values.ndim == 3 else color_table("absolute" if kind == "absolute" else "signed")[index]


def quick_similarity(first: Bytes, second: Bytes) -> Bytes:
    """The map of structural similarity of the luma at half the resolution, while something moves."""
    small = [(image[::2, ::2] @ WEIGHTS).astype(np.float32) / 255 for image in (first, second)]
    if min(small[0].shape) < 7:
        return np.zeros((*first.shape[:2], 3), np.uint8)
    image = similarity_image(ssim_map(small[0], small[1]))
    return image.repeat(2, axis=0).repeat(2, axis=1)[: first.shape[0], : first.shape[1]]


def largest(values: npt.NDArray[np.float32]) -> float:
    """The largest difference in levels, at least 1, so that rounding does not look like a fault."""
    return max(float(np.abs(values).max()), 1.0)


def bar_colors(comparison: Comparison) -> Bytes:
    """Colours of the bar beside the image, shape (256, 3), the smallest value first."""
    if comparison.map == "ssim" or comparison.channel == "rgb":
        return np.repeat(np.arange(256, dtype=np.uint8)[:, None], 3, axis=1)
    return color_table("absolute" if comparison.map == "absolute" else "signed")
