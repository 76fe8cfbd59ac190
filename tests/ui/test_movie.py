"""The movie in the window: steps, key frames, looking ahead and back, the film from a process of its own."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QMessageBox

from tests.ui.conftest import image, is_complete
from volviz.model.movie import Movie
from volviz.model.movies.moves import KeyFrame, Turn, Zoom
from volviz_ui.app.main_window import MainWindow
from volviz_ui.dialogs.save_film import SaveFilmDialog
from volviz_ui.movie.panel import MoviePanel

Wait = Callable[..., None]

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")


@pytest.fixture
def window(same_window: MainWindow) -> MainWindow:
    same_window.docks.show("movie")
    return same_window


def say(panel: MoviePanel, words: str) -> None:
    panel.words.setText(words)
    QTest.keyClick(panel.words, Qt.Key.Key_Return)


def test_moves_in_words_become_steps_that_undo_takes_back(window: MainWindow) -> None:
    panel = window.movie_panel
    say(panel, "turn 360 degrees about z in 8 s, then zoom in by 2 in 3 s")
    assert [step.moves for step in window.store.scene.movie.steps] == [(Turn(360.0, "z"),), (Zoom(2.0),)]
    assert panel.steps.item(0).text() == "Turn 360 degrees about z  ·  8 s"
    assert panel.words.text() == ""
    window.store.undo()
    assert window.store.scene.movie == Movie()
    assert panel.steps.count() == 0


def test_words_that_are_no_move_stay_and_are_explained(window: MainWindow) -> None:
    panel = window.movie_panel
    say(panel, "fly to the moon")
    assert "'fly to the moon' is no move" in panel.complaint.text()
    assert panel.complaint.isVisible()
    assert panel.words.text() == "fly to the moon"
    assert not window.store.scene.movie.steps


def test_steps_are_changed_reordered_and_removed(window: MainWindow) -> None:
    maker, panel = window.movie_maker, window.movie_panel
    say(panel, "turn 90 degrees in 2 s; zoom in by 3 in 1 s; hold 1 s")
    panel.steps.setCurrentRow(1)
    panel.seconds.setValue(5.0)
    panel.easing.setCurrentIndex(panel.easing.findData("even"))
    step = window.store.scene.movie.steps[1]
    assert (step.seconds, step.easing) == (5.0, "even")
    maker.move(1, 0)
    assert isinstance(window.store.scene.movie.steps[0].moves[0], Zoom)
    panel.steps.setCurrentRow(0)
    panel.steps.setFocus()
    QTest.keyClick(panel.steps, Qt.Key.Key_Delete)
    assert [len(step.moves) for step in window.store.scene.movie.steps] == [1, 0]


def test_a_moment_is_seen_and_the_picture_comes_back(window: MainWindow, wait_for: Wait) -> None:
    maker, panel = window.movie_maker, window.movie_panel
    say(panel, "turn 180 degrees about z and zoom in by 4 in 4 s evenly")
    before, picture = window.store.scene, image(window)
    assert maker.show(2.0)
    assert window.store.is_interacting
    camera = window.store.scene.view.camera
    quarter = before.view.camera.rotated((0.0, 0.0, 1.0), 90.0)
    np.testing.assert_allclose(camera.direction, quarter.direction, atol=1e-9)
    wait_for(lambda: np.abs(image(window) - picture).max() > 50)
    assert panel.moment.text() == "2.0 / 4.0 s"
    maker.stop()
    assert window.store.scene == before
    assert window.store.undo_label == "Add to the movie"
    wait_for(lambda: is_complete(window))
    assert np.abs(image(window) - picture).max() < 12


def test_playing_goes_on_by_itself_and_ends_at_the_end(window: MainWindow, wait_for: Wait) -> None:
    maker, panel = window.movie_maker, window.movie_panel
    say(panel, "zoom in by 2 in 0.2 s")
    before = window.store.scene
    QTest.mouseClick(panel.play, Qt.MouseButton.LeftButton)
    assert maker.is_playing
    wait_for(lambda: not maker.is_playing)
    assert maker.is_ahead
    assert window.store.scene.view.camera.distance == pytest.approx(before.view.camera.distance / 2)
    QTest.mouseClick(panel.stop, Qt.MouseButton.LeftButton)
    assert window.store.scene == before


def test_a_change_meanwhile_ends_the_look_and_stays(window: MainWindow) -> None:
    maker, panel = window.movie_maker, window.movie_panel
    say(panel, "turn 180 degrees about z in 4 s")
    camera = window.store.scene.view.camera
    maker.show(2.0)
    window.store.update(lambda scene: scene.with_layer(opacity=0.5), label="fainter")
    assert not maker.is_ahead
    assert window.store.scene.layer.opacity == 0.5
    assert window.store.scene.view.camera == camera
    window.store.undo()
    assert window.store.scene.layer.opacity == 1.0
    assert window.store.scene.view.camera == camera


def test_key_frames_hold_what_was_seen(window: MainWindow) -> None:
    maker, panel = window.movie_maker, window.movie_panel
    first = window.store.scene.view.camera
    QTest.keyClick(
        window, Qt.Key.Key_K, Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier
    )
    second = first.turned(60.0)
    window.store.update(window.store.scene.with_camera(second), record=False)
    QTest.mouseClick(panel.key_button, Qt.MouseButton.LeftButton)
    movie = window.store.scene.movie
    assert all(isinstance(step.moves[0], KeyFrame) for step in movie.steps)
    assert movie.seconds == 2.0
    assert panel.steps.item(0).text() == "Begins with: Key frame 1"
    maker.show(0.0)
    assert window.store.scene.view.camera == first
    maker.show(2.0)
    assert window.store.scene.view.camera == second
    maker.stop()
    third = first.turned(-60.0)
    window.store.update(window.store.scene.with_camera(third), record=False)
    panel.steps.setCurrentRow(1)
    QTest.mouseClick(panel.renew_button, Qt.MouseButton.LeftButton)
    assert window.store.scene.movie.steps[1].moves[0].scene.view.camera == third


def test_a_movie_of_time_needs_time(window: MainWindow) -> None:
    maker, panel = window.movie_maker, window.movie_panel
    said: list[str] = []
    maker.failed.disconnect()
    maker.failed.connect(lambda title, error: said.append(str(error)))
    say(panel, "play in 2 s")
    assert not maker.show(1.0)
    assert "one time point only" in said[0]
    assert not maker.is_ahead
    maker.failed.disconnect()
    maker.failed.connect(window.messages.show_error)


def test_the_film_is_drawn_beside_the_window(window: MainWindow, wait_for: Wait, tmp_path: Path) -> None:
    maker, panel = window.movie_maker, window.movie_panel
    say(panel, "turn 360 degrees about z in 0.25 s")
    panel.fps.setCurrentIndex(panel.fps.findData(12))
    dialog = window.movie_commands.save()
    assert isinstance(dialog, SaveFilmDialog)
    dialog.format.setCurrentIndex(2)
    dialog.size.addItem("small", (64, 48))
    dialog.size.setCurrentIndex(dialog.size.count() - 1)
    written: list[str] = []
    maker.written.connect(written.append)
    dialog.take(str(tmp_path / "film"))
    assert maker.is_drawing
    assert panel.work.isVisible()
    wait_for(lambda: bool(written))
    assert written == [str(tmp_path / "film.gif")]
    with Image.open(written[0]) as film:
        assert (film.n_frames, film.size) == (3, (64, 48))
    assert not panel.work.isVisible()
    maker.written.disconnect(written.append)


def test_what_cannot_be_saved_is_told_in_the_dialog(
    window: MainWindow, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    panel = window.movie_panel
    say(panel, "turn 360 degrees in 1 s")
    told: list[BaseException] = []
    monkeypatch.setattr(
        "volviz_ui.dialogs.save_film.show_error", lambda _parent, _title, error: told.append(error)
    )
    dialog = window.movie_commands.save()
    dialog.format.setCurrentIndex(0)
    dialog.size.addItem("odd", (65, 48))
    dialog.size.setCurrentIndex(dialog.size.count() - 1)
    dialog.take(str(tmp_path / "film"))
    assert "even width" in str(told[0])
    assert dialog.path == ""
    dialog.reject()


def test_numbered_pictures_are_not_replaced_without_a_question(
    window: MainWindow, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    say(window.movie_panel, "turn 360 degrees in 1 s")
    (tmp_path / "movie0000.png").write_bytes(b"somebody's picture")
    asked: list[str] = []
    buttons = QMessageBox.StandardButton
    answers = iter([buttons.Cancel, buttons.No])

    def question(_parent: object, _title: str, words: str, *_buttons: object) -> QMessageBox.StandardButton:
        asked.append(words)
        return next(answers)

    monkeypatch.setattr(QMessageBox, "question", question)
    dialog = window.movie_commands.save()
    dialog.format.setCurrentIndex(dialog.format.count() - 1)
    dialog.accepted.disconnect()
    dialog.take(str(tmp_path / "movie%04d.png"))
    assert (len(asked), dialog.path) == (1, "")
    dialog.take(str(tmp_path / "other%04d.png"))
    assert (len(asked), dialog.overwrite) == (1, False)
    dialog = window.movie_commands.save()
    dialog.accepted.disconnect()
    dialog.format.setCurrentIndex(dialog.format.count() - 1)
    dialog.take(str(tmp_path / "movie%04d.png"))
    assert (len(asked), dialog.overwrite, dialog.resume) == (2, True, False)
