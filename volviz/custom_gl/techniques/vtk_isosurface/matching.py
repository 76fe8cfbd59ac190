"""What VTK's isosurfaces along rays do in one way only."""

from __future__ import annotations

from volviz.custom_gl.matching import Matching, Rule
from volviz.custom_gl.vtk_props import matching as vtk

MATCHING = Matching(
    fixed={"bisections": 0, "gradient_delta": 1.0},
    rules=(
        vtk.HIGHLIGHTS,
        vtk.GRADIENT_DELTA,
        vtk.NO_AMBIENT,
        Rule(
            lambda _, other: (other.get("bisections") or 0) > 0,
            "{it} interpolates once between two samples, {other} bisects {bisections} times before.",
        ),
    ),
)
