"""Splatting: every voxel above an isovalue as a point."""

from __future__ import annotations

from volviz.custom_gl.oracles import isosurfaces
from volviz.custom_gl.picking import Picked, Sight, first_visible, on_isovalue
from volviz.custom_gl.study import splat_lattices
from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.splatting.settings import DEBUG_VIEWS, SplattingSettings
from volviz.custom_gl.techniques.splatting.technique import Splatting


def _pick(sight: Sight) -> Picked | None:
    """Discs cover the surface at the isovalue; Gaussians are looked through."""
    return on_isovalue(sight) if sight.settings.footprint == "disc" else first_visible(sight)


TECHNIQUE = TechniqueInfo(
    id="splatting",
    label="Splatting",
    summary="Voxels above an isovalue as lit points that a blur melts together, or as translucent Gaussians.",
    settings=SplattingSettings,
    create=Splatting,
    pick=_pick,
    isovalue_setting="isovalue",
    debug_views=DEBUG_VIEWS,
    classic={
        "isovalue": 40.0,
        "splats_per_axis": 64,
        # point size 2 x 4 / distance in an image 480 pixels high with 60 degrees of view, in lattice distances
        "splat_size": 1.23,
        "splat_color": "classic",
        "blur_radius": 2.82,
        "ambient": 0.0,
        "diffuse": 1.0,
        "specular": 1.0,
        "shininess": 400.0,
    },
    inert={"opacity_unit_distance": "acts with the Gaussian footprint"},
    order=50,
    study=splat_lattices,
    oracle=isosurfaces,
)
