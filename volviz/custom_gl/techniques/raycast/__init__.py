"""Single-pass ray casting."""

from __future__ import annotations

from volviz.custom_gl.oracles import sampled_rays
from volviz.custom_gl.study import sample_distances
from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.raycast.settings import RaycastSettings
from volviz.custom_gl.techniques.raycast.technique import Raycast

TECHNIQUE = TechniqueInfo(
    id="raycast",
    label="Ray casting",
    summary="One ray per pixel, sampled from entry to exit in a single pass.",
    settings=RaycastSettings,
    create=Raycast,
    classic={
        "step": 1.0,
        "first_sample": 1.0,
        "early_termination": 0.99,
        "opacity_unit_distance": None,
    },
    by_gradient=True,
    inert={
        "mipmaps": "acts where pixels are larger than voxels",
        "attenuation": "acts in the mode attenuated_maximum",
        "ambient": "acts with shading",
        "diffuse": "acts with shading",
        "specular": "acts with shading",
        "shininess": "acts with shading",
        "gradient_delta": "acts with shading or gradient opacity",
    },
    order=10,
    study=sample_distances(converged="raycast"),
    oracle=sampled_rays,
    samples_rays=True,
    draws_layers=True,
    draws_bricks=True,
)
