"""The float64 oracle as a technique."""

from __future__ import annotations

from volviz.custom_gl.oracles import sampled_rays
from volviz.custom_gl.study import sample_distances
from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.reference.settings import ReferenceSettings
from volviz.custom_gl.techniques.reference.technique import Reference

TECHNIQUE = TechniqueInfo(
    id="reference",
    label="Reference (float64)",
    summary="The same rays in double precision on the processor, without shortcuts: slow, and what the others are "
    "judged by.",
    settings=ReferenceSettings,
    create=Reference,
    counterpart_of=("raycast", "two_pass_raycast", "slicing"),
    needs_textures=False,
    by_gradient=True,
    inert={
        "attenuation": "acts in the mode attenuated_maximum",
        "ambient": "acts with shading",
        "diffuse": "acts with shading",
        "specular": "acts with shading",
        "shininess": "acts with shading",
        "gradient_delta": "acts with shading or gradient opacity",
        "early_termination": "the default ends no ray early, and rays of a thin volume never gather that much",
    },
    order=300,
    study=sample_distances(converged="raycast"),
    oracle=sampled_rays,
    samples_rays=True,
    is_oracle=True,
)
