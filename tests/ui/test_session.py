"""Sessions in the window, and what is offered after a crash."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QFileDialog, QMessageBox

from tests.ui.conftest import image, is_complete, save_ball
from volviz.model.layers import ImageLayer, LabelLayer
from volviz.model.session import save_session
from volviz.volume_data.references import VolumeRef
from volviz_ui.app.main_window import MainWindow
from volviz_ui.session.autosave import Autosave, left_behind
from volviz_ui.session.opening import editable

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
    before = image(window)
    path = tmp_path / "mine.volviz.json"
    assert window.session_commands.save_path(path)

    window.open(other_file)
    wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))
    window.open(str(path))
    wait_for(lambda: window.documents.volume.dimensions == (32, 32, 32))
    assert window.store.scene == scene
    wait_for(lambda: is_complete(window))
    assert np.abs(image(window) - before).max() <= 2
    window.commands["edit.undo"].trigger()
    wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))


def test_a_session_whose_volume_is_gone_leaves_the_scene_and_asks_where_it_is(
    window: MainWindow, other_file: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, wait_for: Wait
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
    (box,) = window.findChildren(QMessageBox)
    assert "other.npy is no longer" in box.text()
    assert window.store.scene == scene
    moved = tmp_path / "elsewhere.npy"
    save_ball(moved, 120, size=24)
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(moved), ""))
    box.defaultButton().click()
    wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))
    assert window.store.scene.layer.volume.source == str(moved)


def test_changes_are_marked_saved_without_a_question_and_asked_about(
    window: MainWindow, tmp_path: Path, other_file: str, monkeypatch: pytest.MonkeyPatch, wait_for: Wait
) -> None:
    assert not window.isWindowModified()
    window.view_commands.show_axis_view("L")
    assert not window.isWindowModified()
    window.view_commands.set_background((0.0, 0.0, 0.0))
    assert window.isWindowModified()
    path = tmp_path / "mine.volviz.json"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(path), ""))
    window.commands["file.save_session"].trigger()
    assert not window.isWindowModified()
    assert json.loads(path.read_text())["layers"][0]["volume"]["source"] == "ball.npy"
    monkeypatch.delattr(QFileDialog, "getSaveFileName")
    window.view_commands.set_background((1.0, 1.0, 1.0))
    window.commands["file.save_session"].trigger()
    assert json.loads(path.read_text())["background"] == [1.0, 1.0, 1.0]
    window.view_commands.set_background((0.5, 0.5, 0.5))
    window.preferences.asks_about_changes = True
    window.file_commands.open_path(other_file)
    (box,) = window.findChildren(QMessageBox)
    box.button(QMessageBox.StandardButton.Cancel).click()
    assert window.documents.volume.dimensions == (32, 32, 32)
    QApplication.processEvents()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    assert not window.close()
    (box,) = window.findChildren(QMessageBox)
    box.button(QMessageBox.StandardButton.Save).click()
    assert not window.isVisible()
    assert json.loads(path.read_text())["background"] == [0.5, 0.5, 0.5]


def test_the_scene_is_written_after_a_change_and_removed_at_the_end(
    window: MainWindow, tmp_path: Path, wait_for: Wait
) -> None:
    autosave = Autosave(window.store, tmp_path / "auto", window)
    autosave._timer.setInterval(20)
    window.view_commands.set_background((0.0, 0.0, 0.0))
    wait_for(lambda: autosave.paths and autosave.paths[-1].exists())
    QTest.qWait(50)
    assert not autosave._timer.isActive()
    assert left_behind(tmp_path / "auto") == []
    for _ in range(4):
        autosave._begun = 0.0  # long ago
        autosave.write()
        QTest.qWait(2)
    assert len(list((tmp_path / "auto").iterdir())) == 3
    autosave.close()
    assert not list((tmp_path / "auto").iterdir())


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
    assert "ball" in box.informativeText()
    box.escapeButton().click()
    assert crashed.exists()
    restore = window.session_commands.left_entries()[0]
    assert restore.text == box.informativeText()
    box = window.session_commands.offer_restore(tmp_path / "auto")
    box.defaultButton().click()
    wait_for(lambda: window.documents.volume.dimensions == (32, 32, 32))
    assert window.isWindowModified()
    assert window.store.scene.background == (0.0, 0.0, 0.0)
    assert not crashed.exists()
    assert window.session_commands.offer_restore(tmp_path / "auto") is None


def test_all_layers_are_kept_and_drawn(
    window: MainWindow, tmp_path: Path, ball_file: str, wait_for: Wait
) -> None:
    labels = LabelLayer(VolumeRef(ball_file), {3: "red"}, names={3: "liver"}, hidden=(1,))
    second = ImageLayer(VolumeRef(ball_file), color="green", window=(10, 90), name="second")
    window.store.update(lambda scene: replace(scene, layers=(labels, *scene.layers, second)), label="Layers")
    wait_for(lambda: is_complete(window))
    kept = window.store.scene.layers
    path = tmp_path / "three.volviz.json"
    window.session_commands.save_path(path)
    window.documents.undo()
    assert len(window.store.scene.layers) == 1
    window.documents.redo()
    assert window.store.scene.layers == kept
    window.documents.undo()
    window.session_commands.open_path(path)
    wait_for(lambda: len(window.store.scene.layers) == 3)
    assert [replace(layer, volume=labels.volume) for layer in window.store.scene.layers] == [
        replace(editable(layer, window.documents.volume), volume=labels.volume) for layer in kept
    ]
    assert window.store.scene.layer == window.store.scene.layers[1]
    wait_for(lambda: is_complete(window))
    assert len(window.controller.handle.spec.layers) == 3


def test_a_layer_of_a_colour_is_opened_with_a_function_that_can_be_edited(
    window: MainWindow, tmp_path: Path, ball_file: str, wait_for: Wait
) -> None:
    layer = ImageLayer(VolumeRef(ball_file), color="green", window=(10, 90), opacity=0.5, name="green")
    save_session(replace(window.store.scene, layers=(layer,)), tmp_path / "green.volviz.json")
    window.open(str(tmp_path / "green.volviz.json"))
    wait_for(lambda: window.store.scene.layer.name == "green")
    shown = window.store.scene.layer
    assert shown == replace(editable(layer, window.documents.volume), volume=shown.volume)
    assert (shown.color, shown.opacity) == (None, 0.5)
    color = {point.color for point in shown.transfer_function.points}
    assert color == {layer.color}
    assert window.messages.status_line.currentMessage() == ""


def test_a_session_of_labels_alone_is_refused_in_words(
    window: MainWindow, tmp_path: Path, ball_file: str, wait_for: Wait
) -> None:
    scene = window.store.scene
    save_session(replace(scene, layers=(LabelLayer(VolumeRef(ball_file)),)), tmp_path / "labels.volviz.json")
    window.open(str(tmp_path / "labels.volviz.json"))
    wait_for(lambda: [box for box in window.findChildren(QMessageBox) if box.isVisible()])
    (box,) = [box for box in window.findChildren(QMessageBox) if box.isVisible()]
    assert "labels alone" in box.text() + box.informativeText()
    box.close()
    assert window.store.scene == scene
