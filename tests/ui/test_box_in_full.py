"""A volume too large for memory in the window: its coarse level, and a box of it at full resolution."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import volviz
from volviz.volume_data.budgets import budgets, set_budgets
from volviz_ui.app.main_window import MainWindow
from volviz_ui.session.script import script_of

Wait = Callable[..., None]

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")


@pytest.fixture
def window(same_window: MainWindow) -> MainWindow:
    return same_window


@pytest.fixture
def pyramid(tmp_path: Path) -> Path:
    """160^3 voxels and 80^3; the budget holds the second level only."""
    z, y, x = np.ogrid[:160, :160, :160]
    values = ((x // 2 + y // 2 + z // 2) % 251).astype(np.uint8)
    volviz.save(volviz.Volume(values, name="large"), tmp_path / "large.ome.zarr")
    before = set_budgets(memory=4 << 20)
    yield tmp_path / "large.ome.zarr"
    set_budgets(memory=before.memory, texture=budgets().texture)


def dimensions(window: MainWindow) -> tuple[int, ...]:
    return () if window.documents.volume is None else window.documents.volume.dimensions


def test_a_crop_box_is_read_in_full_and_given_back(window: MainWindow, pyramid: Path, wait_for: Wait) -> None:
    window.open(str(pyramid))
    wait_for(lambda: dimensions(window) == (80, 80, 80))
    crop = window.data_panel.crop
    assert "Level 1 is shown" in window.data_panel.notes.text()
    assert crop.full.isVisibleTo(window.data_panel)
    assert not crop.full.isEnabled()
    coarse = window.documents.volume
    crop.sliders[0].setValue((10, 29))
    crop.sliders[2].setValue((40, 59))
    window.store.update(lambda scene: scene, label="")
    camera = window.store.scene.view.camera
    crop.full.click()
    wait_for(lambda: dimensions(window) == (40, 160, 40))
    shown = window.documents.volume
    z, y, x = np.ogrid[80:120, :160, 20:60]
    np.testing.assert_array_equal(shown.array, (x // 2 + y // 2 + z // 2) % 251)
    assert window.store.scene.clipping.crop is None
    assert window.store.scene.view.camera == camera
    assert "level=0" in script_of(window.store.scene, (64, 48))
    assert "box of level 0, the finest" in window.data_panel.notes.text()

    assert crop.full.text() == "Back to all of the file"
    crop.full.click()
    wait_for(lambda: window.documents.volume is coarse)
    # the box around the voxels that were read, half a voxel larger than was dragged at most
    assert np.abs(np.subtract(window.store.scene.clipping.crop, (10, 29, 0, 79, 40, 59))).max() <= 0.5
    for _ in range(2):
        window.documents.undo()
    wait_for(lambda: window.documents.is_current)
    assert dimensions(window) == (80, 80, 80)
    assert window.store.scene.clipping.crop == (10, 29, 0, 79, 40, 59)


def test_a_small_volume_offers_no_finer_box(window: MainWindow, wait_for: Wait) -> None:
    window.open("sample:head")
    wait_for(lambda: window.documents.volume is not None and window.documents.volume.name != "large")
    crop = window.data_panel.crop
    crop.sliders[0].setValue((3, 9))
    assert not crop.full.isVisibleTo(window.data_panel)
