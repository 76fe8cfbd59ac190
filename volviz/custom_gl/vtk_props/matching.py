"""What VTK's mappers have in common where their settings meet ours (`volviz.custom_gl.matching`)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from volviz.custom_gl.matching import Matching, Rule

#: Opacity at which VTK's GPU mapper ends a ray, fixed in its shader.
VTK_TERMINATION = 1.0 - 1.0 / 255.0

#: What VTK's ray casters always do; only the one on the graphics card has a jitter that can be switched on.
SAMPLING: Mapping[str, Any] = {
    "first_sample": 1.0,
    "early_termination": VTK_TERMINATION,
    "gradient_delta": 1.0,
    "gradient_opacity": 0.0,
    "density_threshold": 0.0,
    "preintegrated": False,
    "mipmaps": False,
}

FAR_ENDS = Rule(
    lambda _, other: other.get("first_sample") not in (None, 1.0),
    "{it} samples the far ends of whole steps and leaves the rest of a ray out, which is first_sample = 1; "
    "{other} has first_sample = {first_sample:g}.",
)
HIGHLIGHTS = Rule(
    lambda it, other: other.is_ours and it.is_lit and other.is_lit and it.get("specular") > 0,
    "Highlights of {it} are Phong's (the reflected light), those of {other} are Blinn's (the half vector).",
)
GRADIENT_DELTA = Rule(
    lambda _, other: other.get("gradient_delta") not in (None, 1.0) and other.is_lit,
    "{it} takes gradients over one voxel to either side, {other} over {gradient_delta:g}.",
)
NO_AMBIENT = Rule(
    lambda it, other: other.is_ours and it.is_lit and not it.light.headlight and it.get("ambient") > 0,
    "With a light that does not sit at the eye, {it} leaves the ambient part of the material out.",
)
NO_GRADIENT_OPACITY = Rule(
    lambda _, other: (other.get("gradient_opacity") or 0.0) > 0.0,
    "{it} is shown without the gradient opacity of {other}.",
)
NO_DENSITY_THRESHOLD = Rule(
    lambda _, other: (other.get("density_threshold") or 0.0) > 0.0,
    "{it} is shown without the density threshold of {other}.",
)
#: What both ray casters cannot follow in the sampling and the modes of ours.
RAYS = (
    Rule(
        lambda _, other: bool(other.get("preintegrated")),
        "{it} classifies samples, {other} whole pieces of ray by a pre-integrated table.",
    ),
    Rule(
        lambda _, other: bool(other.get("mipmaps")),
        "{it} always samples the full data, {other} takes coarser levels from afar.",
    ),
    Rule(
        lambda it, other: bool(it.get("jitter")) or bool(other.get("jitter")),
        "Jitter is another noise in {it} than in {other}.",
    ),
    Rule(
        lambda it, other: other.is_ours and it.get("mode") == other.get("mode") == "average",
        "In the mode average, {it} shows the mean of scalar times opacity in grey; {other} classifies the mean.",
    ),
    Rule(
        lambda it, other: other.is_ours and it.get("mode") == other.get("mode") == "additive",
        "In the mode additive, {it} adds scalar times opacity and shows the sum in grey; {other} adds emitted colours.",
    ),
    Rule(
        lambda it, other: it.get("mode") != other.get("mode"),
        "{it} has no mode {mode}; it shows {its_mode} instead.",
    ),
)
#: VTK's filters that extract meshes.
MESHES = Matching(
    fixed={"color_by": "color", "parts": "all", "smoothing": 0, "decimation": 0.0},
    rules=(
        HIGHLIGHTS,
        Rule(
            lambda _, other: other.get("method") in ("topological", "tetrahedra"),
            "{it} decides ambiguous cells by its table, {other} by the data inside or by tetrahedra.",
        ),
        Rule(
            lambda _, other: other.get("color_by") not in (None, "color"),
            "{it} has one colour, {other} is coloured by {color_by}.",
        ),
        Rule(
            lambda _, other: bool(other.get("smoothing") or other.get("decimation")),
            "{it} shows the mesh as it was extracted, {other} smoothed or decimated.",
        ),
    ),
)
