"""The window for tests: its own settings, a small volume, real events."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QByteArray, QEvent, QPoint, QPointF, QSettings, Qt
from PySide6.QtGui import QImage, QMouseEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMessageBox, QWidget

from tests.leaks import Watch
from tests.screens import NO_DISPLAY, window_can_open
from volviz.annotations.background import background_image
from volviz.custom_gl.scene_techniques import current_settings, current_technique
from volviz.custom_gl.vtk.handle import VolumeHandle
from volviz.model.looks.look import Look
from volviz.model.scene import Scene
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.volume import Volume
from volviz_ui.app.main_window import MainWindow
from volviz_ui.panels.form_cache import FormCache
from volviz_ui.session import opening
from volviz_ui.session.preferences import Preferences
from volviz_ui.style.theme import Theme
from volviz_ui.views.viewport import Viewport

#: Width and height of the window in pixels.
WINDOW_SIZE = (960, 660)


@pytest.fixture(scope="session", autouse=True)
def display() -> None:
    """Refuse in words what Qt would end with "Aborted"."""
    if not window_can_open():
        pytest.fail(NO_DISPLAY, pytrace=False)


@pytest.fixture(scope="session")
def theme(qapp: QApplication) -> Theme:
    """One theme for all windows, as in the program."""
    return Theme(qapp, "dark")


@pytest.fixture(autouse=True)
def only_the_first_image(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """The full image is the last one, except where what follows it at rest is looked at (``accumulates``)."""
    if request.node.get_closest_marker("accumulates") is None:
        monkeypatch.setattr(VolumeHandle, "accumulates", False)


@pytest.fixture(autouse=True)
def files_open_plainly(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Files are ray cast with their automatic function, except where their looks are looked at (``looks``)."""
    if request.node.get_closest_marker("looks") is None:
        monkeypatch.setattr(opening, "best_look", plain_look)


def plain_look(volume: Volume) -> Look:
    """What `volviz.render` draws without a word."""
    return Look("plain", "Plain", "Ray cast, unlit.", TransferFunction.auto(volume))


@pytest.fixture(autouse=True)
def no_forms_in_advance(monkeypatch: pytest.MonkeyPatch) -> None:
    """Forms of techniques that a test does not look at are not made."""
    monkeypatch.setattr(FormCache, "builds_ahead", False)


@pytest.fixture
def preferences(tmp_path: Path) -> Preferences:
    """Settings in a file of the test's own."""
    return Preferences(QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat))


@pytest.fixture
def ball_file(tmp_path: Path) -> str:
    """A NumPy file of a ball of radius 12 in 32^3 voxels, 200 inside and 0 outside, brighter to the right."""
    return str(save_ball(tmp_path / "ball.npy", 200))


@pytest.fixture
def other_file(tmp_path: Path) -> str:
    """A second, smaller volume."""
    return str(save_ball(tmp_path / "other.npy", 120, size=24))


def save_ball(path: Path, value: int, *, size: int = 32) -> Path:
    """Write a ball as uint8 array (Z, Y, X); outside it there is a faint ramp along x."""
    z, y, x = np.indices((size, size, size)) - (size - 1) / 2
    ball = np.where(x**2 + y**2 + z**2 < (0.375 * size) ** 2, value, 0).astype(np.uint8)
    np.save(path, ball)
    return path


@contextmanager
def made_window(app: QApplication, theme: Theme, preferences: Preferences) -> Iterator[MainWindow]:
    """The window, shown, without a volume; taken down at the end."""
    preferences.asks_about_changes = False
    window = MainWindow(theme, preferences)
    window.resize(*WINDOW_SIZE)
    window.show()
    assert QTest.qWaitForWindowExposed(window)
    # keys reach their commands in the active window only
    window.activateWindow()
    assert QTest.qWaitForWindowActive(window)
    yield window
    for box in window.findChildren(QMessageBox):
        box.close()
    preferences.asks_about_changes = False
    window.close()
    window.deleteLater()
    settle(app)
    # pytest holds the fixture's value until after the search for leaks; what hangs on it must not look leaked
    vars(window).clear()


@pytest.fixture
def bare_window(qapp: QApplication, theme: Theme, preferences: Preferences) -> Iterator[MainWindow]:
    """The window, shown, without a volume."""
    with made_window(qapp, theme, preferences) as window:
        yield window


@pytest.fixture
def window(bare_window: MainWindow, ball_file: str, wait_for: Callable[..., None]) -> MainWindow:
    """The window with the ball, fully drawn."""
    bare_window.open(ball_file)
    wait_for(lambda: bare_window.documents.volume is not None)
    wait_for(lambda: is_complete(bare_window))
    return bare_window


@pytest.fixture(scope="module")
def window_of_the_file(
    qapp: QApplication, theme: Theme, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[tuple[MainWindow, Scene, QByteArray]]:
    """One window with the ball for all tests of a file, and the scene and the docks that it opened with.

    What it leaves behind is looked for when the file ends; its tests are marked `leaks_allowed`.
    """
    watch = Watch(objects=True)
    folder = tmp_path_factory.mktemp("window")
    preferences = Preferences(QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat))
    with pytest.MonkeyPatch.context() as patch, made_window(qapp, theme, preferences) as window:
        patch.setattr(VolumeHandle, "accumulates", False)
        patch.setattr(FormCache, "builds_ahead", False)
        patch.setattr(opening, "best_look", plain_look)
        window.open(str(save_ball(folder / "ball.npy", 200)))
        run_until(lambda: window.documents.volume is not None)
        run_until(lambda: is_complete(window))
        yield window, window.store.scene, window.saveState()
    if leaks := watch.leaks():
        pytest.fail("The window left behind:\n  " + "\n  ".join(leaks), pytrace=False)


@pytest.fixture
def same_window(qapp: QApplication, window_of_the_file: tuple[MainWindow, Scene, QByteArray]) -> MainWindow:
    """The window of the file with the scene, docks, size and history that it began with, fully drawn.

    For tests that are not about how a window begins or ends; a new one takes a second.
    """
    window, scene, docks = window_of_the_file
    settle(qapp)
    window.resize(*WINDOW_SIZE)
    window.restoreState(docks)
    window.store.update(scene, record=False)
    window.store.clear_history()
    window.activateWindow()
    assert QTest.qWaitForWindowActive(window)
    run_until(lambda: is_complete(window))
    return window


@pytest.fixture
def first_full_images(monkeypatch: pytest.MonkeyPatch) -> None:
    """No images that follow the full one and make it smoother: two views can be compared to the last bit."""
    monkeypatch.setattr(VolumeHandle, "accumulates", False)


def run_until(condition: Callable[[], object], seconds: float = 120.0) -> None:
    """Run the event loop until something holds; fails when it never does.

    Two minutes, since kernels may have to be compiled first, on a machine that runs other tests beside.
    """
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not happen in time"
        QTest.qWait(5)


@pytest.fixture
def wait_for(qapp: QApplication) -> Callable[..., None]:
    """`run_until`, once there is an application."""
    return run_until


def settle(app: QApplication) -> None:
    """Deliver what is pending, deletions included."""
    for _ in range(3):
        app.sendPostedEvents(None, QEvent.Type.DeferredDelete)
        app.processEvents()


@pytest.fixture
def window_with_slices(same_window: MainWindow) -> MainWindow:
    """The window of the file with three slices beside the volume, fully drawn."""
    same_window.commands["view.slices.grid"].trigger()
    run_until(lambda: len(same_window.views.view_widgets) == 4 and is_complete(same_window))
    return same_window


def viewport(window: MainWindow, view: int) -> Viewport:
    """Where a view is shown, by its number."""
    return window.views.view_widgets[view].viewport


def is_complete(window: MainWindow) -> bool:
    """Whether the image of the present state is there."""
    return window.views.is_complete


def image(window: MainWindow) -> np.ndarray:
    """The viewport without what is painted over it, shape (H, W, 3), float 0..255."""
    return values(window.viewport.grabFramebuffer())


def values(picture: QImage) -> np.ndarray:
    """Colours of an image of Qt, shape (H, W, 3), float 0..255."""
    grabbed = picture.convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(grabbed.constBits(), np.uint8).reshape(grabbed.height(), grabbed.bytesPerLine())
    return rows[:, : 3 * grabbed.width()].reshape(grabbed.height(), grabbed.width(), 3).astype(float)


def foreground(window: MainWindow) -> np.ndarray:
    """Pixels in which the volume stands out from the background, without the orientation marker's corner."""
    grabbed = image(window)
    seen = np.abs(grabbed - grabbed[:, :1]).max(axis=2) > 12
    seen[int(0.75 * len(seen)) :, : int(0.2 * seen.shape[1])] = False
    return seen


def drag(
    widget: QWidget,
    start: QPoint,
    end: QPoint,
    *,
    button: Qt.MouseButton = Qt.MouseButton.LeftButton,
    modifiers: Qt.KeyboardModifier = Qt.KeyboardModifier.NoModifier,
    steps: int = 6,
) -> None:
    """Press, move in steps, release."""
    QTest.mousePress(widget, button, modifiers, start)
    for step in range(1, steps + 1):
        position = start + (end - start) * step / steps
        event = QMouseEvent(
            QEvent.Type.MouseMove,
            QPointF(position),
            QPointF(widget.mapToGlobal(position)),
            Qt.MouseButton.NoButton,
            button,
            modifiers,
        )
        QApplication.sendEvent(widget, event)
        QTest.qWait(5)
    QTest.mouseRelease(widget, button, modifiers, end)


def turn_wheel(
    widget: QWidget,
    notches: int,
    modifiers: Qt.KeyboardModifier = Qt.KeyboardModifier.NoModifier,
) -> None:
    """Turn the wheel over the middle of a widget."""
    middle = widget.rect().center()
    event = QWheelEvent(
        QPointF(middle),
        QPointF(widget.mapToGlobal(middle)),
        QPoint(0, 0),
        QPoint(0, 120 * notches),
        Qt.MouseButton.NoButton,
        modifiers,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    QApplication.sendEvent(widget, event)


def drawn_image(scene: Scene, volume: Volume, size: tuple[int, int], *, transparent: bool) -> np.ndarray:
    """What the scene shows, drawn anew.

    Parameters
    ----------
    size : tuple of 2 ints
        Width and height in pixels.
    transparent : bool
        Without the background of the viewport.

    Returns
    -------
    ndarray of shape (H, W, 4), uint8
        Red, green, blue, straight alpha; row 0 at the top.
    """
    from volviz.renderer import render

    image = render(
        volume,
        current_technique(scene).id,
        transfer_function=scene.layer.transfer_function if scene.layer else None,
        size=size,
        camera=scene.view.camera,
        dtype="float32",
        settings=current_settings(scene),
        light=scene.light,
        clipping=scene.clipping,
    )
    if not transparent:
        alpha = image[..., 3:]
        behind = background_image(scene.background, size)
        image[..., :3] = image[..., :3] * alpha + (1 - alpha) * behind
        image[..., 3] = 1.0
    return np.rint(np.clip(image, 0, 1) * 255).astype(np.uint8)
