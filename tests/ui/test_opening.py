"""Opening files: on a worker, from everywhere, and what happens when it fails."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import tifffile
from PySide6.QtCore import QMimeData, QPointF, QSettings, Qt, QTimer, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QApplication, QMenu, QMessageBox

from tests.ui.conftest import foreground, is_complete, save_ball
from volviz.custom_gl.scene_techniques import choose_technique
from volviz.volume_data.references import VolumeKey, VolumeRef
from volviz_ui.app.main_window import MainWindow
from volviz_ui.session.preferences import Preferences

Wait = Callable[..., None]


def drop(window: MainWindow, *paths: str) -> None:
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(path) for path in paths])
    position = QPointF(window.rect().center())
    keys = (Qt.DropAction.CopyAction, data, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier)
    enter = QDragEnterEvent(position.toPoint(), *keys)
    QApplication.sendEvent(window, enter)
    assert enter.isAccepted()
    QApplication.sendEvent(window, QDropEvent(position, *keys))


def error_boxes(window: MainWindow) -> list[QMessageBox]:
    return [box for box in window.findChildren(QMessageBox) if box.isVisible()]


def test_a_dropped_file_is_shown_in_the_middle(
    bare_window: MainWindow, ball_file: str, wait_for: Wait
) -> None:
    drop(bare_window, ball_file)
    wait_for(lambda: bare_window.documents.volume is not None)
    wait_for(lambda: is_complete(bare_window))
    seen = foreground(bare_window)
    rows, columns = np.nonzero(seen)
    height, width = seen.shape
    assert 0.03 < seen.mean() < 0.6
    assert abs(rows.mean() / height - 0.5) < 0.05
    assert abs(columns.mean() / width - 0.5) < 0.05
    assert bare_window.windowTitle().startswith("ball")


def test_the_panels_say_what_was_opened(window: MainWindow) -> None:
    properties = {key: label.whole for key, label in window.data_panel._properties.items()}
    assert properties["size"] == "32 × 32 × 32"
    assert properties["range"].startswith("0 … 200")
    assert "32 × 32 × 32" in window.messages.status_line.volume.text()


def test_a_file_that_cannot_be_read_leaves_the_scene_and_says_one_sentence(
    window: MainWindow, tmp_path: Path, wait_for: Wait
) -> None:
    bad = tmp_path / "notes.txt"
    bad.write_text("this is no volume\n" * 40)
    scene, volume = window.store.scene, window.documents.volume
    drop(window, str(bad))
    wait_for(lambda: error_boxes(window))
    box = error_boxes(window)[0]
    assert box.text().count("\n") == 0
    assert "Traceback" not in box.text()
    assert "Traceback" in box.detailedText() or "Error" in box.detailedText()
    box.close()
    assert window.store.scene == scene
    assert window.documents.volume is volume
    assert not window.documents.is_loading


def test_the_first_file_leaves_nothing_to_undo(window: MainWindow) -> None:
    assert window.store.undo_label is None
    assert not window.commands["edit.undo"].isEnabled()


def test_undo_across_files_brings_back_volume_and_camera(
    window: MainWindow, other_file: str, wait_for: Wait
) -> None:
    first, camera = window.documents.volume, window.store.scene.view.camera
    window.open(other_file)
    wait_for(lambda: window.documents.volume is not first)
    assert window.documents.volume.dimensions == (24, 24, 24)
    assert "other" in window.commands["edit.undo"].text()
    window.commands["edit.undo"].trigger()
    wait_for(lambda: window.documents.volume is first)
    assert window.store.scene.view.camera == camera
    assert window.viewport.view_camera.position == camera.position
    window.commands["edit.redo"].trigger()
    wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))


def test_undo_reads_a_file_again_when_it_has_left_the_cache(
    window: MainWindow, other_file: str, wait_for: Wait
) -> None:
    first = window.documents.volume
    window.open(other_file)
    wait_for(lambda: window.documents.volume is not first)
    window.documents.cache.clear()
    read: list[str] = []
    window.documents.loading_started.connect(read.append)
    window.commands["edit.undo"].trigger()
    wait_for(lambda: window.documents.volume.dimensions == (32, 32, 32))
    assert read == ["ball.npy"]


def test_undo_to_a_file_that_is_gone_keeps_what_is_shown(
    window: MainWindow, ball_file: str, other_file: str, wait_for: Wait
) -> None:
    window.open(other_file)
    wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))
    wait_for(lambda: is_complete(window))
    shown, scene = window.documents.volume, window.store.scene
    window.documents.cache.clear()
    Path(ball_file).unlink()
    window.commands["edit.undo"].trigger()
    wait_for(lambda: error_boxes(window))
    error_boxes(window)[0].close()
    assert window.documents.volume is shown
    assert window.store.scene.layers == scene.layers


def test_coming_back_from_a_file_that_never_arrived_shows_the_present_technique(
    window: MainWindow, other_file: str, wait_for: Wait
) -> None:
    window.open(other_file)
    wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))
    choose_technique(window.store, "slicing")
    window.documents.cache.clear()
    window.commands["edit.undo"].trigger()
    window.commands["edit.undo"].trigger()
    assert window.documents.is_loading
    window.commands["edit.redo"].trigger()
    assert not window.documents.is_loading
    assert window.store.scene.view.technique == "raycast"
    assert window.controller.handle.technique.id == "raycast"
    assert window.documents.volume.dimensions == (24, 24, 24)
    wait_for(lambda: is_complete(window))
    assert window.controller.handle.error is None


def test_the_newest_wish_wins(bare_window: MainWindow, tmp_path: Path, wait_for: Wait) -> None:
    paths = [str(save_ball(tmp_path / f"ball{n}.npy", 50 + n, size=20 + 2 * n)) for n in range(5)]
    for path in paths:
        bare_window.open(path)
    wait_for(lambda: bare_window.documents.volume is not None)
    wait_for(lambda: not bare_window.workers.is_busy)
    assert bare_window.documents.volume.name == "ball4"


def test_loading_can_be_cancelled(window: MainWindow, tmp_path: Path, wait_for: Wait) -> None:
    big = tmp_path / "big.npy"
    np.save(big, np.zeros((160, 256, 256), np.int16))
    volume = window.documents.volume
    window.open(str(big))
    assert window.messages.banner.shows_progress
    window.messages.banner.stop.click()
    assert not window.documents.is_loading
    wait_for(lambda: not window.workers.is_busy)
    assert window.documents.volume is volume
    assert window.messages.banner.isHidden()


def test_the_window_stays_alive_while_a_file_is_read(
    window: MainWindow, tmp_path: Path, wait_for: Wait
) -> None:
    big = tmp_path / "big.npy"
    rng = np.random.default_rng(5)
    np.save(big, rng.integers(0, 4000, (128, 256, 256), np.int16))
    gaps: list[float] = []
    last = time.perf_counter()

    def beat() -> None:
        nonlocal last
        now = time.perf_counter()
        gaps.append(now - last)
        last = now

    timer = QTimer(window)
    timer.timeout.connect(beat)
    timer.start(5)
    window.open(str(big))
    wait_for(lambda: window.documents.is_loading is False)
    timer.stop()
    # the reading itself, not the drawing that follows it
    assert max(gaps[:-1], default=0.0) < 0.25
    assert len(gaps) > 5


def test_recent_files_can_be_opened_again(window: MainWindow, ball_file: str, wait_for: Wait) -> None:
    assert [key.ref.source for key in window.preferences.recent] == [ball_file]
    (menu,) = [menu for menu in window.findChildren(QMenu) if menu.title() == "Open &recent"]
    menu.aboutToShow.emit()
    assert menu.actions()[0].text() == "ball.npy"


def test_a_time_point_and_channel_live_in_the_layer(
    bare_window: MainWindow, tmp_path: Path, wait_for: Wait
) -> None:
    array = np.arange(3 * 2 * 120, dtype=np.uint8).reshape(3, 4, 2, 5, 6)
    tifffile.imwrite(tmp_path / "h.tif", array, imagej=True, metadata={"axes": "TZCYX"})
    window = bare_window
    window.documents.open(tmp_path / "h.tif", channel=1, time=2, unit="V")
    wait_for(lambda: window.documents.volume is not None)
    layer = window.store.scene.layer
    assert layer is not None
    assert (layer.channel, layer.time, layer.volume.hints) == (1, 2, (("unit", "V"),))
    np.testing.assert_array_equal(window.documents.volume.array, array[2, :, 1])
    # another channel of the same file is another volume, which undo finds in the cache
    window.store.update(lambda scene: scene.with_layer(channel=0), label="Channel")
    wait_for(lambda: np.array_equal(window.documents.volume.array, array[2, :, 0]))
    window.documents.undo()
    assert np.array_equal(window.documents.volume.array, array[2, :, 1])
    assert window.preferences.recent[0] == VolumeKey(replace(layer.volume, content_id=""), 1, 2)


def test_recent_files_of_older_programs_keep_their_time_and_channel(tmp_path: Path) -> None:
    preferences = Preferences(QSettings(str(tmp_path / "p.ini"), QSettings.Format.IniFormat))
    row = {"source": "/a.tif", "hints": {"channel": 1, "time": 3, "spacing": [1.0, 2.0, 3.0]}}
    preferences._settings.setValue("recent", json.dumps([row]))
    ref = VolumeRef("/a.tif", (("spacing", (1.0, 2.0, 3.0)),))
    assert preferences.recent == [VolumeKey(ref, 1, 3)]
    preferences.add_recent(VolumeKey(VolumeRef("/b.tif"), None, 0))
    assert preferences.recent == [VolumeKey(VolumeRef("/b.tif")), VolumeKey(ref, 1, 3)]


def test_a_raw_file_without_a_telling_name_is_asked_about(
    bare_window: MainWindow, tmp_path: Path, wait_for: Wait
) -> None:
    path = tmp_path / "head.raw"
    np.arange(12 * 10 * 8, dtype="<u2").tofile(path)
    dialog = bare_window.file_commands.ask_how_to_read(str(path))
    dialog.dtype.setCurrentText("uint16")
    for field, n in zip(dialog.dims, (8, 10, 12), strict=True):
        field.setValue(n)
    assert dialog.guess.nbytes == path.stat().st_size
    dialog.spacing[2].setValue(2.5)
    # guesses that come later leave alone what was entered
    wait_for(lambda: "exactly" in dialog.check.text())
    assert dialog.guess.dims == (8, 10, 12)
    dialog.accept()
    wait_for(lambda: bare_window.documents.volume is not None)
    assert bare_window.documents.volume.dimensions == (8, 10, 12)
    assert bare_window.documents.volume.spacing == (1.0, 1.0, 2.5)
    assert bare_window.documents.volume.range == (0.0, 959.0)
