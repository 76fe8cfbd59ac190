"""Colours of slice planes, the same in their headers and as lines in the other views."""

from __future__ import annotations

#: As they are known from other viewers of medical images.
COLORS = {
    "axial": (0.95, 0.33, 0.25),
    "coronal": (0.45, 0.75, 0.33),
    "sagittal": (0.95, 0.82, 0.30),
    "oblique": (0.35, 0.65, 1.0),
}
