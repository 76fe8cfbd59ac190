"""How the convergence of VTK's volumetric shadows is measured."""

from __future__ import annotations

from volviz.custom_gl.study import Study, diagonal
from volviz.volume_data.volume import Volume

#: Finest step of an image with a shadow ray from every sample, and most samples along the diagonal of the box. The
#: work grows with the square of their number, and software OpenGL breaks loops off after 65,535 turns in all: with
#: shorter steps the shadows are cut short without a word (on the MRI head below a step of 0.4).
FINEST_STEP, SAMPLES = 0.5, 700
#: Largest images that are drawn.
PIXELS = 64 * 48


def study(volume: Volume) -> Study:
    """Samples come closer, as far as software OpenGL computes all of them."""
    best = max(FINEST_STEP, diagonal(volume) / SAMPLES)
    values = tuple(factor * best for factor in (8.0, 5.6, 4.0, 2.8, 2.0))
    return Study("step", values, best, "distance of samples", finest=best, most_pixels=PIXELS)
