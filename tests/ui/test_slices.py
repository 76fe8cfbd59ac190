"""Slices beside the volume: cameras of their own, one cross-hair, the grey window, what undo and sessions keep."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from tests.ui.conftest import drag, image, is_complete, turn_wheel, viewport
from volviz.annotations.planes import PLANE_COLORS, plane_lines
from volviz.annotations.projection import Projection
from volviz.annotations.shapes import Line, Shape, Text
from volviz.custom_gl.scene_techniques import current_settings, faced, slice_technique
from volviz.model.session import load_session, save_session
from volviz_ui.app.main_window import MainWindow
from volviz_ui.session.script import script_of
from volviz_ui.views.camera_moves import point_on_plane, zoomed_at
from volviz_ui.views.tilt_handles import knobs

Wait = Callable[..., None]

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")


@pytest.fixture
def window(window_with_slices: MainWindow) -> MainWindow:
    """With the slices beside the volume."""
    return window_with_slices


def pixels(window: MainWindow, view: int) -> np.ndarray:
    grabbed = viewport(window, view).grabFramebuffer()
    rows = np.frombuffer(grabbed.constBits(), np.uint8).reshape(grabbed.height(), grabbed.bytesPerLine())
    return rows[:, : 4 * grabbed.width()].reshape(grabbed.height(), grabbed.width(), 4)[..., :3].astype(float)


def shapes_over(window: MainWindow, view: int) -> tuple[Shape, ...]:
    """What is painted over a view."""
    return window.views.view_widgets[view].annotations.overlay.shapes


def shown_words(window: MainWindow, view: int) -> list[str]:
    return [shape.words for shape in shapes_over(window, view) if isinstance(shape, Text)]


def cross_hair(window: MainWindow, view: int) -> list[Line]:
    lines = [shape for shape in shapes_over(window, view) if isinstance(shape, Line)]
    return [line for line in lines if line.color in PLANE_COLORS.values()]


def test_three_slices_have_cameras_of_their_own_beside_the_volume(window: MainWindow) -> None:
    scene = window.store.scene
    assert [current_settings(scene, n).plane for n in (1, 2, 3)] == ["axial", "coronal", "sagittal"]
    for number, direction in ((1, (0, 0, 1)), (2, (0, 1, 0)), (3, (-1, 0, 0))):
        camera = viewport(window, number).view_camera
        assert camera.parallel
        assert camera.direction == pytest.approx(direction)
        assert faced(scene, number) is not None
    before = [viewport(window, number).view_camera for number in range(4)]
    drag(viewport(window, 0), QPoint(60, 60), QPoint(110, 80))
    after = [viewport(window, number).view_camera for number in range(4)]
    assert after[0] != before[0]
    assert after[1:] == before[1:]
    # the ball is a light disc on a dark square
    seen = pixels(window, 1)
    middle = seen.shape[0] // 2, seen.shape[1] // 2
    assert seen[middle[0] - 9, middle[1] - 9].mean() > seen[8, middle[1] - 9].mean() + 60


def test_a_click_and_a_drag_move_the_cross_hair_in_all_views(window: MainWindow, wait_for: Wait) -> None:
    volume = window.documents.volume
    assert volume is not None
    axial = viewport(window, 1)
    QTest.mouseClick(axial, Qt.MouseButton.LeftButton, pos=axial.rect().center() + QPoint(20, -10))
    cursor = window.store.scene.cursor
    assert cursor is not None
    per_pixel = 2 * axial.view_camera.scale / axial.height()
    center = np.asarray(volume.center)
    # half a pixel: the middle of the widget lies between two
    assert np.asarray(cursor) == pytest.approx(center + per_pixel * np.array([20, -10, 0]), abs=per_pixel)
    assert window.store.undo_label is not None
    undo = window.store.undo_label
    drag(axial, axial.rect().center(), axial.rect().center() + QPoint(-30, 12))
    assert window.store.undo_label == undo
    moved = np.asarray(window.store.scene.cursor)
    assert moved == pytest.approx(center + per_pixel * np.array([-30, 12, 0]), abs=per_pixel)
    wait_for(lambda: is_complete(window))
    # the coronal slice goes through it now
    spec = window.documents.shown.spec(2)
    assert spec.settings.point == tuple(moved)
    window.store.undo()
    assert window.store.scene.cursor == cursor
    # beyond the volume it stays within
    drag(axial, axial.rect().center(), QPoint(2, 2))
    i = volume.world_to_index[:3, :3] @ np.asarray(window.store.scene.cursor) + volume.world_to_index[:3, 3]
    assert i.min() >= -1e-9


def test_the_wheel_goes_through_the_slices_and_zooms_with_ctrl(window: MainWindow, wait_for: Wait) -> None:
    volume, sagittal = window.documents.volume, viewport(window, 3)
    assert volume is not None
    scale = sagittal.view_camera.scale
    turn_wheel(sagittal, 3)
    cursor = window.store.scene.cursor
    assert cursor is not None
    # away from the viewer, who stands at the left
    assert volume.center[0] - cursor[0] == pytest.approx(3 * volume.spacing[0])
    assert sagittal.view_camera.scale == scale
    wait_for(lambda: not window.store.is_interacting)
    turn_wheel(sagittal, 2, Qt.KeyboardModifier.ControlModifier)
    assert sagittal.view_camera.scale < scale
    assert window.store.scene.cursor == cursor
    # what lies under the pointer stays there
    size, corner = (sagittal.width(), sagittal.height()), (20.0, 30.0)
    near = zoomed_at(sagittal.view_camera, 1.5, corner, size)
    through = volume.center
    assert point_on_plane(near, corner, size, through) == pytest.approx(
        point_on_plane(sagittal.view_camera, corner, size, through)
    )
    wait_for(lambda: not window.store.is_interacting)
    window.commands["view.slices.centre"].trigger()
    assert window.store.scene.cursor is None


def test_a_knob_of_the_cross_hair_tilts_the_other_slices_together(window: MainWindow, wait_for: Wait) -> None:
    axial, scene = viewport(window, 1), window.store.scene
    before = [faced(scene, number) for number in (1, 2, 3)]
    camera = axial.view_camera
    shown = window.views.view_widgets[1].annotations
    _color, place = knobs(shown.subject(), Projection(camera, (axial.width(), axial.height())))[0]
    middle = np.array([axial.width(), axial.height()]) / 2
    angle = np.radians(20)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    end = middle + turn @ (np.asarray(place) - middle)
    drag(axial, QPoint(*np.rint(place).astype(int)), QPoint(*np.rint(end).astype(int)))
    after = [faced(window.store.scene, number) for number in (1, 2, 3)]
    # the slice itself stays, the others are turned, and all are at right angles to each other
    assert after[0] == (pytest.approx(before[0][0]), pytest.approx(before[0][1]))
    assert axial.view_camera == camera
    for old, new, number in zip(before[1:], after[1:], (2, 3), strict=True):
        assert np.degrees(np.arccos(np.dot(old[0], new[0]))) == pytest.approx(20, abs=2)
        assert viewport(window, number).view_camera.direction == pytest.approx(tuple(-v for v in new[0]))
    normals = np.array([facing[0] for facing in after])
    assert normals @ normals.T == pytest.approx(np.eye(3), abs=1e-9)
    wait_for(lambda: is_complete(window))
    window.store.undo()
    assert window.store.scene.tilt is None
    window.store.redo()
    window.commands["view.slices.straighten"].trigger()
    assert [faced(window.store.scene, number) for number in (1, 2, 3)] == before


def test_the_right_button_changes_the_grey_window_of_all_slices(window: MainWindow, wait_for: Wait) -> None:
    before = pixels(window, 2)
    coronal = viewport(window, 1)
    drag(
        coronal,
        coronal.rect().center(),
        coronal.rect().center() + QPoint(0, -60),
        button=Qt.MouseButton.RightButton,
    )
    settings = [current_settings(window.store.scene, number) for number in (1, 2, 3)]
    assert len({(s.window_level, s.window_width) for s in settings}) == 1
    assert settings[0].window_level is not None
    wait_for(lambda: is_complete(window))
    assert pixels(window, 2).mean() < before.mean()
    window.store.undo()
    assert current_settings(window.store.scene, 2).window_level is None


def test_another_plane_is_looked_at_straight(window: MainWindow, wait_for: Wait) -> None:
    box = window.views.view_widgets[1].header.plane_box
    assert not window.views.view_widgets[1].header.box.isVisible()
    box.setCurrentIndex(box.findData("coronal"))
    box.activated.emit(box.currentIndex())
    wait_for(lambda: viewport(window, 1).view_camera.direction == pytest.approx((0, 1, 0)))
    assert window.views.view_widgets[0].header.box.isVisible()


def test_lines_show_where_the_planes_meet_and_letters_what_is_where(window: MainWindow) -> None:
    scene, volume = window.store.scene, window.documents.volume
    assert volume is not None
    outlines = plane_lines(scene, volume, 0)
    assert [len(points) for _, points in outlines] == [5, 5, 5]
    crossing = plane_lines(scene, volume, 1)
    assert len(crossing) == 2
    for _, points in crossing:
        assert points.mean(axis=0) == pytest.approx(np.asarray(volume.center))
        assert points[0, 2] == points[1, 2]
    words = shown_words(window, 1)
    assert {"A", "P", "L", "R"} <= set(words) or {"+x", "−x", "+y", "−y"} <= set(words)
    assert len(cross_hair(window, 1)) == 2
    window.commands["view.cross_hair"].trigger()
    window.commands["view.letters"].trigger()
    assert not cross_hair(window, 1)
    assert not {"A", "R", "+x", "−x"} & set(shown_words(window, 1))
    window.commands["view.cross_hair"].trigger()
    window.commands["view.letters"].trigger()


def test_a_session_and_a_script_keep_the_slices(window: MainWindow, tmp_path: Path) -> None:
    window.commands["view.slices.large"].trigger()
    QTest.mouseClick(viewport(window, 1), Qt.MouseButton.LeftButton, pos=QPoint(60, 50))
    scene = window.store.scene
    assert scene.layout == "large"
    assert scene.cursor is not None
    assert viewport(window, 0).width() > viewport(window, 1).width()
    save_session(scene, tmp_path / "a.volviz.json")
    info = slice_technique()
    again = load_session(tmp_path / "a.volviz.json", lambda id_: info.settings if id_ == info.id else None)
    assert again.cursor == scene.cursor
    assert again.layout == "large"
    assert [view.own_camera for view in again.views] == [False, True, True, True]
    written = re.split(r"\bpoint=\(", script_of(scene, (300, 200)))[1].split(")")[0]
    assert [float(number) for number in written.split(",")] == pytest.approx(scene.cursor, rel=1e-6)


def test_the_volume_alone_comes_back(window: MainWindow, wait_for: Wait) -> None:
    whole = image(window).shape
    window.commands["view.slices.grid"].trigger()
    wait_for(lambda: len(window.views.view_widgets) == 1 and is_complete(window))
    assert image(window).shape[1] > whole[1]
    window.commands["compare.four_views"].trigger()
    wait_for(lambda: len(window.views.view_widgets) == 4)
    assert not any(view.own_camera for view in window.store.scene.views)
    assert viewport(window, 3).view_camera == viewport(window, 0).view_camera
