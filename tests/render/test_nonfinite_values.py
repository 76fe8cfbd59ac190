"""NaN and infinities are drawn as the lowest value, by every technique; wide and shifted ranges lose nothing."""

from __future__ import annotations

import numpy as np
import pytest

import volviz
from tests.render.scenes import blobs, camera, function, picture

SIZE = (40, 32)
TECHNIQUES = [name for name in volviz.techniques() if name != "reference"]


def holey() -> volviz.Volume:
    """A field in which single voxels and a corner are no numbers."""
    array = 3.0 + blobs(dtype=np.float32)
    random = np.random.default_rng(11)
    for value in (np.nan, np.inf, -np.inf):
        array[random.random(array.shape) < 0.01] = value
    array[:6, :8, :9] = np.nan
    return volviz.Volume(array, spacing=(1.0, 1.1, 0.9))


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_no_number_is_drawn_as_the_lowest_value(technique: str) -> None:
    holes = holey()
    filled = volviz.Volume(
        np.where(np.isfinite(holes.array), holes.array, holes.range[0]), spacing=holes.spacing
    )
    transfer, view = function(holes), camera(holes)
    # the same first surface for both
    surface = {p.name: 3.4 for p in volviz.techniques()[technique].parameters if p.name == "isovalue"}
    seen = picture(holes, transfer, view, size=SIZE, technique_id=technique, **surface)
    expected = picture(filled, transfer, view, size=SIZE, technique_id=technique, **surface)
    assert expected[..., 3].max() > 0.1
    np.testing.assert_array_equal(seen, expected)


def test_splats_of_a_narrow_range_far_from_zero_have_their_colours() -> None:
    near = volviz.Volume(blobs(dtype=np.float64))
    far = volviz.Volume(1e6 + 1e-3 * near.array)
    pictures = [
        picture(of, function(of), camera(of), size=SIZE, technique_id="splatting", splat_color="transfer_function",
                isovalue=of.range[0] + 0.4 * (of.range[1] - of.range[0]))
        for of in (near, far)
    ]  # fmt: skip
    assert pictures[0][..., 3].max() == 1.0
    # doubles near 1e6 resolve a ten millionth of that range
    np.testing.assert_allclose(*pictures, atol=2e-3)
