"""Gestures in the window: what is dragged stays one step whatever else moves, and none outlives its widget."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget

from tests.ui.conftest import is_complete, turn_wheel
from volviz.custom_gl.scene_techniques import choose_technique, current_settings
from volviz_ui.app.main_window import MainWindow

Wait = Callable[..., None]
LEFT, NONE = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")


@pytest.fixture
def window(same_window: MainWindow) -> MainWindow:
    """These tests are about what happens in a window that is there."""
    return same_window


def move_held(widget: QWidget, to: QPoint) -> None:
    """The pointer moves with the left button held."""
    place = QPointF(to)
    kind, nothing = QEvent.Type.MouseMove, Qt.MouseButton.NoButton
    QApplication.sendEvent(
        widget, QMouseEvent(kind, place, QPointF(widget.mapToGlobal(place)), nothing, LEFT, NONE)
    )


@pytest.mark.parametrize("end", ["release", "escape"])
def test_a_wheel_that_comes_to_rest_does_not_cut_the_drag_of_a_point_in_two(
    window: MainWindow, wait_for: Wait, end: str
) -> None:
    store, plot = window.store, window.transfer_editor.plot
    before, camera = store.scene.layer.transfer_function, store.scene.view.camera
    point = before.resolved(window.documents.volume.range).points[1]
    start = plot.places.point(point.value, point.opacity).toPoint()
    turn_wheel(window.viewport, 1)
    QTest.mousePress(plot, LEFT, NONE, start)
    move_held(plot, start + QPoint(0, 12))
    assert window.viewport.is_moving
    wait_for(lambda: not window.viewport.is_moving)
    assert store.scene.view.camera != camera
    zoomed = store.scene.view.camera
    assert store.is_interacting
    half = store.scene.layer.transfer_function
    move_held(plot, start + QPoint(0, 24))
    assert store.scene.layer.transfer_function != half != before
    if end == "release":
        QTest.mouseRelease(plot, LEFT, NONE, start + QPoint(0, 24))
        store.undo()
    else:
        QTest.keyClick(plot, Qt.Key.Key_Escape)
        QTest.mouseRelease(plot, LEFT, NONE, start + QPoint(0, 24))
    assert store.scene.layer.transfer_function == before
    assert store.undo_label is None
    assert store.scene.view.camera == zoomed
    assert not store.is_interacting
    wait_for(lambda: is_complete(window))


def test_a_wheel_during_the_drag_of_a_setting_leaves_it_one_step(window: MainWindow, wait_for: Wait) -> None:
    before = current_settings(window.store.scene)
    slider = window.technique_panel.form.editors["density_threshold"].control.slider
    start = QPoint(6, slider.height() // 2)
    QTest.mousePress(slider, LEFT, NONE, start)
    move_held(slider, start + QPoint(15, 0))
    turn_wheel(window.viewport, 1)
    wait_for(lambda: not window.viewport.is_moving)
    move_held(slider, start + QPoint(30, 0))
    QTest.mouseRelease(slider, LEFT, NONE, start + QPoint(30, 0))
    assert current_settings(window.store.scene) != before
    window.commands["edit.undo"].trigger()
    assert current_settings(window.store.scene) == before
    assert window.store.undo_label is None


def test_a_drag_that_moves_a_knob_says_nothing_of_the_camera(window: MainWindow, wait_for: Wait) -> None:
    """VTK rounds the view up; a camera that nobody has moved stays the same value in the scene."""
    choose_technique(window.store, "bump_mapping")
    window.controller.show_camera(window.viewport.view_camera.turned(31, 17))
    wait_for(lambda: is_complete(window))
    camera = window.store.scene.view.camera
    x, y = (round(v) for v in window.viewport.manipulators.place("light"))
    QTest.mousePress(window.viewport, LEFT, NONE, QPoint(x, y))
    move_held(window.viewport, QPoint(x + 40, y + 30))
    QTest.mouseRelease(window.viewport, LEFT, NONE, QPoint(x + 40, y + 30))
    assert window.store.scene.view.camera == camera
    assert window.store.undo_label == "Move the light"


@pytest.mark.parametrize("closed", [0, 1])
def test_a_view_closed_while_it_is_dragged_ends_its_gesture_and_keeps_the_camera(
    window: MainWindow, wait_for: Wait, closed: int
) -> None:
    window.commands["compare.split"].trigger()
    wait_for(lambda: is_complete(window))
    viewport = window.views.view_widgets[1].viewport
    middle = viewport.rect().center()
    QTest.mousePress(viewport, LEFT, NONE, middle)
    move_held(viewport, middle + QPoint(40, 20))
    turn_wheel(viewport, 1)
    moved = viewport.view_camera
    assert window.store.is_interacting
    window.views.close_view(closed)
    assert not window.store.is_interacting
    wait_for(lambda: window.store.scene.view.camera == moved)
    wait_for(lambda: is_complete(window))
    assert window.viewport.view_camera == moved


def test_a_view_made_during_a_drag_is_completed_after_it(window: MainWindow, wait_for: Wait) -> None:
    middle = window.viewport.rect().center()
    QTest.mousePress(window.viewport, LEFT, NONE, middle)
    move_held(window.viewport, middle + QPoint(40, 20))
    window.commands["compare.split"].trigger()
    QTest.qWait(300)
    assert not any(view_widget.controller.is_complete for view_widget in window.views.view_widgets)
    QTest.mouseRelease(window.viewport, LEFT, NONE, middle + QPoint(40, 20))
    wait_for(lambda: is_complete(window))


def test_a_slider_that_is_taken_away_while_it_is_held_lets_go(window: MainWindow, wait_for: Wait) -> None:
    slider = window.technique_panel.form.editors["density_threshold"].control.slider
    QTest.mousePress(slider, LEFT, NONE, QPoint(6, slider.height() // 2))
    assert window.store.is_interacting
    choose_technique(window.store, "isosurface")
    assert not window.store.is_interacting
    wait_for(lambda: is_complete(window))


def test_an_isovalue_dragged_in_the_plot_is_one_step(window: MainWindow, wait_for: Wait) -> None:
    choose_technique(window.store, "isosurface")
    wait_for(lambda: is_complete(window))
    window.store.clear_history()
    before, plot = current_settings(window.store.scene), window.transfer_editor.plot
    start = QPointF(plot.places.x(plot.markers[0]), plot.places.plot.top() + 4).toPoint()
    for end in ("release", "escape"):
        QTest.mousePress(plot, LEFT, NONE, start)
        for step in (10, 20, 30):
            move_held(plot, start + QPoint(step, 0))
        assert current_settings(window.store.scene) != before
        assert window.store.is_interacting
        if end == "escape":
            QTest.keyClick(plot, Qt.Key.Key_Escape)
        QTest.mouseRelease(plot, LEFT, NONE, start + QPoint(30, 0))
        if end == "release":
            window.commands["edit.undo"].trigger()
        assert current_settings(window.store.scene) == before
        assert window.store.undo_label is None
