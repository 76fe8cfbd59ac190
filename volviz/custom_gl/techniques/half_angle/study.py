"""How the convergence of half-angle slicing is measured."""

from __future__ import annotations

from volviz.custom_gl.study import Study, diagonal
from volviz.custom_gl.techniques.half_angle.oracle import is_exact
from volviz.volume_data.volume import Volume

#: There are at most 2048 slices; the finest image has a few less, or this step.
SLICES, FINEST_STEP = 2000, 0.2
#: Largest images that are drawn.
PIXELS = 160 * 120


def study(volume: Volume) -> Study:
    """Slices come closer, as far as their number allows."""
    best = max(FINEST_STEP, diagonal(volume) / SLICES)
    values = tuple(factor * best for factor in (10.0, 7.0, 5.0, 3.5, 2.5))
    return Study(
        "step", values, best, "distance of slices", is_exact=is_exact, finest=best, most_pixels=PIXELS
    )
