"""Shapes to put on a transfer function: a ramp, a tent, a Gaussian peak, a box."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal

from volviz.errors import InputError
from volviz.model.transfer.channels import ChannelPoint, merged, split, straightened
from volviz.model.transfer.function import Color, TransferFunction

Shape = Literal["ramp", "tent", "gaussian", "box"]

#: Half width of a Gaussian peak in standard deviations, beyond which it counts as 0.
REACH = 3.0
#: Points by which a Gaussian is drawn; the largest deviation is 0.5 % of its height.
GAUSSIAN_POINTS = 33


def with_shape(
    function: TransferFunction,
    shape: Shape,
    center: float,
    width: float,
    height: float,
    color: Color | None = None,
) -> TransferFunction:
    """The function with a shape on it: the opacity is the larger of both.

    Parameters
    ----------
    function : TransferFunction
        What the shape is put on.
    shape : {"ramp", "tent", "gaussian", "box"}
        A ramp rises from left to right; a Gaussian is as wide as the interval of 3 standard deviations to
        either side.
    center, width : float
        Where and how wide, in the units of the function's values; the width is greater than 0.
    height : float
        Opacity at the top, 0..1.
    color : tuple of 3 floats, optional
        Colour inside the shape; the colours stay without it.

    Raises
    ------
    InputError
        An unknown shape, or a width or height outside what is allowed.
    """
    if not width > 0 or not 0.0 <= height <= 1.0:
        raise InputError(
            f"a shape needs a width above 0 and a height of 0 to 1, got {width!r} and {height!r}."
        )
    low, high = center - width / 2, center + width / 2
    profiles: dict[str, tuple[Callable[[float], float], int]] = {
        "ramp": (lambda t: (t + 1.0) / 2.0, 2),
        "tent": (lambda t: 1.0 - abs(t), 3),
        "gaussian": (lambda t: math.exp(-0.5 * (REACH * t) ** 2), GAUSSIAN_POINTS),
        "box": (lambda _t: 1.0, 2),
    }
    if shape not in profiles:
        raise InputError(f"a shape is one of {', '.join(profiles)}, not {shape!r}.")
    profile, count = profiles[shape]
    colors, opacities = split(function)
    inner = [
        ChannelPoint(center + t * width / 2, (height * profile(t),))
        for t in (2.0 * i / (count - 1) - 1.0 for i in range(count))
    ]
    inner[0], inner[-1] = ChannelPoint(low, inner[0].level), ChannelPoint(high, inner[-1].level)
    opacities = _upper(opacities, tuple(inner))
    if color is not None:
        outside = [s for s in colors if not low <= s.value <= high]
        before, after = (function.evaluate([v])[0, :3].tolist() for v in (low, high))
        edge = [
            ChannelPoint(low, tuple(before)),
            ChannelPoint(low, color),
            ChannelPoint(high, color),
            ChannelPoint(high, tuple(after)),
        ]
        left, right = [s for s in outside if s.value < low], [s for s in outside if s.value > high]
        colors = (*left, *edge, *right)
    return merged(straightened(colors), straightened(opacities), function)


def _upper(below: tuple[ChannelPoint, ...], shape: tuple[ChannelPoint, ...]) -> tuple[ChannelPoint, ...]:
    """The larger of a channel and a shape that is 0 outside its first and last point; crossings become points."""
    low, high = shape[0].value, shape[-1].value
    values = sorted({s.value for s in (*below, *shape)} | {low, high})
    points: list[ChannelPoint] = []
    for i, value in enumerate(values):
        left, right = _at(below, value, after=False), _at(below, value, after=True)
        top_left = 0.0 if value <= low else _at(shape, value, after=False) if value <= high else 0.0
        top_right = 0.0 if value >= high else _at(shape, value, after=True) if value >= low else 0.0
        before, here = max(left, top_left), max(right, top_right)
        points += (
            [ChannelPoint(value, (before,)), ChannelPoint(value, (here,))]
            if before != here
            else [ChannelPoint(value, (here,))]
        )
        if i + 1 < len(values):
            end = values[i + 1]
            a0, a1 = right, _at(below, end, after=False)
            b0 = top_right
            b1 = 0.0 if end <= low or end > high else _at(shape, end, after=False)
            if (a0 - b0) * (a1 - b1) < 0:
                t = (a0 - b0) / ((a0 - b0) - (a1 - b1))
                points.append(ChannelPoint(value + t * (end - value), (a0 + t * (a1 - a0),)))
    return tuple(points)


def _at(channel: tuple[ChannelPoint, ...], value: float, *, after: bool) -> float:
    """Level of a channel just below a value, or at it (`after`)."""
    at = [s for s in channel if s.value == value]
    if at:
        return (at[-1] if after else at[0]).level[0]
    before = [s for s in channel if s.value < value]
    beyond = [s for s in channel if s.value > value]
    if not before or not beyond:
        return (before[-1] if before else beyond[0]).level[0]
    a, b = before[-1], beyond[0]
    return a.level[0] + (value - a.value) / (b.value - a.value) * (b.level[0] - a.level[0])
