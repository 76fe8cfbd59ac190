"""The ray inspector in the window: clicks, keys, and what it says against the image's own pixels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from tests.ui.conftest import image, is_complete
from volviz.custom_gl.scene_techniques import choose_technique
from volviz.custom_gl.techniques.raycast.settings import RaycastSettings
from volviz.model.transfer.function import TransferFunction
from volviz_ui.app.main_window import MainWindow

Wait = Callable[..., None]
LEFT = Qt.MouseButton.LeftButton

#: Thin enough that a ray goes through all of the ball.
THIN = TransferFunction.from_points(
    [(0, (0, 0, 0.4, 0.0)), (60, (0.2, 0.9, 0.3, 0.02)), (200, (1, 0.6, 0.2, 0.05))]
)

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")


@pytest.fixture
def window(same_window: MainWindow) -> MainWindow:
    """These tests are about what happens in a window that is there."""
    return same_window


def settle(window: MainWindow, wait_for: Wait) -> None:
    wait_for(lambda: is_complete(window) and window.ray_inspector.is_settled)


def show_function(window: MainWindow, function: TransferFunction) -> None:
    window.store.update(lambda scene: scene.with_layer(transfer_function=function), label="Function")


@pytest.fixture
def inspecting(window: MainWindow, wait_for: Wait) -> MainWindow:
    """The window with the panel open and a thin function."""
    show_function(window, THIN)
    window.docks["ray"].show()
    settle(window, wait_for)
    return window


def click(window: MainWindow, offset: QPoint, wait_for: Wait) -> None:
    QTest.mouseClick(window.viewport, LEFT, pos=window.viewport.rect().center() + offset)
    settle(window, wait_for)


@pytest.mark.parametrize("technique", ["raycast", "two_pass_raycast", "slicing"])
def test_a_click_shows_the_colour_of_that_very_pixel(
    inspecting: MainWindow, wait_for: Wait, technique: str
) -> None:
    choose_technique(inspecting.store, technique)
    for offset in (QPoint(0, 0), QPoint(31, -24), QPoint(-40, 12)):
        click(inspecting, offset, wait_for)
        found = inspecting.ray_panel.plot.found
        drawn = inspecting.controller.handle.read_image()[found.pixel[1], found.pixel[0]]
        assert found.exact
        assert drawn[3] > 0.2
        np.testing.assert_allclose(found.profile.color, drawn, atol=2 / 255)


def test_a_cross_marks_the_pixel_until_the_panel_is_closed(inspecting: MainWindow, wait_for: Wait) -> None:
    offset = QPoint(60, 30)
    click(inspecting, offset, wait_for)
    spot = inspecting.viewport.rect().center() + offset
    arm = image(inspecting)[spot.y(), spot.x() + 8]
    assert arm[0] > 200
    assert arm[2] < 120
    inspecting.docks["ray"].close()
    wait_for(lambda: inspecting.views.first.ray_mark.place is None and is_complete(inspecting))
    assert np.abs(image(inspecting)[spot.y(), spot.x() + 8] - arm).max() > 60


def test_the_ray_follows_the_transfer_function_and_undo(inspecting: MainWindow, wait_for: Wait) -> None:
    click(inspecting, QPoint(0, 0), wait_for)
    before = inspecting.ray_panel.plot.found
    assert before.ends == "box"
    dense = replace(THIN, points=tuple(replace(p, opacity=0.8) for p in THIN.points))
    show_function(inspecting, dense)
    settle(inspecting, wait_for)
    after = inspecting.ray_panel.plot.found
    assert after.ends == "opacity"
    assert len(after.profile.values) < len(before.profile.values)
    assert "enough opacity" in inspecting.ray_panel.sentence.text()
    inspecting.commands["edit.undo"].trigger()
    settle(inspecting, wait_for)
    assert inspecting.ray_panel.plot.found.ends == "box"


def test_the_reason_follows_clip_planes_and_opaque_geometry(inspecting: MainWindow, wait_for: Wait) -> None:
    click(inspecting, QPoint(0, 0), wait_for)
    volume, camera = inspecting.documents.volume, inspecting.viewport.view_camera
    toward = tuple(-c for c in camera.direction)
    clipping = replace(inspecting.store.scene.clipping, planes=((volume.center, toward),))
    inspecting.store.update(lambda scene: replace(scene, clipping=clipping), label="Clip")
    settle(inspecting, wait_for)
    assert inspecting.ray_panel.plot.found.ends == "plane"
    inspecting.commands["edit.undo"].trigger()
    import pyvista as pv

    sphere = pv.Sphere(radius=2.0, center=volume.center)
    actor = inspecting.viewport.add_mesh(sphere, reset_camera=False)
    inspecting.viewport.render()
    settle(inspecting, wait_for)
    wait_for(lambda: inspecting.ray_panel.plot.found.ends == "mesh")
    half = inspecting.ray_panel.plot.found
    eye = np.asarray(half.span.start) + half.span.exit * np.asarray(half.span.direction)
    assert np.linalg.norm(eye - volume.center) == pytest.approx(2.0, abs=0.1)
    inspecting.viewport.remove_actor(actor)


def test_hovering_a_sample_marks_its_value_in_the_editor(inspecting: MainWindow, wait_for: Wait) -> None:
    click(inspecting, QPoint(0, 0), wait_for)
    plot = inspecting.ray_panel.plot
    QTest.mouseMove(plot, QPoint(int(plot.x_of(plot.found.profile.distances[30])), 40))
    wait_for(lambda: plot.chosen == 30)
    assert inspecting.transfer_editor.plot._highlight == plot.found.profile.values[30]
    assert inspecting.ray_panel.sample.text().startswith("31 / ")


def test_everything_can_be_done_with_the_keyboard(window: MainWindow, wait_for: Wait) -> None:
    show_function(window, THIN)
    QTest.keyClick(window, Qt.Key.Key_I, Qt.KeyboardModifier.ControlModifier)
    settle(window, wait_for)
    panel = window.ray_panel
    assert panel.plot.hasFocus()
    # without a click it begins with the middle of the image
    width, height = window.viewport.pixel_size
    assert panel.plot.found.pixel == (width // 2, height // 2)
    QTest.keyClick(panel.plot, Qt.Key.Key_Home)
    QTest.keyClick(panel.plot, Qt.Key.Key_Right)
    QTest.keyClick(panel.plot, Qt.Key.Key_Right, Qt.KeyboardModifier.ShiftModifier)
    assert panel.plot.chosen == 11
    assert panel.plot.accessibleDescription() == panel.sample.text()
    panel.column.setFocus()
    panel.column.selectAll()
    QTest.keyClicks(panel.column, "200")
    QTest.keyClick(panel.column, Qt.Key.Key_Return)
    settle(window, wait_for)
    assert panel.plot.found.pixel == (200, height // 2)
    panel.plot.setFocus()
    settings = (("raycast", RaycastSettings(preintegrated=True, step=0.1)),)
    window.store.update(lambda scene: scene.with_view(settings=settings), label="Step")
    settle(window, wait_for)
    # long and pre-integrated rays are followed on a worker
    assert "Pre-integrated" in panel.note.text()
    assert len(panel.plot.found.profile.values) > 200
    QTest.keyClick(panel.plot, Qt.Key.Key_End)
    QTest.keyClick(panel.plot, Qt.Key.Key_Escape)
    assert panel.plot.chosen == -1


def test_a_drag_turns_the_view_and_the_ray_behind_the_same_spot_is_shown(
    inspecting: MainWindow, wait_for: Wait
) -> None:
    click(inspecting, QPoint(10, 10), wait_for)
    before = inspecting.ray_panel.plot.found
    inspecting.view_commands.show_axis_view("L")
    settle(inspecting, wait_for)
    after = inspecting.ray_panel.plot.found
    assert after.pixel == before.pixel
    assert np.dot(after.span.direction, before.span.direction) < 0.9


def test_techniques_without_samples_are_told_apart_in_words(inspecting: MainWindow, wait_for: Wait) -> None:
    for technique, words in (
        ("isosurface", "shows surfaces"),
        ("splatting", "shows surfaces"),
        ("half_angle", "would gather"),
    ):
        choose_technique(inspecting.store, technique)
        click(inspecting, QPoint(0, 0), wait_for)
        assert not inspecting.ray_panel.plot.found.exact
        assert words in inspecting.ray_panel.note.text()
    choose_technique(inspecting.store, "raycast")
    settle(inspecting, wait_for)
    assert inspecting.ray_panel.note.text() == ""


def test_a_closed_panel_computes_nothing_and_an_idle_window_draws_nothing(
    inspecting: MainWindow, wait_for: Wait, other_file: str
) -> None:
    click(inspecting, QPoint(0, 0), wait_for)
    frames = inspecting.viewport.frames
    QTest.qWait(120)
    assert inspecting.viewport.frames == frames
    inspecting.docks["ray"].close()
    found = inspecting.ray_panel.plot.found
    show_function(inspecting, THIN.with_opacity(0.5))
    click(inspecting, QPoint(5, 5), wait_for)
    assert inspecting.ray_panel.plot.found is found
    inspecting.docks["ray"].show()
    inspecting.open(other_file)
    wait_for(lambda: inspecting.documents.volume.dimensions == (24, 24, 24))
    settle(inspecting, wait_for)
    assert inspecting.ray_panel.plot.found.profile.values.max() < 121


def test_in_several_views_the_ray_is_that_of_the_active_one(inspecting: MainWindow, wait_for: Wait) -> None:
    inspecting.store.update(
        lambda scene: scene.with_view_count(2).with_view(1, technique="slicing"), label="2"
    )
    wait_for(lambda: len(inspecting.views.view_widgets) == 2 and inspecting.views.is_complete)
    for view, technique in ((1, "slicing"), (0, "raycast")):
        viewport = inspecting.views.view_widgets[view].viewport
        QTest.mouseClick(viewport, LEFT, pos=viewport.rect().center())
        wait_for(lambda: inspecting.views.is_complete and inspecting.ray_inspector.is_settled)
        found = inspecting.ray_panel.plot.found
        assert found.technique == technique
        drawn = inspecting.views.view_widgets[view].controller.handle.read_image()[
            found.pixel[1], found.pixel[0]
        ]
        np.testing.assert_allclose(found.profile.color, drawn, atol=2 / 255)
        # the same spot is marked in both, to be compared
        assert all(view_widget.ray_mark.place is not None for view_widget in inspecting.views.view_widgets)
    inspecting.store.update(lambda scene: scene.without_view(1), label="Close")
    settle(inspecting, wait_for)
    assert inspecting.ray_panel.plot.found.technique == "raycast"
