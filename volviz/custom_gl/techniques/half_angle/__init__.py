"""Half-angle slicing: volumetric light and shadow."""

from __future__ import annotations

from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.half_angle.oracle import shadowed_rays
from volviz.custom_gl.techniques.half_angle.settings import DEBUG_VIEWS, HalfAngleSettings
from volviz.custom_gl.techniques.half_angle.study import study
from volviz.custom_gl.techniques.half_angle.technique import HalfAngle

TECHNIQUE = TechniqueInfo(
    id="half_angle",
    label="Half-angle slicing",
    summary="Slices half-way between view and light carry the light through the volume: volumetric shadows.",
    settings=HalfAngleSettings,
    create=HalfAngle,
    manipulators=("light",),
    debug_views=DEBUG_VIEWS,
    classic={
        "slices": 256,
        "density_threshold": 0.1,
        "attenuation_color": (0.1, 0.2, 0.3),
        "ambient": 0.0,
        "light_blend": "over",
        "light_buffer_precision": "float16",
    },
    by_gradient=True,
    inert={
        "diffuse": "acts with shading",
        "specular": "acts with shading",
        "shininess": "acts with shading",
        "light_buffer_precision": "half floats differ by less than a level unless many thin slices add up",
        "gradient_delta": "acts with shading or gradient opacity",
    },
    order=60,
    study=study,
    oracle=shadowed_rays,
    draws_layers=True,
)
