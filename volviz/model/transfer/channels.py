"""Colour and opacity of a transfer function taken apart and put together again.

A transfer function is one list of points; a colour ramp that is edited by itself needs only those that bend
the colours. `split` leaves out of each channel what lies on a straight line anyway; `merged` joins two channels to
a function that has the same colour and opacity at every value.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.model.transfer.function import Color, ControlPoint, TransferFunction

#: Deviation of colour or opacity that counts as none.
STRAIGHT = 1e-9


@dataclass(frozen=True)
class ChannelPoint:
    """A bend of one channel: a value with a colour (3 numbers) or an opacity (1 number)."""

    value: float
    level: tuple[float, ...]


Channel = tuple[ChannelPoint, ...]


def split(function: TransferFunction) -> tuple[Channel, Channel]:
    """The colour channel and the opacity channel of a function, each with its first and last point kept."""
    colors = tuple(ChannelPoint(p.value, p.color) for p in function.points)
    opacities = tuple(ChannelPoint(p.value, (p.opacity,)) for p in function.points)
    return straightened(colors), straightened(opacities)


def merged(colors: Channel, opacities: Channel, like: TransferFunction) -> TransferFunction:
    """One function from two channels; name, domain and overall opacity come from `like`.

    Raises
    ------
    InputError
        A channel without points.
    """
    if not colors or not opacities:
        raise InputError("colours and opacities each need at least one stop.")
    points = []
    for value in sorted({s.value for s in colors} | {s.value for s in opacities}):
        (color_before, color), (opacity_before, opacity) = limits(colors, value), limits(opacities, value)
        if color_before != color or opacity_before != opacity:
            points.append(_point(value, color_before, opacity_before))
        points.append(_point(value, color, opacity))
    return replace(like, points=tuple(points))


def with_moved_point(channel: Channel, index: int, value: float) -> Channel:
    """The channel with one point at another value, limited by both neighbours."""
    if index > 0:
        value = max(value, channel[index - 1].value)
    if index + 1 < len(channel):
        value = min(value, channel[index + 1].value)
    return (*channel[:index], replace(channel[index], value=value), *channel[index + 1 :])


def with_point(channel: Channel, value: float) -> tuple[Channel, int]:
    """The channel with one more point that leaves it as it looks, and its index."""
    index = sum(s.value <= value for s in channel)
    return (*channel[:index], ChannelPoint(value, limits(channel, value)[1]), *channel[index:]), index


def without_point(channel: Channel, index: int) -> Channel:
    """The channel without one point; the last remaining one stays."""
    return channel if len(channel) < 2 else (*channel[:index], *channel[index + 1 :])


def with_level(channel: Channel, index: int, level: Sequence[float]) -> Channel:
    """The channel with another colour or opacity at one point."""
    return (*channel[:index], replace(channel[index], level=tuple(level)), *channel[index + 1 :])


def with_ramp(
    function: TransferFunction, ramp: npt.ArrayLike, low: float | None = None, high: float | None = None
) -> TransferFunction:
    """The function with its opacities and the colours of a ramp.

    Parameters
    ----------
    function : TransferFunction
        Gives the opacities.
    ramp : array_like of shape (n, 3), n of at least 2
        Colours in 0..1, evenly spread.
    low, high : float, optional
        Values that get the first and last colour; default: the first and last point.

    Raises
    ------
    InputError
        The ramp has another shape or colours outside 0..1.
    """
    colors = np.asarray(ramp, dtype=np.float64)
    if colors.ndim != 2 or colors.shape[1] != 3 or len(colors) < 2:
        raise InputError(f"a colour ramp has the shape (n, 3) with n of at least 2, got {colors.shape}.")
    if not (np.isfinite(colors).all() and colors.min() >= 0.0 and colors.max() <= 1.0):
        raise InputError("the colours of a ramp lie between 0 and 1.")
    low = function.points[0].value if low is None else low
    high = function.points[-1].value if high is None else high
    if not low < high:
        high = low + 1.0
    values = np.linspace(low, high, len(colors)).tolist()
    channel = tuple(ChannelPoint(v, tuple(c)) for v, c in zip(values, colors.tolist(), strict=True))
    return merged(straightened(channel, 1 / 512), split(function)[1], function)


def simplified(function: TransferFunction, tolerance: float = 0.45 / 255) -> TransferFunction:
    """The function with as few of its points as keep colour and opacity within a tolerance everywhere.

    Douglas and Peucker's subdivision (1973), measured along colour and opacity; jumps stay.
    """
    rows = [ChannelPoint(p.value, p.rgba) for p in function.points]
    keep = _needed(rows, tolerance)
    return replace(function, points=tuple(function.points[i] for i in keep))


def straightened(channel: Channel, tolerance: float = STRAIGHT) -> Channel:
    """The channel without the points that lie on a straight line between others; the ends stay."""
    return tuple(channel[i] for i in _needed(channel, tolerance))


def _needed(points: Sequence[ChannelPoint], tolerance: float) -> list[int]:
    last = len(points) - 1
    values = np.array([s.value for s in points])
    levels = np.array([s.level for s in points])
    keep = {0, last}
    # Both sides of a jump bound pieces of their own; more than two points at a value have no effect.
    for i, (a, b) in enumerate(pairwise(points)):
        if a.value == b.value and a.level != b.level:
            keep |= {i, i + 1}
    todo = list(pairwise(sorted(keep)))
    while todo:
        i, j = todo.pop()
        if j - i < 2 or values[i] == values[j]:
            continue
        t = ((values[i + 1 : j] - values[i]) / (values[j] - values[i]))[:, None]
        off = np.abs(levels[i + 1 : j] - (levels[i] + t * (levels[j] - levels[i]))).max(axis=1)
        worst = int(np.argmax(off))
        if off[worst] > tolerance:
            middle = i + 1 + worst
            keep.add(middle)
            todo += [(i, middle), (middle, j)]
    return sorted(keep)


def limits(channel: Channel, value: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Level just below a value and at it; they differ at a jump."""
    at = [s for s in channel if s.value == value]
    if at:
        return at[0].level, at[-1].level
    before = [s for s in channel if s.value < value]
    after = [s for s in channel if s.value > value]
    if not before:
        return after[0].level, after[0].level
    if not after:
        return before[-1].level, before[-1].level
    a, b = before[-1], after[0]
    t = (value - a.value) / (b.value - a.value)
    level = tuple(x + t * (y - x) for x, y in zip(a.level, b.level, strict=True))
    return level, level


def _point(value: float, color: tuple[float, ...], opacity: tuple[float, ...]) -> ControlPoint:
    r, g, b, a = (min(max(c, 0.0), 1.0) for c in (*color, *opacity))
    rgb: Color = (r, g, b)
    return ControlPoint(value, rgb, a)
