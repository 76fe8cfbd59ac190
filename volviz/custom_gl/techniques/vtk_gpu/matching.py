"""What VTK's ray caster on the graphics card does in one way only."""

from __future__ import annotations

from volviz.custom_gl.matching import Matching, Rule
from volviz.custom_gl.vtk_props import matching as vtk

MATCHING = Matching(
    fixed=vtk.SAMPLING,
    rules=(
        vtk.FAR_ENDS,
        Rule(
            lambda _, other: other.get("early_termination") not in (None, vtk.VTK_TERMINATION),
            "{it} ends a ray at an opacity of 254/255, {other} at {early_termination:g}.",
        ),
        vtk.HIGHLIGHTS,
        vtk.GRADIENT_DELTA,
        vtk.NO_AMBIENT,
        vtk.NO_GRADIENT_OPACITY,
        vtk.NO_DENSITY_THRESHOLD,
        *vtk.RAYS,
    ),
)
