"""The axes of the plot: from values and opacities to fractions of its width and height, and back."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from volviz.model.ticks import round_values

#: The part of the data range around its origin that a logarithmic axis shows linearly.
LINEAR_PART = 1e-2
#: How far beyond the data the view may go, and the smallest part of the data it may show.
BEYOND, SMALLEST = 1.0, 1e-6
#: Exponent of the opacity scale that gives small opacities room.
FINE_EXPONENT = 0.4


@dataclass(frozen=True)
class ValueAxis:
    """The visible window of values.

    Attributes
    ----------
    low, high : float
        Values at the left and right edge, data units.
    data_low, data_high : float
        Range of the data.
    logarithmic : bool
        Values are spread by the inverse hyperbolic sine of their distance from an origin: 0 where the data
        have both signs or start there, else the lowest value. Near the origin that is linear, far from it
        logarithmic.
    """

    low: float
    high: float
    data_low: float
    data_high: float
    logarithmic: bool = False

    @classmethod
    def of_range(cls, low: float, high: float, *, logarithmic: bool = False) -> ValueAxis:
        """An axis that shows exactly that range of data."""
        if not low < high:
            high = low + max(abs(low) * 1e-6, 1.0)
        return cls(low, high, low, high, logarithmic)

    @property
    def origin(self) -> float:
        """Where a logarithmic axis has its finest resolution."""
        return 0.0 if self.data_low <= 0.0 <= self.data_high else self.data_low

    def fraction(self, value: float) -> float:
        """Position of a value: 0 at the left edge, 1 at the right edge, beyond them outside the view."""
        a, b = self._forward(self.low), self._forward(self.high)
        return (self._forward(value) - a) / (b - a)

    def value(self, fraction: float) -> float:
        """Value at a position."""
        a, b = self._forward(self.low), self._forward(self.high)
        return self._backward(a + fraction * (b - a))

    def values(self, fractions: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Values at many positions."""
        a, b = self._forward(self.low), self._forward(self.high)
        places = a + fractions * (b - a)
        if not self.logarithmic:
            return places
        return self.origin + np.sinh(places) * LINEAR_PART * (self.data_high - self.data_low)

    def fractions(self, values: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Positions of many values."""
        a, b = self._forward(self.low), self._forward(self.high)
        if not self.logarithmic:
            return (values - a) / (b - a)
        places = np.arcsinh((values - self.origin) / (LINEAR_PART * (self.data_high - self.data_low)))
        return np.asarray((places - a) / (b - a))

    def zoomed(self, factor: float, at: float = 0.5) -> ValueAxis:
        """The window made narrower (factor above 1) about a position that stays where it is."""
        return self._window(at - at / factor, at + (1.0 - at) / factor)

    def panned(self, fraction: float) -> ValueAxis:
        """The window moved to the right by a fraction of its width."""
        return self._window(fraction, 1.0 + fraction)

    def showing(self, low: float, high: float, margin: float = 0.04) -> ValueAxis:
        """A window around two values."""
        if not low < high:
            reach = max((self.data_high - self.data_low) * 0.02, abs(low) * 1e-6, 1e-9)
            low, high = low - reach, high + reach
        window = replace(self, low=low, high=high)
        return window._window(-margin, 1.0 + margin)  # noqa: SLF001 - a window of the same class

    def with_points(self, low: float, high: float) -> ValueAxis:
        """The window of the data range, widened by up to a sixth to show points just outside it."""
        reach = (self.data_high - self.data_low) / 6
        low = min(self.data_low, low) if low >= self.data_low - reach else self.data_low
        high = max(self.data_high, high) if high <= self.data_high + reach else self.data_high
        return replace(self, low=low, high=high)._window(-0.02, 1.02)  # noqa: SLF001 - of the same class

    def toggled(self, logarithmic: bool) -> ValueAxis:
        """The same window on the other scale."""
        return replace(self, logarithmic=logarithmic)

    def ticks(self, most: int) -> list[float]:
        """At most about that many round values within the window, ascending."""
        if not self.logarithmic:
            return round_values(self.low, self.high, most)
        reach = max(abs(self.low - self.origin), abs(self.high - self.origin))
        top = math.floor(math.log10(reach)) if reach > 0 else 0
        sizes = [m * 10.0**k for k in range(top - 7, top + 1) for m in (1.0, 2.0, 5.0)]
        shift = 0.0 if self.origin == 0.0 else self.origin
        candidates = [shift, *(shift + s for s in sizes), *(shift - s for s in sizes)]
        # the coarsest first: powers of ten, then 5, then 2; each keeps its distance from those already there
        candidates.sort(
            key=lambda v: (v != shift, _leading(v - shift) != 1, _leading(v - shift) != 5, -abs(v - shift))
        )
        placed: list[tuple[float, float]] = []
        for value in candidates:
            place = self.fraction(value)
            if 0.0 <= place <= 1.0 and all(abs(place - other) >= 0.7 / most for other, _ in placed):
                placed.append((place, value))
        return sorted(value for _, value in placed)

    def _window(self, first: float, last: float) -> ValueAxis:
        low, high = self.value(first), self.value(last)
        span = self.data_high - self.data_low
        limit_low, limit_high = self.data_low - BEYOND * span, self.data_high + BEYOND * span
        if high - low < SMALLEST * span:
            return self
        width = min(high - low, limit_high - limit_low)
        low = min(max(low, limit_low), limit_high - width)
        return replace(self, low=low, high=low + width)

    def _forward(self, value: float) -> float:
        if not self.logarithmic:
            return value
        return math.asinh((value - self.origin) / (LINEAR_PART * (self.data_high - self.data_low)))

    def _backward(self, place: float) -> float:
        if not self.logarithmic:
            return place
        return self.origin + math.sinh(place) * LINEAR_PART * (self.data_high - self.data_low)


@dataclass(frozen=True)
class OpacityAxis:
    """Opacities 0..1 from bottom to top, linear or with room for small ones."""

    fine: bool = True

    def fraction(self, opacity: float) -> float:
        """Height of an opacity, 0..1."""
        return max(opacity, 0.0) ** FINE_EXPONENT if self.fine else opacity

    def fractions(self, opacities: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Heights of many opacities."""
        return np.maximum(opacities, 0.0) ** FINE_EXPONENT if self.fine else opacities

    def opacity(self, fraction: float) -> float:
        """Opacity at a height, within 0..1."""
        fraction = min(max(fraction, 0.0), 1.0)
        return fraction ** (1.0 / FINE_EXPONENT) if self.fine else fraction

    def ticks(self) -> list[float]:
        """Opacities to draw lines at."""
        return [0.0, 0.001, 0.01, 0.1, 0.3, 1.0] if self.fine else [0.0, 0.25, 0.5, 0.75, 1.0]


def _leading(value: float) -> int:
    """First digit of a number, 0 of 0."""
    return 0 if value == 0.0 else round(abs(value) / 10.0 ** math.floor(math.log10(abs(value)) + 1e-9))
