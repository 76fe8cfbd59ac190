"""Time in the window: each picture is that of the time point beside it, whatever is played, dragged and undone."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

import volviz
from tests.ui.conftest import is_complete
from volviz.model.auto_isovalue import auto_isovalue
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.array_source import ArraySource
from volviz_ui.app.main_window import MainWindow

Wait = Callable[..., None]

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")

COUNT = 6
#: Opaque, and as bright as the value.
GREY = TransferFunction.from_points([(0.0, (0.0, 0.0, 0.0, 1.0)), (255.0, (1.0, 1.0, 1.0, 1.0))])


def brightness(number: int) -> int:
    """Value of all voxels of a time point."""
    return 30 + 40 * number


@pytest.fixture
def film(tmp_path: Path) -> Path:
    """Time points whose voxels tell their number, a quarter of a second apart."""
    array = np.empty((COUNT, 40, 40, 40), np.uint8)
    array[:] = np.array([brightness(n) for n in range(COUNT)], np.uint8)[:, None, None, None]
    source = ArraySource(array, times=tuple(0.25 * n for n in range(COUNT)), name="film")
    volviz.save(source, tmp_path / "film.ome.tif")
    return tmp_path / "film.ome.tif"


@pytest.fixture
def window(same_window: MainWindow, film: Path, wait_for: Wait) -> Iterator[MainWindow]:
    same_window.open(str(film))
    wait_for(lambda: same_window.player.count == COUNT)
    same_window.store.update(lambda scene: scene.with_layer(transfer_function=GREY), label="grey")
    wait_for(lambda: is_complete(same_window))
    yield same_window
    same_window.player.pause()
    same_window.player.repeat = "loop"


@pytest.fixture
def seen(window: MainWindow) -> Iterator[list[tuple[int, int]]]:
    """For every frame that the window draws: the time point beside the picture, and the one in it."""
    found: list[tuple[int, int]] = []

    def look() -> None:
        image = window.controller.handle.present_image()
        value = 255.0 * image[image.shape[0] // 2, image.shape[1] // 2, 0]
        found.append((window.player.seen, round((value - brightness(0)) / 40)))

    window.views.drawn.connect(look)
    yield found
    window.views.drawn.disconnect(look)


def test_while_time_runs_no_picture_is_mixed_or_stale(
    window: MainWindow, seen: list[tuple[int, int]], wait_for: Wait
) -> None:
    player, steps = window.player, window.store.undo_label
    assert player.speed == 4.0
    player.set_speed(60.0)
    QTest.keyClick(window, Qt.Key.Key_K)
    assert player.is_playing
    wait_for(lambda: len(set(seen)) == COUNT)
    wait_for(lambda: [shown for shown, _ in seen].count(0) > 0)
    # nobody counts the values of pictures that pass
    assert window.data_panel.histogram.words == "Waits while time runs"
    QTest.keyClick(window, Qt.Key.Key_K)
    assert not player.is_playing
    wait_for(lambda: is_complete(window))
    assert all(beside == inside for beside, inside in seen)
    numbers = [number for number, before in zip(seen[1:], seen, strict=False) if number != before]
    assert all((b[0] - a[0]) % COUNT == 1 for a, b in itertools.pairwise(numbers))
    wait_for(lambda: window.data_panel.histogram.counts is not None)
    # all of it is one step of the history
    window.documents.undo()
    wait_for(lambda: player.seen == 0)
    assert window.store.undo_label == steps


def test_back_and_forth_and_stopping_at_the_end(
    window: MainWindow, seen: list[tuple[int, int]], wait_for: Wait
) -> None:
    player = window.player
    player.set_speed(60.0)
    player.repeat = "once"
    player.play()
    wait_for(lambda: not player.is_playing)
    assert player.seen == COUNT - 1
    player.repeat = "ping-pong"
    player.play()
    seen.clear()
    wait_for(lambda: {0, COUNT - 1} <= {number for number, _ in seen})
    assert player.is_playing
    assert all(beside == inside for beside, inside in seen)


def test_dragging_the_slider_is_one_step_and_keys_step(
    window: MainWindow, seen: list[tuple[int, int]], wait_for: Wait
) -> None:
    slider, player = window.time_bar.slider, window.player
    slider.setSliderDown(True)
    for number in (3, 1, 5):
        slider.setValue(number)
    slider.setSliderDown(False)
    wait_for(lambda: player.seen == 5)
    wait_for(lambda: not window.store.is_interacting)
    wait_for(lambda: is_complete(window))
    assert seen[-1] == (5, 5)
    for key, number in ((Qt.Key.Key_Comma, 4), (Qt.Key.Key_Period, 5), (Qt.Key.Key_Period, 0)):
        QTest.keyClick(window, key)
        wait_for(lambda number=number: player.seen == number)
    wait_for(lambda: not window.store.is_interacting)
    assert all(beside == inside for beside, inside in seen)
    window.documents.undo()
    wait_for(lambda: player.seen == 5)
    window.documents.undo()
    wait_for(lambda: player.seen == 0)


@pytest.mark.parametrize(
    ("choice", "factors"), [("fixed", [1, 1, 1]), ("widest", [1, 3, 3]), ("each", [1, 3, 2])]
)
def test_colours_follow_the_values_as_was_chosen(
    window: MainWindow, tmp_path: Path, wait_for: Wait, choice: str, factors: list[int]
) -> None:
    ramp = np.arange(16.0)[None, None, :] + np.zeros((16, 16, 16))
    np.save(tmp_path / "brighter.npy", np.stack([ramp * factor for factor in (1, 3, 2)]).astype(np.float32))
    window.documents.open(str(tmp_path / "brighter.npy"))
    wait_for(lambda: window.player.count == 3)
    window.player.set_time_range(choice)
    first = window.store.scene.layer.transfer_function
    isovalues = []
    for number, factor in enumerate(factors):
        window.player.show(number)
        wait_for(lambda number=number: window.player.seen == number)
        found = [point.value for point in window.store.scene.layer.transfer_function.points]
        np.testing.assert_allclose(found, [factor * point.value for point in first.points], rtol=0.02)
        isovalues.append(auto_isovalue(window.documents.volume))
    assert (len(set(isovalues)) == 1) == (choice == "fixed")
    window.player.set_time_range("fixed")


def test_memory_for_time_points_is_limited(window: MainWindow, wait_for: Wait) -> None:
    frames, player = window.documents.frames, window.player
    frames.clear()
    frames.budget = 500_000
    try:
        for number in range(COUNT):
            player.show(number)
            wait_for(lambda number=number: player.seen == number)
            assert frames.size <= frames.budget
    finally:
        frames.budget = 384 << 20


def test_meshes_are_waited_for(window: MainWindow, tmp_path: Path, wait_for: Wait) -> None:
    """The time beside a surface changes with the surface."""
    z, y, x = np.indices((32, 32, 32)) - 15.5
    distance = np.sqrt(x**2 + y**2 + z**2)
    array = np.stack([np.clip(100 + 10 * (radius - distance), 0, 255) for radius in (6, 9, 12)])
    np.save(tmp_path / "growing.npy", array.astype(np.uint8))
    window.documents.open(str(tmp_path / "growing.npy"))
    wait_for(lambda: window.player.count == 3)
    window.store.update(lambda scene: scene.with_view(technique="marching_cubes"), label="surface")
    wait_for(lambda: is_complete(window))
    sizes = {}

    def look() -> None:
        image = window.controller.handle.present_image()
        sizes.setdefault(window.player.seen, []).append(float((image[..., 3] > 0.5).mean()))

    window.views.drawn.connect(look)
    window.player.set_speed(60.0)
    window.player.play()
    wait_for(lambda: all(len(sizes.get(n, ())) > 1 for n in range(3)))
    window.views.drawn.disconnect(look)
    window.player.pause()
    assert max(sizes[0]) < min(sizes[1])
    assert max(sizes[1]) < min(sizes[2])
    wait_for(lambda: is_complete(window))
