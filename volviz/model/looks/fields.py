"""Looks at fields without borders, from simulation or mathematics, and at signed distances."""

from __future__ import annotations

import numpy as np

from volviz.model.auto_isovalue import auto_isovalue
from volviz.model.looks.evidence import Evidence
from volviz.model.looks.look import TRANSLUCENT, Look, lit, shells
from volviz.model.looks.projections import brightest, x_ray
from volviz.model.transfer.automatic import auto_transfer_function
from volviz.model.transfer.function import Color

#: From the outermost shell to the innermost.
SHELL_COLORS: tuple[Color, ...] = (
    (0.30, 0.55, 0.80),
    (0.38, 0.74, 0.66),
    (0.97, 0.74, 0.36),
    (0.90, 0.36, 0.28),
)
SHELL_OPACITIES = (0.18, 0.3, 0.5, 1.0)
ONE_COLOR: Color = (0.87, 0.79, 0.65)
#: Voxels to either side over which gradients are taken: steps of 8-bit data must not roughen surfaces.
SMOOTH = 1.5
#: Shares of the rays through the box that meet the shells.
COVERED = (0.42, 0.22, 0.10, 0.05)
#: No shell lies nearer to either end of the range than this share of it: there the data have hardly any levels.
LEAST_VALUE = 0.08


def looks_of_field(evidence: Evidence) -> list[Look]:
    """Nested surfaces first; a single one where the field is steep, since nested ones would hide each other."""
    values = _shell_values(evidence)
    nested = _nested(evidence, values)
    rest = [_cloud(evidence), x_ray(evidence), brightest(evidence)]
    if evidence.is_smooth:
        middle = values[len(values) // 2 - 1] if len(values) > 1 else values[0]
        return [nested, _one(evidence, middle), *rest]
    return [_one(evidence, auto_isovalue(evidence.volume)), nested, *rest]


def looks_of_distances(evidence: Evidence) -> list[Look]:
    """The surface itself, where the distance is 0, then shells around it."""
    one = _one(evidence, 0.0)
    look = evidence.look
    inner = look.high if look.coverage(0.5 * look.high) < look.coverage(0.0) else look.low
    values = sorted((-0.25 * inner, 0.0, 0.4 * inner))
    return [one, _nested(evidence, values), _cloud(evidence), x_ray(evidence), brightest(evidence)]


def _shell_values(evidence: Evidence) -> list[float]:
    """Values of shells such that each covers a share of the view."""
    _, largest = evidence.along_rays()
    values = [float(v) for v in np.unique(np.quantile(largest, [1.0 - share for share in COVERED]))]
    low, high = evidence.look.low, evidence.look.high
    margin = LEAST_VALUE * (high - low)
    return sorted({min(max(v, low + margin), high - margin) for v in values})


def _nested(evidence: Evidence, values: list[float]) -> Look:
    surfaces = [
        (value, SHELL_COLORS[-len(values) :][n], SHELL_OPACITIES[-len(values) :][n])
        for n, value in enumerate(values)
    ]
    words = "Surfaces of equal value, one inside the other."
    return shells("shells", "Shells", words, surfaces, _width(evidence), gradient_delta=SMOOTH)


def _one(evidence: Evidence, value: float) -> Look:
    words = "The surface where the value is " + f"{value:.4g}."
    return shells("surface", "Surface", words, [(value, ONE_COLOR, 1.0)], _width(evidence))


def _cloud(evidence: Evidence) -> Look:
    function = auto_transfer_function(evidence.volume)
    points = [(p.value, p.color, p.opacity) for p in function.points]
    return lit("cloud", "Cloud", "All values, translucent, lit.", points, **TRANSLUCENT)


def _width(evidence: Evidence) -> float:
    return 0.02 * (evidence.look.high - evidence.look.low)
