"""A volume ten thousand kilometres from the world's origin (in millimetres: 1e7) is drawn as one at the origin."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import volviz
from tests.render.scenes import LEFT_HANDED, function, image, volume
from volviz.custom_gl.registry import techniques

OFFSET = np.array([1e7, -1e7, 1e7])
IMAGE_TECHNIQUES = [key for key, info in techniques().items() if info.kind == "image"]


def view_of(of: volviz.Volume, offset: Any, **changes: Any) -> volviz.Camera:
    """One and the same view, at a place whose digits 1e7 does not cut off."""
    x, y, z = np.round(np.array(of.center) - offset) + offset
    camera = volviz.Camera((x + 55.0, y - 80.0, z + 35.0), (x, y, z), (0.0, 0.0, 1.0))
    return replace(camera, **changes)


def both(technique: str, light: Any = (-60.0, -20.0, 50.0), **values: Any) -> tuple[Any, Any]:
    """The image at the origin and the one far away."""
    images = []
    parallel = values.pop("parallel", False)
    for offset in (np.zeros(3), OFFSET):
        of = volume(np.float32, spacing=(0.75, 1.0, 1.25), origin=tuple(offset), direction=LEFT_HANDED)
        x, y, z = np.round(np.array(of.center) - offset) + offset
        placed = {"light_position": (x + light[0], y + light[1], z + light[2])} if light else {}
        planes = ((of.center, (1.0, 0.25, 0.0)),) if values.get("clip_planes") else ()
        view = view_of(of, offset, parallel=parallel)
        images.append(
            image(
                of, function(of), view, technique_id=technique, **placed, **(values | {"clip_planes": planes})
            )
        )
    return images[0], images[1]


@pytest.mark.parametrize("technique", IMAGE_TECHNIQUES)
def test_the_placed_light_shines_far_from_the_origin_as_it_does_there(technique: str) -> None:
    known = {p.name for p in techniques()[technique].parameters}
    near, far = both(technique, **({"shading": True} if "shading" in known else {}))
    assert near[..., 3].max() > 0.1
    assert np.abs(near - far).max() <= 1 / 255


@pytest.mark.parametrize(
    "values", [{"parallel": True}, {"clip_planes": True}], ids=lambda values: next(iter(values))
)
@pytest.mark.parametrize("technique", ["raycast", "isosurface", "half_angle", "splatting"])
def test_headlight_projection_and_clip_planes_keep_their_digits(
    technique: str, values: dict[str, Any]
) -> None:
    near, far = both(technique, light=None, **values)
    assert near[..., 3].max() > 0.1
    assert np.abs(near - far).max() <= 1 / 255
