"""Looks at scans whose values have no unit: MRI, microscopy, industrial CT."""

from __future__ import annotations

from volviz.model.looks.evidence import Evidence
from volviz.model.looks.look import TRANSLUCENT, Look, lit
from volviz.model.looks.projections import brightest, x_ray
from volviz.model.transfer.function import Color

#: Colours from the outer surface inwards.
Tones = tuple[Color, Color, Color, Color]
SKIN: Tones = ((0.45, 0.28, 0.20), (0.80, 0.60, 0.48), (0.95, 0.85, 0.75), (1.0, 1.0, 1.0))
BRAIN: Tones = ((0.60, 0.35, 0.30), (0.85, 0.62, 0.52), (0.95, 0.85, 0.75), (1.0, 1.0, 1.0))
STONE: Tones = ((0.56, 0.58, 0.60), (0.76, 0.76, 0.74), (0.94, 0.88, 0.76), (1.0, 0.98, 0.92))

#: Voxels to either side over which gradients are taken: noise must not roughen surfaces.
SMOOTH = 1.5


def looks_of_scan(evidence: Evidence) -> list[Look]:
    """The outer surface first, then what lies inside; the inside first where matter fills the box."""
    anatomy = evidence.anatomy
    if anatomy == "head":
        outer = surface(evidence, "skin", "Skin", "The surface of the head.", SKIN)
    elif anatomy == "brain":
        outer = surface(evidence, "brain", "Brain", "The surface of the brain.", BRAIN)
    else:
        outer = surface(evidence, "surface", "Surface", "The outer surface.", STONE)
    tones = BRAIN if anatomy else STONE
    within = [inside(evidence, tones), tissue(evidence, tones)]
    projections = [x_ray(evidence), brightest(evidence)]
    if evidence.is_flat:
        return [projections[1], *within, projections[0], outer]
    return [*within, outer, *projections] if evidence.fills_box else [outer, *within, *projections]


def surface(evidence: Evidence, ident: str, label: str, description: str, tones: Tones) -> Look:
    """What lies outermost, nearly opaque."""
    levels, border = evidence.levels, evidence.border
    width = 0.6 * (border - levels.start)
    points = [
        (border - width, tones[0], 0.0),
        (border + width, tones[1], 0.5),
        (max(levels.steps[0], border + 2 * width), tones[2], 0.8),
        (max(levels.end, levels.steps[-1], border + 3 * width), tones[3], 0.9),
    ]
    return lit(ident, label, description, _unmirrored(points, evidence), gradient_delta=SMOOTH)


def inside(evidence: Evidence, tones: Tones) -> Look:
    """The densest matter, behind a veil of what surrounds it."""
    levels = evidence.levels
    border, last = evidence.border, levels.steps[-1]
    width = 0.12 * (levels.end - last) + 0.05 * (last - border)
    points = [
        (levels.start, tones[0], 0.0),
        (border, tones[1], 0.012),
        (last - 2 * width, tones[1], 0.012),
        (last + width, tones[2], 0.45),
        (max(levels.end, last + 2 * width), tones[3], 0.9),
    ]
    words = "The densest matter, behind a veil of what surrounds it."
    return lit("inside", "Inside", words, _unmirrored(points, evidence), **TRANSLUCENT)


def tissue(evidence: Evidence, tones: Tones) -> Look:
    """Borders of all matter, like glass."""
    levels, border = evidence.levels, evidence.border
    points = [
        (levels.start, tones[0], 0.0),
        (border, tones[0], 0.05),
        (levels.steps[0], tones[1], 0.07),
        (levels.steps[-1], tones[2], 0.14),
        (max(levels.end, levels.steps[-1] + border - levels.start), tones[3], 0.5),
    ]
    words = "The borders of all matter, like glass."
    return lit("tissue", "Tissue", words, _unmirrored(points, evidence), **TRANSLUCENT, gradient_opacity=0.9)


def _unmirrored(
    points: list[tuple[float, Color, float]], evidence: Evidence
) -> list[tuple[float, Color, float]]:
    if not evidence.is_mirrored:
        return points
    return [(-value, color, opacity) for value, color, opacity in reversed(points)]
