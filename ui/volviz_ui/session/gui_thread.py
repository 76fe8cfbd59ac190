"""From any thread to the GUI thread."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from functools import partial
from typing import Any

from PySide6.QtCore import QObject, Qt, Signal, Slot
from shiboken6 import isValid


class _Post(QObject):
    """Lives as long as the process: a thread must never emit a signal of an object that the window may delete."""

    sent = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.sent.connect(self._deliver, Qt.ConnectionType.QueuedConnection)

    @Slot(object)
    def _deliver(self, call: Callable[[], None]) -> None:
        call()


_POST = _Post()


class Delivery:
    """A method to be called on the GUI thread; calling the delivery itself is allowed on any thread.

    The method runs in a later turn of the event loop, unless its object has gone by then: nothing here keeps it alive.

    Parameters
    ----------
    method : callable
        Bound method of a QObject of the GUI thread.
    """

    def __init__(self, method: Callable[..., Any]) -> None:
        self._method = weakref.WeakMethod(method)

    def __call__(self, *arguments: Any) -> None:
        """Ask for the call, with these arguments."""
        _POST.sent.emit(partial(self._deliver, arguments))

    def _deliver(self, arguments: tuple[Any, ...]) -> None:
        method = self._method()
        if method is not None and isValid(method.__self__):
            method(*arguments)
