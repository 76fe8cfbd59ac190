"""Pre-integrated classification: colour and opacity of a ray segment from the values at its two ends.

Between its ends the value is taken to change linearly, so that the segment runs through every entry of the
transfer function between the front and the back value; nothing between two samples is missed (Engel, Kraus
and Ertl 2001). With extinction t and colour c as functions of the value,

    alpha = 1 - exp(-D),   D = length / (b - f) * integral of t from f to b
    C     = (integral of t c / integral of t) * alpha

The second factor of C is the self-attenuation of the segment; without it the method is of first order only.
Integrals come from cumulative sums, so that a table costs one exponential per entry.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.kernels.compiled import compiled

Float64Array = npt.NDArray[np.float64]

#: Opacity per unit length above which extinction stops to grow: an opaque entry has extinction -ln(1e-6) =
#: 13.8.
MAX_OPACITY = 1.0 - 1e-6

#: Distance in table entries below which the value counts as constant: the difference of the sums would lose
#: digits.
_CONSTANT = 1e-4


class Extinction(NamedTuple):
    """A baked table as extinction and its running integrals over the table coordinate x = 0 .. n - 1.

    Between entries, extinction and (extinction x colour) are taken as linear; the running integrals are
    exact for that.

    Attributes
    ----------
    nodes : ndarray of shape (n, 4), float64
        (extinction x red, extinction x green, extinction x blue, extinction) at each entry, per unit length.
    sums : ndarray of shape (n, 4), float64
        Integrals of `nodes` from entry 0, in table entries.
    """

    nodes: Float64Array
    sums: Float64Array


def extinction_sums(table: npt.ArrayLike) -> Extinction:
    """Extinction of a baked transfer function and its running integrals.

    Parameters
    ----------
    table : array_like of shape (n, 4), n >= 2
        Straight RGBA; opacity per unit length. Extinction is ``-ln(1 - min(opacity, MAX_OPACITY))``.

    Raises
    ------
    InputError
        Another shape, or opacities outside 0..1.
    """
    rgba = np.asarray(table, np.float64)
    if rgba.ndim != 2 or rgba.shape[1] != 4 or len(rgba) < 2:
        raise InputError(f"the table must have shape (n, 4) with at least 2 entries, got {rgba.shape}.")
    if not (np.all(rgba[:, 3] >= 0) and np.all(rgba[:, 3] <= 1)):
        raise InputError("the opacities of the table must lie between 0 and 1.")
    tau = -np.log1p(-np.minimum(rgba[:, 3], MAX_OPACITY))
    nodes = np.concatenate([rgba[:, :3] * tau[:, None], tau[:, None]], axis=1)
    sums = np.zeros_like(nodes)
    np.cumsum(0.5 * (nodes[1:] + nodes[:-1]), axis=0, out=sums[1:])
    return Extinction(nodes, sums)


@compiled
def segment_color(
    extinction: Extinction, front: float, back: float, length: float
) -> tuple[float, float, float, float]:
    """Premultiplied RGBA of one segment from the table coordinates of its ends (0 .. n - 1).

    `length` is the segment's length in unit lengths. Exact for the piecewise linear extinction. Symmetric in
    `front` and `back`.
    """
    nodes, sums = extinction.nodes, extinction.sums
    last = len(nodes) - 2
    i, j = min(int(front), last), min(int(back), last)
    gap = back - front
    if i == j or abs(gap) < _CONSTANT:
        # within one interval the mean of a linear function is its value in the middle
        x = 0.5 * (front + back)
        i = min(int(x), last)
        u = x - i
        tau = nodes[i, 3] * (1 - u) + nodes[i + 1, 3] * u
        red = nodes[i, 0] * (1 - u) + nodes[i + 1, 0] * u
        green = nodes[i, 1] * (1 - u) + nodes[i + 1, 1] * u
        blue = nodes[i, 2] * (1 - u) + nodes[i + 1, 2] * u
    else:
        u, w = front - i, back - j
        tau = (_integral(nodes, sums, j, w, 3) - _integral(nodes, sums, i, u, 3)) / gap
        red = (_integral(nodes, sums, j, w, 0) - _integral(nodes, sums, i, u, 0)) / gap
        green = (_integral(nodes, sums, j, w, 1) - _integral(nodes, sums, i, u, 1)) / gap
        blue = (_integral(nodes, sums, j, w, 2) - _integral(nodes, sums, i, u, 2)) / gap
    if tau <= 0:
        return 0.0, 0.0, 0.0, 0.0
    alpha = -np.expm1(-tau * length)
    return red / tau * alpha, green / tau * alpha, blue / tau * alpha, alpha


@compiled
def _integral(nodes: Float64Array, sums: Float64Array, i: int, u: float, channel: int) -> float:
    """Integral from entry 0 to the coordinate i + u, 0 <= u <= 1."""
    a, b = nodes[i, channel], nodes[i + 1, channel]
    return sums[i, channel] + u * (a + 0.5 * u * (b - a))  # type: ignore[no-any-return]


def preintegration_table(
    table: npt.ArrayLike, relative_length: float, size: int = 256
) -> npt.NDArray[np.float32]:
    """Table of segment colours for all pairs of front and back values.

    Parameters
    ----------
    table : array_like of shape (n, 4), n >= 2
        Baked transfer function, straight RGBA over the data range; opacity per unit length.
    relative_length : float
        Length of a segment divided by the opacity unit distance, above 0.
    size : int, default: 256
        Entries along each axis, at least 2; entry i stands for the fraction i / (size - 1) of the data range.

    Returns
    -------
    ndarray of shape (size, size, 4), float32
        Premultiplied RGBA, index ``[front, back]``: rows are front values, columns back values. As a 2D
        texture the back value is the first coordinate (s) and the front value the second (t). Symmetric:
        C[f, b] = C[b, f]. For a segment of another length, scale the opacity to ``1 - (1 - alpha)^ratio``
        and the colour by scaled / alpha.

    Raises
    ------
    InputError
        A table of another shape, a length that is not positive, fewer than 2 entries.
    """
    if not relative_length > 0:
        raise InputError(f"relative_length must be greater than 0, got {relative_length:g}.")
    if size < 2:
        raise InputError(f"a pre-integration table needs at least 2 entries along each axis, got {size}.")
    result = np.empty((size, size, 4), np.float32)
    extinction = extinction_sums(table)
    _fill_table(extinction, float(relative_length), result)
    return result


@compiled
def _fill_table(extinction: Extinction, length: float, result: npt.NDArray[np.float32]) -> None:
    size = len(result)
    scale = (len(extinction.nodes) - 1) / (size - 1)
    for f in range(size):
        for b in range(f + 1):
            color = segment_color(extinction, f * scale, b * scale, length)
            for channel in range(4):
                result[f, b, channel] = color[channel]
                result[b, f, channel] = color[channel]
