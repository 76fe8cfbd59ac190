"""Saving the volume from the window."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtWidgets import QMessageBox

import volviz
from volviz.io.writers import WRITERS
from volviz.volume_data.array_source import ArraySource
from volviz_ui.app.main_window import MainWindow
from volviz_ui.dialogs.save_volume import SaveVolumeDialog, voxels_of

Wait = Callable[..., None]

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")


@pytest.fixture
def window(same_window: MainWindow) -> MainWindow:
    return same_window


def asked(window: MainWindow, kind: str) -> SaveVolumeDialog:
    window.commands["file.save_volume"].trigger()
    dialog = window.findChild(SaveVolumeDialog)
    dialog.format.setCurrentIndex([writer.id for writer in WRITERS].index(kind))
    return dialog


def written(dialog: SaveVolumeDialog, path: Path, wait_for: Wait) -> None:
    """The dialog writes and goes."""
    paths: list[str] = []
    dialog.saved.connect(paths.append)
    dialog.save(str(path))
    wait_for(lambda: bool(paths))
    assert paths == [str(path)]


def test_the_crop_box_is_written_and_the_words_tell_what_is_lost(
    window: MainWindow, tmp_path: Path, wait_for: Wait
) -> None:
    clipping = replace(window.store.scene.clipping, crop=(3.4, 20.0, 0.0, 31.0, 5.0, 9.5))
    window.store.update(lambda scene: replace(scene, clipping=clipping))
    dialog = asked(window, "nrrd")
    assert dialog.words.text() == "All that is known of the volume is kept."
    assert not dialog.channels.isVisible()
    dialog.part.setCurrentIndex(1)
    written(dialog, tmp_path / "part.nrrd", wait_for)
    again = volviz.load(tmp_path / "part.nrrd")
    np.testing.assert_array_equal(again.array, window.documents.volume.array[5:10, :, 4:21])
    np.testing.assert_allclose(again.origin, (4, 0, 5))


def test_all_time_points_are_read_again_or_the_format_says_no(
    window: MainWindow, tmp_path: Path, wait_for: Wait
) -> None:
    array = np.random.default_rng(2).integers(0, 99, (2, 3, 5, 6, 7)).astype(np.int16)
    volviz.save(ArraySource(array, "tczyx"), tmp_path / "in.nrrd")
    window.open(str(tmp_path / "in.nrrd"))
    wait_for(lambda: window.documents.volume.name == "in")
    dialog = asked(window, "vti")
    dialog.times.setCurrentIndex(1)
    assert "holds one time point" in dialog.words.text()
    assert not dialog.save_button.isEnabled()
    dialog.format.setCurrentIndex([writer.id for writer in WRITERS].index("imagej"))
    assert "holds no values of type int16" in dialog.words.text()
    dialog.format.setCurrentIndex([writer.id for writer in WRITERS].index("ome-tiff"))
    dialog.channels.setCurrentIndex(1)
    written(dialog, tmp_path / "out.ome.tif", wait_for)
    again = volviz.open(tmp_path / "out.ome.tif")
    np.testing.assert_array_equal(again.read(time=1, channel=2).array, array[1, 2])


def test_a_failure_is_told_and_the_dialog_stays(window: MainWindow, tmp_path: Path, wait_for: Wait) -> None:
    dialog = asked(window, "nifti")
    dialog.save(str(tmp_path / "missing" / "v.nii"))
    (box,) = [each for each in dialog.findChildren(QMessageBox) if each.isVisible()]
    assert "missing" in box.text() + box.informativeText()
    box.close()
    assert dialog.isVisible()
    dialog.reject()


def test_voxels_of_a_crop_box_are_those_whose_centres_lie_in_it() -> None:
    assert voxels_of((0.0, 9.0, 0.0, 9.0, 0.0, 9.0), (10, 10, 10)) is None
    assert voxels_of((0.5, 3.0, 2.0, 8.9, 8.9, 9.0), (10, 10, 10)) == (1, 4, 2, 9, 8, 10)
