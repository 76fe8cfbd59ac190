"""Long work off the GUI thread: progress, cancel, errors brought back; for one purpose the newest wins."""

from __future__ import annotations

import threading
from collections.abc import Callable, Hashable
from typing import Any

from PySide6.QtCore import QObject, QRunnable, QThreadPool, QTimer, Signal, Slot

from volviz.errors import Cancelled

THREADS = 2
"""Two: a cancelled load that has not noticed yet must not hold up the next one."""


class _Relay(QObject):
    """Carries what happens on a worker to the GUI thread (queued, since the receiver lives there)."""

    progress = Signal(float, str)
    finished = Signal(object)
    failed = Signal(object)


class Task(QObject):
    """One piece of work. Its signals arrive on the GUI thread; after `cancel` none arrives but `ended`."""

    progressed = Signal(float, str)
    """Fraction done (below 0: unknown), and what is being done."""
    succeeded = Signal(object)
    failed = Signal(object)
    ended = Signal()

    def __init__(self, parent: QObject, function: Callable[[Task], Any], label: str) -> None:
        super().__init__(parent)
        self.label = label
        self._function = function
        self._cancel = threading.Event()
        self._relay = _Relay()
        self._relay.progress.connect(self._on_progress)
        self._relay.finished.connect(self._on_finished)
        self._relay.failed.connect(self._on_failed)

    @property
    def is_cancelled(self) -> bool:
        """Asked by the work itself, from any thread."""
        return self._cancel.is_set()

    def cancel(self) -> None:
        """Ask the work to stop; its result is dropped in any case."""
        self._cancel.set()

    def report(self, fraction: float, text: str = "") -> None:
        """Called by the work: how far it is. Raises `Cancelled` when nobody waits for it any more."""
        if self.is_cancelled:
            raise Cancelled("The work was cancelled.")
        self._relay.progress.emit(fraction, text)

    def run(self) -> None:
        """Do the work; called on a worker thread."""
        try:
            if self.is_cancelled:
                raise Cancelled("The work was cancelled.")
            result = self._function(self)
        except BaseException as error:  # noqa: BLE001 - whatever it is belongs to the GUI thread, not to the pool
            self._relay.failed.emit(error)
        else:
            self._relay.finished.emit(result)

    @Slot(float, str)
    def _on_progress(self, fraction: float, text: str) -> None:
        if not self.is_cancelled:
            self.progressed.emit(fraction, text)

    @Slot(object)
    def _on_finished(self, result: Any) -> None:
        if not self.is_cancelled:
            self.succeeded.emit(result)
        self._end()

    @Slot(object)
    def _on_failed(self, error: BaseException) -> None:
        if not self.is_cancelled and not isinstance(error, Cancelled):
            self.failed.emit(error)
        self._end()

    def _end(self) -> None:
        self._function = lambda _task: None  # lets go of everything the work referred to
        self.ended.emit()
        self.deleteLater()


class _Runnable(QRunnable):
    def __init__(self, task: Task) -> None:
        super().__init__()
        self._task: Task | None = task

    def run(self) -> None:
        task, self._task = self._task, None
        if task is not None:
            task.run()


class Gate(QObject):
    """Keeps work that nobody waits for from taking the processor while a first picture is drawn."""

    opened = Signal()
    PATIENCE_MS = 1500
    """Longest time that it stays shut: some pictures take minutes."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(self.PATIENCE_MS)
        self._timer.timeout.connect(self.open)
        self.is_open = True

    def shut(self) -> None:
        """Something urgent begins."""
        self.is_open = False
        self._timer.start()

    def open(self) -> None:
        """It is over; a second call does nothing."""
        self._timer.stop()
        if not self.is_open:
            self.is_open = True
            self.opened.emit()


class Workers(QObject):
    """The window's pool of threads."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._gate: Gate | None = None
        self._waiting: list[Task] = []
        self._pool = QThreadPool(self)
        self._pool.setMaxThreadCount(THREADS)
        self._tasks: dict[Task, Hashable | None] = {}

    @property
    def gate(self) -> Gate | None:
        """Where patient work waits; None lets it begin at once."""
        return self._gate

    @gate.setter
    def gate(self, gate: Gate) -> None:
        self._gate = gate
        gate.opened.connect(self._on_gate_opened)

    def start(
        self,
        function: Callable[[Task], Any],
        *,
        label: str = "",
        key: Hashable | None = None,
        patient: bool = False,
    ) -> Task:
        """Run `function(task)` on a worker.

        Parameters
        ----------
        function : callable
            The work; calls ``task.report`` now and then, returns the result.
        label : str
            What is done, for people.
        key : hashable, optional
            Purpose; running work for the same purpose is cancelled, the newest wins.
        patient : bool
            Nobody waits for it: it begins when the gate is open.

        Returns
        -------
        Task
            Connect to its signals at once.
        """
        if key is not None:
            self.cancel(key)
        task = Task(self, function, label)
        self._tasks[task] = key
        task.ended.connect(self._forget)
        if patient and self._gate is not None and not self._gate.is_open:
            self._waiting.append(task)
        else:
            self._pool.start(_Runnable(task))
        return task

    @Slot()
    def _on_gate_opened(self) -> None:
        waiting, self._waiting = self._waiting, []
        for task in waiting:
            # cancelled ones too: they end as the others do
            self._pool.start(_Runnable(task))

    def cancel(self, key: Hashable) -> None:
        """Cancel the work for that purpose."""
        for task, other in self._tasks.items():
            if other == key:
                task.cancel()

    @property
    def is_busy(self) -> bool:
        """Whether any work is waited for."""
        return any(not task.is_cancelled for task in self._tasks)

    def close(self) -> None:
        """Cancel everything and wait until the threads have ended."""
        for task in self._tasks:
            task.cancel()
        self._waiting.clear()
        self._pool.clear()
        self._pool.waitForDone()

    @Slot()
    def _forget(self) -> None:
        self._tasks.pop(self.sender(), None)  # type: ignore[call-overload]
