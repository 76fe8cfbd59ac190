"""What VTK's normal-mapped cut does in one way only."""

from __future__ import annotations

from volviz.custom_gl.matching import Matching, Rule

MATCHING = Matching(
    fixed={"surface": "plane", "normal_source": "data", "lighting": "pixel", "dot3": "rgb"},
    rules=(
        Rule(
            lambda _, other: other.id == "bump_mapping",
            "{it} reads colours and normals from pictures of the plane, {other} from the volume in every pixel.",
        ),
        Rule(
            lambda _, other: (
                (other.get("surface"), other.get("normal_source")) not in ((None, None), ("plane", "data"))
            ),
            "{it} shows the relief of the data on the cut plane only.",
        ),
    ),
)
