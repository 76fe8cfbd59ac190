"""Sessions in the window, and what is offered after a crash."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMessageBox

from tests.ui.conftest import is_complete, picture
from volviz.model.session import save_session
from volviz_ui.autosave import Autosave, left_behind
from volviz_ui.main_window import MainWindow

Wait = Callable[..., None]
DEAD_PROCESS = 2**22 + 5


def test_a_saved_session_brings_everything_back(
    window: MainWindow, other_file: str, tmp_path: Path, wait_for: Wait
) -> None:
    window.view_commands.show_axis_view("L")
    window.data_panel.planes.add_plane((0.0, 0.0, 1.0))
    window.technique_commands.refine(1)
    scene = window.store.scene
    wait_for(lambda: is_complete(window))
    before = picture(window)
    path = tmp_path / "mine.volviz.json"
    assert window.session_commands.save_path(path)

    window.open(other_file)
    wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))
    window.open(str(path))
    wait_for(lambda: window.documents.volume.dimensions == (32, 32, 32))
    assert window.store.scene == scene
    wait_for(lambda: is_complete(window))
    assert np.abs(picture(window) - before).max() <= 2
    window.commands["edit.undo"].trigger()
    wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))


def test_a_session_whose_volume_is_gone_leaves_the_scene(
    window: MainWindow, other_file: str, tmp_path: Path, wait_for: Wait
) -> None:
    window.open(other_file)
    wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))
    path = tmp_path / "mine.volviz.json"
    save_session(window.store.scene, path)
    window.commands["edit.undo"].trigger()
    wait_for(lambda: window.documents.volume.dimensions == (32, 32, 32))
    Path(other_file).unlink()
    window.documents.cache.clear()
    scene = window.store.scene
    window.open(str(path))
    wait_for(lambda: [box for box in window.findChildren(QMessageBox) if box.isVisible()])
    assert window.store.scene == scene
    for box in window.findChildren(QMessageBox):
        box.close()


def test_the_scene_is_written_after_a_change_and_removed_at_the_end(
    window: MainWindow, tmp_path: Path, wait_for: Wait
) -> None:
    autosave = Autosave(window.store, tmp_path / "auto", window)
    autosave._timer.setInterval(20)
    window.view_commands.set_background((0.0, 0.0, 0.0))
    wait_for(autosave.path.exists)
    QTest.qWait(50)
    assert not autosave._timer.isActive()
    assert left_behind(tmp_path / "auto") is None
    autosave.close()
    assert not autosave.path.exists()


def test_after_a_crash_the_scene_is_offered_and_restored(
    window: MainWindow, other_file: str, tmp_path: Path, wait_for: Wait, qapp: QApplication
) -> None:
    window.view_commands.set_background((0.0, 0.0, 0.0))
    crashed = tmp_path / "auto" / f"autosave-{DEAD_PROCESS}.volviz.json"
    crashed.parent.mkdir()
    save_session(window.store.scene, crashed)
    window.open(other_file)
    wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))
    box = window.session_commands.offer_restore(tmp_path / "auto")
    assert box is not None
    box.defaultButton().click()
    wait_for(lambda: window.documents.volume.dimensions == (32, 32, 32))
    assert window.store.scene.background == (0.0, 0.0, 0.0)
    assert not crashed.exists()
    assert window.session_commands.offer_restore(tmp_path / "auto") is None
