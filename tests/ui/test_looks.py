"""Files open with the look that suits them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.ui.conftest import foreground, image, is_complete
from volviz.custom_gl.scene_techniques import current_settings, with_slices
from volviz.model.light import Light
from volviz_ui.app.main_window import MainWindow

pytestmark = pytest.mark.looks
Wait = Callable[..., None]


@pytest.fixture
def distances(tmp_path: Path) -> str:
    """A NumPy file of the distance from a sphere of radius 8 in 24^3 voxels."""
    place = np.indices((24, 24, 24)) - 11.5
    path = tmp_path / "distances.npy"
    np.save(path, (8.0 - np.sqrt((place**2).sum(axis=0))).astype(np.float32))
    return str(path)


def test_a_file_opens_lit_from_the_upper_left_in_one_step(
    bare_window: MainWindow, distances: str, ball_file: str, wait_for: Wait
) -> None:
    window = bare_window
    window.open(ball_file)
    wait_for(lambda: window.documents.volume is not None)
    before = window.store.scene
    window.open(distances)
    wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))
    wait_for(lambda: is_complete(window))
    assert window.store.scene.view.technique == "isosurface"
    assert current_settings(window.store.scene).isovalues == (0.0,)
    assert window.store.scene.light == Light(headlight=False)
    seen = foreground(window)
    rows, columns = np.nonzero(seen)
    middle, brightness = int(columns.mean()), image(window).mean(axis=2)
    left, right = seen.copy(), seen.copy()
    left[:, middle:] = right[:, :middle] = False
    assert brightness[left].mean() > 1.05 * brightness[right].mean()
    upper, lower = seen.copy(), seen.copy()
    upper[int(rows.mean()) :] = lower[: int(rows.mean())] = False
    assert brightness[upper].mean() > 1.05 * brightness[lower].mean()
    window.store.undo()
    assert window.store.scene.layers == before.layers
    assert window.store.scene.view.technique == before.view.technique


def test_slices_and_views_that_are_compared_keep_their_techniques(
    bare_window: MainWindow, distances: str, ball_file: str, wait_for: Wait
) -> None:
    window = bare_window
    window.open(ball_file)
    wait_for(lambda: window.documents.volume is not None)
    window.store.update(lambda scene: with_slices(scene, "large").with_view(0, technique="slicing"))
    window.open(distances)
    wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))
    assert [view.technique for view in window.store.scene.views] == ["isosurface", "slice", "slice", "slice"]
    window.store.undo()
    compared = ["splatting", "slicing"]
    window.store.update(lambda scene: scene.with_view_count(1).with_view_count(2))
    for number, technique in enumerate(compared):
        window.store.update(lambda scene, n=number, t=technique: scene.with_view(n, technique=t))
    wait_for(lambda: window.documents.volume.dimensions == (32, 32, 32))
    window.open(distances)
    wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))
    assert [view.technique for view in window.store.scene.views] == compared
