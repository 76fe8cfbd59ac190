"""Looks in which a ray shows one value: its mean, as in an X-ray image, or its largest."""

from __future__ import annotations

import numpy as np

from volviz.model.looks.evidence import Evidence
from volviz.model.looks.look import RAYS, Look, function

#: From film to bone: shades of an X-ray image.
DARK, LIGHT = (0.04, 0.06, 0.09), (0.97, 0.98, 1.0)


def x_ray(evidence: Evidence) -> Look:
    """Mean values along rays, in shades of grey."""
    means, _ = evidence.along_rays()
    return _grey(
        "x-ray", "X-ray", "The mean along every ray, as an X-ray image shows it.", means, "average", evidence
    )


def brightest(evidence: Evidence) -> Look:
    """Largest values along rays: vessels, bone, stained cells."""
    _, largest = evidence.along_rays()
    extreme = "minimum" if evidence.is_mirrored else "maximum"
    words = "The darkest value" if evidence.is_mirrored else "The brightest value"
    label = "Darkest" if evidence.is_mirrored else "Brightest"
    return _grey("brightest", label, f"{words} along every ray.", largest, extreme, evidence)


def _grey(ident: str, label: str, description: str, found: np.ndarray, mode: str, evidence: Evidence) -> Look:
    low, high = (float(v) for v in np.quantile(found, (0.02, 0.995)))
    low = max(low, evidence.look.low)
    if not low < high:
        low, high = evidence.look.low, evidence.look.high
    points = [(low, DARK, 0.0), (low + 0.25 * (high - low), (0.27, 0.29, 0.32), 0.6), (high, LIGHT, 1.0)]
    if evidence.is_mirrored:
        points = [(-value, color, opacity) for value, color, opacity in reversed(points)]
    return Look(ident, label, description, function(label, points), RAYS, {"mode": mode})
