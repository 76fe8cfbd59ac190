"""Looks at CT, whose values say what is skin, muscle and bone."""

from __future__ import annotations

import numpy as np

from volviz.model.looks.evidence import Evidence
from volviz.model.looks.look import RAYS, Look
from volviz.model.looks.projections import brightest, x_ray
from volviz.model.transfer.presets import preset, preset_for

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
    bone = _of_preset(
        "bone", "Bone", "Bones, and vessels that are filled with contrast.", "ct-bone", evidence
    )
    tissue = _of_preset("tissue", "Tissue", "Muscles and organs before the bones.", "ct-muscle", evidence)
    skin = _of_preset("skin", "Skin", "The surface of the body.", "ct-skin", evidence)
    lung = _of_preset("lung", "Lung", "Lungs, airways and their vessels.", "ct-lung", evidence)
    found = [bone, tissue, skin] if has_bone else [tissue, skin]
    return [*found, *([lung] if has_lung else []), x_ray(evidence), brightest(evidence)]


def _of_preset(ident: str, label: str, description: str, name: str, evidence: Evidence) -> Look:
    function = preset_for(name, evidence.volume)
    return Look(ident, label, description, function, RAYS, preset(name).settings or {})
