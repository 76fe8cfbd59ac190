"""The first transfer function of a data set nobody has seen: neither an empty image nor a solid block.

Three steps. *What is background*: the commonest value on the surface of the box and how far it scatters.
*What is worth seeing*: thresholds that split the rest into classes (Otsu 1979, on the histogram weighted by
gradient magnitude, so that the borders of materials count). *How dense*: the opacities are scaled in
extinction until foreseen images of the box have the mean alpha aimed at; this loop holds whatever the first
two steps found.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from volviz.model.transfer.first_look import FirstLook, Floats
from volviz.model.transfer.function import Color, ControlPoint, TransferFunction
from volviz.model.transfer.label_values import commonest, label_values
from volviz.model.transfer.levels import LEAST_COVERAGE, Levels, is_dark_on_bright, levels_of
from volviz.model.transfer.presets import offset_of_hu

if TYPE_CHECKING:
    from volviz.volume_data.volume import Volume

#: Mean alpha aimed at over the rays that meet something, and the limits of the mean over all rays of the box.
TARGET_COVERED, TARGET_LOW, TARGET_HIGH = 0.88, 0.2, 0.68
#: Mean alpha of the veil over the box of data with next to nothing in them.
VEIL = 0.14
#: Largest opacity of a control point.
MOST_OPAQUE = 0.95
#: Largest opacity of the faintest control point that shows anything.
MOST_OPAQUE_STEP = 0.5

#: Dark to light, cool to warm, lightness rising all the way.
RAMP: tuple[Color, ...] = (
    (0.12, 0.17, 0.38),
    (0.11, 0.38, 0.60),
    (0.34, 0.63, 0.66),
    (0.89, 0.70, 0.45),
    (0.98, 0.86, 0.65),
    (1.00, 0.98, 0.92),
)
#: Value in HU, colour and relative opacity: skin and lung as a veil, muscle, then bone.
CT_POINTS: tuple[tuple[float, Color, float], ...] = (
    (-1000.0, (0.32, 0.14, 0.10), 0.0),
    (-500.0, (0.55, 0.36, 0.33), 0.0),
    (-250.0, (0.70, 0.50, 0.40), 0.0),
    (-100.0, (0.80, 0.62, 0.42), 0.01),
    (40.0, (0.72, 0.34, 0.25), 0.05),
    (180.0, (0.86, 0.62, 0.46), 0.1),
    (400.0, (0.95, 0.87, 0.72), 0.35),
    (1500.0, (1.00, 0.99, 0.95), 0.7),
)
#: Hues far apart, of similar lightness, for labels.
LABEL_COLORS: tuple[Color, ...] = (
    (0.93, 0.80, 0.60),
    (0.36, 0.62, 0.84),
    (0.91, 0.49, 0.36),
    (0.55, 0.76, 0.41),
    (0.70, 0.52, 0.80),
    (0.35, 0.74, 0.70),
    (0.90, 0.56, 0.70),
    (0.66, 0.60, 0.46),
)


def auto_transfer_function(volume: Volume) -> TransferFunction:
    """A first function for a volume, such that the first image is neither empty nor solid.

    Numbers that stand for "no data" are not looked at and stay invisible.

    Parameters
    ----------
    volume : Volume
        Any data: CT, MRI, microscopy, simulation, labels, constant.

    Returns
    -------
    TransferFunction
        In data units, named "auto", with few enough points to edit by hand (labels: two a label).
    """
    function = _of_data(volume)
    return _without_no_data(function, volume) if volume.no_data else function


def _of_data(volume: Volume) -> TransferFunction:
    look = FirstLook.at(volume)
    if look is None:
        return _of_constant(volume.data_range[0], min(volume.dimensions))
    labels = label_values(look)
    if labels is not None:
        return _calibrated(_of_labels(labels, look), look)
    offset = offset_of_hu(volume)
    if offset is not None:
        return _calibrated(_of_ct(look, offset), look)
    if is_dark_on_bright(look):
        mirrored = look.mirrored()
        return _mirrored(_calibrated(_of_levels(levels_of(mirrored), mirrored), mirrored))
    return _calibrated(_of_levels(levels_of(look), look), look)


def _without_no_data(function: TransferFunction, volume: Volume) -> TransferFunction:
    """The function with nothing to be seen at numbers that stand for "no data", all far from the data."""
    low, high = volume.data_range
    margin = 0.25 * (high - low)
    points = function.points
    if volume.no_data[0] < low and points[0].opacity > 0:
        end = replace(points[0], value=min(points[0].value, low - margin))
        points = (replace(end, opacity=0.0), end, *points)
    if volume.no_data[-1] > high and points[-1].opacity > 0:
        end = replace(points[-1], value=max(points[-1].value, high + margin))
        points = (*points, end, replace(end, opacity=0.0))
    return replace(function, points=points)


def ramp_color(fraction: float) -> Color:
    """Colour of the default ramp at a fraction 0..1."""
    positions = np.linspace(0.0, 1.0, len(RAMP))
    r, g, b = (float(np.interp(fraction, positions, [c[k] for c in RAMP])) for k in range(3))
    return r, g, b


# ---------------------------------------------------------------------- labels


def _of_labels(labels: Floats, look: FirstLook) -> TransferFunction:
    """One flat piece per label; the commonest value on the surface of the box is left out."""
    background = commonest(look.shell)
    points: list[ControlPoint] = []
    shown = 0
    for i, label in enumerate(labels):
        reach_down = min(0.5, (label - labels[i - 1]) / 2) if i else 0.5
        reach_up = min(0.5, (labels[i + 1] - label) / 2) if i + 1 < len(labels) else 0.5
        color = LABEL_COLORS[shown % len(LABEL_COLORS)]
        opacity = 0.0 if label == background else 0.2
        shown += label != background
        points += [
            ControlPoint(float(label - reach_down), color, opacity),
            ControlPoint(float(label + reach_up), color, opacity),
        ]
    if len(labels) == 2:
        # A mask: its blurred edge belongs to it, so one slope from out to in.
        points = [replace(points[1], value=float(labels[0])), replace(points[2], value=float(labels[1]))]
    return TransferFunction(tuple(points), name="auto")


# ---------------------------------------------------------------------- levels of grey data


def _mirrored(function: TransferFunction) -> TransferFunction:
    return replace(function, points=tuple(replace(p, value=-p.value) for p in reversed(function.points)))


def _of_levels(levels: Levels, look: FirstLook) -> TransferFunction:
    """Opacity rises in steps at the levels; colours run from cool and dark to warm and light."""
    stations = (levels.start, *levels.steps, levels.end)
    opacities = (0.0, *np.linspace(0.02, 0.2, len(levels.steps)), 0.55)
    points = [ControlPoint(min(look.low, levels.start), RAMP[0], 0.0)]
    for rank, (value, opacity) in enumerate(zip(stations, opacities, strict=True)):
        # Half by rank, half by value: classes differ in colour even where they lie close together.
        fraction = rank / (len(stations) - 1) + (value - levels.start) / (levels.end - levels.start)
        points.append(ControlPoint(float(value), ramp_color(0.12 + 0.44 * fraction), float(opacity)))
    return TransferFunction(tuple(points), name="auto")


def _of_ct(look: FirstLook, offset: float) -> TransferFunction:
    """CT in the colours of tissue. `offset` is added to HU."""
    points = [ControlPoint(hu + offset, color, opacity) for hu, color, opacity in CT_POINTS]
    if look.high - offset < 100.0:
        # No bone: what is there must not stay a veil.
        points = [replace(p, opacity=p.opacity + 0.05 * (p.value - offset >= -500.0)) for p in points]
    return TransferFunction(tuple(points), name="auto")


# ---------------------------------------------------------------------- how dense


def _calibrated(function: TransferFunction, look: FirstLook) -> TransferFunction:
    """The function with opacities scaled until the foreseen images have the mean alpha aimed at."""
    # Several times as dense, what is there is opaque, and specks of noise still hardly count.
    covered = float(look.mean_alphas(4.0 * look.extinctions(function)).mean())
    target = min(max(TARGET_COVERED * covered, TARGET_LOW), TARGET_HIGH, 0.92 * covered)
    if covered < LEAST_COVERAGE:
        # Too little for the foreseen rays to judge: as dense as it may get, and the veil does the rest.
        target = 1.0
    faintest = min((p.opacity for p in function.points if p.opacity > 0), default=0.5)
    # Denser than this the steps of the function would all become opaque.
    low, high = np.log(1e-5), np.log(np.log1p(-MOST_OPAQUE_STEP) / np.log1p(-faintest))
    for _ in range(16):
        middle = (low + high) / 2
        if look.mean_alphas(look.extinctions(_thinned(function, float(np.exp(middle))))).mean() < target:
            low = middle
        else:
            high = middle
    function = _thinned(function, float(np.exp((low + high) / 2)))
    thinnest = look.mean_alphas(look.extinctions(function)).min()
    return function if thinnest >= VEIL else _veiled(function, look)


def _thinned(function: TransferFunction, scale: float) -> TransferFunction:
    """Extinction at the control points times `scale`: ``a' = 1 - (1 - a)^scale``, at most `MOST_OPAQUE`."""

    def thinned(opacity: float) -> float:
        return float(min(-np.expm1(np.log1p(-min(opacity, 0.9999)) * scale), MOST_OPAQUE))

    return replace(function, points=tuple(replace(p, opacity=thinned(p.opacity)) for p in function.points))


def _veiled(function: TransferFunction, look: FirstLook) -> TransferFunction:
    """The function with a faint veil over the whole box, so that next to nothing still makes an image."""
    depths = look.lengths * look.rays.shape[2]
    low, high = 1e-9, 10.0
    for _ in range(32):
        middle = (low * high) ** 0.5
        if look.mean_alphas(middle * depths).min() < VEIL:
            low = middle
        else:
            high = middle
    least = float(-np.expm1(-low))
    return replace(function, points=tuple(replace(p, opacity=max(p.opacity, least)) for p in function.points))


def _of_constant(value: float, voxels: int) -> TransferFunction:
    """A veil of alpha 0.4 across the shortest axis, for data without any difference."""
    opacity = 1.0 - (1.0 - 0.4) ** (1.0 / max(voxels - 1, 1))
    color = ramp_color(0.6)
    return TransferFunction(
        (ControlPoint(value, color, opacity), ControlPoint(value + 1.0, color, opacity)), name="auto"
    )
