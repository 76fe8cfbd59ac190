"""The editor by keyboard alone."""

from __future__ import annotations

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QAbstractButton, QAbstractSlider, QAbstractSpinBox, QWidget

from volviz.model.scene import Scene

Key = Qt.Key
CTRL, SHIFT, ALT = (
    Qt.KeyboardModifier.ControlModifier,
    Qt.KeyboardModifier.ShiftModifier,
    Qt.KeyboardModifier.AltModifier,
)


def points(store):
    return store.scene.layer.transfer_function.points


def test_points_are_chosen_one_after_the_other(editor, qtbot) -> None:
    plot = editor.plot
    qtbot.keyClick(plot, Key.Key_PageDown)
    assert editor.model.selection == {0}
    qtbot.keyClick(plot, Key.Key_PageDown)
    qtbot.keyClick(plot, Key.Key_PageDown, CTRL)
    assert editor.model.selection == {1, 2}
    qtbot.keyClick(plot, Key.Key_PageUp)
    assert editor.model.selection == {0}
    assert "1" in plot.accessibleDescription()


def test_choose_all_and_choose_nothing(editor, qtbot) -> None:
    qtbot.keyClick(editor.plot, Key.Key_A, CTRL)
    assert editor.model.selection == {0, 1, 2, 3}
    qtbot.keyClick(editor.plot, Key.Key_Escape)
    assert editor.model.selection == frozenset()
    qtbot.keyClick(editor.plot, Key.Key_A, CTRL)
    qtbot.keyClick(editor.plot, Key.Key_A, CTRL | SHIFT)
    assert editor.model.selection == frozenset()


def test_arrows_nudge_and_shift_takes_longer_steps(editor, store, qtbot) -> None:
    editor.model.select({1})
    qtbot.keyClick(editor.plot, Key.Key_Right)
    short = points(store)[1].value
    assert short > 0
    qtbot.keyClick(editor.plot, Key.Key_Right, SHIFT)
    assert points(store)[1].value - short == pytest.approx(10 * short, rel=0.01)
    qtbot.keyClick(editor.plot, Key.Key_Up)
    assert points(store)[1].opacity > 0.1
    for _ in range(4):
        store.undo()
    assert points(store)[1].value == 0


def test_arrow_keys_work_on_the_fine_and_logarithmic_axes(editor, store, qtbot) -> None:
    editor.plot.set_fine_opacity(True)
    editor.plot.set_log_values(True)
    editor.model.select({0})
    qtbot.keyClick(editor.plot, Key.Key_Up)
    assert 0 < points(store)[0].opacity < 0.001
    before = points(store)[0].value
    qtbot.keyClick(editor.plot, Key.Key_Left)
    assert points(store)[0].value < before


def test_insert_duplicate_and_delete(editor, store, qtbot) -> None:
    editor.model.select({1})
    qtbot.keyClick(editor.plot, Key.Key_Insert)
    assert [p.value for p in points(store)] == [-500, 0, 200, 400, 1000]
    assert editor.model.selection == {2}
    qtbot.keyClick(editor.plot, Key.Key_D, CTRL)
    assert len(points(store)) == 6
    assert editor.model.selection == {3}
    qtbot.keyClick(editor.plot, Key.Key_Delete)
    assert [p.value for p in points(store)] == [-500, 0, 200, 400, 1000]
    qtbot.keyClick(editor.plot, Key.Key_A, CTRL)
    qtbot.keyClick(editor.plot, Key.Key_Delete)
    assert len(points(store)) == 1


def test_brackets_shift_and_braces_stretch(editor, store, qtbot) -> None:
    qtbot.keyClick(editor.plot, Key.Key_BracketRight)
    shifted = [p.value for p in points(store)]
    assert shifted[0] > -500
    assert shifted[3] - shifted[0] == pytest.approx(1500)
    qtbot.keyClick(editor.plot, Key.Key_BraceRight)
    wider = [p.value for p in points(store)]
    assert wider[3] - wider[0] == pytest.approx(1575)


def test_the_value_axis_is_zoomed_panned_and_fitted(editor, qtbot) -> None:
    plot = editor.plot
    whole = plot.axis
    qtbot.keyClick(plot, Key.Key_Plus)
    assert plot.axis.high - plot.axis.low < whole.high - whole.low
    left = plot.axis.low
    qtbot.keyClick(plot, Key.Key_Right, ALT)
    assert plot.axis.low > left
    qtbot.keyClick(plot, Key.Key_End)
    assert plot.places.outside(editor.model.function) == ([], [])
    qtbot.keyClick(plot, Key.Key_Home)
    assert plot.axis.low <= plot.axis.data_low
    assert plot.axis.high >= plot.axis.data_high


def test_a_moved_point_stays_in_view(editor, qtbot) -> None:
    plot = editor.plot
    plot.set_axis(plot.axis.showing(-100, 100))
    editor.model.select({1})
    for _ in range(12):
        qtbot.keyClick(plot, Key.Key_Right, SHIFT)
    assert plot.places.is_visible(editor.model.function.points[1].value)


def test_enter_leads_to_the_number_fields(editor, store, qtbot) -> None:
    editor.model.select({1})
    qtbot.keyClick(editor.plot, Key.Key_Return)
    assert editor.focusWidget() is editor.fields.value
    qtbot.keyClicks(editor.fields.value, "123")
    qtbot.keyClick(editor.fields.value, Key.Key_Return)
    assert points(store)[1].value == 123
    qtbot.keyClick(editor.fields.value, Key.Key_Tab)
    assert editor.focusWidget() is editor.fields.opacity
    editor.fields.opacity.selectAll()
    qtbot.keyClicks(editor.fields.opacity, "0.25")
    qtbot.keyClick(editor.fields.opacity, Key.Key_Return)
    assert points(store)[1].opacity == 0.25


def test_the_plots_keys_come_before_shortcuts_of_the_window(editor, qtbot) -> None:
    taken: list[str] = []
    action = QAction(editor)
    action.setShortcut("+")
    action.triggered.connect(lambda: taken.append("+"))
    editor.addAction(action)
    before = editor.plot.axis
    qtbot.keyClick(editor.plot, Key.Key_Plus)
    assert taken == []
    assert editor.plot.axis != before


def test_every_control_has_a_tooltip_a_name_and_a_place_in_the_tab_order(editor) -> None:
    for control in editor.findChildren(QWidget):
        is_control = isinstance(control, (QAbstractButton, QAbstractSlider, QAbstractSpinBox))
        if not is_control or not control.isVisible() or control.parent().inherits("QAbstractScrollArea"):
            continue
        assert control.toolTip(), control
        assert control.accessibleName(), control
        assert control.focusPolicy() & Qt.FocusPolicy.TabFocus, control


def test_the_page_of_keys_opens_from_the_menu_and_closes_by_escape(editor, qtbot) -> None:
    from volviz_ui.transfer_editor.help_dialog import HelpDialog

    menu = editor.more_button.menu()
    next(a for a in menu.actions() if a.text().startswith("Keys")).trigger()
    dialog = editor.findChild(HelpDialog)
    assert dialog.isVisible()
    qtbot.keyClick(dialog, Key.Key_Escape)
    qtbot.waitUntil(lambda: editor.findChild(HelpDialog) is None)


def test_without_a_volume_nothing_can_be_edited_and_nothing_breaks(editor, store, qtbot) -> None:
    store.update(Scene())
    assert editor.model.function is None
    for key in (Key.Key_PageDown, Key.Key_Delete, Key.Key_Right, Key.Key_Insert, Key.Key_Escape):
        qtbot.keyClick(editor.plot, key)
    qtbot.mouseDClick(editor.plot, Qt.MouseButton.LeftButton)
    assert not editor.grab().isNull()
    assert not editor.auto_button.isEnabled()


def test_colours_of_the_ramp_are_chosen_moved_added_and_removed(editor, store, qtbot) -> None:
    plot, model = editor.plot, editor.model
    count = len(model.channels[0])
    qtbot.keyClick(plot, Qt.Key.Key_Period)
    qtbot.keyClick(plot, Qt.Key.Key_Period)
    assert model.color_point == 1
    assert plot.accessibleDescription().startswith(f"Colour 2 of {count}")
    before, opacities = model.channels[0][1].value, model.channels[1]
    qtbot.keyClick(plot, Qt.Key.Key_Right)
    assert model.channels[0][1].value > before
    assert model.channels[1] == opacities
    qtbot.keyClick(plot, Qt.Key.Key_Insert, Qt.KeyboardModifier.ShiftModifier)
    assert len(model.channels[0]) == count + 1
    assert model.color_point == 2
    qtbot.keyClick(plot, Qt.Key.Key_Delete)
    assert len(model.channels[0]) == count
    qtbot.keyClick(plot, Qt.Key.Key_Comma)
    assert model.color_point == count - 1
    qtbot.keyClick(plot, Qt.Key.Key_Escape)
    assert model.color_point is None


def test_isovalues_are_chosen_and_moved(editor, store, qtbot) -> None:
    editor.set_isovalues((100.0, 600.0))
    moved, told = [], []
    editor.isovalue_moved.connect(lambda index, value: moved.append((index, value)))
    store.interaction_changed.connect(told.append)
    qtbot.keyClick(editor.plot, Qt.Key.Key_I)
    qtbot.keyClick(editor.plot, Qt.Key.Key_I)
    qtbot.keyClick(editor.plot, Qt.Key.Key_Left)
    assert moved[0][0] == 1
    assert moved[0][1] < 600.0
    assert told == [True, False]
    assert editor.plot.accessibleDescription().startswith("Isovalue 2 of 2")
    # after the last one none is chosen, and the arrows belong to the points again
    qtbot.keyClick(editor.plot, Qt.Key.Key_I)
    qtbot.keyClick(editor.plot, Qt.Key.Key_Right)
    assert len(moved) == 1
    assert editor.model.selection == {0}


def test_a_key_held_down_is_one_step_and_escape_takes_it_back(editor, store, qtbot) -> None:
    start = points(store)
    qtbot.keyClick(editor.plot, Qt.Key.Key_PageDown)
    qtbot.keyClick(editor.plot, Qt.Key.Key_PageDown)

    def hold(presses: int) -> None:
        for _ in range(presses):
            qtbot.keyPress(editor.plot, Qt.Key.Key_Up)

    hold(5)
    assert editor.model.in_gesture
    qtbot.keyRelease(editor.plot, Qt.Key.Key_Up)
    moved = points(store)
    assert moved != start
    store.undo()
    assert points(store) == start
    store.redo()
    hold(3)
    assert points(store) != moved
    qtbot.keyClick(editor.plot, Qt.Key.Key_Escape)
    qtbot.keyRelease(editor.plot, Qt.Key.Key_Up)
    assert points(store) == moved
    assert not editor.model.in_gesture


def test_arrow_keys_lead_from_the_bundled_presets_to_ones_own_and_back(editor, qtbot) -> None:
    editor.commands.save_as("Mine")
    editor.show_presets()
    assert editor.popup.list.hasFocus()
    qtbot.keyClick(editor.popup.list, Qt.Key.Key_Up)
    assert editor.popup.own_list.hasFocus()
    assert editor.popup.own_list.currentItem().text() == "Mine"
    qtbot.keyClick(editor.popup.own_list, Qt.Key.Key_Down)
    assert editor.popup.list.hasFocus()
    editor.popup.close()
