"""The dialog for raw files: guesses, slices, and whether the sizes fit."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from PySide6.QtWidgets import QDialogButtonBox

from tests.unit.io.test_raw_guesses import smooth
from volviz_ui.app.main_window import MainWindow
from volviz_ui.dialogs.raw_import import RawImportDialog, is_raw, says_all

Wait = Callable[..., None]


def dialog_of(window: MainWindow, path: Path) -> RawImportDialog:
    window.file_commands.open_path(str(path))
    (dialog,) = (each for each in window.findChildren(RawImportDialog) if each.isVisible())
    return dialog


def test_what_is_likely_is_filled_in_shown_and_opened(
    bare_window: MainWindow, wait_for: Wait, tmp_path: Path
) -> None:
    array = smooth((24, 30, 36), ">i2")
    path = tmp_path / "scan.raw"
    path.write_bytes(bytes(352) + array.tobytes())
    dialog = dialog_of(bare_window, path)
    opens = dialog.buttons.button(QDialogButtonBox.StandardButton.Open)
    wait_for(lambda: all(not label.pixmap().isNull() for label in dialog.slices))
    assert dialog.guesses.currentText() == "36 × 30 × 24, int16, big endian, header 352 bytes"
    assert dialog.guess.dims == (36, 30, 24)
    assert "exactly" in dialog.check.text()
    dialog.dims[2].setValue(25)
    assert "cannot be so" in dialog.check.text()
    assert not opens.isEnabled()
    wait_for(lambda: dialog.slices[0].pixmap().isNull())
    dialog.dims[2].setValue(23)
    assert "2 160 bytes longer" in dialog.check.text()
    assert opens.isEnabled()
    dialog.guesses.activated.emit(0)
    wait_for(lambda: not dialog.slices[0].pixmap().isNull())
    opens.click()
    wait_for(lambda: bare_window.documents.volume is not None)
    assert bare_window.documents.volume is not None
    np.testing.assert_array_equal(bare_window.documents.volume.array, array)


def test_a_file_that_cannot_be_read_is_said_and_not_opened(
    bare_window: MainWindow, wait_for: Wait, tmp_path: Path
) -> None:
    path = tmp_path / "scan.raw.gz"
    path.write_bytes(b"\x1f\x8b\x08 damaged")
    dialog = dialog_of(bare_window, path)
    wait_for(lambda: "cannot be read" in dialog.check.text())
    assert not dialog.buttons.button(QDialogButtonBox.StandardButton.Open).isEnabled()
    dialog.reject()


def test_raw_names_tell_what_they_tell() -> None:
    assert is_raw("a/head_256x256x225_uint8.RAW")
    assert is_raw("male_128x256x256_uint8.raw.gz")
    assert not is_raw("head.nii")
    assert says_all("head_256x256x225_uint8.raw")
    assert not says_all("head_256x256x225.raw")
    assert not says_all("head.raw")
