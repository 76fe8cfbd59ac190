"""Colours between two colours, in the spaces that colour maps of other programs name."""

from __future__ import annotations

import colorsys

import numpy as np
import numpy.typing as npt

from volviz.model.transfer.function import Color

# sRGB to XYZ under D65 (IEC 61966-2-1:1999), and its white point
_TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
_WHITE = _TO_XYZ.sum(axis=1)
_EDGE = 6.0 / 29.0


def between(first: tuple[float, ...], second: tuple[float, ...], t: float, space: str = "RGB") -> Color:
    """The colour at a fraction `t` of the way, along a straight line in a colour space.

    Parameters
    ----------
    first, second : tuple of 3 floats
        Red, green, blue in 0..1.
    t : float
        0 gives `first`, 1 gives `second`.
    space : str
        "HSV" (the shorter way round the circle), "Lab", "CIELAB", "Diverging" (the last as Lab); "Step"
        keeps the first colour; anything else is RGB.
    """
    a, b = np.clip(first[:3], 0.0, 1.0), np.clip(second[:3], 0.0, 1.0)
    kind = space.upper()
    if kind == "STEP":
        color = a if t < 1.0 else b
    elif kind == "HSV":
        (h0, s0, v0), (h1, s1, v1) = colorsys.rgb_to_hsv(*a.tolist()), colorsys.rgb_to_hsv(*b.tolist())
        turn = (h1 - h0 + 0.5) % 1.0 - 0.5
        color = np.array(colorsys.hsv_to_rgb((h0 + t * turn) % 1.0, s0 + t * (s1 - s0), v0 + t * (v1 - v0)))
    elif kind in ("LAB", "CIELAB", "DIVERGING"):
        p, q = rgb_to_lab(a), rgb_to_lab(b)
        color = lab_to_rgb(p + t * (q - p))
    else:
        color = a + t * (b - a)
    r, g, blue = np.clip(color, 0.0, 1.0).tolist()
    return r, g, blue


def rgb_to_lab(rgb: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """CIE L*a*b* (CIE 15:2004) of sRGB colours in 0..1, arrays of shape (..., 3)."""
    c = np.asarray(rgb, dtype=np.float64)
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    xyz = linear @ _TO_XYZ.T / _WHITE
    f = np.where(xyz > _EDGE**3, np.cbrt(xyz), xyz / (3 * _EDGE**2) + 4.0 / 29.0)
    return np.stack(
        [116.0 * f[..., 1] - 16.0, 500.0 * (f[..., 0] - f[..., 1]), 200.0 * (f[..., 1] - f[..., 2])], axis=-1
    )


def lab_to_rgb(lab: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """SRGB in 0..1 (clipped to the gamut) of CIE L*a*b* colours, arrays of shape (..., 3)."""
    values = np.asarray(lab, dtype=np.float64)
    y = (values[..., 0] + 16.0) / 116.0
    f = np.stack([y + values[..., 1] / 500.0, y, y - values[..., 2] / 200.0], axis=-1)
    xyz = np.where(f > _EDGE, f**3, 3 * _EDGE**2 * (f - 4.0 / 29.0)) * _WHITE
    linear = np.clip(xyz @ np.linalg.inv(_TO_XYZ).T, 0.0, 1.0)
    return np.asarray(np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055))
