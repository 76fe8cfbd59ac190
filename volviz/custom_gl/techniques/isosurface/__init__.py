"""Isosurfaces by ray casting."""

from __future__ import annotations

from volviz.custom_gl.oracles import isosurfaces
from volviz.custom_gl.study import Study
from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.isosurface.settings import DEBUG_VIEWS, IsosurfaceSettings
from volviz.custom_gl.techniques.isosurface.technique import Isosurface, pick
from volviz.volume_data.volume import Volume

#: Bisections that are tried when convergence is measured, and those of the converged image.
BISECTIONS, REFERENCE_BISECTIONS = (0.0, 1.0, 2.0, 3.0, 4.0, 5.0), 14


def bisections(_volume: Volume) -> Study:
    """Each bisection halves the length within which the surface is known."""
    return Study("bisections", BISECTIONS, REFERENCE_BISECTIONS, "length within which the surface is known")


TECHNIQUE = TechniqueInfo(
    id="isosurface",
    label="Isosurface",
    summary="Surfaces of equal value, found along each ray and lit, without a mesh.",
    settings=IsosurfaceSettings,
    create=Isosurface,
    pick=pick,
    isovalue_setting="isovalues",
    debug_views=DEBUG_VIEWS,
    classic={
        "isovalues": (40.0,),
        "colors": ((0.5, 0.5, 0.5),),
        "bisections": 4,
        "step": 1.0,
        # 0.01 of a cube of 256 voxels
        "gradient_delta": 2.56,
        "ambient": 0.0,
        "diffuse": 1.0,
        "specular": 1.0,
        "shininess": 250.0,
    },
    uses_transfer_function=False,
    draws_bricks=True,
    order=40,
    study=bisections,
    oracle=isosurfaces,
    draws_layers=True,
)
