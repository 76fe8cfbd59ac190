"""Pieces of VTK's images: all of the tiles, none twice, and smaller where pixels cost more."""

from __future__ import annotations

import numpy as np
import pytest

from volviz.custom_gl.vtk.prop_tiles import FEWEST_PIXELS, PIECE_SECONDS, TileSizes

TILES = ((10, 3, 256, 64), (266, 3, 256, 64), (10, 67, 100, 13))


@pytest.mark.parametrize("cost", [1e-9, 1e-6, 4e-6, 3e-5, 1e-3, 10.0])
def test_pieces_cover_the_tiles_once(cost: float) -> None:
    covered = np.zeros((100, 600), int)
    for x, y, width, height in TileSizes(cost).cut(TILES):
        assert width > 0
        assert height > 0
        covered[y : y + height, x : x + width] += 1
    expected = np.zeros_like(covered)
    for x, y, width, height in TILES:
        expected[y : y + height, x : x + width] += 1
    np.testing.assert_array_equal(covered, expected)


def test_cheap_pixels_leave_the_tiles_whole_and_costly_ones_make_small_pieces() -> None:
    assert TileSizes(1e-9).cut(TILES) == list(TILES)
    for cost in (3e-6, 1e-5, 5e-5):
        sizes = [w * h for _, _, w, h in TileSizes(cost).cut(TILES)]
        assert max(sizes) <= max(PIECE_SECONDS / cost, FEWEST_PIXELS)


def test_what_was_measured_of_the_last_picture_counts_but_not_its_slowest_pieces() -> None:
    sizes = TileSizes(1e-6)
    for _ in range(20):
        sizes.note((0, 0, 100, 10), 0.02)
    sizes.note((0, 0, 100, 10), 5.0)
    assert sizes.seconds_per_pixel == 1e-6
    sizes.begin()
    assert sizes.seconds_per_pixel == pytest.approx(2e-5)
    # nothing was measured since
    sizes.begin()
    assert sizes.seconds_per_pixel == pytest.approx(2e-5)
