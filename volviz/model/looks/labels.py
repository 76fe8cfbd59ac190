"""Looks at masks and label maps."""

from __future__ import annotations

from volviz.model.looks.evidence import Evidence
from volviz.model.looks.look import MATT, RAYS, Look, shells
from volviz.model.looks.projections import brightest, x_ray
from volviz.model.transfer.automatic import auto_transfer_function
from volviz.model.transfer.first_look import Floats
from volviz.model.transfer.function import Color

MASK_COLOR: Color = (0.87, 0.79, 0.65)


def looks_of_labels(evidence: Evidence, labels: Floats) -> list[Look]:
    """The surfaces of the labels first."""
    outside, inside = float(labels[0]), float(labels[1])
    middle, width = 0.5 * (outside + inside), 0.25 * (inside - outside)
    one = shells("surface", "Surface", "The surface of all that is marked.", [(middle, MASK_COLOR, 1.0)], width,
                 gradient_delta=1.5)  # fmt: skip
    veil = shells("glass", "Glass", "The same surface, translucent.", [(middle, MASK_COLOR, 0.35)], width,
                  gradient_delta=1.5)  # fmt: skip
    function = auto_transfer_function(evidence.volume)
    settings = {"shading": True, **MATT, "interpolation": "nearest"}
    each = Look("labels", "Labels", "Each label in a colour of its own.", function, RAYS, settings)
    first = [one, veil] if len(labels) == 2 else [each, one, veil]
    return [*first, x_ray(evidence), brightest(evidence)]
