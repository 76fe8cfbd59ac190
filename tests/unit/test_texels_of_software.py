"""What is stored for rasterisers that compute on the processor: values with their neighbours, curves as segments."""

from __future__ import annotations

import numpy as np
import pytest

from volviz.custom_gl.gpu.context import segment_texels
from volviz.custom_gl.gpu.corner_texels import holds_corners, with_neighbours

RANDOM = np.random.default_rng(5)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_a_texel_holds_the_eight_values_around_a_place(dtype: type[np.unsignedinteger]) -> None:
    data = RANDOM.integers(0, np.iinfo(dtype).max, (5, 4, 6)).astype(dtype)
    stored = with_neighbours(data, 1, 5)
    assert stored.shape == (4, 4, 6, 8)
    assert stored.dtype == dtype
    edged = np.pad(data, ((0, 1), (0, 1), (0, 1)), mode="edge")
    for corner in range(8):
        x, y, z = corner & 1, corner >> 1 & 1, corner >> 2
        assert np.array_equal(stored[..., corner], edged[1 + z : 5 + z, y : 4 + y, x : 6 + x])


def test_values_with_neighbours_must_fit() -> None:
    assert holds_corners(2**24, 1, 2**31)
    assert not holds_corners(2**24, 4, 2**31), "floats are filtered by OpenGL"
    assert not holds_corners(2**24, 2, 2**27), "eight times two bytes a voxel"


def test_a_segment_holds_both_ends_of_a_piece_of_the_curve() -> None:
    table = RANDOM.uniform(0, 1, (1, 40, 4)).astype(np.float32)
    table[0, 3] = (0, 1, 0, 0)
    table[0, 4] = (1, 0, 1, 1)
    texels = segment_texels(table)
    assert texels.shape == (1, 39, 4)
    words = texels.view(np.uint32)[0].astype(np.int64)
    for end in range(2):
        color, opacity = words[:, end], words[:, 2 + end]
        blue = (color >> 26 & 63) | (opacity & 127) << 6
        found = np.stack([color & 8191, color >> 13 & 8191, blue], axis=1) / 8191
        expected = table[0, end : 39 + end]
        assert np.abs(found - expected[:, :3]).max() <= 0.5 / 8191 + 1e-7
        kept = (opacity & ~127).astype(np.uint32).view(np.float32)
        assert np.abs(kept - expected[:, 3]).max() <= 2.0**-17
        # nothing and everything stay exact: what is not there must not be drawn
        assert set(kept[expected[:, 3] == 0]) <= {0.0}
        assert set(kept[expected[:, 3] == 1]) <= {1.0}
