"""Looks at CT, whose values say what is skin, muscle and bone."""

from __future__ import annotations

import numpy as np

from volviz.model.looks.evidence import Evidence
from volviz.model.looks.look import Look, lit
from volviz.model.looks.projections import brightest, x_ray
from volviz.model.transfer.function import Color

Points = list[tuple[float, Color, float]]

#: Hounsfield units, colours and opacities.
BONE: Points = [
    (-1000.0, (0.25, 0.08, 0.06), 0.0),
    (120.0, (0.45, 0.16, 0.10), 0.0),
    (190.0, (0.72, 0.38, 0.26), 0.03),
    (320.0, (0.90, 0.72, 0.53), 0.22),
    (600.0, (0.97, 0.90, 0.77), 0.50),
    (1500.0, (1.00, 0.99, 0.95), 0.80),
]
SKIN: Points = [
    (-1000.0, (0.60, 0.40, 0.32), 0.0),
    (-420.0, (0.62, 0.42, 0.33), 0.0),
    (-200.0, (0.86, 0.66, 0.54), 0.55),
    (50.0, (0.93, 0.76, 0.65), 0.85),
    (1500.0, (1.00, 0.93, 0.85), 0.95),
]
TISSUE: Points = [
    (-1000.0, (0.55, 0.22, 0.16), 0.0),
    (-60.0, (0.62, 0.24, 0.18), 0.0),
    (20.0, (0.66, 0.24, 0.18), 0.05),
    (80.0, (0.78, 0.33, 0.24), 0.16),
    (200.0, (0.90, 0.62, 0.46), 0.25),
    (400.0, (0.97, 0.90, 0.77), 0.55),
    (1500.0, (1.00, 0.99, 0.95), 0.85),
]
LUNG: Points = [
    (-1000.0, (0.30, 0.42, 0.60), 0.0),
    (-920.0, (0.36, 0.50, 0.68), 0.0),
    (-820.0, (0.46, 0.60, 0.74), 0.012),
    (-650.0, (0.66, 0.72, 0.78), 0.02),
    (-450.0, (0.88, 0.62, 0.52), 0.10),
    (-100.0, (0.86, 0.40, 0.32), 0.0),
    (250.0, (0.90, 0.80, 0.66), 0.0),
    (400.0, (0.97, 0.92, 0.80), 0.12),
    (1500.0, (1.00, 0.99, 0.95), 0.5),
]
#: Bone is what lies above so many Hounsfield units; so much of the body must be bone.
BONE_FROM, LEAST_BONE = 250.0, 0.004
#: Lung lies between these; so much of the box must be lung.
LUNG_VALUES, LEAST_LUNG = (-920.0, -600.0), 0.04


def looks_of_ct(evidence: Evidence, offset: float) -> list[Look]:
    """Bone first where there is some; `offset` is added to Hounsfield units in the values."""
    values = evidence.look.values - offset
    body = values > -300.0
    has_bone = (values > BONE_FROM).sum() > LEAST_BONE * max(int(body.sum()), 1)
    has_lung = np.mean((values > LUNG_VALUES[0]) & (values < LUNG_VALUES[1])) > LEAST_LUNG
    bone = lit("bone", "Bone", "Bones, and vessels that are filled with contrast.", _moved(BONE, offset))
    skin = lit("skin", "Skin", "The surface of the body.", _moved(SKIN, offset))
    tissue = lit("tissue", "Tissue", "Muscles and organs before the bones.", _moved(TISSUE, offset))
    lung = lit("lung", "Lung", "Lungs, airways and their vessels.", _moved(LUNG, offset))
    found = [bone, tissue, skin] if has_bone else [tissue, skin]
    return [*found, *([lung] if has_lung else []), x_ray(evidence), brightest(evidence)]


def _moved(points: Points, offset: float) -> Points:
    return [(value + offset, color, opacity) for value, color, opacity in points]
