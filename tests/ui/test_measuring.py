"""Measuring in the window: clicks become points, numbers stand in pictures, the list edits what there is."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from tests.ui.conftest import drag, is_complete, viewport
from volviz.annotations.shapes import Text
from volviz_ui.app.main_window import MainWindow

Wait = Callable[..., None]

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")


@pytest.fixture
def window(window_with_slices: MainWindow) -> MainWindow:
    """With the slices beside the volume."""
    return window_with_slices


def click(window: MainWindow, view: int, x: int, y: int) -> None:
    shown = viewport(window, view)
    QTest.mouseClick(shown, Qt.MouseButton.LeftButton, pos=shown.rect().center() + QPoint(x, y))


def words(window: MainWindow, view: int) -> list[str]:
    shapes = window.views.view_widgets[view].annotations.overlay.shapes
    return [shape.words for shape in shapes if isinstance(shape, Text)]


def test_clicks_on_a_slice_measure_a_distance_that_stands_in_the_picture(window: MainWindow) -> None:
    window.commands["measure.distance"].trigger()
    before = window.store.scene.cursor
    click(window, 1, -12, 14)
    click(window, 1, 12, 14)
    (found,) = window.store.scene.measurements
    per_pixel = 2 * viewport(window, 1).view_camera.scale / viewport(window, 1).height()
    a, b = (np.asarray(point.position) for point in found.points)
    assert np.linalg.norm(b - a) == pytest.approx(24 * per_pixel)
    assert window.store.scene.cursor == before
    number = window.measurements_panel.list.topLevelItem(0).text(1)
    assert "±" in number
    assert number in words(window, 1)
    # it lies in one plane alone
    assert number not in words(window, 2)
    QTest.keyClick(viewport(window, 1), Qt.Key.Key_Escape)
    assert window.measure_tool.kind is None
    middle = viewport(window, 1).rect().center()
    drag(viewport(window, 1), middle + QPoint(12, 14), middle + QPoint(20, 30))
    moved = window.store.scene.measurements[0]
    assert moved.points[0] == found.points[0]
    assert moved.points[1] != found.points[1]
    window.store.undo()
    assert window.store.scene.measurements == (found,)
    window.store.undo()
    assert window.store.scene.measurements == ()


def test_measurements_go_with_their_volume_and_come_back_with_it(
    window: MainWindow, other_file: str, wait_for: Wait
) -> None:
    window.commands["measure.distance"].trigger()
    click(window, 1, -10, 0)
    click(window, 1, 10, 6)
    QTest.keyClick(viewport(window, 1), Qt.Key.Key_Escape)
    before, volume = window.store.scene, window.documents.volume
    assert len(before.measurements) == 1
    window.open(other_file)
    wait_for(lambda: window.documents.volume is not volume and is_complete(window))
    scene = window.store.scene
    assert (scene.measurements, scene.cursor, scene.tilt) == ((), None, None)
    window.store.undo()
    wait_for(lambda: window.documents.volume is volume)
    assert window.store.scene.measurements == before.measurements


def test_a_click_on_the_volume_is_a_point_by_the_rule_of_the_picture(window: MainWindow) -> None:
    window.commands["measure.point"].trigger()
    click(window, 0, 0, 0)
    (point,) = window.store.scene.measurements[0].points
    assert point.rule == "opacity"
    assert point.number is not None
    assert 0 < point.error < 20
    window.measure_tool.hold(None)


def test_a_polygon_ends_by_double_click_and_takes_points_back(window: MainWindow) -> None:
    window.commands["measure.polygon"].trigger()
    for x, y in ((-10, -10), (10, -10), (30, 30)):
        click(window, 1, x, y)
    QTest.keyClick(viewport(window, 1), Qt.Key.Key_Backspace)
    click(window, 1, 10, 10)
    end = viewport(window, 1).rect().center() + QPoint(-10, 10)
    QTest.mouseClick(viewport(window, 1), Qt.MouseButton.LeftButton, pos=end)
    QTest.mouseDClick(viewport(window, 1), Qt.MouseButton.LeftButton, pos=end)
    (found,) = window.store.scene.measurements
    assert len(found.points) == 4
    assert "Mean in" in window.measurements_panel.details.text()
    window.measure_tool.hold(None)


def test_the_list_renames_hides_locks_deletes_and_exports(window: MainWindow, tmp_path: Path) -> None:
    window.commands["measure.distance"].trigger()
    for x in (-12, 12, -8, 8):
        click(window, 1, x, 4)
    window.measure_tool.hold(None)
    panel = window.measurements_panel
    panel.list.topLevelItem(0).setText(0, "Width")
    panel.list.topLevelItem(1).setCheckState(0, Qt.CheckState.Unchecked)
    first, second = window.store.scene.measurements
    assert (first.name, second.visible) == ("Width", False)
    assert any(text.startswith("Width: ") for text in words(window, 1))
    panel.choose(0)
    panel.lock.click()
    window.measure_commands.write(tmp_path / "all.json")
    assert [each["name"] for each in json.loads((tmp_path / "all.json").read_text())] == [
        "Width",
        "Distance 2",
    ]
    window.measure_commands.write(tmp_path / "all.csv")
    assert (tmp_path / "all.csv").read_text().startswith("name,kind,quantity,value,error (95 %),unit")
    window.measure_commands.look_at(0)
    assert window.store.scene.cursor == pytest.approx(np.mean([p.position for p in first.points], axis=0))
    window.commands["measure.delete_all"].trigger()
    assert [each.name for each in window.store.scene.measurements] == ["Width"]


def test_a_click_on_the_volume_moves_the_cross_hair_to_what_is_seen(window: MainWindow) -> None:
    click(window, 0, 0, 0)
    cursor = window.store.scene.cursor
    assert cursor is not None
    handle = window.views.view_widgets[0].controller.handle
    center = viewport(window, 0).rect().center()
    assert cursor == pytest.approx(handle.pick(center.x(), center.y()).position)
