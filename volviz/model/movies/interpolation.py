"""Between two scenes: numbers pass evenly, functions morph, cameras turn, and what has no middle is switched."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from functools import singledispatch
from itertools import pairwise
from typing import Any, TypeVar

import numpy as np

from volviz.errors import VolvizError
from volviz.model.camera import Camera
from volviz.model.layers import ImageLayer, LabelLayer
from volviz.model.movie import Movie
from volviz.model.movies.camera_path import CameraPath
from volviz.model.parameters import Parameter, parameters_of
from volviz.model.transfer.channels import Channel, ChannelPoint, limits, merged, split
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.references import VolumeRef

T = TypeVar("T")

#: Fields of layers, views and scenes that name something: they have no middle.
_NAMES = frozenset(
    {"channel", "active", "active_layer", "hidden", "colors", "names", "name", "comparison", "movie"}
)


def between(start: T, end: T, fraction: float) -> T:
    """What lies between two values of one type.

    Parameters
    ----------
    start, end : Scene, or any part of one
    fraction : float
        0 is the start, 1 the end. What has no middle (a technique, a choice, a number of layers) is switched halfway.
    """
    if start == end or fraction <= 0.0:
        return start
    if fraction >= 1.0:
        return end
    same = type(start) is type(end)
    found: T = _between(start, end, fraction) if same else _switched(start, end, fraction)
    return found


def _switched(start: Any, end: Any, fraction: float) -> Any:
    return start if fraction < 0.5 else end


@singledispatch
def _between(start: Any, end: Any, fraction: float) -> Any:
    """Values of other types: dataclasses field by field, the rest is switched."""
    if not is_dataclass(start) or isinstance(start, type):
        return _switched(start, end, fraction)
    known: dict[str, Parameter] = {p.name: p for p in parameters_of(type(start))}
    parts: dict[str, Any] = {}
    for field in fields(start):
        a, b = getattr(start, field.name), getattr(end, field.name)
        if field.name in known:
            parts[field.name] = _setting(known[field.name], a, b, fraction)
        elif field.name in _NAMES:
            parts[field.name] = _switched(a, b, fraction)
        else:
            parts[field.name] = between(a, b, fraction)
    return _made(start, end, parts, fraction)


def _made(start: Any, end: Any, parts: dict[str, Any], fraction: float) -> Any:
    """The value of these parts, or one of the ends where they do not go together."""
    try:
        return replace(start, **parts)
    except VolvizError:
        return _switched(start, end, fraction)


@_between.register
def _(start: float, end: float, fraction: float) -> float:
    return start + fraction * (end - start)


@_between.register
def _(start: int, end: int, fraction: float) -> int:
    return round(start + fraction * (end - start))


@_between.register
def _(start: bool, end: bool, fraction: float) -> bool:  # a bool is an int
    return bool(_switched(start, end, fraction))


@_between.register
def _(start: tuple, end: tuple, fraction: float) -> Any:  # type: ignore[type-arg]
    if len(start) != len(end):
        return _switched(start, end, fraction)
    return tuple(between(a, b, fraction) for a, b in zip(start, end, strict=True))


@_between.register(VolumeRef)
@_between.register(Movie)
def _(start: Any, end: Any, fraction: float) -> Any:
    return _switched(start, end, fraction)


@_between.register
def _(start: Camera, end: Camera, fraction: float) -> Camera:
    return CameraPath((start, end)).at(fraction)


@_between.register(ImageLayer)
@_between.register(LabelLayer)
def _(start: Any, end: Any, fraction: float) -> Any:
    """Layers that come or go fade."""
    if start.volume != end.volume:
        return _switched(start, end, fraction)
    parts = {
        field.name: _switched(a, b, fraction) if field.name in _NAMES else between(a, b, fraction)
        for field in fields(start)
        for a, b in [(getattr(start, field.name), getattr(end, field.name))]
    }
    if start.visible != end.visible:
        shown, share = (end, fraction) if end.visible else (start, 1.0 - fraction)
        parts |= {"visible": True, "opacity": shown.opacity * share}
    if isinstance(start, ImageLayer) and parts["transfer_function"] is not None:
        # a layer has a function, or a colour and a window
        parts |= {"color": None, "window": None}
    return _made(start, end, parts, fraction)


@_between.register
def _(start: TransferFunction, end: TransferFunction, fraction: float) -> TransferFunction:
    """At every value the mean of both, so that a function morphs into one of other points."""
    if start.domain != end.domain:
        return _switched(start, end, fraction)  # type: ignore[no-any-return]
    named = _switched(start, end, fraction)
    if len(start.points) == len(end.points) and _are_alike(start, end):
        # points move: a peak wanders instead of sinking here and rising there
        points = tuple(
            replace(
                a, value=between(a.value, b.value, fraction), color=between(a.color, b.color, fraction),
                opacity=between(a.opacity, b.opacity, fraction),
            )
            for a, b in zip(start.points, end.points, strict=True)
        )  # fmt: skip
        mixed = replace(start, points=points)
    else:
        channels = zip(split(start), split(end), strict=True)
        colors, opacities = (_mixed(one, other, fraction) for one, other in channels)
        mixed = merged(colors, opacities, start)
    return replace(
        mixed, name=named.name, opacity=between(start.opacity, end.opacity, fraction),
        by_gradient=between(start.by_gradient, end.by_gradient, fraction),
    )  # fmt: skip


def _are_alike(start: TransferFunction, end: TransferFunction) -> bool:
    """Whether opacity rises and falls between the same points, so that they mean the same things."""
    slopes = [
        [np.sign(b.opacity - a.opacity) for a, b in pairwise(function.points)] for function in (start, end)
    ]
    return slopes[0] == slopes[1]


def _mixed(one: Channel, other: Channel, fraction: float) -> Channel:
    """A channel whose levels lie between those of two others, at the values of both; jumps stay jumps."""
    points: list[ChannelPoint] = []
    for value in sorted({p.value for p in (*one, *other)}):
        below, here = (
            between(a, b, fraction) for a, b in zip(limits(one, value), limits(other, value), strict=True)
        )
        points += [ChannelPoint(value, level) for level in ((below, here) if below != here else (here,))]
    return tuple(points)


def _setting(parameter: Parameter, start: Any, end: Any, fraction: float) -> Any:
    """A setting of a technique; sliders that move by factors pass by factors."""
    if parameter.kind in ("bool", "choice", "path"):
        return _switched(start, end, fraction)
    numbers = isinstance(start, int | float) and isinstance(end, int | float)
    if parameter.logarithmic and numbers and start > 0 and end > 0:
        value = start * (end / start) ** fraction
        return round(value) if parameter.kind == "int" else value
    return between(start, end, fraction)
