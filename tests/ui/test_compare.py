"""Several views: one camera, one active view, drawn and closed as they should be."""

from __future__ import annotations

import gc
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from tests.ui.conftest import drag, is_complete, turn_wheel
from volviz.custom_gl.registry import known_settings
from volviz.custom_gl.scene_techniques import choose_technique
from volviz.model.session import load_session
from volviz_ui.app.main_window import MainWindow
from volviz_ui.views.difference_image import array_of
from volviz_ui.views.viewport import Viewport

Wait = Callable[..., None]
pytestmark = [
    pytest.mark.usefixtures("first_full_images"),
    pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends"),
]


@pytest.fixture
def window(same_window: MainWindow) -> MainWindow:
    """These tests are about what happens in a window that is there."""
    return same_window


def image_of(viewport: Viewport) -> np.ndarray:
    """A viewport as shown, shape (H, W, 3), float 0..255."""
    image = viewport.grab().toImage().convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).astype(float)


def viewports(window: MainWindow) -> list[Viewport]:
    return [view_widget.viewport for view_widget in window.views.view_widgets]


@pytest.fixture
def split(window: MainWindow, wait_for: Wait) -> MainWindow:
    """The window with two views of the ball, complete."""
    window.commands["compare.split"].trigger()
    wait_for(lambda: is_complete(window))
    return window


def test_two_views_of_the_same_show_the_same_picture_and_follow_one_another(split: MainWindow) -> None:
    left, right = (image_of(viewport) for viewport in viewports(split))
    assert left.shape == right.shape
    assert np.abs(left - right).max() == 0
    middle = left[left.shape[0] // 2, left.shape[1] // 2]
    assert np.abs(middle - left[4, 4]).max() > 12
    first, second = viewports(split)
    before = second.frames
    drag(first, first.rect().center(), first.rect().center() + QPoint(40, 0), steps=4)
    assert second.frames - before >= 3


def test_a_drag_in_either_view_moves_both_and_they_never_drift(split: MainWindow, wait_for: Wait) -> None:
    random = np.random.default_rng(5)
    for number in range(8):
        viewport = viewports(split)[number % 2]
        middle = viewport.rect().center()
        drag(viewport, middle, middle + QPoint(*(int(v) for v in random.integers(-60, 60, 2))), steps=3)
        turn_wheel(viewport, int(random.choice([-1, 1])))
    wait_for(lambda: is_complete(split) and not any(v.is_moving for v in viewports(split)))
    cameras = [view.camera for view in split.store.scene.views]
    assert cameras[0] == cameras[1]
    assert viewports(split)[0].view_camera == viewports(split)[1].view_camera
    left, right = (image_of(viewport) for viewport in viewports(split))
    assert np.abs(left - right).max() == 0
    assert split.store.undo_label == split.tr("%1 views").replace("%1", "2")


def test_keys_and_panel_act_on_the_view_that_was_clicked(split: MainWindow, wait_for: Wait) -> None:
    QTest.mouseClick(viewports(split)[1], Qt.MouseButton.LeftButton, pos=QPoint(20, 60))
    assert split.store.scene.active == 1
    assert split.views.view_widgets[1].header.is_active
    assert not split.views.view_widgets[0].header.is_active
    QTest.keyClick(split, "2")
    first, second = split.store.scene.views
    assert first.technique == "raycast"
    assert second.technique != "raycast"
    assert split.technique_panel.box.currentData() == second.technique
    assert split.views.view_widgets[1].header.box.currentData() == second.technique
    assert split.views.view_widgets[0].header.box.currentData() == "raycast"
    wait_for(lambda: is_complete(split))
    assert split.views.view_widgets[0].controller.handle.technique.id == "raycast"
    assert split.views.view_widgets[1].controller.handle.technique.id == second.technique


def test_the_header_chooses_the_technique_of_its_view(split: MainWindow) -> None:
    box = split.views.view_widgets[1].header.box
    box.setCurrentIndex(box.findData("isosurface"))
    box.activated.emit(box.currentIndex())
    assert [view.technique for view in split.store.scene.views] == ["raycast", "isosurface"]
    assert split.store.scene.active == 1


def test_the_words_of_a_header_give_way_where_it_is_too_narrow(split: MainWindow) -> None:
    header = split.views.view_widgets[0].header
    for width in range(180, 520, 20):
        header.resize(width, header.height())
        header.layout().activate()
        if header.words.isVisible():
            assert header.words.geometry().right() < header.close_button.geometry().left()
            assert header.box.geometry().right() < header.words.geometry().left()
        else:
            assert width < 400
    assert header.words.isVisible()


def test_undo_goes_through_splitting_and_techniques_of_both_views(split: MainWindow, wait_for: Wait) -> None:
    choose_technique(split.store, "isosurface", view=1)
    choose_technique(split.store, "slicing", view=0)
    for expected in (["raycast", "isosurface"], ["raycast", "raycast"], ["raycast"]):
        split.commands["edit.undo"].trigger()
        assert [view.technique for view in split.store.scene.views] == expected
        assert len(split.views.view_widgets) == len(expected)
        wait_for(lambda: is_complete(split))
    for _ in range(3):
        split.commands["edit.redo"].trigger()
    assert [view.technique for view in split.store.scene.views] == ["slicing", "isosurface"]
    wait_for(lambda: is_complete(split))
    assert [p.controller.handle.technique.id for p in split.views.view_widgets] == ["slicing", "isosurface"]


def test_closing_the_left_half_leaves_the_right_one(split: MainWindow, wait_for: Wait) -> None:
    choose_technique(split.store, "isosurface", view=1)
    wait_for(lambda: is_complete(split))
    width = viewports(split)[0].width()
    split.views.view_widgets[0].header.close_button.click()
    assert [view.technique for view in split.store.scene.views] == ["isosurface"]
    wait_for(lambda: is_complete(split))
    assert split.controller.handle.technique.id == "isosurface"
    assert split.viewport.width() > 1.8 * width
    assert split.views.first.header.isHidden()


def test_a_closed_view_leaves_nothing_behind(split: MainWindow, wait_for: Wait) -> None:
    names = ("vtkGenericOpenGLRenderWindow", "Viewport", "ViewController", "ViewWidget")

    def count() -> list[int]:
        gc.collect()
        kinds = [type(item).__name__ for item in gc.get_objects()]
        return [kinds.count(name) for name in names]

    before = count()
    for _ in range(2):
        split.commands["compare.split"].trigger()
        QTest.qWait(30)
        split.commands["compare.split"].trigger()
        wait_for(lambda: is_complete(split))
    split.commands["compare.split"].trigger()
    QTest.qWait(30)
    after = count()
    assert [b - a for a, b in zip(after, before, strict=True)] == [1, 1, 1, 1]


def test_four_views_are_equally_large_and_drawn_in_four_ways(split: MainWindow, wait_for: Wait) -> None:
    split.commands["compare.four_views"].trigger()
    for size in ((1001, 705), (1100, 760)):
        split.resize(*size)
        QTest.qWait(30)
        assert len({(v.width(), v.height()) for v in viewports(split)}) == 1
    wait_for(lambda: is_complete(split))
    used = [view.technique for view in split.store.scene.views]
    assert used[0] == used[1]
    assert len(set(used[1:])) == 3


def test_another_file_keeps_the_views_and_is_shown_in_all(
    split: MainWindow, other_file: str, wait_for: Wait
) -> None:
    choose_technique(split.store, "isosurface", view=1)
    split.open(other_file)
    wait_for(lambda: split.documents.volume is not None and split.documents.volume.dimensions[0] == 24)
    wait_for(lambda: is_complete(split))
    assert [view.technique for view in split.store.scene.views] == ["raycast", "isosurface"]
    assert all(
        view_widget.controller.handle.volume is split.documents.volume
        for view_widget in split.views.view_widgets
    )
    assert split.store.scene.views[0].camera == split.store.scene.views[1].camera
    split.commands["edit.undo"].trigger()
    wait_for(lambda: is_complete(split))
    assert split.documents.volume.dimensions[0] == 32
    assert all(
        view_widget.controller.handle.volume is split.documents.volume
        for view_widget in split.views.view_widgets
    )


def test_a_copied_picture_holds_all_views(split: MainWindow) -> None:
    split.commands["file.copy_picture"].trigger()
    image = QApplication.clipboard().image()
    area, ratio = split.views, split.devicePixelRatioF()
    assert (image.width(), image.height()) == (round(area.width() * ratio), round(area.height() * ratio))
    copied = array_of(image)
    for view_widget in split.views.view_widgets:
        corner = view_widget.viewport.mapTo(area, QPoint(0, 0))
        shown = image_of(view_widget.viewport)
        part = copied[corner.y() :, corner.x() :][: shown.shape[0], : shown.shape[1]]
        assert np.abs(part - shown).mean() < 1


def test_two_views_at_rest_draw_no_frame(split: MainWindow) -> None:
    QTest.qWait(300)
    before = [viewport.frames for viewport in viewports(split)]
    QTest.qWait(1500)
    assert [viewport.frames for viewport in viewports(split)] == before


def test_a_session_brings_views_and_comparison_back(
    split: MainWindow, tmp_path: Path, wait_for: Wait
) -> None:
    choose_technique(split.store, "isosurface", view=1)
    split.views.activate(1)
    split.compare_commands.change(divider=0.25, period=1.5)
    path = tmp_path / "two.volviz.json"
    assert split.session_commands.save_path(path)
    saved = split.store.scene
    assert load_session(path, known_settings).comparison == saved.comparison
    split.commands["compare.one_view"].trigger()
    split.compare_commands.change(divider=0.5)
    assert split.session_commands.open_path(path)
    wait_for(lambda: len(split.store.scene.views) == 2)
    wait_for(lambda: is_complete(split))
    assert split.store.scene.views == saved.views
    assert split.store.scene.active == 1
    assert split.store.scene.comparison.divider == 0.25
