"""Functions of layers: one colour for a channel, or a preset, colour map or colour by its name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from volviz.errors import InputError
from volviz.model.auto_isovalue import auto_isovalue
from volviz.model.named_colors import checked_color
from volviz.model.transfer.channels import with_ramp
from volviz.model.transfer.first_look import automatic_window, sample_values
from volviz.model.transfer.formats import colormap_colors
from volviz.model.transfer.function import Color, TransferFunction
from volviz.model.transfer.presets import preset_for, presets

if TYPE_CHECKING:
    from volviz.volume_data.volume import Volume

#: Colours of channels whose file names none: magenta and green are told apart by the colour-blind as well.
CHANNEL_COLORS: tuple[Color, ...] = (
    (1.0, 0.0, 1.0),
    (0.0, 1.0, 0.0),
    (0.25, 0.45, 1.0),
    (1.0, 1.0, 1.0),
    (0.0, 1.0, 1.0),
    (1.0, 1.0, 0.0),
    (1.0, 0.5, 0.0),
    (1.0, 0.1, 0.1),
)
#: Opacity at the upper end of a window: light from behind shines through.
FULL_OPACITY = 0.35
#: Where a channel begins to be seen, between its background and the value that separates it from what is bright.
ABOVE_BACKGROUND = 0.6


def channel_color(number: int) -> Color:
    """The usual colour of a channel, counted from 0."""
    return CHANNEL_COLORS[number % len(CHANNEL_COLORS)]


def channel_window(volume: Volume) -> tuple[float, float]:
    """Values from above the background of a channel to its brightest thousandth, in data units."""
    values = sample_values(volume)
    low, high = automatic_window(volume)
    if not len(values):
        return low, high
    # half of nearly every channel is background, and noise must not become a veil
    background, bright = float(np.median(values)), float(np.quantile(values, 0.999))
    low = background + ABOVE_BACKGROUND * (auto_isovalue(volume) - background)
    return (low, bright) if low < bright else automatic_window(volume)


def channel_function(
    volume: Volume, color: Color, window: tuple[float, float] | None = None
) -> TransferFunction:
    """The first function of a channel in one colour.

    Parameters
    ----------
    volume : Volume
        Its values.
    color : tuple of 3 floats
        Red, green, blue (0..1).
    window : tuple of 2 floats, optional
        Values that a flat picture shows as black and as full. A volume is seen from above its background on, or noise
        would become a veil; without a window, to its brightest thousandth.
    """
    low, high = channel_window(volume)
    if window is not None:
        high = window[1]
        low = max(low, window[0]) if max(low, window[0]) < high else window[0]
    return TransferFunction.from_points([(low, (*color, 0.0)), (high, (*color, FULL_OPACITY))])


def named_look(name: str, volume: Volume) -> TransferFunction:
    """A preset, a colour map or a colour as a function of a volume.

    Colours are those of channels (`channel_function`), colour maps take opacities made from the data.

    Raises
    ------
    InputError
        There is nothing of that name.
    """
    if name in presets():
        return preset_for(name, volume)
    try:
        return channel_function(volume, checked_color(name, "look"))
    except InputError:
        pass
    try:
        return with_ramp(TransferFunction.auto(volume), colormap_colors(name))
    except InputError:
        raise InputError(
            f"there is no preset, colour or colour map called {name!r}; try green, #ff8800, hot, or one of "
            "volviz presets."
        ) from None
