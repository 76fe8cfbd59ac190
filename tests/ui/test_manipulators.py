"""Knobs in the viewport, under a real mouse: one step of the history, and the camera's drags stay the camera's."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from tests.ui.conftest import drag, image, is_complete
from volviz.custom_gl.scene_techniques import choose_technique, current_settings
from volviz_ui.app.main_window import MainWindow

Wait = Callable[..., None]

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")


@pytest.fixture
def window(same_window: MainWindow) -> MainWindow:
    """These tests are about what happens in a window that is there."""
    return same_window


def show(window: MainWindow, technique: str, wait_for: Wait) -> None:
    choose_technique(window.store, technique)
    wait_for(lambda: is_complete(window))
    window.store.clear_history()


def place_of(window: MainWindow, grip: str) -> QPoint:
    """The pixel in the middle of a manipulator, at which it can be held."""
    x, y = (round(v) for v in window.viewport.manipulators.place(grip))
    assert window.viewport.manipulators.part_at(x, y) == grip
    return QPoint(x, y)


def drag_on(window: MainWindow, to: QPoint) -> None:
    """The pointer goes on with the button held."""
    event = QMouseEvent(
        QEvent.Type.MouseMove,
        QPointF(to),
        QPointF(window.viewport.mapToGlobal(to)),
        Qt.MouseButton.NoButton,
        Qt.MouseButton.LeftButton,
        Qt.KeyboardModifier.NoModifier,
    )
    QApplication.sendEvent(window.viewport, event)


def test_the_knob_of_the_light_moves_it_as_one_step(window: MainWindow, wait_for: Wait) -> None:
    show(window, "bump_mapping", wait_for)
    before, camera = window.store.scene.light, window.viewport.view_camera
    at = place_of(window, "light")
    drag(window.viewport, at, at + QPoint(70, 60))
    after = window.store.scene.light
    assert after.position is not None
    assert after.position != before.position
    assert window.viewport.view_camera == camera
    assert window.viewport.manipulators.part_at(at.x() + 70, at.y() + 60) == "light"
    assert window.store.undo_label == "Move the light"
    window.commands["edit.undo"].trigger()
    assert window.store.scene.light == before
    assert window.store.undo_label is None
    # the manipulator follows
    assert window.viewport.manipulators.part_at(at.x(), at.y()) == "light"


def test_the_cut_plane_is_tilted_and_pushed_by_its_knobs(window: MainWindow, wait_for: Wait) -> None:
    show(window, "bump_mapping", wait_for)
    window.controller.show_camera(window.viewport.view_camera.turned(50, 10))
    wait_for(lambda: is_complete(window))
    before = current_settings(window.store.scene)
    at = place_of(window, "normal")
    drag(window.viewport, at, at + QPoint(15, -40))
    tilted = current_settings(window.store.scene)
    assert tilted.plane_normal is not None
    assert window.store.undo_label == "Move the cut plane"
    at = place_of(window, "plane")
    drag(window.viewport, at, at + QPoint(40, 10))
    pushed = current_settings(window.store.scene)
    assert pushed.plane_normal == tilted.plane_normal
    assert pushed.plane_origin != tilted.plane_origin
    assert window.technique_panel.form is not None
    window.commands["edit.undo"].trigger()
    assert current_settings(window.store.scene) == tilted
    window.commands["edit.undo"].trigger()
    assert current_settings(window.store.scene) == before


def test_escape_takes_the_drag_of_a_knob_back(window: MainWindow, wait_for: Wait) -> None:
    show(window, "bump_mapping", wait_for)
    before = window.store.scene.light
    at = place_of(window, "light")
    QTest.mousePress(window.viewport, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, at)
    drag_on(window, at + QPoint(50, 30))
    assert window.store.scene.light != before
    QTest.keyClick(window.viewport, Qt.Key.Key_Escape)
    assert window.store.scene.light == before
    assert window.store.undo_label is None
    QTest.mouseRelease(window.viewport, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, at)
    assert not window.viewport.is_moving


def test_beside_the_knobs_a_drag_turns_the_volume(window: MainWindow, wait_for: Wait) -> None:
    show(window, "bump_mapping", wait_for)
    scene, camera = window.store.scene, window.viewport.view_camera
    start = window.viewport.rect().center() + QPoint(60, 60)
    assert window.viewport.manipulators.part_at(start.x(), start.y()) is None
    drag(window.viewport, start, start + QPoint(40, 0))
    assert window.viewport.view_camera != camera
    assert window.store.scene.light == scene.light


def test_the_pointer_says_what_can_be_dragged(window: MainWindow, wait_for: Wait) -> None:
    show(window, "bump_mapping", wait_for)
    QTest.mouseMove(window.viewport, place_of(window, "light"))
    wait_for(lambda: window.viewport.cursor().shape() == Qt.CursorShape.OpenHandCursor)
    assert "light" in window.viewport.toolTip()
    QTest.mouseMove(window.viewport, window.viewport.rect().center() + QPoint(60, 60))
    wait_for(lambda: window.viewport.cursor().shape() == Qt.CursorShape.ArrowCursor)
    assert window.viewport.toolTip() == ""


def test_handles_are_switched_off_for_good_and_are_not_in_copied_pictures(
    window: MainWindow, wait_for: Wait
) -> None:
    show(window, "bump_mapping", wait_for)
    with_manipulator = image(window)
    window.commands["file.copy_picture"].trigger()
    copied = QApplication.clipboard().image()
    window.commands["view.handles"].trigger()
    wait_for(lambda: is_complete(window))
    without = image(window)
    assert window.viewport.manipulators is None
    assert 50 < (np.abs(with_manipulator - without).max(axis=2) > 30).sum() < 9000
    assert not window.preferences.shows("handles", True)
    x, y = np.argwhere(np.abs(with_manipulator - without).max(axis=2) > 100)[0][::-1]
    color = copied.pixelColor(int(x), int(y))
    assert (color.red(), color.green(), color.blue()) == pytest.approx(tuple(without[y, x]), abs=2)
    window.commands["view.handles"].trigger()
    assert window.viewport.manipulators is not None


def test_techniques_without_handles_show_none(window: MainWindow, wait_for: Wait) -> None:
    show(window, "bump_mapping", wait_for)
    assert window.viewport.manipulators.shown == ("light", "plane")
    show(window, "raycast", wait_for)
    assert window.viewport.manipulators.shown == ()
