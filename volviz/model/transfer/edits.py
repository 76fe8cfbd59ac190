"""Edits of several control points at once; each takes a function and gives back a new one.

Indices count the points of the function from 0. Edits that can change the order of the points also tell where
the chosen ones are afterwards.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Literal

from volviz.errors import InputError
from volviz.model.transfer.function import ControlPoint, TransferFunction

Indices = tuple[int, ...]
Edge = Literal["left", "center", "right", "top", "middle", "bottom"]


def moved(
    function: TransferFunction, indices: Iterable[int], value: float = 0.0, opacity: float = 0.0
) -> TransferFunction:
    """The chosen points moved together.

    The move is shortened where a chosen point would pass one that stays, or leave the opacities 0..1: the
    group keeps its shape and the points their order.

    Parameters
    ----------
    function : TransferFunction
        What is edited.
    indices : iterable of int
        Points that move.
    value : float
        By how much, in units of the function's values.
    opacity : float
        By how much.
    """
    points = function.points
    chosen = _checked(function, indices)
    if not chosen:
        return function
    inside = set(chosen)
    for i in chosen:
        if i > 0 and i - 1 not in inside:
            value = max(value, points[i - 1].value - points[i].value)
        if i + 1 < len(points) and i + 1 not in inside:
            value = min(value, points[i + 1].value - points[i].value)
    opacity = max(opacity, -min(points[i].opacity for i in chosen))
    opacity = min(opacity, 1.0 - max(points[i].opacity for i in chosen))
    changed = list(points)
    for i in chosen:
        p = points[i]
        changed[i] = replace(p, value=p.value + value, opacity=min(max(p.opacity + opacity, 0.0), 1.0))
    # Sums of floats may pass a neighbour by a rounding error.
    for i in range(1, len(changed)):
        if changed[i].value < changed[i - 1].value:
            changed[i] = replace(changed[i], value=changed[i - 1].value)
    return replace(function, points=tuple(changed))


def duplicated(
    function: TransferFunction, indices: Iterable[int], offset: float
) -> tuple[TransferFunction, Indices]:
    """The function with copies of the chosen points, moved by `offset`; tells where the copies are."""
    chosen = _checked(function, indices)
    marked = [(p, False) for p in function.points]
    marked += [(replace(function.points[i], value=function.points[i].value + offset), True) for i in chosen]
    return _sorted(function, marked)


def aligned(function: TransferFunction, indices: Iterable[int], edge: Edge) -> TransferFunction:
    """The chosen points at one value ("left", "center", "right") or one opacity ("top", "middle", "bottom").

    Values are limited by the points that stay, so that the order remains.
    """
    chosen = _checked(function, indices)
    if len(chosen) < 2:
        return function
    values = [function.points[i].value for i in chosen]
    opacities = [function.points[i].opacity for i in chosen]
    targets = {
        "left": min(values),
        "right": max(values),
        "center": sum(values) / len(values),
        "top": max(opacities),
        "bottom": min(opacities),
        "middle": sum(opacities) / len(opacities),
    }
    if edge not in targets:
        raise InputError(f"points are aligned left, center, right, top, middle or bottom, not {edge!r}.")
    target = targets[edge]
    changed = list(function.points)
    if edge in ("top", "middle", "bottom"):
        for i in chosen:
            changed[i] = replace(changed[i], opacity=target)
        return replace(function, points=tuple(changed))
    stay = [j for j in range(len(changed)) if j not in chosen]
    for i in chosen:
        low = max((changed[j].value for j in stay if j < i), default=target)
        high = min((changed[j].value for j in stay if j > i), default=target)
        changed[i] = replace(changed[i], value=min(max(target, low), high))
    return replace(function, points=tuple(changed))


def distributed(function: TransferFunction, indices: Iterable[int]) -> tuple[TransferFunction, Indices]:
    """The chosen points at equal distances between the first and the last of them."""
    chosen = _checked(function, indices)
    if len(chosen) < 3:
        return function, chosen
    low, high = function.points[chosen[0]].value, function.points[chosen[-1]].value
    marked = [(p, False) for p in function.points]
    for rank, i in enumerate(chosen[1:-1], start=1):
        value = low + (high - low) * rank / (len(chosen) - 1)
        marked[i] = (replace(function.points[i], value=value), True)
    for i in (chosen[0], chosen[-1]):
        marked[i] = (function.points[i], True)
    return _sorted(function, marked)


def flipped(function: TransferFunction, indices: Iterable[int]) -> tuple[TransferFunction, Indices]:
    """The chosen points mirrored left to right about the middle of their values."""
    chosen = _checked(function, indices)
    if not chosen:
        return function, ()
    total = function.points[chosen[0]].value + function.points[chosen[-1]].value
    mirrored = [
        (replace(function.points[i], value=total - function.points[i].value), True) for i in reversed(chosen)
    ]
    # Reversed, so that the order at a jump is mirrored too; each goes into a slot of a chosen point.
    marked = [(p, False) for p in function.points]
    for slot, one in zip(chosen, mirrored, strict=True):
        marked[slot] = one
    return _sorted(function, marked)


def inverted(function: TransferFunction, indices: Iterable[int]) -> TransferFunction:
    """The opacities of the chosen points mirrored top to bottom between the lowest and highest of them."""
    chosen = _checked(function, indices)
    if not chosen:
        return function
    opacities = [function.points[i].opacity for i in chosen]
    total = min(opacities) + max(opacities)
    changed = list(function.points)
    for i in chosen:
        changed[i] = replace(changed[i], opacity=min(max(total - changed[i].opacity, 0.0), 1.0))
    return replace(function, points=tuple(changed))


def scaled(
    function: TransferFunction, indices: Iterable[int], *, value: float = 1.0, opacity: float = 1.0
) -> tuple[TransferFunction, Indices]:
    """The chosen points spread about the middle of their values, their opacities multiplied.

    Parameters
    ----------
    value : float
        Factor on the distances from the middle, 0 or more.
    opacity : float
        Factor on the opacities, 0 or more; they stay within 0..1.

    Raises
    ------
    InputError
        A negative factor.
    """
    if value < 0 or opacity < 0:
        raise InputError(f"points are scaled by factors of 0 or more, got {value!r} and {opacity!r}.")
    chosen = _checked(function, indices)
    if not chosen:
        return function, ()
    middle = (function.points[chosen[0]].value + function.points[chosen[-1]].value) / 2
    marked = [(p, False) for p in function.points]
    for i in chosen:
        p = function.points[i]
        marked[i] = (
            replace(p, value=middle + (p.value - middle) * value, opacity=min(p.opacity * opacity, 1.0)),
            True,
        )
    return _sorted(function, marked)


def fitted(function: TransferFunction, low: float, high: float) -> TransferFunction:
    """All points spread so that the first lies at `low` and the last at `high`.

    Raises
    ------
    InputError
        `low` is not below `high`.
    """
    if not low < high:
        raise InputError(f"a function is fitted between two different values, got {low!r} and {high!r}.")
    first, last = function.points[0].value, function.points[-1].value
    if first == last:
        return replace(function, points=tuple(replace(p, value=low) for p in function.points))
    factor = (high - low) / (last - first)
    return replace(
        function, points=tuple(replace(p, value=low + (p.value - first) * factor) for p in function.points)
    )


def _checked(function: TransferFunction, indices: Iterable[int]) -> Indices:
    chosen = tuple(sorted(set(indices)))
    if chosen and not 0 <= chosen[0] <= chosen[-1] < len(function.points):
        raise InputError(
            f"this function has the points 0 to {len(function.points) - 1}, not {chosen[0]} to {chosen[-1]}."
        )
    return chosen


def _sorted(
    function: TransferFunction, marked: Sequence[tuple[ControlPoint, bool]]
) -> tuple[TransferFunction, Indices]:
    ordered = sorted(marked, key=lambda pair: pair[0].value)
    function = replace(function, points=tuple(p for p, _ in ordered))
    return function, tuple(i for i, (_, mark) in enumerate(ordered) if mark)
