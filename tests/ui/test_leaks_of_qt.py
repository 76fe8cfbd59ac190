"""The leak checks find windows, timers and threads of Qt, and the application is made as the program's is."""

from __future__ import annotations

import pytest
import shiboken6
from PySide6.QtCore import QObject, Qt, QThread, QTimer
from PySide6.QtWidgets import QApplication, QWidget

from tests import leaks

pytestmark = pytest.mark.leaks_allowed("these tests look after their own leaks")


def test_contexts_are_shared(qapp: QApplication) -> None:
    assert qapp.testAttribute(Qt.ApplicationAttribute.AA_ShareOpenGLContexts)
    assert qapp.platformName() in {"xcb", "cocoa", "windows"}


def test_a_window_left_open_is_found(qapp: QApplication) -> None:
    watch = leaks.Watch(objects=True)
    window = QWidget()
    assert "QWidget" in "\n".join(watch.leaks())
    window.deleteLater()
    assert watch.leaks() == []
    assert not shiboken6.isValid(window)


def test_a_running_timer_is_found(qapp: QApplication) -> None:
    watch = leaks.Watch(objects=True)
    owner = QObject()
    timer = QTimer(owner, objectName="blinker")
    timer.start(1000)
    assert "'blinker'" in "\n".join(watch.leaks())
    timer.stop()
    assert watch.leaks() == []


def test_a_running_thread_of_qt_is_found(qapp: QApplication) -> None:
    watch = leaks.Watch(objects=True)
    thread = QThread(objectName="loader")
    thread.start()
    assert "QThread 'loader' is still running" in "\n".join(watch.leaks())
    thread.quit()
    assert thread.wait(2000)
    assert watch.leaks() == []
