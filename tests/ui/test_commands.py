"""Commands of the menus: export, copy, script, keys, preferences, shortcuts, what is remembered."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QMessageBox, QProgressDialog, QPushButton, QTabBar

from tests.ui.conftest import drawn_image, foreground, image, is_complete
from volviz.annotations.shapes import Text
from volviz.cli import main
from volviz.custom_gl.scene_techniques import choose_technique, current_settings, drawing_techniques
from volviz.custom_gl.vtk.technique_runner import TechniqueRunner
from volviz.model.picture import PictureContents
from volviz.volume_data.budgets import budgets
from volviz_ui.app.main_window import MainWindow
from volviz_ui.commands.shortcuts import ShortcutsDialog
from volviz_ui.dialogs.export_image import ExportImageDialog
from volviz_ui.session.preferences import Preferences
from volviz_ui.session.script import script_of
from volviz_ui.style.theme import Theme
from volviz_ui.views.picture_parts import PictureRequest

Wait = Callable[..., None]

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")


@pytest.fixture
def window(same_window: MainWindow) -> MainWindow:
    """These tests are about what happens in a window that is there."""
    return same_window


def save(
    window: MainWindow, wait_for: Wait, path: Path, size: tuple[int, int], *, transparent: bool
) -> list[str]:
    """Export and wait for the end; what was saved."""
    saved: list[str] = []
    export = window.picture_commands.save_image(str(path), PictureRequest(size, transparent))
    assert export is not None
    export.saved.connect(saved.append)
    ended: list[bool] = []
    export.ended.connect(lambda: ended.append(True))
    wait_for(lambda: bool(ended))
    return saved


def test_an_exported_picture_has_the_size_and_shows_what_the_viewport_shows(
    window: MainWindow, wait_for: Wait, tmp_path: Path
) -> None:
    shown = image(window)
    height, width = shown.shape[:2]
    path = tmp_path / "out.png"
    assert save(window, wait_for, path, (width, height), transparent=False) == [str(path)]
    saved = np.asarray(Image.open(path), float)
    assert saved.shape == (height, width, 3)
    marker = np.zeros((height, width), bool)
    marker[int(0.75 * height) :, : int(0.2 * width)] = True
    difference = np.abs(saved - shown).max(axis=2)[~marker]
    assert np.percentile(difference, 99) <= 4


def test_an_exported_picture_holds_what_was_asked_for_and_all_views_if_wanted(
    window: MainWindow, wait_for: Wait, tmp_path: Path
) -> None:
    window.commands["view.slices.large"].trigger()
    wait_for(lambda: len(window.views.view_widgets) == 4 and is_complete(window))
    dialog = window.picture_commands.export_image()
    assert dialog is not None
    assert dialog.view.currentData() is None
    assert dialog.switches["marker"].isChecked() == window.annotations.is_shown("marker")
    dialog._print_at(85.0)
    assert dialog.image_size[0] == 1004
    dialog.switches["bar"].setChecked(True)
    dialog.title.setText("A ball")
    asked = dialog.request
    dialog.reject()
    assert (asked.dpi, asked.contents.title, asked.contents.bar) == (300.0, "A ball", True)
    size = (300, round(300 * asked.size[1] / asked.size[0]))
    found = []
    for number, contents in enumerate((PictureContents(), asked.contents)):
        path = tmp_path / f"{number}.png"
        export = window.picture_commands.save_image(str(path), replace(asked, size=size, contents=contents))
        assert export is not None
        wait_for(lambda export=export: export.is_over)
        with Image.open(path) as image:
            assert image.size == size
            found.append(np.asarray(image, float))
    assert np.abs(found[1] - found[0]).max() > 100
    window.commands["view.slices.large"].trigger()
    window.picture_commands.copy_methods()
    assert "voxels of" in QApplication.clipboard().text()


def test_a_transparent_picture_has_alpha_only_where_the_volume_is(
    window: MainWindow, wait_for: Wait, tmp_path: Path
) -> None:
    path = tmp_path / "cut_out.png"
    assert save(window, wait_for, path, (300, 200), transparent=True) == [str(path)]
    saved = np.asarray(Image.open(path))
    assert saved.shape == (200, 300, 4)
    assert saved[0, 0, 3] == 0
    assert saved[100, 150, 3] > 30


def test_an_export_can_be_cancelled_and_leaves_the_file_that_was_there(
    window: MainWindow, wait_for: Wait, tmp_path: Path
) -> None:
    path = tmp_path / "old.png"
    path.write_bytes(b"what was there")
    export = window.picture_commands.save_image(str(path), PictureRequest((6000, 6000)))
    assert export is not None
    told: list[float] = []
    export.progressed.connect(told.append)
    wait_for(lambda: len(told) > 2)
    assert told[-1] < 1.0
    (dialog,) = window.findChildren(QProgressDialog)
    wait_for(dialog.isVisible)
    (button,) = dialog.findChildren(QPushButton)
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    assert export.is_over
    assert path.read_bytes() == b"what was there"
    assert [p.name for p in tmp_path.iterdir() if p.suffix == ".png"] == ["old.png"]


def test_a_window_that_closes_gives_up_its_exports(
    bare_window: MainWindow, ball_file: str, wait_for: Wait, tmp_path: Path
) -> None:
    bare_window.open(ball_file)
    wait_for(lambda: is_complete(bare_window))
    export = bare_window.picture_commands.save_image(
        str(tmp_path / "a.png"), PictureRequest((3000, 3000), True)
    )
    assert export is not None
    told: list[float] = []
    export.progressed.connect(told.append)
    wait_for(lambda: bool(told))
    bare_window.close()
    assert export.is_over


def test_a_picture_that_cannot_be_saved_is_told_in_one_sentence(
    window: MainWindow, wait_for: Wait, tmp_path: Path
) -> None:
    assert save(window, wait_for, tmp_path / "no" / "folder.png", (40, 30), transparent=False) == []
    (box,) = [b for b in window.findChildren(QMessageBox) if b.isVisible()]
    assert "\n" not in box.text()
    box.close()


def test_the_picture_on_the_clipboard_is_the_viewport(window: MainWindow) -> None:
    window.commands["file.copy_picture"].trigger()
    image = QApplication.clipboard().image()
    assert (image.width(), image.height()) == window.viewport.pixel_size
    shown = window.viewport.grab().toImage().convertToFormat(QImage.Format.Format_RGB888)
    assert image.convertToFormat(QImage.Format.Format_RGB888) == shown


@pytest.fixture
def slow_drawing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every chunk of every technique takes a twelfth of a second longer."""
    draw = TechniqueRunner.draw

    def slow(self: TechniqueRunner, *arguments: Any) -> None:
        time.sleep(0.08)
        draw(self, *arguments)

    monkeypatch.setattr(TechniqueRunner, "draw", slow)


@pytest.mark.usefixtures("slow_drawing")
def test_copying_waits_for_a_slow_technique_and_the_window_goes_on(
    window: MainWindow, wait_for: Wait
) -> None:
    QApplication.clipboard().setText("before")
    window.technique_commands.refine(1)
    ticks: list[float] = []
    timer = QTimer()
    timer.setInterval(10)
    timer.timeout.connect(lambda: ticks.append(time.monotonic()))
    timer.start()
    copy = window.picture_commands.copy_image()
    told: list[float] = []
    copy.progressed.connect(told.append)
    assert not copy.is_over
    assert QApplication.clipboard().text() == "before"
    (dialog,) = window.findChildren(QProgressDialog)
    wait_for(dialog.isVisible)
    assert not copy.is_over
    wait_for(lambda: copy.is_over)
    timer.stop()
    assert window.controller.status.complete
    # a turn of the event loop after every chunk or two, as while the window completes an image by itself
    assert len(ticks) >= 4
    assert max(after - before for before, after in pairwise(ticks)) < 1.0
    assert told
    assert told == sorted(told)
    assert 0.0 < told[-1] <= 1.0
    shown = window.viewport.grab().toImage().convertToFormat(QImage.Format.Format_RGB888)
    assert QApplication.clipboard().image().convertToFormat(QImage.Format.Format_RGB888) == shown
    wait_for(lambda: not window.findChildren(QProgressDialog))


@pytest.mark.usefixtures("slow_drawing")
def test_copying_can_be_cancelled_and_the_clipboard_keeps_what_it_has(
    window: MainWindow, wait_for: Wait
) -> None:
    QApplication.clipboard().setText("before")
    window.technique_commands.refine(1)
    copy = window.picture_commands.copy_image()
    (dialog,) = window.findChildren(QProgressDialog)
    wait_for(dialog.isVisible)
    (button,) = dialog.findChildren(QPushButton)
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    assert copy.is_over
    wait_for(lambda: is_complete(window))
    QTest.qWait(100)
    assert QApplication.clipboard().text() == "before"


@pytest.mark.usefixtures("slow_drawing")
def test_a_window_that_closes_gives_up_copying(
    bare_window: MainWindow, ball_file: str, wait_for: Wait
) -> None:
    bare_window.open(ball_file)
    wait_for(lambda: is_complete(bare_window))
    bare_window.technique_commands.refine(1)
    copy = bare_window.picture_commands.copy_image()
    assert not copy.is_over
    bare_window.close()
    assert copy.is_over


def test_the_copied_script_draws_the_same_picture(window: MainWindow, tmp_path: Path) -> None:
    window.view_commands.show_axis_view("L")
    window.technique_commands.refine(1)
    window.data_panel.planes.add_plane((0.0, 1.0, 0.0))
    window.commands["file.copy_script"].trigger()
    script = QApplication.clipboard().text()
    assert script == script_of(window.store.scene, window.viewport.pixel_size)
    size = window.viewport.pixel_size
    expected = drawn_image(window.store.scene, window.documents.volume, size, transparent=True)
    out = tmp_path / "picture.npy"
    code = script + f"\nimport numpy\nnumpy.save({str(out)!r}, picture)\n"
    subprocess.run([sys.executable, "-c", code], check=True, timeout=120, cwd=tmp_path)
    drawn = np.load(out)
    with Image.open(tmp_path / "picture.png") as saved:
        np.testing.assert_array_equal(np.asarray(saved), drawn)
    assert drawn.shape == expected.shape
    assert np.abs(drawn.astype(int) - expected.astype(int)).max() <= 3


def test_keys_choose_techniques(window: MainWindow) -> None:
    for number, info in enumerate(drawing_techniques()[:9], start=1):
        QTest.keyClick(window, str(number))
        assert window.store.scene.view.technique == info.id


def test_plus_and_minus_change_the_sampling(window: MainWindow) -> None:
    window.viewport.setFocus()
    before = current_settings(window.store.scene).step
    QTest.keyClick(window.viewport, Qt.Key.Key_Plus)
    finer = current_settings(window.store.scene).step
    assert finer == pytest.approx(before / 1.25, rel=1e-3)
    QTest.keyClick(window.viewport, Qt.Key.Key_Minus)
    assert current_settings(window.store.scene).step == pytest.approx(before, rel=1e-3)


def test_w_shows_the_machinery_where_there_is_one(window: MainWindow, wait_for: Wait) -> None:
    for info in drawing_techniques():
        choose_technique(window.store, info.id)
        names = [p.name for p in info.parameters]
        if "wireframe" not in names and "display" not in names:
            continue
        before = current_settings(window.store.scene)
        QTest.keyClick(window, "w")
        assert current_settings(window.store.scene) != before
        QTest.keyClick(window, "w")
        assert current_settings(window.store.scene) == before


def test_the_page_of_shortcuts_names_every_key(window: MainWindow) -> None:
    QTest.keyClick(window, "?")
    (dialog,) = window.findChildren(ShortcutsDialog)
    words = " ".join(label.text() for label in dialog.findChildren(QLabel))
    for key in ("Ctrl+O", "Home", "F11", "Right drag", "W"):
        assert key in words
    dialog.reject()


def test_the_export_dialog_keeps_the_proportions(window: MainWindow) -> None:
    dialog = ExportImageDialog([(0, "")], lambda _view: (400, 300), PictureContents(), window)
    dialog.pixel_width.setValue(800)
    assert dialog.image_size == (800, 600)
    dialog.keep.setChecked(False)
    dialog.pixel_height.setValue(100)
    assert dialog.image_size == (800, 100)
    dialog.deleteLater()


def test_the_theme_can_be_switched_and_icons_follow(window: MainWindow, theme: Theme) -> None:
    dark = window.grab().toImage().pixelColor(5, 5).lightness()
    icon = window.commands["file.open"].icon().cacheKey()
    dialog = window.edit_commands.show_preferences()
    dialog.theme.setCurrentIndex(dialog.theme.findData("light"))
    QTest.qWait(50)
    light = window.grab().toImage().pixelColor(5, 5).lightness()
    assert light > dark + 100
    assert window.commands["file.open"].icon().cacheKey() != icon
    assert window.preferences.theme == "light"
    dialog.theme.setCurrentIndex(dialog.theme.findData("dark"))
    dialog.reject()


def test_the_memory_of_a_volume_is_limited_and_remembered(window: MainWindow) -> None:
    dialog = window.edit_commands.show_preferences()
    memory = dialog.budgets["memory"]
    memory.setCurrentIndex(memory.findData(2 << 30))
    assert (window.preferences.budget("memory"), budgets().memory) == (2 << 30, 2 << 30)
    memory.setCurrentIndex(0)
    assert (window.preferences.budget("memory"), budgets().memory) == (None, None)
    dialog.reject()


def test_the_quality_reaches_the_host_and_is_remembered(window: MainWindow) -> None:
    window.view_commands.set_quality("full")
    assert window.controller.handle.quality == "full"
    assert window.preferences.quality == "full"
    assert window.tools.quality.currentData() == "full"


def test_the_layout_is_remembered(qapp: QApplication, theme: Theme, preferences: Preferences) -> None:
    first = MainWindow(theme, preferences)
    first.resize(1000, 700)
    first.show()
    QTest.qWait(100)
    first.docks["data"].hide()
    first.close()
    second = MainWindow(theme, preferences)
    second.show()
    QTest.qWait(100)
    assert not second.docks["data"].isVisible()
    assert second.width() == 1000
    second.docks.reset()
    assert second.docks["data"].isVisible()
    second.docks["compare"].show()
    second.close()
    third = MainWindow(theme, preferences)
    third.show()
    QTest.qWait(100)
    menu = third.menuBar().geometry()
    assert not any(bar.isVisible() and bar.geometry().intersects(menu) for bar in third.findChildren(QTabBar))
    third.close()
    second.close()
    for window in (first, second, third):
        window.deleteLater()
    del first, second, third, window


def test_no_panel_has_two_tabs_after_reset_and_a_second_start(
    qapp: QApplication, theme: Theme, preferences: Preferences
) -> None:
    def tabs(window: MainWindow) -> list[str]:
        bars = [bar for bar in window.findChildren(QTabBar) if bar.isVisible() and bar.x() >= 0]
        return sorted(bar.tabText(i) for bar in bars for i in range(bar.count()))

    for floating in (False, True, False):
        window = MainWindow(theme, preferences)
        window.show()
        for name in ("compare", "crosscheck"):
            window.docks[name].setFloating(floating)
            window.docks.show(name)
        QTest.qWait(50)
        opened = [] if floating else ["Compare", "Cross-check", "Data", "Transfer function"]
        assert tabs(window) == opened
        window.docks.reset()
        QTest.qWait(50)
        assert tabs(window) == []
        assert [name for name in window.docks.names if window.docks[name].isVisible()] == [
            "data", "technique", "transfer",
        ]  # fmt: skip
        window.docks.show("compare")
        QTest.qWait(50)
        assert tabs(window) == ["Compare", "Data"]
        window.close()
        window.deleteLater()
        del window


def test_two_views_of_four_are_two(window: MainWindow) -> None:
    window.commands["compare.four_views"].trigger()
    window.commands["compare.split"].trigger()
    assert len(window.store.scene.views) == 2
    window.commands["compare.split"].trigger()
    assert len(window.store.scene.views) == 1


def test_full_screen_and_back_by_escape(window: MainWindow) -> None:
    window.commands["view.full_screen"].trigger()
    assert window.isFullScreen()
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert not window.isFullScreen()
    assert not window.commands["view.full_screen"].isChecked()


def test_the_background_is_a_step_of_the_history(window: MainWindow, wait_for: Wait) -> None:
    window.view_commands.set_background((1.0, 1.0, 1.0))
    wait_for(lambda: is_complete(window))
    assert image(window)[3, 3].min() == 255
    window.commands["edit.undo"].trigger()
    QTest.qWait(50)
    assert image(window)[3, 3].max() < 120
    assert foreground(window).mean() > 0.02


def test_an_exported_picture_restores_the_scene_and_is_drawn_again_to_the_bit(
    window: MainWindow, wait_for: Wait, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    window.store.update(lambda scene: scene.with_layer(opacity=0.6), label="fainter")
    before = window.store.scene
    path = tmp_path / "kept.png"
    contents = PictureContents.of("box,bar,scale", "A ball")
    export = window.picture_commands.save_image(str(path), PictureRequest((200, 150), contents=contents))
    assert export is not None
    wait_for(lambda: export.is_over)
    window.store.undo()
    window.store.clear_history()
    window.file_commands.open_dropped([str(path)])
    wait_for(lambda: window.store.scene == before)
    # saving goes into a session file, not into the picture
    assert window.session_commands.unsaved.path is None
    assert main(["reproduce", str(path), "-o", str(tmp_path / "again.png")]) == 0
    assert "equal to kept.png to the bit" in capsys.readouterr().out


def test_a_presentation_shows_the_picture_alone_and_escape_brings_the_panels_back(
    window: MainWindow, wait_for: Wait
) -> None:
    window.view_commands.show_annotations("bar", True)
    before = [dock.isVisible() for dock in window.docks.all]
    size = max(shape.size for shape in window.annotations.overlay.shapes if isinstance(shape, Text))
    QTest.keyClick(window, Qt.Key.Key_F5)
    wait_for(window.isFullScreen)
    assert not any(dock.isVisible() for dock in window.docks.all)
    assert not window.menuBar().isVisible()
    assert max(s.size for s in window.annotations.overlay.shapes if isinstance(s, Text)) > 1.5 * size
    QTest.keyClick(window, Qt.Key.Key_Escape)
    wait_for(lambda: not window.isFullScreen())
    assert [dock.isVisible() for dock in window.docks.all] == before
    assert window.menuBar().isVisible()
    window.view_commands.show_annotations("bar", False)
