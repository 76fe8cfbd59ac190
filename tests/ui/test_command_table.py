"""The table of commands, and what is made of it: menus, keys, page of shortcuts, palette."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QAction
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QMenu

from tests.ui.conftest import is_complete
from volviz.custom_gl.scene_techniques import drawing_techniques
from volviz.io.samples import samples
from volviz.model.scene import Scene
from volviz.model.transfer.presets import presets
from volviz_ui.app.main_window import MainWindow
from volviz_ui.commands.command import Command, State
from volviz_ui.commands.palette import ENTRY, CommandPalette
from volviz_ui.commands.shortcuts import ShortcutsDialog
from volviz_ui.style.theme import Theme

Wait = Callable[..., None]
BOTH = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier


def commands_of(window: MainWindow) -> dict[str, Command]:
    return {command.id: command for _path, command in window.commands.walk()}


def open_palette(window: MainWindow) -> CommandPalette:
    """By its keys; the one that is open."""
    QTest.keyClick(window, Qt.Key.Key_P, BOTH)
    (palette,) = [each for each in window.findChildren(CommandPalette) if each.isVisible()]
    return palette


def shown_ids(palette: CommandPalette) -> list[str]:
    rows = range(palette.model.rowCount())
    return [palette.model.index(row).data(ENTRY).command.id for row in rows]


def actions_below(menu: QMenu) -> set[QAction]:
    found: set[QAction] = set()
    for action in menu.actions():
        below = action.menu()
        found |= {action} if below is None else actions_below(below)
    return found


# ---------------------------------------------------------------------- the table


def test_every_command_has_text_and_tip_and_ids_are_unique(bare_window: MainWindow) -> None:
    every = [command for menu in bare_window.commands.menus for _path, command in menu.walk()]
    state = bare_window.commands.state
    for command in every:
        assert command.words(state).strip("&… ")
        assert command.tip.strip()
    # a command may stand in two menus, but two commands never share an id
    for command in every:
        twins = [other for other in every if other.id == command.id]
        assert {other.words(state) for other in twins} == {command.words(state)}
    assert len({command.id for command in every}) > 60


def test_no_two_commands_share_a_key(bare_window: MainWindow) -> None:
    owners: dict[str, str] = {}
    for ident, command in commands_of(bare_window).items():
        for sequence in command.sequences():
            key = sequence.toString()
            assert key not in owners, f"{key}: {owners.get(key)} and {ident}"
            owners[key] = ident
    assert owners["Ctrl+Shift+P"] == "help.palette"


def test_every_action_stands_in_a_menu_and_says_its_key(bare_window: MainWindow) -> None:
    reachable: set[QAction] = set()
    for action in bare_window.menuBar().actions():
        reachable |= actions_below(action.menu())
    for ident, command in commands_of(bare_window).items():
        if ident.startswith(("preset.", "file.sample.", "file.recent.")):
            continue
        action = bare_window.commands[ident]
        assert action in reachable
        for sequence in command.sequences()[:1]:
            assert sequence.toString(sequence.SequenceFormat.NativeText) in action.toolTip()


def test_the_palette_lists_every_command_technique_sample_preset_and_panel(bare_window: MainWindow) -> None:
    palette = open_palette(bare_window)
    shown = set(shown_ids(palette))
    assert shown == set(commands_of(bare_window))
    assert {f"technique.use.{info.id}" for info in drawing_techniques()} <= shown
    assert {f"file.sample.{sample.id}" for sample in samples()} <= shown
    assert {f"preset.{name}" for name in presets()} <= shown
    assert {f"panel.{name}" for name in bare_window.docks.names} <= shown
    palette.close()


def test_the_page_of_shortcuts_lists_every_command_with_keys(bare_window: MainWindow) -> None:
    QTest.keyClick(bare_window, Qt.Key.Key_F1)
    (dialog,) = bare_window.findChildren(ShortcutsDialog)
    words = {label.text() for label in dialog.findChildren(QLabel)}
    state = bare_window.commands.state
    for command in commands_of(bare_window).values():
        if command.sequences():
            assert command.words(state).replace("&", "") in words
    dialog.reject()


# ---------------------------------------------------------------------- what can be run


def test_enabled_and_checked_follow_the_scene(window: MainWindow) -> None:
    commands = window.commands
    assert not commands["edit.undo"].isEnabled()
    assert not commands["compare.swap"].isEnabled()
    commands["compare.split"].trigger()
    assert commands["compare.swap"].isEnabled()
    assert commands["compare.split"].isChecked()
    assert "views" in commands["edit.undo"].text()
    commands["edit.undo"].trigger()
    assert not commands["compare.swap"].isEnabled()
    assert not commands["compare.split"].isChecked()
    for info in drawing_techniques()[:3]:
        commands[f"technique.use.{info.id}"].trigger()
        on = [other.id for other in drawing_techniques() if commands[f"technique.use.{other.id}"].isChecked()]
        assert on == [info.id]


def test_nothing_that_needs_a_volume_can_be_run_without_one(bare_window: MainWindow) -> None:
    state = State(Scene())
    for ident in ("file.export_picture", "file.copy_picture", "file.save_session", "view.reset_camera"):
        assert not commands_of(bare_window)[ident].enabled(state)
        assert not bare_window.commands[ident].isEnabled()
    assert commands_of(bare_window)["file.export_picture"].enabled(State(Scene(), has_volume=True))


def test_a_command_that_cannot_run_does_nothing(bare_window: MainWindow) -> None:
    ran: list[str] = []
    command = Command(
        "test.never", "Never", "Never runs", lambda: ran.append("never"), enabled=lambda _state: False
    )
    assert not bare_window.commands.run(command)
    assert ran == []


def test_a_switch_is_told_whether_it_is_to_be_on(bare_window: MainWindow) -> None:
    command = commands_of(bare_window)["view.box"]
    assert bare_window.commands.run(command)
    assert bare_window.commands["view.box"].isChecked()
    assert bare_window.annotations.is_shown("box")
    assert bare_window.commands.run(command)
    assert not bare_window.annotations.is_shown("box")


def test_a_panel_behind_another_one_comes_to_the_front_before_it_is_closed(bare_window: MainWindow) -> None:
    dock, action = bare_window.docks["compare"], bare_window.commands["panel.compare"]
    action.trigger()
    QTest.qWait(20)
    assert dock.is_in_front
    bare_window.docks.show("data")
    QTest.qWait(20)
    assert dock.is_open
    assert not dock.is_in_front
    action.trigger()
    QTest.qWait(20)
    assert dock.is_in_front
    assert action.isChecked()
    action.trigger()
    assert not dock.is_open
    assert not action.isChecked()


# ---------------------------------------------------------------------- the palette


def test_typing_filters_enter_runs_and_it_is_remembered(window: MainWindow, wait_for: Wait) -> None:
    palette = open_palette(window)
    QTest.keyClicks(palette.line, "iso")
    assert shown_ids(palette)[0] == "technique.use.isosurface"
    assert 0 < palette.model.rowCount() < len(commands_of(window))
    QTest.keyClick(palette.line, Qt.Key.Key_Return)
    assert window.store.scene.view.technique == "isosurface"
    wait_for(lambda: not window.findChildren(CommandPalette))
    again = open_palette(window)
    assert shown_ids(again)[0] == "technique.use.isosurface"
    again.close()
    assert window.preferences.used_commands[0] == "technique.use.isosurface"
    wait_for(lambda: is_complete(window))


def test_arrows_move_and_escape_closes_without_running(bare_window: MainWindow) -> None:
    palette = open_palette(bare_window)
    before = bare_window.store.scene
    for key, row in (
        (Qt.Key.Key_Down, 1),
        (Qt.Key.Key_Down, 2),
        (Qt.Key.Key_Up, 1),
        (Qt.Key.Key_PageDown, 13),
        (Qt.Key.Key_PageUp, 1),
        (Qt.Key.Key_Up, 0),
        (Qt.Key.Key_Up, palette.model.rowCount() - 1),
    ):
        QTest.keyClick(palette.line, key)
        assert palette.list.currentIndex().row() == row
    QTest.keyClick(palette.line, Qt.Key.Key_Escape)
    assert not palette.isVisible()
    assert bare_window.store.scene == before
    assert bare_window.preferences.used_commands == []


def test_a_command_that_cannot_run_stays_in_the_palette(bare_window: MainWindow) -> None:
    palette = open_palette(bare_window)
    QTest.keyClicks(palette.line, "export picture")
    assert shown_ids(palette)[0] == "file.export_picture"
    assert "Not possible now" in palette.tip.text()
    QTest.keyClick(palette.line, Qt.Key.Key_Return)
    assert palette.isVisible()
    assert bare_window.preferences.used_commands == []
    palette.close()


def test_a_sample_and_a_preset_are_run_by_a_click_and_by_enter(
    bare_window: MainWindow, wait_for: Wait
) -> None:
    palette = open_palette(bare_window)
    QTest.keyClicks(palette.line, "torus")
    assert shown_ids(palette)[0] == "file.sample.torus"
    place: QPoint = palette.list.visualRect(palette.model.index(0)).center()
    QTest.mouseClick(palette.list.viewport(), Qt.MouseButton.LeftButton, pos=place)
    wait_for(lambda: bare_window.documents.volume is not None)
    wait_for(lambda: is_complete(bare_window))
    name, preset = next(iter(presets().items()))
    palette = open_palette(bare_window)
    QTest.keyClicks(palette.line, f"{preset.label} preset")
    assert shown_ids(palette)[0] == f"preset.{name}"
    QTest.keyClick(palette.line, Qt.Key.Key_Return)
    assert preset.label in (bare_window.store.undo_label or "")
    wait_for(lambda: is_complete(bare_window))


def test_what_nothing_is_called_runs_nothing(bare_window: MainWindow) -> None:
    palette = open_palette(bare_window)
    QTest.keyClicks(palette.line, "zzqq")
    assert palette.model.rowCount() == 0
    QTest.keyClick(palette.line, Qt.Key.Key_Return)
    assert palette.isVisible()
    palette.close()


@pytest.mark.parametrize("size", [(900, 600), (1100, 760)])
def test_the_palette_fits_into_the_window_and_has_names_for_screen_readers(
    bare_window: MainWindow, size: tuple[int, int], theme: Theme
) -> None:
    bare_window.resize(*size)
    QApplication.processEvents()
    palette = open_palette(bare_window)
    frame = bare_window.frameGeometry()
    assert frame.contains(palette.geometry())
    for widget in (palette, palette.line, palette.list, palette.tip):
        assert widget.accessibleName()
    spoken = palette.model.index(0).data(Qt.ItemDataRole.AccessibleTextRole)
    assert "File" in spoken
    palette.close()
