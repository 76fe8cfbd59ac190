"""Move and turn of a layer as a matrix, and back."""

from __future__ import annotations

import numpy as np
import pytest

from volviz.model.layers import ImageLayer
from volviz.model.placement import Placement
from volviz.volume_data.references import VolumeRef

CENTER = (10.0, -4.0, 2.5)


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (30.0, -20.0, 75.0), (0.0, 0.0, 180.0)])
def test_a_placement_is_found_again_in_its_matrix(turn: tuple[float, float, float]) -> None:
    placed = Placement((1.0, 2.0, -3.0), turn)
    matrix = np.array(placed.transform(CENTER))
    # the middle is only moved
    np.testing.assert_allclose(matrix @ (*CENTER, 1.0), (11.0, -2.0, -0.5, 1.0), atol=1e-12)
    found = Placement.of(ImageLayer(VolumeRef("a"), transform=matrix).transform, CENTER)
    np.testing.assert_allclose(np.array(found.transform(CENTER)), matrix, atol=1e-12)
    np.testing.assert_allclose(found.move, placed.move, atol=1e-12)


def test_what_stretches_is_kept_and_nothing_is_no_matrix() -> None:
    matrix = np.diag((2.0, 1.0, -1.0, 1.0))
    matrix[:3, 3] = 5.0, 6.0, 7.0
    found = Placement.of(ImageLayer(VolumeRef("a"), transform=matrix).transform, CENTER)
    assert found.turn == (0.0, 0.0, 0.0)
    np.testing.assert_allclose(np.array(found.transform(CENTER)), matrix, atol=1e-12)
    assert Placement.of(None, CENTER).transform(CENTER) is None
