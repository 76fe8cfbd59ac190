"""Slices and slabs on planes."""

from __future__ import annotations

from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.techniques.slice.oracle import resampled_planes
from volviz.custom_gl.techniques.slice.planes import facing, turned
from volviz.custom_gl.techniques.slice.settings import SliceSettings
from volviz.custom_gl.techniques.slice.technique import Slice, pick

TECHNIQUE = TechniqueInfo(
    id="slice",
    label="Slice",
    summary="The values on a plane, or on three, resampled at any angle; across a slab their mean or extreme.",
    settings=SliceSettings,
    create=Slice,
    pick=pick,
    facing=facing,
    turned=turned,
    cursor_setting="point",
    inert={
        "normal": "acts with an oblique plane",
        "slab_mode": "acts with a slab that is thicker than a step",
        "step": "acts across a slab",
        "opacity_unit_distance": "acts where a slab is composited",
    },
    order=70,
    oracle=resampled_planes,
)
