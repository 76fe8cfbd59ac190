"""Transfer functions: from a scalar to colour and opacity, as control points in data units."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.model.transfer.function_2d import TransferFunction2D

Color = tuple[float, float, float]
RGBA = tuple[float, float, float, float]
Domain = Literal["data", "relative"]

#: Smallest number of entries of a baked table.
MIN_TABLE = 1024
#: Largest number of entries of a baked table, unless the function has features narrower than two of them.
MAX_TABLE = 4096
#: Largest number of entries for the sake of such features.
MAX_NARROW_TABLE = 2**18
#: By how much colour or opacity must leave that of both sides to be a feature.
FEATURE = 1 / 512


@dataclass(frozen=True, slots=True)
class ControlPoint:
    """One point of a transfer function: straight (not premultiplied) colour and opacity at a value."""

    value: float
    color: Color
    opacity: float

    @property
    def rgba(self) -> RGBA:
        """Red, green, blue, opacity, each in 0..1."""
        return (*self.color, self.opacity)


@dataclass(frozen=True)
class TransferFunction:
    """Colour and opacity over the scalar value, linear between control points, constant beyond them.

    Two points at one value make a jump: exactly at that value the later one counts. Opacity is the opacity of
    a piece of ray one ``opacity_unit_distance`` long.

    Attributes
    ----------
    points : tuple of ControlPoint
        At least one, sorted by value.
    domain : {"data", "relative"}
        Whether values are data units (HU, say) or fractions 0..1 of the range of the data shown.
    name : str
        What to call it; presets carry their id.
    opacity : float
        Factor on all opacities, 0..1.
    by_gradient : TransferFunction2D or None
        Regions over value and gradient magnitude, which techniques that can use them draw instead of the
        curve while they are enabled.
    """

    points: tuple[ControlPoint, ...]
    domain: Domain = "data"
    name: str = ""
    opacity: float = 1.0
    by_gradient: TransferFunction2D | None = None

    def __post_init__(self) -> None:
        if not self.points:
            raise InputError("a transfer function needs at least one control point.")
        if self.domain not in ("data", "relative"):
            raise InputError(f'domain of a transfer function is "data" or "relative", got {self.domain!r}.')
        if not 0.0 <= self.opacity <= 1.0:
            raise InputError(f"overall opacity must lie between 0 and 1, got {self.opacity!r}.")
        values = [p.value for p in self.points]
        if any(b < a for a, b in pairwise(values)):
            object.__setattr__(self, "points", tuple(sorted(self.points, key=lambda p: p.value)))

    # ------------------------------------------------------------------ making one

    @classmethod
    def from_points(
        cls,
        points: Iterable[tuple[float, Sequence[float]]],
        *,
        domain: Domain = "data",
        name: str = "",
    ) -> TransferFunction:
        """A transfer function from ``(value, (red, green, blue, opacity))`` pairs.

        Raises
        ------
        InputError
            A value that is not finite, or a colour or opacity outside 0..1.
        """
        return cls(tuple(_point(value, rgba) for value, rgba in points), domain, name)

    @classmethod
    def preset(cls, name: str) -> TransferFunction:
        """The bundled preset of that name (see `volviz.presets`).

        Raises
        ------
        InputError
            There is no preset of that name.
        """
        from volviz.model.transfer.presets import preset

        return preset(name).transfer_function

    @classmethod
    def auto(cls, volume: Any) -> TransferFunction:
        """A first function for a `Volume` from its histogram: neither empty nor solid."""
        from volviz.model.transfer.automatic import auto_transfer_function

        return auto_transfer_function(volume)

    @classmethod
    def from_table(cls, table: npt.ArrayLike, *, name: str = "table") -> TransferFunction:
        """A relative function from a table of shape (N, 4), float 0..1 or uint8, over the range of data."""
        entries = np.asarray(table)
        if entries.ndim != 2 or entries.shape[1] != 4 or len(entries) < 2:
            raise InputError(
                f"a colour table has the shape (N, 4) with N of at least 2, got {entries.shape}."
            )
        rgba = entries.astype(np.float64) / (255.0 if entries.dtype == np.uint8 else 1.0)
        positions = np.linspace(0.0, 1.0, len(rgba))
        return cls.from_points(
            ((float(v), tuple(row)) for v, row in zip(positions, rgba.tolist(), strict=True)),
            domain="relative",
            name=name,
        )

    # ------------------------------------------------------------------ asking it

    def resolved(self, data_range: tuple[float, float]) -> TransferFunction:
        """The same function with values in data units, for data with that range."""
        if self.domain == "data":
            return self
        low, high = data_range
        return replace(
            self,
            points=tuple(replace(p, value=low + p.value * (high - low)) for p in self.points),
            domain="data",
        )

    def evaluate(
        self, values: npt.ArrayLike, data_range: tuple[float, float] | None = None
    ) -> npt.NDArray[np.float64]:
        """Straight RGBA at values in data units.

        Parameters
        ----------
        values : array_like of any shape
            Scalars in data units (fractions of the range for a relative function without `data_range`).
        data_range : tuple of 2 floats, optional
            Range of the data, for relative functions.

        Returns
        -------
        ndarray of shape values.shape + (4,)
            Red, green, blue, opacity in 0..1.
        """
        function = self if data_range is None else self.resolved(data_range)
        x = np.asarray(values, dtype=np.float64)
        positions = np.array([p.value for p in function.points])
        rgba = np.array([p.rgba for p in function.points])
        out = np.stack([np.interp(x, positions, rgba[:, c]) for c in range(4)], axis=-1)
        out[..., 3] *= self.opacity
        return out

    def bake(self, data_range: tuple[float, float], size: int = MIN_TABLE) -> npt.NDArray[np.float32]:
        """The function sampled at `size` values spread evenly over the data range, ends included.

        Returns
        -------
        ndarray of shape (size, 4), float32
            Straight RGBA; entry i belongs to ``low + i / (size - 1) * (high - low)``, so texel centres lie on
            the entries when looked up at ``(0.5 + t * (size - 1)) / size``.
        """
        low, high = data_range
        if not low < high:
            high = low + 1.0
        return self.evaluate(np.linspace(low, high, size), data_range).astype(np.float32)

    def table_range(self, data_range: tuple[float, float]) -> tuple[float, float]:
        """The part of the data range between the first and the last point, where the function changes at all.

        A table baked over it and looked up with clamped coordinates is right everywhere, and finer than one
        over the whole range: one outlier of a billion would leave all other data in a single entry of that.
        Constant ends are left out where features between them would vanish in a table over all points.
        """
        low, high = data_range
        points = self.resolved(data_range).points
        if _narrowest_feature(points, _feature_limit(points[0].value, points[-1].value)) is not None:
            points = _without_constant_ends(points)
        first, last = points[0].value, points[-1].value
        if len(points) > 1 and points[1].value == first:
            # a jump at the very start: the side below it must stay within the table
            first -= 1e-3 * (last - first)
        first, last = max(first, low), min(last, high)
        return (first, last) if first < last else (low, high)

    def table_size(self, table_range: tuple[float, float], *, integer: bool) -> int:
        """Number of entries of a table over a range: enough for every feature, a single label among 65536 say."""
        size = table_size(table_range, integer)
        narrowest = _narrowest_feature(self.resolved(table_range).points, _feature_limit(*table_range))
        if size < MAX_TABLE or narrowest is None:
            return size
        span = table_range[1] - table_range[0]
        per_unit = 2.0 / narrowest
        if integer and span >= 1:
            # control points half-way between whole numbers, and these themselves, fall on entries
            per_unit = 2.0 * np.ceil(per_unit / 2.0)
        return int(min(max(round(span * per_unit) + 1, size), MAX_NARROW_TABLE))

    def oracle_range(self, data_range: tuple[float, float]) -> tuple[float, float]:
        """The range of an oracle's table: that of the data, unless outliers would leave the function few entries."""
        first, last = self.table_range(data_range)
        low, high = data_range
        return (first, last) if high - low > 8 * (last - first) else (low, high)

    def visible_range(self, data_range: tuple[float, float]) -> tuple[float, float] | None:
        """Lowest and highest value of the data with an opacity above 0; None when nothing is visible."""
        entries = self.table_size(data_range, integer=False)
        table = self.bake(data_range, entries)[:, 3]
        seen = np.flatnonzero(table > 0)
        if len(seen) == 0:
            return None
        values = np.linspace(*data_range, entries)
        return float(values[max(seen[0] - 1, 0)]), float(values[min(seen[-1] + 1, entries - 1)])

    # ------------------------------------------------------------------ edits, each a new function

    def with_point(self, value: float, rgba: Sequence[float] | None = None) -> tuple[TransferFunction, int]:
        """The function with one more point, and its index; without `rgba` the curve keeps its shape."""
        if rgba is None:
            r, g, b, a = self.evaluate([value])[0]
            rgba = (r, g, b, a / self.opacity if self.opacity else 0.0)
        index = bisect_right([p.value for p in self.points], value)
        points = (*self.points[:index], _point(value, rgba), *self.points[index:])
        return replace(self, points=points), index

    def without_points(self, indices: Iterable[int]) -> TransferFunction:
        """The function without the points of these indices; the last remaining point stays."""
        drop = set(indices)
        kept = tuple(p for i, p in enumerate(self.points) if i not in drop)
        return replace(self, points=kept or self.points[:1])

    def with_changed_point(
        self,
        index: int,
        *,
        value: float | None = None,
        opacity: float | None = None,
        color: Sequence[float] | None = None,
    ) -> TransferFunction:
        """The function with one point changed; both neighbours limit its value, so the order stays."""
        point = self.points[index]
        if value is not None:
            if index > 0:
                value = max(value, self.points[index - 1].value)
            if index + 1 < len(self.points):
                value = min(value, self.points[index + 1].value)
        changed = _point(
            point.value if value is None else value,
            (*(point.color if color is None else color), point.opacity if opacity is None else opacity),
        )
        return replace(self, points=(*self.points[:index], changed, *self.points[index + 1 :]))

    def shifted(self, offset: float) -> TransferFunction:
        """All values moved by `offset`, those of the regions too."""
        return replace(
            self,
            points=tuple(replace(p, value=p.value + offset) for p in self.points),
            by_gradient=None if self.by_gradient is None else self.by_gradient.mapped(1.0, 0.0, offset),
        )

    def stretched(self, factor: float, center: float) -> TransferFunction:
        """All values scaled about `center` by a factor greater than 0."""
        if not factor > 0:
            raise InputError(f"a transfer function is stretched by a factor greater than 0, got {factor!r}.")
        return replace(
            self,
            points=tuple(replace(p, value=center + (p.value - center) * factor) for p in self.points),
            by_gradient=None if self.by_gradient is None else self.by_gradient.mapped(factor, center, 0.0),
        )

    def with_opacity(self, opacity: float) -> TransferFunction:
        """The function with another overall opacity (0..1)."""
        return replace(self, opacity=min(max(float(opacity), 0.0), 1.0))

    # ------------------------------------------------------------------ to and from plain data

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON; `from_dict` gives back an equal function."""
        data = {
            "domain": self.domain,
            "name": self.name,
            "opacity": self.opacity,
            "points": [[p.value, *p.color, p.opacity] for p in self.points],
        }
        return data if self.by_gradient is None else {**data, "by_gradient": self.by_gradient.to_dict()}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> TransferFunction:
        """The function that `to_dict` described.

        Raises
        ------
        InputError
            The data does not describe a transfer function.
        """
        try:
            points = tuple(_point(float(v), rgba) for v, *rgba in data["points"])
            by_gradient = data.get("by_gradient")
            return cls(
                points,
                data.get("domain", "data"),
                str(data.get("name", "")),
                float(data.get("opacity", 1.0)),
                None if by_gradient is None else TransferFunction2D.from_dict(by_gradient),
            )
        except (KeyError, TypeError, ValueError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError(
                'a transfer function needs "points": a list of [value, red, green, blue, opacity].'
            ) from None


def table_size(data_range: tuple[float, float], integer: bool) -> int:
    """Number of table entries for data with that range.

    Integer data with a narrow range gets a whole number of entries per value, so that control points on
    integers fall on entries and the piecewise linear function is reproduced exactly.
    """
    span = data_range[1] - data_range[0]
    if integer and 1 <= span <= MAX_TABLE - 1:
        per_value = -(-(MIN_TABLE - 1) // int(span))
        return int(span) * per_value + 1
    return MAX_TABLE


def _feature_limit(first: float, last: float) -> float:
    """Width of two entries of the usual table over a range: what is narrower may fall between entries."""
    return 2.0 * (last - first) / (MAX_TABLE - 1)


@lru_cache(maxsize=64)
def _narrowest_feature(points: tuple[ControlPoint, ...], limit: float) -> float | None:
    """Width of the narrowest piece where a function leaves the colours on both sides; None: none below `limit`."""
    narrowest = None
    for k in range(1, len(points) - 1):
        here = points[k]
        for before in reversed(points[:k]):
            if here.value - before.value >= limit:
                break
            for after in points[k + 1 :]:
                width = after.value - before.value
                if width >= (limit if narrowest is None else narrowest):
                    break
                if width > 0 and _leaves(here, before, after):
                    narrowest = width
    return narrowest


def _leaves(point: ControlPoint, before: ControlPoint, after: ControlPoint) -> bool:
    return any(
        not min(a, b) - FEATURE <= c <= max(a, b) + FEATURE
        for a, b, c in zip(before.rgba, after.rgba, point.rgba, strict=True)
    )


def _without_constant_ends(points: tuple[ControlPoint, ...]) -> tuple[ControlPoint, ...]:
    first, last = 0, len(points) - 1
    while first < last and points[first + 1].rgba == points[first].rgba:
        first += 1
    while last > first and points[last - 1].rgba == points[last].rgba:
        last -= 1
    return points[first : last + 1]


def _point(value: float, rgba: Sequence[float]) -> ControlPoint:
    try:
        r, g, b, a = (float(c) for c in rgba)
        value = float(value)
    except (TypeError, ValueError):
        raise InputError(
            f"a control point is (value, (red, green, blue, opacity)), got ({value!r}, {rgba!r})."
        ) from None
    if not np.isfinite(value):
        raise InputError(f"a control point needs a finite value, got {value!r}.")
    if not all(0.0 <= c <= 1.0 for c in (r, g, b, a)):
        raise InputError(f"colour and opacity of a control point lie between 0 and 1, got {(r, g, b, a)}.")
    return ControlPoint(value, (r, g, b), a)
