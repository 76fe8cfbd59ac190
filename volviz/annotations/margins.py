"""Annotations at the edges of a picture: colour bar, scale bar, letters, legend, title."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from volviz.annotations.projection import Projection
from volviz.annotations.shapes import Area, Color, Ramp, Shape, Text
from volviz.annotations.style import Style
from volviz.annotations.subject import BarColors, Floats, Subject
from volviz.model.ticks import round_values, value_text

#: Letters of the directions x, y and z, towards lower and higher values: right and left, front and back, feet and head.
LETTERS = (("R", "L"), ("A", "P"), ("I", "S"))
#: A direction gets a second letter when it leans by more than this share towards another axis.
LEANING = 0.35
MARGIN, BAR_WIDTH, BAR_LENGTH = 16.0, 14.0, 320.0
#: Pixels of a screen between two numbers of a bar.
BETWEEN = 44.0
#: Largest share of the width that a scale bar takes.
SCALE_SHARE = 0.22
#: Entries of a legend; further ones are counted.
MOST_ENTRIES = 16


def bar(colors: BarColors, size: tuple[int, int], style: Style, edge: float = 0.0) -> Iterator[Shape]:
    """Colours of the values at the right edge, with round numbers and the unit above; `edge` pixels are left free."""
    width, height = size[0] - edge, size[1]
    length = min(0.5 * height, BAR_LENGTH * style.scale)
    span = colors.high - colors.low
    values = round_values(colors.low, colors.high, max(2, int(length / (BETWEEN * style.scale))))
    words = [value_text(value, span) for value in values]
    room = max((style.length_of(word) for word in words), default=0.0)
    left = width - (MARGIN + BAR_WIDTH + 10.0) * style.scale - room
    top, thick = (height - length) / 2, BAR_WIDTH * style.scale
    yield Ramp(left, top, thick, length, colors.colors)
    outline = [
        (left, top),
        (left + thick, top),
        (left + thick, top + length),
        (left, top + length),
        (left, top),
    ]
    yield style.line(*outline, color=style.quiet)
    for value, word in zip(values, words, strict=True):
        y = top + length * (colors.high - value) / span
        x = left + thick
        yield style.line((x, y), (x + 4.0 * style.scale, y), color=style.quiet)
        yield style.text(word, (x + 8.0 * style.scale, y))
    if colors.unit:
        # the unit stands at the right edge where it is longer than bar and numbers
        fits = style.length_of(colors.unit) <= width - MARGIN * style.scale - left
        x, across = (left, "left") if fits else (width - MARGIN * style.scale, "right")
        yield style.text(colors.unit, (x, top - 8.0 * style.scale), across=across, upright="bottom")


def scale_bar(subject: Subject, projection: Projection, style: Style) -> Iterator[Shape]:
    """A line of a round length in the lower right corner; in perspective it holds at the focal point."""
    width, height = projection.size
    most = SCALE_SHARE * width * projection.pixel_length
    power = 10.0 ** np.floor(np.log10(most))
    length = float(max(part * power for part in (1.0, 2.0, 5.0) if part * power <= most))
    pixels = length / projection.pixel_length
    right, y = width - MARGIN * style.scale, height - MARGIN * style.scale
    left, tick = right - pixels, 4.0 * style.scale
    for color, thick in ((style.rim, 4.0), (style.ink, 2.0)):
        yield style.line((left, y), (right, y), color=color, width=thick)
        for x in (left, right):
            yield style.line((x, y - tick), (x, y + tick), color=color, width=thick)
    number = f"{length:.0f}" if length >= 1 else f"{length:.4g}"
    words = f"{number} {subject.length_unit}".rstrip()
    if not projection.camera.parallel:
        words += " in the middle"
    middle = min((left + right) / 2, right - style.length_of(words) / 2)
    yield style.text(words, (middle, y - 7.0 * style.scale), across="middle", upright="bottom")


def letters(subject: Subject, projection: Projection, style: Style) -> Iterator[Text]:
    """What lies at the right, left, upper and lower edge of a plane that is faced."""
    width, height = projection.size
    margin = 1.2 * style.em
    right, up, _toward = projection.axes
    for direction, place in (
        (right, (width - margin, height / 2)), (-right, (margin, height / 2)),
        (up, (width / 2, margin)), (-up, (width / 2, height - margin)),
    ):  # fmt: skip
        words = direction_words(direction, is_anatomical=subject.is_anatomical)
        yield style.text(words, place, size=1.2, across="middle", bold=True)


def legend(entries: Sequence[tuple[str, Color]], style: Style) -> Iterator[Shape]:
    """Names and colours in the upper left corner, one below the other."""
    line, swatch = 1.6 * style.em, 0.9 * style.em
    x, y = MARGIN * style.scale, MARGIN * style.scale + line / 2
    shown = entries if len(entries) <= MOST_ENTRIES else entries[: MOST_ENTRIES - 1]
    for words, color in shown:
        corners = tuple(
            (x + dx * swatch, y + (dy - 0.5) * swatch) for dx, dy in ((0, 0), (1, 0), (1, 1), (0, 1))
        )
        yield Area(corners, color)
        yield style.line(*corners, corners[0], color=style.quiet)
        yield style.text(words, (x + swatch + 0.6 * style.em, y))
        y += line
    if len(shown) < len(entries):
        yield style.text(f"and {len(entries) - len(shown)} more", (x, y))


def title(words: str, size: tuple[int, int], style: Style) -> Iterator[Shape]:
    """A line at the upper edge."""
    yield style.text(
        words, (size[0] / 2, MARGIN * style.scale), size=1.4, across="middle", upright="top", bold=True
    )


def note(words: str, size: tuple[int, int], style: Style) -> Iterator[Shape]:
    """A line at the lower edge."""
    place = (size[0] / 2, size[1] - MARGIN * style.scale)
    yield style.text(words, place, across="middle", upright="bottom")


def direction_words(direction: Floats, *, is_anatomical: bool) -> str:
    """A direction in the world as letters of anatomy, "LA" where it leans, or as an axis with its sign."""
    strength = np.abs(direction)
    order = [int(axis) for axis in np.argsort(-strength, kind="stable") if strength[axis] >= LEANING]
    order = order or [int(np.argmax(strength))]
    if is_anatomical:
        return "".join(LETTERS[axis][int(direction[axis] > 0)] for axis in order)
    first = order[0]
    return ("+" if direction[first] > 0 else "−") + "xyz"[first]
