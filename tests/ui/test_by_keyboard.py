"""What keys move, and fields that follow: the view, ranges, automatic values, numbers of nothing."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel

from volviz.annotations.shapes import Text
from volviz.custom_gl.registry import techniques
from volviz.custom_gl.scene_techniques import current_settings
from volviz_ui.app.main_window import MainWindow
from volviz_ui.commands.shortcuts import ShortcutsDialog
from volviz_ui.editors.optional import OptionalEditor
from volviz_ui.views.viewport import ARROW_TURN

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")


def test_arrows_turn_the_view_and_move_it_with_shift(same_window: MainWindow) -> None:
    before = same_window.viewport.view_camera
    QTest.keyClick(same_window.viewport, Qt.Key.Key_Left)
    turned = same_window.viewport.view_camera
    angle = np.degrees(np.arccos(np.dot(before.direction, turned.direction)))
    assert angle == pytest.approx(ARROW_TURN, rel=0.05)
    assert turned.focal_point == pytest.approx(before.focal_point)
    QTest.keyClick(same_window.viewport, Qt.Key.Key_Up, Qt.KeyboardModifier.ShiftModifier)
    panned = same_window.viewport.view_camera
    assert panned.direction == pytest.approx(turned.direction)
    assert panned.focal_point[2] < turned.focal_point[2]


def test_arrows_move_the_ends_of_a_crop_range(same_window: MainWindow) -> None:
    slider = same_window.data_panel.crop.sliders[0]
    QTest.keyClick(slider, Qt.Key.Key_Right)
    QTest.keyClick(slider, Qt.Key.Key_Left, Qt.KeyboardModifier.ShiftModifier)
    assert same_window.store.scene.clipping.crop[:2] == (1.0, 30.0)


def test_moving_an_automatic_value_takes_it_over(same_window: MainWindow) -> None:
    editors = same_window.technique_panel.form.editors
    name, editor = next(
        (name, e) for name, e in editors.items() if isinstance(e, OptionalEditor) and e.check.isChecked()
    )
    assert editor.inner.isEnabled()
    wanted = editor._last
    editor.inner.value_changed.emit(wanted)
    assert not editor.check.isChecked()
    assert getattr(current_settings(same_window.store.scene), name) == wanted


def test_fields_of_nothing_are_empty(same_window: MainWindow) -> None:
    editor = same_window.transfer_editor
    editor.model.select({0})
    assert editor.fields.value.text()
    assert editor.fields.opacity.text()
    editor.model.select(())
    assert (editor.fields.value.text(), editor.fields.opacity.text()) == ("", "")
    editor.model.select({0})
    assert editor.fields.value.text()


def test_all_techniques_are_in_the_menu(same_window: MainWindow) -> None:
    listed = {command.id.removeprefix("technique.use.") for _path, command in same_window.commands.walk()}
    assert listed >= set(techniques())


def test_the_page_of_shortcuts_does_not_tell_the_last_change(same_window: MainWindow) -> None:
    same_window.view_commands.set_background((0.0, 0.0, 0.0))
    dialog = same_window.help_commands.show_shortcuts()
    assert isinstance(dialog, ShortcutsDialog)
    words = [label.text() for label in dialog.findChildren(QLabel)]
    assert "Undo" in words
    assert not any("Background" in word for word in words)
    dialog.reject()


def test_a_colour_bar_has_round_numbers(same_window: MainWindow) -> None:
    same_window.view_commands.show_annotations("bar", True)
    words = [shape.words for shape in same_window.annotations.overlay.shapes if isinstance(shape, Text)]
    numbers = [word for word in words if word.lstrip("-").isdigit()]
    assert numbers
    assert {int(number) % 50 for number in numbers} == {0}
    same_window.view_commands.show_annotations("bar", False)
