"""What VTK's ray caster on the processor does in one way only."""

from __future__ import annotations

from volviz.custom_gl.matching import Matching, Rule
from volviz.custom_gl.vtk_props import matching as vtk

MATCHING = Matching(
    fixed={**vtk.SAMPLING, "jitter": False},
    rules=(
        Rule(
            lambda _, other: other.is_ours,
            "{it} samples on a grid of steps from the eye and leaves the rest of a ray out; its numbers have 15 bits.",
        ),
        Rule(
            lambda _, other: other.get("shading") is True,
            "{it} rounds normals to some thousand directions.",
        ),
        vtk.HIGHLIGHTS,
        vtk.GRADIENT_DELTA,
        vtk.NO_GRADIENT_OPACITY,
        vtk.NO_DENSITY_THRESHOLD,
        *vtk.RAYS,
    ),
)
