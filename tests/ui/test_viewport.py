"""The viewport under real mouse events: camera, light, images, and nothing drawn without a reason."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from tests.ui.conftest import drag, foreground, image, is_complete, turn_wheel, values
from volviz.custom_gl.scene_techniques import choose_technique, drawing_techniques
from volviz.model.transfer.function import TransferFunction
from volviz_ui.app.main_window import MainWindow

Wait = Callable[..., None]

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")


@pytest.fixture
def window(same_window: MainWindow) -> MainWindow:
    """These tests are about what happens in a window that is there."""
    return same_window


def enlarge(window: MainWindow, wait_for: Wait) -> None:
    """A viewport with room around the volume, and for numbers at the axes."""
    window.resize(1100, 760)
    QTest.qWait(100)
    wait_for(lambda: is_complete(window))


def centre(window: MainWindow) -> QPoint:
    return window.viewport.rect().center()


def test_a_left_drag_to_the_right_moves_the_eye_to_the_left_of_the_volume(window: MainWindow) -> None:
    window.view_commands.show_axis_view("A")
    before = window.viewport.view_camera
    drag(window.viewport, centre(window), centre(window) + QPoint(80, 0))
    after = window.viewport.view_camera
    right = np.cross(before.direction, before.view_up)
    moved = np.subtract(after.position, before.position)
    assert moved @ right < 0
    assert after.distance == pytest.approx(before.distance)


def test_a_drag_is_committed_once_and_is_no_step_of_the_history(window: MainWindow) -> None:
    scenes = []
    window.store.changed.connect(lambda old, new: scenes.append(new))
    drag(window.viewport, centre(window), centre(window) + QPoint(60, 40), steps=10)
    assert len(scenes) == 1
    assert scenes[0].view.camera == window.viewport.view_camera
    assert window.store.undo_label is None


def test_a_click_without_a_move_changes_nothing(window: MainWindow) -> None:
    scene, frames = window.store.scene, window.viewport.frames
    QTest.mouseClick(window.viewport, Qt.MouseButton.LeftButton, pos=centre(window))
    QTest.qWait(50)
    assert window.store.scene is scene
    assert window.viewport.frames == frames


def test_the_wheel_zooms_and_the_camera_is_committed_when_it_rests(
    window: MainWindow, wait_for: Wait
) -> None:
    before = window.store.scene.view.camera
    turn_wheel(window.viewport, 2)
    assert window.viewport.view_camera.distance < before.distance
    assert window.store.scene.view.camera == before
    wait_for(lambda: window.store.scene.view.camera != before)
    assert window.store.scene.view.camera == window.viewport.view_camera


def test_a_shift_drag_pushes_the_volume_along(window: MainWindow, wait_for: Wait) -> None:
    enlarge(window, wait_for)

    def middle() -> tuple[float, float]:
        rows, columns = np.nonzero(foreground(window))
        return float(columns.mean()), float(rows.mean())

    x, y = middle()
    drag(
        window.viewport,
        centre(window),
        centre(window) + QPoint(70, -50),
        modifiers=Qt.KeyboardModifier.ShiftModifier,
    )
    wait_for(lambda: is_complete(window))
    moved_x, moved_y = middle()
    assert moved_x - x == pytest.approx(70, abs=4)
    assert moved_y - y == pytest.approx(-50, abs=4)


def test_a_middle_drag_upwards_zooms_in(window: MainWindow) -> None:
    before = window.viewport.view_camera
    drag(window.viewport, centre(window), centre(window) - QPoint(0, 60), button=Qt.MouseButton.MiddleButton)
    after = window.viewport.view_camera
    assert after.distance < before.distance
    assert after.direction == pytest.approx(before.direction)


def test_a_right_drag_moves_the_light_where_the_technique_has_one(window: MainWindow) -> None:
    window.viewport.light_is_movable = True
    camera = window.viewport.view_camera
    drag(window.viewport, centre(window), centre(window) + QPoint(50, 20), button=Qt.MouseButton.RightButton)
    light = window.store.scene.light
    assert not light.headlight
    assert light.position is not None
    assert window.viewport.view_camera == camera
    assert window.store.undo_label == "Move the light"
    window.commands["edit.undo"].trigger()
    assert window.store.scene.light.headlight
    assert window.store.undo_label is None


def test_a_right_drag_zooms_where_there_is_no_light(window: MainWindow) -> None:
    window.viewport.light_is_movable = False
    before = window.viewport.view_camera.distance
    drag(window.viewport, centre(window), centre(window) - QPoint(0, 60), button=Qt.MouseButton.RightButton)
    assert window.viewport.view_camera.distance < before
    assert window.store.scene.light.headlight


def test_ctrl_and_wheel_change_the_distance_of_the_light(window: MainWindow, wait_for: Wait) -> None:
    window.viewport.light_is_movable = True
    centre_of_volume = np.asarray(window.documents.volume.center)
    turn_wheel(window.viewport, 1, Qt.KeyboardModifier.ControlModifier)
    near = np.linalg.norm(np.subtract(window.store.scene.light.position, centre_of_volume))
    # every change of the scene asks the technique anew, and ray casting's light is not dragged
    window.viewport.light_is_movable = True
    turn_wheel(window.viewport, -3, Qt.KeyboardModifier.ControlModifier)
    far = np.linalg.norm(np.subtract(window.store.scene.light.position, centre_of_volume))
    assert far > near
    wait_for(lambda: not window.viewport.is_moving)


def test_a_ctrl_drag_shifts_and_stretches_the_colours_as_one_step(window: MainWindow) -> None:
    before = window.store.scene.layer.transfer_function
    camera = window.viewport.view_camera
    control = Qt.KeyboardModifier.ControlModifier
    drag(window.viewport, centre(window), centre(window) + QPoint(60, 0), modifiers=control)
    after = window.store.scene.layer.transfer_function
    moved = [b.value - a.value for a, b in zip(before.points, after.points, strict=True)]
    assert min(moved) > 0
    assert max(moved) == pytest.approx(min(moved))
    assert window.viewport.view_camera == camera
    window.commands["edit.undo"].trigger()
    assert window.store.scene.layer.transfer_function == before
    assert window.store.undo_label is None


def test_escape_takes_a_ctrl_drag_back(window: MainWindow) -> None:
    before = window.store.scene.layer.transfer_function
    control = Qt.KeyboardModifier.ControlModifier
    QTest.mousePress(window.viewport, Qt.MouseButton.LeftButton, control, centre(window))
    for step in (10, 30, 50):
        position = centre(window) + QPoint(step, step)
        event = QMouseEvent(
            QEvent.Type.MouseMove,
            QPointF(position),
            QPointF(window.viewport.mapToGlobal(position)),
            Qt.MouseButton.NoButton,
            Qt.MouseButton.LeftButton,
            control,
        )
        QApplication.sendEvent(window.viewport, event)
    assert window.store.scene.layer.transfer_function != before
    QTest.keyClick(window.viewport, Qt.Key.Key_Escape)
    assert window.store.scene.layer.transfer_function == before
    assert window.store.undo_label is None
    QTest.mouseRelease(window.viewport, Qt.MouseButton.LeftButton, control, centre(window))
    assert not window.viewport.is_moving


def test_the_first_view_is_filled_by_what_is_visible(window: MainWindow, wait_for: Wait) -> None:
    solid = TransferFunction.from_points([(100, (1, 1, 1, 0)), (150, (1, 1, 1, 1))])
    window.store.update(lambda scene: scene.with_layer(transfer_function=solid))
    window.commands["view.reset_camera"].trigger()
    wait_for(lambda: is_complete(window))
    rows, columns = np.nonzero(foreground(window))
    height, width = foreground(window).shape
    extent = max((np.ptp(rows) + 1) / height, (np.ptp(columns) + 1) / width)
    assert 0.75 < extent < 0.97
    assert rows.min() > 2
    assert columns.min() > 2


def test_an_idle_window_draws_no_frame(window: MainWindow) -> None:
    QTest.qWait(300)
    before = window.viewport.frames
    QTest.qWait(3000)
    assert window.viewport.frames == before


def test_ten_moves_of_the_mouse_do_not_draw_more_than_ten_frames(window: MainWindow, wait_for: Wait) -> None:
    before = window.viewport.frames
    drag(window.viewport, centre(window), centre(window) + QPoint(50, 0), steps=10)
    moved = window.viewport.frames - before
    assert 1 <= moved <= 10
    wait_for(lambda: is_complete(window))
    # the image at rest, and the complete one
    assert window.viewport.frames - before <= moved + 3


def test_after_a_drag_the_complete_picture_comes(window: MainWindow, wait_for: Wait) -> None:
    drag(window.viewport, centre(window), centre(window) + QPoint(30, 0))
    wait_for(lambda: is_complete(window))
    assert window.controller.status.resolution == 1.0
    wait_for(lambda: "full quality" in window.messages.status_line.drawing.text())


@pytest.mark.parametrize("key", ["3", "s", "q", "e", "v", "b", "C", "w", "+", "-"])
def test_keys_of_vtk_and_pyvista_do_not_reach_the_scene(window: MainWindow, key: str) -> None:
    window.viewport.setFocus()
    renderer = window.viewport.renderer
    QTest.keyClick(window.viewport, key)
    QTest.qWait(20)
    assert not window.viewport.render_window.GetStereoRender()
    for actor in renderer.actors.values():
        if hasattr(actor, "GetProperty") and hasattr(actor.GetProperty(), "GetRepresentation"):
            assert actor.GetProperty().GetRepresentation() == 2
    assert window.isVisible()


def test_the_axis_views_look_along_the_axes(window: MainWindow) -> None:
    for action, direction in zip(
        [window.commands[f"view.from.{letter}"] for letter in "APLRSI"],
        [(0, 1, 0), (0, -1, 0), (-1, 0, 0), (1, 0, 0), (0, 0, -1), (0, 0, 1)],
        strict=True,
    ):
        action.trigger()
        assert window.viewport.view_camera.direction == pytest.approx(direction)
        assert window.store.scene.view.camera == window.viewport.view_camera


def test_parallel_projection_keeps_the_size_of_the_volume(window: MainWindow, wait_for: Wait) -> None:
    window.view_commands.show_axis_view("A")
    wait_for(lambda: is_complete(window))
    before = foreground(window).sum()
    QTest.keyClick(window, Qt.Key.Key_O)
    assert window.store.scene.view.camera.parallel
    wait_for(lambda: is_complete(window))
    assert foreground(window).sum() == pytest.approx(before, rel=0.15)


def test_the_pointer_tells_the_voxel_below_it(window: MainWindow, wait_for: Wait) -> None:
    window.view_commands.show_axis_view("A")
    solid = TransferFunction.from_points([(100, (1, 1, 1, 0)), (150, (1, 1, 1, 1))])
    window.store.update(lambda scene: scene.with_layer(transfer_function=solid))
    QTest.mouseMove(window.viewport, centre(window) - QPoint(3, 3))
    QTest.mouseMove(window.viewport, centre(window))
    wait_for(window.messages.status_line.pointer.text)
    text = window.messages.status_line.pointer.text()
    index = [int(n) for n in text[1 : text.index(")")].split(",")]
    assert text.endswith("200")
    volume = window.documents.volume
    place = [float(v) for v in text[text.index(")") + 1 : text.index(" mm")].split(",")]
    assert volume.world_to_index[:3, :3] @ place + volume.world_to_index[:3, 3] == pytest.approx(
        index, abs=0.6
    )
    # the middle of the image shows the middle of the volume, seen from the front, where y is small
    assert index[0] in (15, 16)
    assert index[2] in (15, 16)
    assert index[1] in (3, 4, 5)
    QTest.mouseMove(window.viewport, QPoint(4, 4))
    wait_for(lambda: not window.messages.status_line.pointer.text())


def test_floating_and_docking_a_panel_leaves_the_picture_as_it_was(
    window: MainWindow, wait_for: Wait
) -> None:
    before = image(window)
    for dock in window.docks.all:
        dock.setFloating(True)
        QTest.qWait(50)
        dock.setFloating(False)
        QTest.qWait(50)
    window.docks.reset()
    wait_for(lambda: is_complete(window))
    after = image(window)
    if after.shape == before.shape:
        assert np.abs(after - before).max() <= 2
    assert window.controller.handle.error is None
    assert foreground(window).mean() > 0.02


def test_techniques_can_be_changed_faster_than_they_draw(window: MainWindow, wait_for: Wait) -> None:
    errors: list[object] = []
    window.controller.failed.connect(errors.append)
    for wait in (0, 15, 60):
        for info in drawing_techniques():
            choose_technique(window.store, info.id)
            QTest.qWait(wait)
    choose_technique(window.store, "raycast")
    wait_for(lambda: is_complete(window))
    assert not errors
    assert foreground(window).mean() > 0.02


def test_another_size_of_the_window_gives_a_right_picture(window: MainWindow, wait_for: Wait) -> None:
    for width, height in ((900, 640), (1200, 800), (1000, 700)):
        window.resize(width, height)
        QTest.qWait(100)
        wait_for(lambda: is_complete(window))
        rows, columns = np.nonzero(foreground(window))
        shape = foreground(window).shape
        assert abs(rows.mean() / shape[0] - 0.5) < 0.05
        assert abs(columns.mean() / shape[1] - 0.5) < 0.05


def test_box_axes_marker_and_bar_can_be_switched(window: MainWindow, wait_for: Wait) -> None:
    enlarge(window, wait_for)
    for name in ("box", "axes", "marker", "bar"):
        action = window.commands[f"view.{name}"]
        off = values(window.viewport.grab().toImage())
        was_on = action.isChecked()
        action.trigger()
        QTest.qWait(50)
        wait_for(lambda: is_complete(window))
        assert np.abs(values(window.viewport.grab().toImage()) - off).max() > 20, name
        assert window.annotations.is_shown(name) is not was_on
        action.trigger()
        QTest.qWait(50)
        wait_for(lambda: is_complete(window))
        assert np.abs(values(window.viewport.grab().toImage()) - off).max() <= 2, name


def double_click(window: MainWindow, at: QPoint) -> None:
    """A double-click with its last release, which QTest leaves out: the button would stay down for good."""
    button, no_keys = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    QTest.mouseDClick(window.viewport, button, no_keys, at)
    QTest.mouseRelease(window.viewport, button, no_keys, at)


def test_a_double_click_looks_at_what_was_clicked_on(window: MainWindow) -> None:
    ball = TransferFunction.from_points([(100, (1, 1, 1, 0)), (101, (1, 1, 1, 1))])
    window.store.update(lambda scene: scene.with_layer(transfer_function=ball))
    before = window.viewport.view_camera
    at = centre(window) + QPoint(60, 30)
    double_click(window, at)
    after = window.viewport.view_camera
    assert after.distance == pytest.approx(before.distance)
    assert after.direction == pytest.approx(before.direction)
    # on the ball's surface, and now in the middle of the image
    radius = np.linalg.norm(np.subtract(after.focal_point, window.documents.volume.center))
    assert radius == pytest.approx(12, abs=1)
    assert window.store.scene.view.camera.focal_point == after.focal_point
    double_click(window, QPoint(5, 5))
    assert window.viewport.view_camera == after
