"""Wipe, blink and difference: seen pixels, drags, what stops when nobody looks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, QRect, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from tests.ui.conftest import drag, drawn_image, is_complete
from tests.ui.test_compare import image_of, viewports
from volviz.compare.image_metrics import difference_image
from volviz.custom_gl.scene_techniques import choose_technique
from volviz.model.comparison import Mode
from volviz_ui.app.main_window import MainWindow
from volviz_ui.views.difference_image import array_of
from volviz_ui.views.divider import Divider

Wait = Callable[..., None]
pytestmark = [
    pytest.mark.usefixtures("first_full_images"),
    pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends"),
]


@pytest.fixture
def window(same_window: MainWindow) -> MainWindow:
    """These tests are about what happens in a window that is there."""
    return same_window


@pytest.fixture
def pair(window: MainWindow, wait_for: Wait) -> MainWindow:
    """The ball twice: as a volume and as a surface, complete."""
    window.commands["compare.split"].trigger()
    choose_technique(window.store, "isosurface", view=1)
    wait_for(lambda: is_complete(window))
    return window


def enter(window: MainWindow, mode: Mode, wait_for: Wait) -> None:
    window.compare_commands.set_mode(mode)
    wait_for(lambda: is_complete(window))
    QTest.qWait(50)


def drag_divider(divider: Divider, dx: int) -> None:
    """Drag with the pointer's own place: the divider moves away below it."""
    start = divider.mapToGlobal(divider.rect().center())
    QTest.mousePress(divider, Qt.MouseButton.LeftButton)
    for step in range(1, 6):
        at = start + QPoint(round(dx * step / 5), 5 * step)
        event = QMouseEvent(
            QEvent.Type.MouseMove,
            QPointF(divider.mapFromGlobal(at)),
            QPointF(at),
            Qt.MouseButton.NoButton,
            Qt.MouseButton.LeftButton,
            Qt.KeyboardModifier.NoModifier,
        )
        QApplication.sendEvent(divider, event)
        QTest.qWait(5)
    QTest.mouseRelease(divider, Qt.MouseButton.LeftButton)


def on_screen(window: MainWindow) -> np.ndarray:
    """What the screen shows where the images are, below the headers, shape (H, W, 3)."""
    area = window.views
    body = QRect(area.mapTo(window, QPoint(0, 0)), area.size())
    image = array_of(window.screen().grabWindow(window.winId()).toImage())
    top = body.top() + area.first.frame.y()
    return image[top : body.top() + area.height(), body.left() : body.left() + area.width()].astype(float)


def exported(window: MainWindow) -> list[np.ndarray]:
    """Both images as they would be exported, shape (H, W, 3), uint8."""
    found = []
    for view in range(2):
        window.views.activate(view)
        scene, volume = window.store.scene, window.documents.volume
        found.append(drawn_image(scene, volume, window.viewport.pixel_size, transparent=False)[..., :3])
    return found


def test_a_wipe_shows_the_first_view_left_of_the_line_and_the_second_right_of_it(
    pair: MainWindow, wait_for: Wait
) -> None:
    enter(pair, "wipe", wait_for)
    divider = pair.views.arrangement.divider
    assert divider.isVisible()
    width = pair.views.width()
    drag_divider(divider, -round(0.2 * width))
    share = pair.store.scene.comparison.divider
    assert share == pytest.approx(0.3, abs=0.01)
    wait_for(lambda: is_complete(pair))
    QTest.qWait(80)
    seen = on_screen(pair)
    left, right = (image_of(viewport) for viewport in viewports(pair))
    at = round(share * width)
    assert seen.shape == left.shape == right.shape
    assert np.abs(seen[:, : at - 12] - left[:, : at - 12]).max() <= 1
    assert np.abs(seen[:, at + 12 :] - right[:, at + 12 :]).max() <= 1
    assert np.abs(left - right)[:, at + 12 :].max() > 30
    # looking is no step of the history
    assert pair.store.undo_label not in (None, pair.tr("Comparison"))


def test_the_line_of_a_wipe_can_be_moved_by_keys_and_both_sides_keep_up_with_a_drag(
    pair: MainWindow, wait_for: Wait
) -> None:
    enter(pair, "wipe", wait_for)
    divider = pair.views.arrangement.divider
    divider.setFocus()
    QTest.keyClick(divider, Qt.Key.Key_Right)
    QTest.keyClick(divider, Qt.Key.Key_Right)
    assert pair.store.scene.comparison.divider == pytest.approx(0.52)
    for _ in range(80):
        QTest.keyClick(divider, Qt.Key.Key_Left)
    assert pair.store.scene.comparison.divider == pytest.approx(0.02)
    QTest.mouseDClick(divider, Qt.MouseButton.LeftButton)
    QTest.mouseRelease(divider, Qt.MouseButton.LeftButton)
    assert pair.store.scene.comparison.divider == 0.5
    wait_for(lambda: is_complete(pair))
    before = [viewport.frames for viewport in viewports(pair)]
    start = QPoint(40, 200)
    drag(viewports(pair)[0], start, start + QPoint(60, 10), steps=5)
    after = [viewport.frames for viewport in viewports(pair)]
    assert all(b - a >= 4 for a, b in zip(before, after, strict=True))


def test_blinking_shows_one_view_and_the_other_in_turn_and_stops_when_hidden(
    pair: MainWindow, wait_for: Wait
) -> None:
    pair.compare_commands.change(period=0.2)
    enter(pair, "blink", wait_for)
    arrangement = pair.views.arrangement
    assert arrangement.blinks
    seen: list[bool] = []
    left, right = viewports(pair)

    def both_seen() -> bool:
        seen.append(right.is_covered)
        assert right.is_covered is not left.is_covered
        return seen.count(True) > 3 and seen.count(False) > 3

    wait_for(both_seen)
    images = [image_of(viewport) for viewport in viewports(pair)]
    for covered in (True, False):
        wait_for(lambda wanted=covered: right.is_covered is wanted)
        QTest.qWait(60)
        shown = on_screen(pair)
        near = [float(np.abs(shown - image).mean()) for image in images]
        assert min(near) < 0.5
    pair.hide()
    QTest.qWait(20)
    assert not arrangement.blinks
    frames = [viewport.frames for viewport in viewports(pair)]
    QTest.qWait(500)
    assert [viewport.frames for viewport in viewports(pair)] == frames
    pair.show()
    wait_for(lambda: arrangement.blinks)
    pair.compare_commands.set_mode("side_by_side")
    assert not arrangement.blinks


def test_the_difference_of_a_picture_with_itself_is_nothing(window: MainWindow, wait_for: Wait) -> None:
    window.commands["compare.split"].trigger()
    enter(window, "difference", wait_for)
    view = window.views.arrangement.difference
    wait_for(lambda: view.is_exact)
    zero = array_of(view.image)
    assert np.ptp(zero.reshape(-1, 3), axis=0).max() == 0
    assert view.labels() == ("\N{MINUS SIGN}1", "0", "+1")


def test_the_difference_is_that_of_the_exported_pictures(pair: MainWindow, wait_for: Wait) -> None:
    # wide enough that the colour bar leaves most of the image free
    pair.resize(1100, 760)
    enter(pair, "difference", wait_for)
    view = pair.views.arrangement.difference
    images = exported(pair)
    for kind, channel in (("signed", "luminance"), ("absolute", "rgb"), ("absolute", "green")):
        pair.compare_commands.change(map=kind, channel=channel)
        QTest.qWait(80)
        wait_for(lambda: view.is_exact)
        expected = difference_image(*images, kind=kind, channel=channel)
        assert view.limit == pytest.approx(expected.limit, abs=1.01)
        shown = array_of(view.image).astype(float)
        assert shown.shape == expected.image.shape
        assert np.abs(shown - expected.image).mean() < 0.5
        QTest.qWait(80)
        seen = on_screen(pair)[:, : int(0.7 * shown.shape[1])]
        assert np.abs(seen - shown[:, : seen.shape[1]]).max() <= 1


def test_the_difference_follows_a_drag_becomes_exact_again_and_rests(
    pair: MainWindow, wait_for: Wait
) -> None:
    enter(pair, "difference", wait_for)
    view = pair.views.arrangement.difference
    wait_for(lambda: view.is_exact)
    shown: list[int] = []
    view.shown.connect(lambda: shown.append(view.image.cacheKey()))
    top = viewports(pair)[0]
    middle = top.rect().center()
    drag(top, middle, middle + QPoint(70, 20), steps=6)
    assert len(set(shown)) >= 4
    wait_for(lambda: view.is_exact and is_complete(pair))
    assert pair.store.scene.views[0].camera == pair.store.scene.views[1].camera
    # at rest nothing is drawn
    QTest.qWait(200)
    before = [viewport.frames for viewport in viewports(pair)]
    QTest.qWait(1000)
    assert [viewport.frames for viewport in viewports(pair)] == before


def test_a_fixed_scale_and_the_similarity_have_their_own_bar(pair: MainWindow, wait_for: Wait) -> None:
    pair.compare_commands.change(limit=32.0, map="absolute")
    enter(pair, "difference", wait_for)
    view = pair.views.arrangement.difference
    wait_for(lambda: view.is_exact)
    assert view.labels() == ("0", "16", "32")
    pair.compare_commands.change(map="ssim")
    wait_for(lambda: view.labels() == ("0", "0.5", "1"))
    # the label changes at once, the map once it is computed
    wait_for(lambda: array_of(view.image)[2, 2].tolist() == [255, 255, 255])
    similarity = array_of(view.image)
    assert similarity.min() < 128


@pytest.mark.parametrize("mode", ["wipe", "difference"])
def test_sizes_files_techniques_and_closing_leave_right_pictures(
    pair: MainWindow, other_file: str, wait_for: Wait, mode: Mode
) -> None:
    enter(pair, mode, wait_for)
    pair.resize(1000, 700)
    QTest.qWait(50)
    wait_for(lambda: is_complete(pair))
    pair.open(other_file)
    wait_for(lambda: pair.documents.volume.dimensions[0] == 24)
    choose_technique(pair.store, "slicing", view=1)
    wait_for(lambda: is_complete(pair))
    QTest.qWait(60)
    if mode == "difference":
        view = pair.views.arrangement.difference
        wait_for(lambda: view.is_exact)
        assert view.image.width() == pair.viewport.pixel_size[0]
        assert view.limit < 60
    left, right = (image_of(viewport) for viewport in viewports(pair))
    assert np.abs(left - right).mean() < 3
    assert np.abs(left - left[:, :1]).max() > 30
    pair.views.close_view(0)
    wait_for(lambda: is_complete(pair))
    QTest.qWait(50)
    assert [view.technique for view in pair.store.scene.views] == ["slicing"]
    assert pair.views.arrangement.difference.isHidden()
    assert pair.views.arrangement.divider.isHidden()
    assert pair.viewport.size() == pair.views.size()
    assert np.abs(on_screen(pair) - image_of(pair.viewport)).mean() < 1


def test_which_two_of_four_views_are_compared_is_said_and_can_be_chosen(
    window: MainWindow, wait_for: Wait
) -> None:
    window.commands["compare.four_views"].trigger()
    for view, technique in enumerate(("raycast", "isosurface", "slicing", "splatting")):
        choose_technique(window.store, technique, view=view)
    badges = [view_widget.header.badge for view_widget in window.views.view_widgets]
    look = window.compare_panel.look
    assert [badge.text() for badge in badges] == ["A", "B", "3", "4"]
    assert [box.currentText() for box in look.sides] == ["1  Ray casting", "2  Isosurface"]
    # the fourth as B by its badge, then a wipe: no other views are seen
    badges[3].menu().aboutToShow.emit()
    next(action for action in badges[3].menu().actions() if action.text().endswith("as B")).trigger()
    assert [badge.text() for badge in badges] == ["A", "2", "3", "B"]
    window.views.activate(2)
    enter(window, "wipe", wait_for)
    assert [view_widget.frame.isVisible() for view_widget in window.views.view_widgets] == [
        True,
        False,
        False,
        True,
    ]
    assert window.store.scene.active == 0
    assert "two of 4" in look.seen.text()
    seen = on_screen(window)
    half = window.views.width() // 2
    right = image_of(viewports(window)[3])[:, half + 12 :]
    assert np.abs(seen[:, half + 12 :] - right).max() <= 1
    # keys go from A to B, and choosing B as A exchanges the sides
    QTest.keyClick(window, "N")
    assert window.store.scene.active == 3
    look.sides[0].activated.emit(3)
    wait_for(lambda: is_complete(window))
    QTest.qWait(50)
    assert [badge.text() for badge in badges] == ["B", "2", "3", "A"]
    assert (
        np.abs(on_screen(window)[:, half + 12 :] - image_of(viewports(window)[0])[:, half + 12 :]).max() <= 1
    )
    # the difference of another pair is that of their exported images
    enter(window, "difference", wait_for)
    look.sides[0].activated.emit(1)
    view = window.views.arrangement.difference
    wait_for(lambda: is_complete(window) and view.is_exact)
    first, second = window.views.pair_images()
    assert window.store.scene.pair == (1, 0)
    expected = difference_image(first, second, kind="signed", limit=view.limit)
    assert np.abs(array_of(view.image).astype(float) - expected.image).mean() < 0.5
    assert view.caption().startswith("B \N{MINUS SIGN} A")
