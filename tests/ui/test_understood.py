"""What was understood of a file is shown, corrected and remembered for it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

import volviz
from volviz_ui.app.main_window import MainWindow
from volviz_ui.dialogs.understood import UnderstoodDialog

Wait = Callable[..., None]


def dialog_of(window: MainWindow) -> UnderstoodDialog:
    window.data_panel.correct.click()
    (dialog,) = (each for each in window.findChildren(UnderstoodDialog) if each.isVisible())
    return dialog


def shown(window: MainWindow) -> volviz.Volume:
    volume = window.documents.volume
    assert volume is not None
    return volume


def test_spacing_axes_and_units_are_corrected_remembered_and_taken_back(
    bare_window: MainWindow, wait_for: Wait, tmp_path: Path
) -> None:
    window = bare_window
    path, other = tmp_path / "v.npy", tmp_path / "w.npy"
    for each in (path, other):
        np.save(each, np.arange(7 * 8 * 9, dtype=np.uint16).reshape(7, 8, 9))
    window.open(str(path))
    wait_for(lambda: window.documents.volume is not None)
    dialog = dialog_of(window)
    assert not dialog.apply.isEnabled()
    dialog.axes[0].setCurrentIndex(dialog.axes[0].findData("P"))
    assert "same line" in dialog.check.text()
    assert not dialog.apply.isEnabled()
    dialog.axes[1].setCurrentIndex(dialog.axes[1].findData("R"))
    dialog.spacing[2].setValue(2.5)
    dialog.length_unit.setCurrentText("µm")
    dialog.unit.setText("counts")
    dialog.apply.click()
    wait_for(lambda: window.documents.is_current and shown(window).spacing == (1, 1, 2.5))
    np.testing.assert_array_equal(shown(window).direction, [[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    assert (shown(window).metadata["length_unit"], shown(window).unit) == ("µm", "counts")
    # a step of the history
    window.documents.undo()
    wait_for(lambda: window.documents.is_current and shown(window).spacing == (1, 1, 1))
    # another file is as it says, this one as it was corrected
    window.open(str(other))
    wait_for(lambda: shown(window).name == "w")
    assert shown(window).spacing == (1, 1, 1)
    window.open(str(path))
    wait_for(lambda: shown(window).name == "v")
    assert (shown(window).spacing, shown(window).unit) == ((1, 1, 2.5), "counts")
    # Python and the command line take the file at its word
    assert volviz.load(path).spacing == (1, 1, 1)
    dialog = dialog_of(window)
    dialog.as_the_file_says.click()
    wait_for(lambda: window.documents.is_current and shown(window).spacing == (1, 1, 1))
    assert window.preferences.correction(window.store.scene.layers[0].key.ref) == {}


def test_a_file_that_has_changed_is_taken_at_its_word(
    bare_window: MainWindow, wait_for: Wait, tmp_path: Path
) -> None:
    path = tmp_path / "v.npy"
    np.save(path, np.arange(7 * 8 * 9, dtype=np.uint16).reshape(7, 8, 9))
    bare_window.open(str(path))
    wait_for(lambda: bare_window.documents.volume is not None)
    dialog = dialog_of(bare_window)
    dialog.spacing[0].setValue(3)
    dialog.apply.click()
    wait_for(lambda: bare_window.documents.is_current and shown(bare_window).spacing == (3, 1, 1))
    np.save(path, np.zeros((5, 6, 7), np.uint8))
    bare_window.open(str(path))
    wait_for(lambda: shown(bare_window).dimensions == (7, 6, 5))
    assert shown(bare_window).spacing == (1, 1, 1)
