"""Where grey data are background, where materials begin, and where they end."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from volviz.kernels.histogram import even_histogram
from volviz.model.transfer.first_look import FirstLook, Floats

#: Share of rays that must meet something, or the threshold is lowered.
LEAST_COVERAGE = 0.04
#: Share of the variance between two classes above which they count as two materials.
TWO_CLASSES = 0.8


@dataclass(frozen=True)
class Levels:
    """Where opacity starts, where it steps up, and where the data end; ascending."""

    start: float
    steps: tuple[float, ...]
    end: float


def levels_of(look: FirstLook) -> Levels:
    """Levels of data in which what lies inside is brighter than what surrounds it."""
    low, high = look.low, look.high
    background, scatter = background_of(look)
    start = background + max(4.0 * scatter, 0.02 * (high - low))
    # Noise about the background must not become a fog: half way to the best single cut, while enough stays.
    cut = otsu(look.values.ravel(), None, 1)
    if cut and scatter > 0 and start < cut[0] and look.coverage(cut[0]) >= 0.35:
        start = max(start, background + 0.5 * (cut[0] - background))
    # Two materials that both reach the surface of the box widen what looks like the scatter of one.
    if cut and start > cut[0] and separability(look.values / look.scale, cut[0] / look.scale) > TWO_CLASSES:
        start = cut[0]
    if np.count_nonzero(look.values > start) < 32 and start > low:
        start = low + 0.35 * (high - low)
    for _ in range(8):
        if look.coverage(start) >= LEAST_COVERAGE:
            break
        start = low + 0.7 * (start - low)
    chosen = look.values > start
    if not chosen.any():
        return Levels(low, (0.5 * (low + high),), high)
    values = look.values[chosen]
    end = float(max(np.quantile(values, 0.995), min(high, values.max())))
    if not start < end:
        end = start + max(1e-6 * abs(start), 1e-12)
    chosen &= look.values <= end
    cuts = otsu(look.values[chosen], _weights(look.gradient[chosen]), 2)
    inner = tuple(c for c in cuts if start + 0.03 * (end - start) < c < start + 0.97 * (end - start))
    return Levels(start, inner or (start + 0.4 * (end - start), start + 0.7 * (end - start)), end)


def background_of(look: FirstLook) -> tuple[float, float]:
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


def is_dark_on_bright(look: FirstLook) -> bool:
    """Whether the surface of the box is bright and what lies inside is darker, as in transmitted light."""
    middle = float(np.median(look.shell))
    span = look.high - look.low
    flat = float((np.abs(look.shell - middle) <= 0.1 * span).mean())
    darker = float((look.values < middle - 0.15 * span).mean())
    brighter = float((look.values > middle + 0.15 * span).mean())
    return middle > look.low + 0.6 * span and flat > 0.6 and darker > 0.01 and darker > 3 * brighter


def _weights(gradient: Floats) -> Floats:
    """Borders of materials count more than their insides, but no voxel more than 8 times the mean."""
    scale = float(gradient.mean()) if len(gradient) else 0.0
    return np.minimum(0.25 + (gradient / scale if scale > 0 else 1.0 + 0.0 * gradient), 8.0)


def otsu(values: Floats, weights: Floats | None, cuts: int, bins: int = 64) -> tuple[float, ...]:
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


def separability(values: Floats, cut: float) -> float:
    """Share of the variance that lies between the two sides of a cut: 0.64 of one normal distribution."""
    above = values > cut
    share = float(above.mean())
    total = float(np.var(values))
    if not 0.0 < share < 1.0 or total == 0.0:
        return 0.0
    apart = float(values[above].mean() - values[~above].mean())
    return share * (1.0 - share) * apart**2 / total
