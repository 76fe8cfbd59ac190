"""The first transfer function of a data set nobody has seen: neither an empty image nor a solid block.

Three steps. *What is background*: the commonest value on the surface of the box and how far it scatters.
*What is worth seeing*: thresholds that split the rest into classes (Otsu 1979, on the histogram weighted by
gradient magnitude, so that the borders of materials count). *How dense*: the opacities are scaled in
extinction until foreseen images of the box have the mean alpha aimed at; this loop holds whatever the first
two steps found.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.kernels.histogram import even_histogram
from volviz.model.transfer.first_look import FirstLook, Floats
from volviz.model.transfer.function import Color, ControlPoint, TransferFunction

if TYPE_CHECKING:
    from volviz.volume_data.volume import Volume

#: Mean alpha aimed at over the rays that meet something, and the limits of the mean over all rays of the box.
TARGET_COVERED, TARGET_LOW, TARGET_HIGH = 0.88, 0.2, 0.68
#: Mean alpha of the veil over the box of data with next to nothing in them.
VEIL = 0.14
#: Share of rays that must meet something, or the threshold is lowered.
LEAST_COVERAGE = 0.04
#: Share of the variance between two classes above which they count as two materials.
TWO_CLASSES = 0.8
#: Distinct values up to which whole numbers are taken for labels.
MOST_LABELS = 64
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
    labels = _labels(look)
    if labels is not None:
        return _calibrated(_of_labels(labels, look), look)
    offset = _offset_of_hu(volume)
    if offset is not None:
        return _calibrated(_of_ct(look, offset), look)
    if _is_dark_on_bright(look):
        mirrored = look.mirrored()
        return _mirrored(_calibrated(_of_levels(_levels(mirrored), mirrored), mirrored))
    return _calibrated(_of_levels(_levels(look), look), look)


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


def _labels(look: FirstLook) -> Floats | None:
    """The distinct values when the data look like a label map: few whole numbers in flat patches."""
    if not look.integer:
        return None
    distinct = np.unique(look.values)
    if not 2 <= len(distinct) <= MOST_LABELS:
        return None
    if len(distinct) == 2:
        return distinct
    inside = look.values != _commonest(look.shell)
    if not inside.any() or (look.gradient[inside] == 0).mean() < 0.25:
        return None
    # A smooth field of few grey levels changes by one level at a time; labels meet in any order.
    if len(distinct) > 8:
        ranks = np.searchsorted(distinct, look.values)
        jumps = np.concatenate([np.abs(np.diff(ranks, axis=axis)).ravel() for axis in range(3)])
        jumps = jumps[jumps > 0]
        if (jumps == 1).mean() > 0.8:
            return None
    return distinct


def _commonest(values: Floats) -> float:
    distinct, counts = np.unique(values, return_counts=True)
    return float(distinct[np.argmax(counts)])


def _of_labels(labels: Floats, look: FirstLook) -> TransferFunction:
    """One flat piece per label; the commonest value on the surface of the box is left out."""
    background = _commonest(look.shell)
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


@dataclass(frozen=True)
class _Levels:
    """Where opacity starts, where it steps up, and where the data end; ascending."""

    start: float
    steps: tuple[float, ...]
    end: float


def _levels(look: FirstLook) -> _Levels:
    low, high = look.low, look.high
    background, scatter = _background(look)
    start = background + max(4.0 * scatter, 0.02 * (high - low))
    # Noise about the background must not become a fog: half way to the best single cut, while enough stays.
    cut = _otsu(look.values.ravel(), None, 1)
    if cut and scatter > 0 and start < cut[0] and look.coverage(cut[0]) >= 0.35:
        start = max(start, background + 0.5 * (cut[0] - background))
    # Two materials that both reach the surface of the box widen what looks like the scatter of one.
    if cut and start > cut[0] and _separability(look.values / look.scale, cut[0] / look.scale) > TWO_CLASSES:
        start = cut[0]
    if np.count_nonzero(look.values > start) < 32 and start > low:
        start = low + 0.35 * (high - low)
    for _ in range(8):
        if look.coverage(start) >= LEAST_COVERAGE:
            break
        start = low + 0.7 * (start - low)
    chosen = look.values > start
    if not chosen.any():
        return _Levels(low, (0.5 * (low + high),), high)
    values = look.values[chosen]
    end = float(max(np.quantile(values, 0.995), min(high, values.max())))
    if not start < end:
        end = start + max(1e-6 * abs(start), 1e-12)
    chosen &= look.values <= end
    cuts = _otsu(look.values[chosen], _weights(look.gradient[chosen]), 2)
    inner = tuple(c for c in cuts if start + 0.03 * (end - start) < c < start + 0.97 * (end - start))
    return _Levels(start, inner or (start + 0.4 * (end - start), start + 0.7 * (end - start)), end)


def _background(look: FirstLook) -> tuple[float, float]:
    """Commonest value on the surface of the box, and how far the surface scatters about it.

    The surface of a box that the object fills is no background: the lowest value is taken then.
    """
    low, high = look.low, look.high
    counts, edges = even_histogram(look.shell, 128, low, high)
    peak = int(np.argmax(np.convolve(counts, (0.25, 0.5, 0.25), mode="same")))
    center = float(edges[peak] + edges[peak + 1]) / 2
    width, middle, scatter = 0.08 * (high - low), center, 0.0
    for _ in range(4):
        # Noise wider than the window is cut off by it and looks narrower: widen until it fits.
        near = look.shell[np.abs(look.shell - middle) <= width]
        if not len(near):
            break
        middle = float(np.median(near))
        scatter = 1.4826 * float(np.median(np.abs(near - middle)))
        if 3.5 * scatter <= width:
            break
        width = min(3.5 * scatter, 0.5 * (high - low))
    share = float((np.abs(look.shell - middle) <= width).mean())
    if share < 0.35 or middle > low + 0.6 * (high - low):
        return low, 0.0
    return middle, scatter


def _is_dark_on_bright(look: FirstLook) -> bool:
    """Whether the surface of the box is bright and what lies inside is darker, as in transmitted light."""
    middle = float(np.median(look.shell))
    span = look.high - look.low
    flat = float((np.abs(look.shell - middle) <= 0.1 * span).mean())
    darker = float((look.values < middle - 0.15 * span).mean())
    brighter = float((look.values > middle + 0.15 * span).mean())
    return middle > look.low + 0.6 * span and flat > 0.6 and darker > 0.01 and darker > 3 * brighter


def _mirrored(function: TransferFunction) -> TransferFunction:
    return replace(function, points=tuple(replace(p, value=-p.value) for p in reversed(function.points)))


def _weights(gradient: Floats) -> Floats:
    """Borders of materials count more than their insides, but no voxel more than 8 times the mean."""
    scale = float(gradient.mean()) if len(gradient) else 0.0
    return np.minimum(0.25 + (gradient / scale if scale > 0 else 1.0 + 0.0 * gradient), 8.0)


def _otsu(values: Floats, weights: Floats | None, cuts: int, bins: int = 64) -> tuple[float, ...]:
    """One or two thresholds between classes of least variance within (Otsu 1979), exhaustively."""
    if len(values) < 2:
        return ()
    low, high = (float(v) for v in np.quantile(values, (0.001, 0.999)))
    if not low < high or not np.isfinite(high - low):
        return ()
    histogram, edges = even_histogram(values, bins, low, high, weights)
    # Positions in bins instead of values: no overflow however large the values are.
    mass = np.concatenate([[0.0], np.cumsum(histogram)])
    moment = np.concatenate([[0.0], np.cumsum(histogram * np.arange(bins))])

    def between(i: Any, j: Any) -> Any:
        m = np.asarray(mass[j] - mass[i])
        return np.divide((moment[j] - moment[i]) ** 2, m, out=np.zeros_like(m), where=m > 0)

    if cuts == 1:
        i = np.arange(1, bins)
        return (float(edges[int(i[np.argmax(between(0, i) + between(i, bins))])]),)
    i, j = np.triu_indices(bins, 1)
    i, j = i[i >= 1], j[i >= 1]
    k = int(np.argmax(between(0, i) + between(i, j) + between(j, bins)))
    return float(edges[i[k]]), float(edges[j[k]])


def _separability(values: Floats, cut: float) -> float:
    """Share of the variance that lies between the two sides of a cut: 0.64 of one normal distribution."""
    above = values > cut
    share = float(above.mean())
    total = float(np.var(values))
    if not 0.0 < share < 1.0 or total == 0.0:
        return 0.0
    apart = float(values[above].mean() - values[~above].mean())
    return share * (1.0 - share) * apart**2 / total


def _of_levels(levels: _Levels, look: FirstLook) -> TransferFunction:
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


def _offset_of_hu(volume: Volume) -> float | None:
    """What is added to HU in the data, None when they are no CT."""
    from volviz.model.transfer.presets import HU_OFFSET, looks_like_hu, looks_like_shifted_hu

    if looks_like_hu(volume):
        return 0.0
    return HU_OFFSET if looks_like_shifted_hu(volume) else None


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
