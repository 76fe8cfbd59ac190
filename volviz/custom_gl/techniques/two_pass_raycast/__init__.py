"""Two-pass ray casting."""

from __future__ import annotations

from volviz.custom_gl.oracles import sampled_rays
from volviz.custom_gl.study import sample_distances
from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.two_pass_raycast.settings import DEBUG_VIEWS, TwoPassSettings
from volviz.custom_gl.techniques.two_pass_raycast.technique import TwoPassRaycast

TECHNIQUE = TechniqueInfo(
    id="two_pass_raycast",
    label="Two-pass ray casting",
    summary="The box's faces drawn as colours tell each ray where it leaves; a second pass marches it.",
    settings=TwoPassSettings,
    create=TwoPassRaycast,
    debug_views=DEBUG_VIEWS,
    classic={"half_float": True, "step": 0.25, "first_sample": 1.0, "early_termination": 1.0},
    by_gradient=True,
    inert={
        "mipmaps": "acts where pixels are larger than voxels",
        "attenuation": "acts in the mode attenuated_maximum",
        "ambient": "acts with shading",
        "diffuse": "acts with shading",
        "specular": "acts with shading",
        "shininess": "acts with shading",
        "gradient_delta": "acts with shading or gradient opacity",
        "reverse": "both orders give the same image; the debug views show the difference",
    },
    order=30,
    study=sample_distances(converged="raycast"),
    oracle=sampled_rays,
    samples_rays=True,
    draws_layers=True,
    draws_bricks=True,
)
