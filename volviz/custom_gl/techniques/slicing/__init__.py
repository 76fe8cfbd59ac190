"""View-aligned 3D-texture slicing."""

from __future__ import annotations

from volviz.custom_gl.oracles import sampled_rays
from volviz.custom_gl.study import sample_distances
from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.slicing.polygons import view_slices
from volviz.custom_gl.techniques.slicing.settings import DEBUG_VIEWS, SlicingSettings
from volviz.custom_gl.techniques.slicing.technique import Slicing

TECHNIQUE = TechniqueInfo(
    id="slicing",
    label="Slicing",
    summary="Polygons perpendicular to the view, textured with the volume and blended back to front.",
    settings=SlicingSettings,
    create=Slicing,
    debug_views=DEBUG_VIEWS,
    classic={"slices": 256},
    by_gradient=True,
    inert={
        "mipmaps": "acts where pixels are larger than voxels",
        "attenuation": "acts in the mode attenuated_maximum",
        "ambient": "acts with shading",
        "diffuse": "acts with shading",
        "specular": "acts with shading",
        "shininess": "acts with shading",
        "gradient_delta": "acts with shading or gradient opacity",
        "early_termination": "slices are blended by the hardware, which cannot stop",
    },
    draws_bricks=True,
    order=20,
    study=sample_distances(converged="raycast"),
    oracle=sampled_rays,
    samples_rays=True,
    draws_layers=True,
    view_slices=view_slices,
)
