"""Bump mapping: cut planes, box faces and meshes lit per pixel in tangent space."""

from __future__ import annotations

from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.bump_mapping.picking import pick
from volviz.custom_gl.techniques.bump_mapping.settings import DEBUG_VIEWS, BumpSettings
from volviz.custom_gl.techniques.bump_mapping.technique import BumpMapping

TECHNIQUE = TechniqueInfo(
    id="bump_mapping",
    label="Bump-mapped cut",
    summary="A cut plane, the faces of the box or a coarse mesh, lit per pixel by a normal map (DOT3).",
    settings=BumpSettings,
    create=BumpMapping,
    pick=pick,
    isovalue_setting="isovalue",
    manipulators=("light", "plane"),
    debug_views=DEBUG_VIEWS,
    classic={
        "normal_source": "bricks",
        "color_source": "flat",
        "cut_out": False,
        "encoding": "bytes_classic",
        "normalization": "cube_map",
        "cube_map_size": 32,
        "ambient": 0.0,
        "diffuse": 1.0,
        "two_passes": True,
    },
    inert={
        "plane_up": "turns patterns and images; the relief of the data does not depend on it",
        "gradient_delta": "acts on the relief of the data",
        "normal_image": "acts with the normal map from an image file",
        "flip_green": "acts with the normal map from an image file",
        "tile_size": "acts with bricks, bumps and images",
        "flat_color": "acts with the flat colour",
        "dot3": "differs in opacity only where it is not lit; acts on encoded colours",
        "normalization": "the two differ by less than a step of 8-bit colour; a display shows where",
        "two_passes": "both ways give the same picture",
        "self_shadowing": "acts where light grazes or comes from behind",
        "subdivisions": "acts with lighting per vertex",
        "mesh_file": "acts on the mesh",
        "isovalue": "acts on the mesh",
        "stride": "acts on the mesh",
    },
    order=75,
)
