"""One of several images of a file, and files on the network, in the window."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QDialogButtonBox

from tests.unit.io import stores
from volviz_ui.app.main_window import MainWindow
from volviz_ui.dialogs.choose_entry import ChooseEntryDialog
from volviz_ui.dialogs.open_address import OpenAddressDialog

Wait = Callable[..., None]


def shown(window: MainWindow) -> tuple[int, ...] | None:
    volume = window.documents.volume
    return None if volume is None else volume.dimensions


def dialogs(window: MainWindow) -> list[ChooseEntryDialog]:
    return [each for each in window.findChildren(ChooseEntryDialog) if each.isVisible()]


def test_a_data_set_is_chosen_in_a_tree_and_kept_in_the_list_of_files(
    bare_window: MainWindow, wait_for: Wait, tmp_path: Path
) -> None:
    path = tmp_path / "v.h5"
    with h5py.File(path, "w") as file:
        file["scan/raw"] = np.arange(8 * 9 * 10, dtype=np.uint16).reshape(8, 9, 10)
        file["scan/small/half"] = np.arange(4 * 5 * 6, dtype=np.uint8).reshape(4, 5, 6)
    bare_window.open(str(path))
    wait_for(lambda: dialogs(bare_window))
    (dialog,) = dialogs(bare_window)
    assert not bare_window.documents.is_loading
    assert dialog.entry is not None
    assert dialog.entry.name == "scan/raw"
    top = dialog.tree.topLevelItem(0)
    assert (top.text(0), top.childCount()) == ("scan", 2)
    assert [top.child(0).text(column) for column in range(3)] == ["raw", "8 × 9 × 10", "uint16"]
    dialog.tree.setCurrentItem(top)
    assert not dialog.buttons.button(QDialogButtonBox.StandardButton.Open).isEnabled()
    dialog.choose("scan/small/half")
    dialog.buttons.button(QDialogButtonBox.StandardButton.Open).click()
    wait_for(lambda: shown(bare_window) == (6, 5, 4))
    assert dict(bare_window.preferences.recent[0].ref.hints) == {"series": "scan/small/half"}
    # cancelled, nothing changes
    bare_window.open(str(path))
    wait_for(lambda: dialogs(bare_window))
    dialogs(bare_window)[0].reject()
    assert shown(bare_window) == (6, 5, 4)


def test_an_address_is_asked_for_and_opened(bare_window: MainWindow, wait_for: Wait, tmp_path: Path) -> None:
    path = stores.image(tmp_path / "v.zarr", [stores.small((4, 5, 6))], [(1, 1, 1)])
    QApplication.clipboard().setText("no address")
    dialog = bare_window.file_commands.ask_for_address()
    assert isinstance(dialog, OpenAddressDialog)
    button = dialog.buttons.button(QDialogButtonBox.StandardButton.Open)
    assert not button.isEnabled()
    QTest.keyClicks(dialog.field, path.as_uri())
    assert button.isEnabled()
    QTest.keyClick(dialog.field, Qt.Key.Key_Return)
    wait_for(lambda: shown(bare_window) == (6, 5, 4))
    assert bare_window.windowTitle().startswith("v")
