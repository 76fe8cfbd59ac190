"""The window at rest: a few more images make the shown one smoother, and then nothing is drawn any more."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from PySide6.QtCore import QPoint
from PySide6.QtTest import QTest

from tests.ui.conftest import drag, image, is_complete
from volviz_ui.app.main_window import MainWindow

Wait = Callable[..., None]

pytestmark = pytest.mark.accumulates


def at_rest(window: MainWindow) -> bool:
    """Whether nothing more will be drawn."""
    controller = window.controller
    return is_complete(window) and not controller.handle.is_accumulating and not controller.scheduler.is_busy


def test_further_pictures_follow_the_complete_one_and_end(window: MainWindow, wait_for: Wait) -> None:
    # complete with the first full image, which is what the fixture has waited for
    wait_for(lambda: at_rest(window))
    assert window.controller.status.samples in (3, 5, 9)
    assert window.controller.status.complete
    before = window.viewport.frames
    QTest.qWait(1000)
    assert window.viewport.frames == before


def test_a_drag_takes_precedence_and_the_mean_comes_again(window: MainWindow, wait_for: Wait) -> None:
    wait_for(lambda: at_rest(window))
    before = image(window)
    middle = window.viewport.rect().center()
    drag(window.viewport, middle, middle + QPoint(60, 0), steps=4)
    wait_for(lambda: is_complete(window))
    wait_for(lambda: at_rest(window))
    assert window.controller.status.samples in (3, 5, 9)
    assert np.abs(image(window) - before).max() > 10
    assert not window.controller.handle.error
