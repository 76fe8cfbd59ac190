"""What VTK's splats do in one way only."""

from __future__ import annotations

from volviz.custom_gl.matching import Matching, Rule

MATCHING = Matching(
    fixed={"blur_radius": 0.0, "shading": False, "splat_color": "transfer_function"},
    rules=(
        Rule(
            lambda _, other: other.get("shading") is True,
            "Splats of {it} are unlit.",
        ),
        Rule(
            lambda it, other: it.get("footprint") == "disc" and (other.get("blur_radius") or 0.0) > 0.0,
            "{it} has no blur.",
        ),
        Rule(
            lambda it, other: other.is_ours and it.get("footprint") == "gaussian",
            "{it} blends Gaussians in the order of the voxels, each with the opacity of the transfer function; {other} "
            "sorts them and keeps the opacity of the matter they stand for.",
        ),
    ),
)
