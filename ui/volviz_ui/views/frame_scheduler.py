"""Lets the image become complete a little at every turn of the event loop, and never during a gesture."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject, QTimer, Signal

from volviz.model.store import Store
from volviz_ui.session.gui_thread import Delivery

BUDGET_SECONDS = 0.03
"""Time of one turn; the window answers in between."""
WAITING_MS = 100
"""While the image waits for work in the background, it is asked this often how far that is."""


class QtFrameScheduler(QObject):
    """What the host calls when the image that it shows is not the complete one."""

    completed = Signal()
    """The complete image is ready to be shown."""
    failed = Signal(object)
    frame_wanted = Signal()
    """There is more to be seen during a gesture."""

    def __init__(self, store: Store, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._store = store
        self._handle: Any = None
        self._paused = False
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.timeout.connect(self._turn)
        self._deliver_wake = Delivery(self._on_woken)

    def request(self, handle: Any) -> None:
        """Called by the host while it draws an incomplete image."""
        self._handle = handle
        self.go_on()

    def wake(self, _handle: Any) -> None:
        """Called by the host, on any thread, when something is ready for which the image has waited."""
        self._deliver_wake()

    def _on_woken(self) -> None:
        if self._store.is_interacting:
            self.frame_wanted.emit()
        else:
            self.go_on()

    def pause(self) -> None:
        """Somebody else completes the image, until `resume`: frame times are being measured."""
        self._paused = True
        self._timer.stop()

    def resume(self) -> None:
        """Nobody else does any more."""
        self._paused = False
        self.go_on()

    def go_on(self) -> None:
        """Take up what was left when a gesture began."""
        if self._may_draw:
            self._timer.start(0)

    @property
    def _may_draw(self) -> bool:
        return self._handle is not None and not self._paused and not self._store.is_interacting

    @property
    def is_busy(self) -> bool:
        """Whether an image is being completed."""
        return self._timer.isActive()

    def stop(self) -> None:
        """Forget the handle: it is about to be removed."""
        self._timer.stop()
        self._handle = None

    def _turn(self) -> None:
        if not self._may_draw:
            return
        try:
            done = self._handle.refine(budget=BUDGET_SECONDS)
        except Exception as error:  # noqa: BLE001 - whatever drawing raises is shown, the window goes on
            self.stop()
            self.failed.emit(error)
            return
        if done:
            self._handle = None
            self.completed.emit()
        elif not self._timer.isActive():
            self._timer.start(WAITING_MS if self._handle.is_waiting else 0)
