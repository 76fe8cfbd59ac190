"""Sessions in the window, and what is offered after a crash."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMessageBox

from tests.ui.conftest import image, is_complete
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
