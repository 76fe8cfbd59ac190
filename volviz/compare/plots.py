"""Small plots as SVG text: errors over steps on logarithmic axes, and frame times as dots.

The text has the colour of its surroundings (``currentColor``), so that a plot reads well on light and dark pages.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

import numpy as np

from volviz.compare.convergence import LEVELS, ROUNDING, Convergence
from volviz.compare.timing import FrameTimes

#: Colours that people with any colour vision tell apart, on light and on dark (after Okabe and Ito 2008).
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b8860b", "#56b4e9", "#7f7f7f", "#a04bc4")
DISTANCE = "distance of "
_GRID = "#808080"
_FAINT = 'stroke-width="1" stroke-opacity="0.3"'
_FONT = 'font-family="system-ui, sans-serif" font-size="12"'


def convergence_plot(results: Sequence[Convergence], size: tuple[int, int] = (860, 400)) -> str:
    """Errors over distances, both on logarithmic axes, with fitted lines and their slopes.

    Parameters
    ----------
    results : sequence of Convergence
        At least one, all with errors in the same unit; a side is a colour and a shape.
    size : tuple of 2 ints
        Width and height.
    """
    points = [(d, e) for c in results for d, e in zip(c.distances, c.errors, strict=True) if e > 0 and d > 0]
    if not points:
        return _svg(size, [_text(size[0] / 2, size[1] / 2, "No errors to plot.", "middle")])
    xs, ys = (np.array(v) for v in zip(*points, strict=True))
    frame = _LogFrame(size, (float(xs.min()), float(xs.max())), (float(ys.min()), float(ys.max())))
    kind = "RMS" if results[0].unit == LEVELS else "mean"
    parts = frame.axes(axis_words(results), f"error in {results[0].unit} ({kind})")
    for i, found in enumerate(results):
        color = COLORS[i % len(COLORS)]
        parts += frame.line_of(found, color)
        for d, e in zip(found.distances, found.errors, strict=True):
            if e > 0 and d > 0:
                parts.append(_marker(frame.x(d), frame.y(e), i, color))
        slope = "no slope" if math.isnan(found.slope) else f"slope {found.slope:.2f}"
        x, y = size[0] - frame.right + 18, 24 + 22 * i
        parts.append(_marker(x, y, i, color))
        parts.append(_text(x + 12, y + 4, f"{found.name}: {slope}", "start"))
    return _svg(size, parts)


def axis_words(results: Sequence[Convergence]) -> str:
    """What the horizontal axis shows: distances of whatever the techniques are made of, and other lengths."""
    axes = dict.fromkeys(found.axis for found in results)
    kinds = [axis.removeprefix(DISTANCE) for axis in axes if axis.startswith(DISTANCE)]
    words = [axis for axis in axes if not axis.startswith(DISTANCE)]
    if kinds:
        *most, last = kinds
        words.insert(0, DISTANCE + (", ".join(most) + " or " if most else "") + last)
    return "; ".join(words) + " (voxels)"


class _LogFrame:
    """The area of a plot with logarithmic axes."""

    left, right, top, bottom = 78, 220, 12, 52

    def __init__(self, size: tuple[int, int], xs: tuple[float, float], ys: tuple[float, float]) -> None:
        self.size = size
        self._x0, self._x1 = math.log10(xs[0]) - 0.06, math.log10(xs[1]) + 0.06
        self._y0 = math.floor(math.log10(ys[0]) - 0.05)
        self._y1 = math.ceil(math.log10(ys[1]) + 0.05)

    def x(self, value: float) -> float:
        share = (math.log10(value) - self._x0) / (self._x1 - self._x0)
        return self.left + share * (self.size[0] - self.left - self.right)

    def y(self, value: float) -> float:
        share = (math.log10(value) - self._y0) / (self._y1 - self._y0)
        return self.size[1] - self.bottom - share * (self.size[1] - self.top - self.bottom)

    def axes(self, x_label: str, y_label: str) -> list[str]:
        width, height = self.size
        low, high = height - self.bottom, width - self.right
        parts = []
        for exponent in range(self._y0, self._y1 + 1):
            y = self.y(10.0**exponent)
            parts.append(_line(self.left, y, high, y, _GRID, _FAINT))
            parts.append(_text(self.left - 8, y + 4, f"{10.0**exponent:g}", "end"))
        for value in _log_ticks(10**self._x0, 10**self._x1):
            x = self.x(value)
            parts.append(_line(x, self.top, x, low, _GRID, _FAINT))
            parts.append(_text(x, low + 18, f"{value:g}", "middle"))
        parts.append(_text((self.left + high) / 2, height - 10, x_label, "middle"))
        turn = f'transform="rotate(-90 16 {(self.top + low) / 2:.1f})"'
        parts.append(_text(16, (self.top + low) / 2, y_label, "middle", turn))
        return parts

    def line_of(self, found: Convergence, color: str) -> list[str]:
        """The fitted error: a straight line, bent down where the converged image is not much finer."""
        least = ROUNDING if found.unit == LEVELS else 0.0
        fitted = [d for d, e in zip(found.distances, found.errors, strict=True) if e > least]
        if math.isnan(found.slope) or not fitted:
            return []
        places = np.geomspace(min(fitted), max(fitted), 33 if found.finest > 0 else 2)
        points = " ".join(f"{self.x(d):.1f},{self.y(found.expected(d)):.1f}" for d in map(float, places))
        style = 'fill="none" stroke-width="1.5" stroke-dasharray="6 4"'
        return [f'<polyline points="{points}" stroke="{color}" {style}/>']


def times_plot(times: Sequence[FrameTimes], width: int = 720) -> str:
    """Every measured frame as a dot, the median as a bar; a row for each side, milliseconds from 0."""
    row, left, right, low = 34, 170, 24, 40
    height = row * len(times) + low
    longest = max((max(t.seconds) for t in times if t.seconds), default=0.0) or 1.0
    step = _nice_step(1000 * longest / 6)

    def x(seconds: float) -> float:
        return left + (width - left - right) * seconds / (1.05 * longest)

    parts = []
    for k in range(math.floor(1050 * longest / step) + 1):
        value = k * step
        parts.append(_line(x(value / 1000), 4, x(value / 1000), height - low + 4, _GRID, _FAINT))
        parts.append(_text(x(value / 1000), height - 20, f"{value:g}", "middle"))
    parts.append(_text((left + width - right) / 2, height - 4, "milliseconds a frame", "middle"))
    for i, side in enumerate(times):
        y = row * i + row / 2 + 2
        color = COLORS[i % len(COLORS)]
        parts.append(_text(left - 12, y + 4, side.name, "end"))
        parts += [
            f'<circle cx="{x(s):.1f}" cy="{y:.1f}" r="4" fill="{color}" fill-opacity="0.45"/>'
            for s in side.seconds
        ]
        if side.seconds:
            parts.append(_line(x(side.median), y - 11, x(side.median), y + 11, color, 'stroke-width="3"'))
    return _svg((width, height), parts)


def _log_ticks(low: float, high: float) -> list[float]:
    """1, 2, 5 of every decade between two values; of wide ranges only the decades."""
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    digits = (1, 2, 5) if len(decades) <= 4 else (1,)
    ticks = [digit * 10.0**exponent for exponent in decades for digit in digits]
    return [tick for tick in ticks if low <= tick <= high]


def _nice_step(wanted: float) -> float:
    """1, 2 or 5 times a power of ten, at least as large as wanted."""
    power = 10.0 ** math.floor(math.log10(wanted))
    return next(digit * power for digit in (1, 2, 5, 10) if digit * power >= wanted * (1 - 1e-9))


def _marker(x: float, y: float, number: int, color: str) -> str:
    """Circle, square, triangle or diamond: a side is not told by its colour alone."""
    shapes = (
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" fill="{color}"/>',
        f'<rect x="{x - 4:.1f}" y="{y - 4:.1f}" width="8" height="8" fill="{color}"/>',
        f'<path d="M {x:.1f} {y - 5:.1f} l 5 9 h -10 z" fill="{color}"/>',
        f'<path d="M {x:.1f} {y - 5.5:.1f} l 5.5 5.5 -5.5 5.5 -5.5 -5.5 z" fill="{color}"/>',
    )
    return shapes[number % len(shapes)]


def _line(x0: float, y0: float, x1: float, y1: float, color: str, style: str = 'stroke-width="1"') -> str:
    return f'<line x1="{x0:.1f}" y1="{y0:.1f}" x2="{x1:.1f}" y2="{y1:.1f}" stroke="{color}" {style}/>'


def _text(x: float, y: float, words: str, anchor: str, more: str = "") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="currentColor" {more}>{escape(words)}</text>'


def _svg(size: tuple[int, int], parts: Sequence[str]) -> str:
    width, height = size
    inside = "\n".join(parts)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
        f'role="img" {_FONT}>\n{inside}\n</svg>'
    )
