"""Files open with the look that suits them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QToolButton

from tests.ui.conftest import foreground, image, is_complete
from volviz.custom_gl.scene_techniques import can_take_looks, current_settings, with_slices
from volviz.model.layers import ImageLayer, LabelLayer
from volviz.model.light import FROM_UPPER_LEFT
from volviz.model.looks.choice import looks
from volviz.model.scene import Scene
from volviz.volume_data.references import VolumeRef
from volviz_ui.app.main_window import MainWindow

pytestmark = pytest.mark.looks
Wait = Callable[..., None]


@pytest.fixture
def distances(tmp_path: Path) -> str:
    """A NumPy file of the distance from a sphere of radius 8 in 24^3 voxels."""
    place = np.indices((24, 24, 24)) - 11.5
    path = tmp_path / "distances.npy"
    np.save(path, (8.0 - np.sqrt((place**2).sum(axis=0))).astype(np.float32))
    return str(path)


def test_a_file_opens_lit_from_the_upper_left_in_one_step(
    bare_window: MainWindow, distances: str, ball_file: str, wait_for: Wait
) -> None:
    window = bare_window
    window.open(ball_file)
    wait_for(lambda: window.documents.volume is not None)
    before = window.store.scene
    window.open(distances)
    wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))
    wait_for(lambda: is_complete(window))
    assert window.store.scene.view.technique == "isosurface"
    assert current_settings(window.store.scene).isovalues == (0.0,)
    assert window.store.scene.light == FROM_UPPER_LEFT
    seen = foreground(window)
    rows, columns = np.nonzero(seen)
    middle, brightness = int(columns.mean()), image(window).mean(axis=2)
    left, right = seen.copy(), seen.copy()
    left[:, middle:] = right[:, :middle] = False
    assert brightness[left].mean() > 1.05 * brightness[right].mean()
    upper, lower = seen.copy(), seen.copy()
    upper[int(rows.mean()) :] = lower[: int(rows.mean())] = False
    assert brightness[upper].mean() > 1.05 * brightness[lower].mean()
    window.store.undo()
    assert window.store.scene.layers == before.layers
    assert window.store.scene.view.technique == before.view.technique


def test_slices_and_views_that_are_compared_keep_their_techniques(
    bare_window: MainWindow, distances: str, ball_file: str, wait_for: Wait
) -> None:
    window = bare_window
    window.open(ball_file)
    wait_for(lambda: window.documents.volume is not None)
    window.store.update(lambda scene: with_slices(scene, "large").with_view(0, technique="slicing"))
    window.open(distances)
    wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))
    assert [view.technique for view in window.store.scene.views] == ["isosurface", "slice", "slice", "slice"]
    window.store.undo()
    compared = ["splatting", "slicing"]
    window.store.update(lambda scene: scene.with_view_count(1).with_view_count(2))
    for number, technique in enumerate(compared):
        window.store.update(lambda scene, n=number, t=technique: scene.with_view(n, technique=t))
    wait_for(lambda: window.documents.volume.dimensions == (32, 32, 32))
    window.open(distances)
    wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))
    assert [view.technique for view in window.store.scene.views] == compared


def test_the_space_bar_takes_one_look_after_the_other_and_a_strip_shows_them(
    bare_window: MainWindow, distances: str, wait_for: Wait
) -> None:
    window, scene = bare_window, lambda: bare_window.store.scene
    window.open(distances)
    wait_for(lambda: window.documents.volume is not None)
    wait_for(lambda: is_complete(window))
    strip = window.look_commands.strip
    known = tuple(looks(window.documents.volume).values())
    seen = []
    for _ in known:
        seen.append(scene().layer.transfer_function)
        if len(seen) > 1:
            assert window.store.undo_label == f"Look: {known[len(seen) - 1].label}"
        before = scene()
        QTest.keyClick(window.viewport, Qt.Key.Key_Space)
        wait_for(lambda before=before: scene() is not before)
    assert seen == [look.transfer_function for look in known]
    assert scene().layer.transfer_function == seen[0]
    assert strip.isVisible()
    assert [button.text() for button in strip.buttons] == [look.label for look in known]
    assert [button.isChecked() for button in strip.buttons] == [True, *(len(known) - 1) * [False]]
    wait_for(lambda: all(_has_colours(button) for button in strip.buttons))
    window.store.undo()
    assert scene().layer.transfer_function == seen[-1]
    QTest.mouseClick(strip.buttons[1], Qt.MouseButton.LeftButton)
    assert scene().layer.transfer_function == seen[1]
    assert strip.buttons[1].isChecked()
    QTest.keyClick(window.viewport, Qt.Key.Key_Space, Qt.KeyboardModifier.ShiftModifier)
    wait_for(lambda: scene().layer.transfer_function == seen[0])


def _has_colours(button: QToolButton) -> bool:
    shown = button.icon().pixmap(104, 72).toImage()
    return len({shown.pixel(x, 36) for x in range(0, 104, 2)}) > 3


def test_the_space_bar_presses_the_button_that_has_the_focus(
    bare_window: MainWindow, ball_file: str, wait_for: Wait
) -> None:
    window = bare_window
    window.open(ball_file)
    wait_for(lambda: window.documents.volume is not None)
    before = window.store.scene
    button = window.transfer_editor.auto_button
    button.setFocus()
    pressed = []
    button.clicked.connect(lambda: pressed.append(True))
    QTest.keyClick(button, Qt.Key.Key_Space)
    assert pressed
    assert not window.look_commands.strip.isVisible()
    assert window.store.scene.view == before.view


def test_another_look_frames_what_it_shows_unless_somebody_has_turned_the_view(
    bare_window: MainWindow, tmp_path: Path, wait_for: Wait
) -> None:
    window = bare_window
    place = np.indices((24, 24, 24)) - 11.5
    radius = np.sqrt((place**2).sum(axis=0))
    path = tmp_path / "seed.npy"
    np.save(path, np.where(radius < 4, 1000, np.where(radius < 11, 40, -1000)).astype(np.int16))
    window.open(str(path))
    wait_for(lambda: window.documents.volume is not None)
    wait_for(lambda: is_complete(window))
    found = looks(window.documents.volume)
    window.look_commands.take(found["bone"])
    near = window.store.scene.view.camera
    window.look_commands.take(found["skin"])
    far = window.store.scene.view.camera
    assert far.distance > 1.5 * near.distance
    turned = far.turned(20.0)
    window.controller.show_camera(turned)
    window.look_commands.take(found["bone"])
    assert window.store.scene.view.camera.distance == pytest.approx(far.distance)


def test_looks_are_for_one_volume_in_one_view() -> None:
    image = ImageLayer(VolumeRef("a.nrrd"))
    labels = LabelLayer(VolumeRef("b.nrrd"))
    one = Scene((image,))
    assert can_take_looks(one)
    assert can_take_looks(with_slices(one, "large"))
    assert can_take_looks(replace(one, layers=(image, replace(labels, visible=False))))
    assert not can_take_looks(Scene())
    assert not can_take_looks(one.with_view_count(2))
    assert not can_take_looks(replace(one, layers=(image, labels)))
    assert not can_take_looks(replace(one, layers=(replace(image, visible=False),)))
