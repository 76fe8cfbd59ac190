"""What VTK's volumetric shadows do in one way only."""

from __future__ import annotations

from volviz.custom_gl.matching import Matching, Rule
from volviz.custom_gl.vtk_props import matching as vtk

MATCHING = Matching(
    fixed={"first_sample": 1.0, "gradient_delta": 1.0, "gradient_opacity": 0.0, "density_threshold": 0.0},
    unlit={"diffuse": 1.0, "specular": 0.0},
    # the share of blurred light that half-angle slicing looks up, and VTK's blend from lighting by the gradient
    # (0, without any shadow) to scattering with shadows (2)
    other_meaning={"half_angle": frozenset({"scattering"})},
    rules=(
        vtk.FAR_ENDS,
        vtk.GRADIENT_DELTA,
        vtk.NO_AMBIENT,
        vtk.NO_GRADIENT_OPACITY,
        vtk.NO_DENSITY_THRESHOLD,
        Rule(
            lambda _, other: other.id == "half_angle",
            "{it} casts a grey shadow ray from every sample and scatters by its own model; {other} carries coloured "
            "light from slice to slice.",
        ),
    ),
)
