"""The first transfer function of a data set nobody has seen: neither an empty picture nor a solid block.

Three steps. *What is background*: the commonest value on the surface of the box and how far it scatters. *What is
worth seeing*: thresholds that split the rest into classes (Otsu 1979, on the histogram weighted by gradient
magnitude, so that the borders of materials count). *How dense*: the opacities are scaled in extinction until
axis-parallel views of the box have the mean alpha aimed at; this loop holds whatever the first two steps found.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from volviz.model.transfer_function import Color, ControlPoint, TransferFunction

if TYPE_CHECKING:
    from volviz.model.volume import Volume

Floats = npt.NDArray[np.float64]

#: Largest number of voxels along an axis that is looked at.
LOOK = 88
#: Mean alpha that is aimed at where something is visible, and the limits of the mean over the whole box.
TARGET_COVERED, TARGET_LOW, TARGET_HIGH = 0.62, 0.14, 0.62
#: Share of rays that must meet something for a threshold to be kept.
LEAST_COVERAGE = 0.16
#: Distinct values up to which whole numbers are taken for labels.
MOST_LABELS = 64

#: Dark to light, cool to warm, lightness rising all the way.
RAMP: tuple[Color, ...] = (
    (0.16, 0.21, 0.38),
    (0.18, 0.40, 0.56),
    (0.44, 0.61, 0.62),
    (0.83, 0.71, 0.53),
    (0.96, 0.86, 0.68),
    (1.00, 0.98, 0.92),
)
#: Colours of CT from fat over muscle to bone.
CT_COLORS: tuple[tuple[float, Color], ...] = (
    (-1000.0, (0.32, 0.14, 0.10)),
    (-500.0, (0.55, 0.36, 0.33)),
    (-100.0, (0.80, 0.62, 0.42)),
    (40.0, (0.72, 0.34, 0.25)),
    (180.0, (0.86, 0.62, 0.46)),
    (400.0, (0.95, 0.87, 0.72)),
    (1500.0, (1.00, 0.99, 0.95)),
)
#: Hues far apart, of similar lightness, for labels.
LABEL_COLORS: tuple[Color, ...] = (
    (0.91, 0.49, 0.36),
    (0.36, 0.62, 0.84),
    (0.55, 0.76, 0.41),
    (0.93, 0.76, 0.36),
    (0.70, 0.52, 0.80),
    (0.35, 0.74, 0.70),
    (0.90, 0.56, 0.70),
    (0.66, 0.60, 0.46),
)


def auto_transfer_function(volume: Volume) -> TransferFunction:
    """A first function for a volume, such that the first picture is neither empty nor solid.

    Parameters
    ----------
    volume : Volume
        Any data: CT, MRI, microscopy, simulation, labels, constant.

    Returns
    -------
    TransferFunction
        In data units, named "auto", with few enough points to edit by hand.
    """
    look = _Look.at(volume)
    if look is None:
        value = volume.range[0]
        return _calibrated_constant(value, max(volume.dimensions))
    labels = _labels(look)
    if labels is not None:
        return _calibrated(_label_function(labels, look), look)
    levels = _levels(look)
    is_ct = _is_hu(volume)
    return _calibrated(_ct_function(levels) if is_ct else _ramp_function(levels, look), look)


def robust_range(volume: Volume) -> tuple[float, float]:
    """Range without the outermost thousandth of the values at either end, in data units.

    Widened again where that leaves nothing, as in data that are zero nearly everywhere.
    """
    values = sample_values(volume)
    if not len(values):
        return volume.range
    return _robust(values)


def sample_values(volume: Volume) -> Floats:
    """Finite values of at most about 700 000 voxels spread evenly over the volume, shape (n,), float64."""
    values = _strided(volume)[0].ravel()
    return np.asarray(values[np.isfinite(values)])


# ---------------------------------------------------------------------------------------------- looking at the data


@dataclass(frozen=True)
class _Look:
    """A coarse lattice of the data: values (z, y, x), gradient magnitude a voxel, and voxel lengths of a cell."""

    values: Floats
    gradient: Floats
    #: Length of one cell along (z, y, x), in units of the mean spacing.
    lengths: tuple[float, float, float]
    low: float
    high: float
    integer: bool

    @classmethod
    def at(cls, volume: Volume) -> _Look | None:
        """None when there are not two different finite values."""
        low, high = volume.range
        if not low < high:
            return None
        values, steps = _strided(volume)
        values = np.where(np.isfinite(values), values, low)
        if values.min() == values.max():
            # What differs fell between the samples: look at the densest slab around an extreme value instead.
            values = _around_extreme(volume, values.shape)
            steps = (1, 1, 1)
        gradient = np.zeros_like(values)
        for axis in range(3):
            if values.shape[axis] > 1:
                gradient += np.gradient(values, axis=axis) ** 2
        spacing = volume.spacing[::-1]
        lengths = tuple(s * n / volume.mean_spacing for s, n in zip(spacing, steps, strict=True))
        integer = volume.array.dtype.kind in "bui" or bool(np.all(values == np.rint(values)))
        robust_low, robust_high = _robust(values.ravel())
        return cls(values, np.sqrt(gradient), lengths, robust_low, robust_high, integer)  # type: ignore[arg-type]

    def shell(self) -> Floats:
        """Values on the six faces of the box."""
        v = self.values
        faces = (v[0], v[-1], v[:, 0], v[:, -1], v[:, :, 0], v[:, :, -1])
        return np.concatenate([f.ravel() for f in faces])

    def coverage(self, threshold: float) -> float:
        """Share of axis-parallel rays that meet a value of at least `threshold`, mean of the three axes."""
        above = self.values >= threshold
        return float(np.mean([above.any(axis=axis).mean() for axis in range(3)]))


def _strided(volume: Volume) -> tuple[Floats, tuple[int, int, int]]:
    array: Any = volume.array
    steps = tuple(max(1, -(-n // LOOK)) for n in array.shape)
    taken = array[tuple(slice((n - 1) % s // 2, None, s) for n, s in zip(array.shape, steps, strict=True))]
    with np.errstate(over="ignore", invalid="ignore"):
        return np.asarray(taken, dtype=np.float64), steps  # type: ignore[return-value]


def _around_extreme(volume: Volume, shape: tuple[int, ...]) -> Floats:
    array: Any = volume.array
    low, high = volume.range
    common = float(array.flat[0])
    wanted = high if common != high else low
    where = np.argwhere(array == array.dtype.type(wanted))[0]
    corner = [int(min(max(p - n // 2, 0), full - n)) for p, n, full in zip(where, shape, array.shape, strict=True)]
    block = array[tuple(slice(c, c + n) for c, n in zip(corner, shape, strict=True))].astype(np.float64)
    return np.where(np.isfinite(block), block, low)


def _robust(values: Floats) -> tuple[float, float]:
    low, high = (float(v) for v in np.quantile(values, (0.001, 0.999)))
    if low < high:
        return low, high
    # Nearly all are equal: of the others, all but the outermost hundredth.
    others = values[values != low]
    if not len(others):
        return low, low
    a, b = (float(v) for v in np.quantile(others, (0.01, 0.99)))
    return min(a, low), max(b, low)


# ------------------------------------------------------------------------------------------------------ labels


def _labels(look: _Look) -> Floats | None:
    """The distinct values when the data look like a label map: few whole numbers in flat patches."""
    if not look.integer:
        return None
    distinct = np.unique(look.values)
    if len(distinct) > MOST_LABELS or len(distinct) < 2:
        return None
    if len(distinct) <= 3:
        return np.asarray(distinct)
    flat = float((look.gradient == 0).mean())
    inside = look.values != _background_value(look)
    if not inside.any():
        return None
    flat_inside = float((look.gradient[inside] == 0).mean())
    return np.asarray(distinct) if flat > 0.5 and flat_inside > 0.3 else None


def _background_value(look: _Look) -> float:
    values, counts = np.unique(look.shell(), return_counts=True)
    return float(values[np.argmax(counts)])


def _label_function(labels: Floats, look: _Look) -> TransferFunction:
    """One flat piece per label; the commonest value of the surface is left out."""
    background = _background_value(look)
    points: list[ControlPoint] = []
    seen = 0
    for i, label in enumerate(labels):
        before = labels[i - 1] if i else label - 1.0
        after = labels[i + 1] if i + 1 < len(labels) else label + 1.0
        left = label - min(0.5, (label - before) / 2)
        right = label + min(0.5, (after - label) / 2)
        if label == background:
            color, opacity = LABEL_COLORS[seen % len(LABEL_COLORS)], 0.0
        else:
            color, opacity = LABEL_COLORS[seen % len(LABEL_COLORS)], 0.2
            seen += 1
        points += [ControlPoint(float(left), color, opacity), ControlPoint(float(right), color, opacity)]
    return TransferFunction(tuple(points), name="auto")


# ------------------------------------------------------------------------------------------- levels of grey data


@dataclass(frozen=True)
class _Levels:
    """Where opacity starts, where it steps up, and where the data end; ascending."""

    start: float
    steps: tuple[float, ...]
    end: float


def _levels(look: _Look) -> _Levels:
    low, high = look.low, look.high
    background, scatter = _background(look)
    ordinary = high > low
    if not ordinary:
        return _Levels(low, (low + 0.5,), low + 1.0)
    start = background + max(4.0 * scatter, 0.02 * (high - low))
    values, weights = _weighted(look, start)
    if len(values) < 32 or start >= high:
        start = low + 0.35 * (high - low)
        values, weights = _weighted(look, start)
    cuts = _otsu(values, weights, 2)
    first = _otsu(look.values.ravel(), None, 1)
    # Noise above the background must not become a fog: between both estimates, the higher one while enough stays.
    if first and start < first[0] and look.coverage(first[0]) >= 0.35 and scatter > 0:
        start = max(start, background + 0.5 * (first[0] - background))
    while look.coverage(start) < LEAST_COVERAGE and start - low > 0.01 * (high - low):
        start = low + 0.7 * (start - low)
    inner = tuple(c for c in cuts if start + 0.03 * (high - start) < c < high)
    if not inner:
        inner = (start + 0.4 * (high - start), start + 0.7 * (high - start))
    return _Levels(start, inner, max(high, start + 1e-6 * max(abs(start), 1.0)))


def _background(look: _Look) -> tuple[float, float]:
    """Commonest value on the surface of the box, and how far the surface scatters about it.

    The surface of a box that the object fills is no background: the lowest value is taken then.
    """
    shell = look.shell()
    low, high = look.low, look.high
    counts, edges = np.histogram(np.clip(shell, low, high), bins=128, range=(low, high))
    smooth = np.convolve(counts, (0.25, 0.5, 0.25), mode="same")
    peak = int(np.argmax(smooth))
    center = float(edges[peak] + edges[peak + 1]) / 2
    near = shell[np.abs(shell - center) <= 0.08 * (high - low)]
    if len(near) < 0.35 * len(shell) or center > low + 0.6 * (high - low):
        return low, 0.0
    middle = float(np.median(near))
    return middle, 1.4826 * float(np.median(np.abs(near - middle)))


def _weighted(look: _Look, start: float) -> tuple[Floats, Floats]:
    """Values above `start` and the weight of each: borders of materials count more than their insides."""
    chosen = (look.values > start) & (look.values <= look.high)
    values, gradient = look.values[chosen], look.gradient[chosen]
    scale = float(gradient.mean()) if len(gradient) else 0.0
    weights = 0.25 + (gradient / scale if scale > 0 else np.ones_like(gradient))
    return values, np.minimum(weights, 8.0)


def _otsu(values: Floats, weights: Floats | None, cuts: int, bins: int = 64) -> tuple[float, ...]:
    """Thresholds that split values into ``cuts + 1`` classes of least variance within (Otsu 1979), exhaustively."""
    if len(values) < 2:
        return ()
    low, high = (float(v) for v in np.quantile(values, (0.001, 0.999)))
    if not low < high:
        return ()
    histogram, edges = np.histogram(np.clip(values, low, high), bins=bins, range=(low, high), weights=weights)
    centers = (edges[:-1] + edges[1:]) / 2
    mass = np.concatenate([[0.0], np.cumsum(histogram)])
    moment = np.concatenate([[0.0], np.cumsum(histogram * centers)])

    def between(i: Any, j: Any) -> Any:
        m = np.asarray(mass[j] - mass[i])
        return np.divide((moment[j] - moment[i]) ** 2, m, out=np.zeros_like(m), where=m > 0)

    if cuts == 1:
        i = np.arange(1, bins)
        best = int(i[np.argmax(between(0, i) + between(i, bins))])
        return (float(edges[best]),)
    i, j = np.triu_indices(bins, 1)
    inside = (i >= 1) & (j < bins)
    i, j = i[inside], j[inside]
    k = int(np.argmax(between(0, i) + between(i, j) + between(j, bins)))
    return float(edges[i[k]]), float(edges[j[k]])


# ----------------------------------------------------------------------------------------------- functions from levels


def _ramp_function(levels: _Levels, look: _Look) -> TransferFunction:
    """Opacity rises in steps at the levels; colours run from cool and dark to warm and light."""
    bottom = min(look.low, levels.start)
    stations = [levels.start, *levels.steps, levels.end]
    opacities = [0.0, *np.linspace(0.05, 0.2, len(levels.steps)), 0.5]
    points = [ControlPoint(bottom, RAMP[0], 0.0)]
    span = levels.end - levels.start
    for value, opacity in zip(stations, opacities, strict=True):
        # Half by rank, half by value: classes differ in colour even where they lie close together.
        rank = stations.index(value) / (len(stations) - 1)
        fraction = 0.5 * rank + 0.5 * (value - levels.start) / span
        points.append(ControlPoint(float(value), ramp_color(0.12 + 0.88 * fraction), float(opacity)))
    return TransferFunction(tuple(points), name="auto")


def ramp_color(fraction: float) -> Color:
    """Colour of the default ramp at a fraction 0..1."""
    positions = np.linspace(0.0, 1.0, len(RAMP))
    r, g, b = (float(np.interp(fraction, positions, [c[k] for c in RAMP])) for k in range(3))
    return r, g, b


def _ct_function(levels: _Levels) -> TransferFunction:
    """CT in the colours of tissue: skin and lung as a veil, muscle, then bone."""
    opacities = (0.0, 0.0, 0.01, 0.05, 0.1, 0.35, 0.7)
    points = [ControlPoint(v, c, a) for (v, c), a in zip(CT_COLORS, opacities, strict=True)]
    points.insert(2, ControlPoint(-250.0, (0.70, 0.50, 0.40), 0.0))
    if levels.end < 100.0:
        # No bone: what is there must not stay a veil.
        points = [replace(p, opacity=p.opacity + 0.05 * (p.value >= -500.0)) for p in points]
    return TransferFunction(tuple(points), name="auto")


def _is_hu(volume: Volume) -> bool:
    from volviz.model.presets import looks_like_hu

    return looks_like_hu(volume)


# ---------------------------------------------------------------------------------------------------- how dense


def mean_alpha(function: TransferFunction, look: _Look, density: float = 1.0) -> tuple[float, float]:
    """Mean alpha of the three axis-parallel views of the box, and share of rays with an alpha above 0.02.

    ``alpha = 1 - exp(-density * sum(tau * length))``, lengths in unit distances.
    """
    tau = _extinction(function, look)
    alphas = [
        1.0 - np.exp(-density * tau.sum(axis=axis) * length) for axis, length in zip(range(3), look.lengths, strict=True)
    ]
    return float(np.mean([a.mean() for a in alphas])), float(np.mean([(a > 0.02).mean() for a in alphas]))


def _extinction(function: TransferFunction, look: _Look) -> Floats:
    opacity = function.evaluate(look.values)[..., 3]
    return np.asarray(-np.log1p(-np.minimum(opacity, 0.9999)))


def _calibrated(function: TransferFunction, look: _Look) -> TransferFunction:
    """The function with opacities scaled until the mean alpha of the views is what is aimed at."""
    scale = 1.0
    for _ in range(12):
        scaled = _thinned(function, scale)
        now, _ = mean_alpha(scaled, look)
        covered = mean_alpha(scaled, look, density=50.0)[1]
        target = min(max(TARGET_COVERED * covered, TARGET_LOW), TARGET_HIGH)
        if abs(now - target) < 0.01:
            break
        # Extinction and mean depth are proportional for thin pictures; the loop closes the rest.
        factor = np.log1p(-target) / np.log1p(-min(max(now, 1e-6), 0.9999))
        scale = float(np.clip(scale * np.clip(factor, 0.05, 20.0), 1e-5, 1e4))
    return _thinned(function, scale)


def _thinned(function: TransferFunction, scale: float) -> TransferFunction:
    """Extinction at the control points times `scale`: ``a' = 1 - (1 - a)^scale``."""
    return replace(
        function,
        points=tuple(replace(p, opacity=float(1.0 - (1.0 - min(p.opacity, 0.9999)) ** scale)) for p in function.points),
    )


def _calibrated_constant(value: float, voxels: int) -> TransferFunction:
    """A veil of mean alpha 0.4 across the longest axis, for data without any difference."""
    opacity = 1.0 - (1.0 - 0.4) ** (1.0 / max(voxels - 1, 1))
    color = ramp_color(0.6)
    return TransferFunction(
        (ControlPoint(value, color, opacity), ControlPoint(value + 1.0, color, opacity)), name="auto"
    )
