"""Long work of the window: progress, results and errors arrive on the GUI thread; for one purpose the newest wins."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any

from PySide6.QtCore import QObject, QTimer, Signal, Slot

from volviz.errors import Cancelled
from volviz.tasks import BackgroundTask, Cancel, Progress, Tasks
from volviz_ui.session.gui_thread import Delivery

THREADS = 2
"""Two: a cancelled load that has not noticed yet must not hold up the next one."""


class Task(QObject):
    """One piece of work. Its signals arrive on the GUI thread; after `cancel` none arrives but `ended`."""

    progressed = Signal(float, str)
    """Fraction done (below 0: unknown), and what is being done."""
    published = Signal(object)
    """What the work knows before its end."""
    succeeded = Signal(object)
    failed = Signal(object)
    ended = Signal()

    def __init__(self, parent: QObject, function: Callable[[Task], Any], label: str) -> None:
        super().__init__(parent)
        self.label = label
        self._function: Callable[[Task], Any] | None = function
        self._is_cancelled = False
        self._work: BackgroundTask[Any] | None = None
        self._progress = Delivery(self._on_progress)
        self._publish = Delivery(self._on_published)

    @property
    def is_cancelled(self) -> bool:
        """Asked by the work itself, from any thread."""
        return self._is_cancelled or (self._work is not None and self._work.is_cancelled)

    def cancel(self) -> None:
        """Ask the work to stop; its result is dropped in any case."""
        self._is_cancelled = True
        if self._work is not None:
            self._work.cancel()

    def report(self, fraction: float, text: str = "") -> None:
        """Called by the work: how far it is. Raises `Cancelled` when nobody waits for it any more."""
        self._check()
        self._progress(fraction, text)

    def publish(self, result: object) -> None:
        """Called by the work: what it knows so far. Raises `Cancelled` when nobody waits for it any more."""
        self._check()
        self._publish(result)

    def _check(self) -> None:
        if self.is_cancelled:
            raise Cancelled("The work was cancelled.")

    def begin(self, tasks: Tasks, key: Hashable | None) -> None:
        """Have the work done in the background."""
        self._work = tasks.start(key, self._run, Delivery(self._on_done))

    def _run(self, _progress: Progress, _cancel: Cancel) -> Any:
        self._check()
        assert self._function is not None
        return self._function(self)

    def _on_progress(self, fraction: float, text: str) -> None:
        if not self.is_cancelled:
            self.progressed.emit(fraction, text)

    def _on_published(self, result: object) -> None:
        if not self.is_cancelled:
            self.published.emit(result)

    def _on_done(self, work: BackgroundTask[Any]) -> None:
        if not self.is_cancelled:
            if work.error is None:
                self.succeeded.emit(work.result())
            elif not isinstance(work.error, Cancelled):
                self.failed.emit(work.error)
        self._function = None  # lets go of everything the work referred to
        self.ended.emit()
        self.deleteLater()


class Gate(QObject):
    """Keeps work that nobody waits for from taking the processor while a first image is drawn."""

    opened = Signal()
    TIMEOUT_MS = 1500
    """Longest time that it stays shut: some images take minutes."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(self.TIMEOUT_MS)
        self._timer.timeout.connect(self.open)
        self.is_open = True
        self.is_held = False

    def shut(self) -> None:
        """Something urgent begins."""
        self.is_open = False
        self._timer.start()

    def open(self) -> None:
        """It is over; a second call does nothing."""
        self._timer.stop()
        if not self.is_open and not self.is_held:
            self.is_open = True
            self.opened.emit()

    def hold(self) -> None:
        """Keep it shut until `release`, whatever has been drawn: time runs."""
        self.is_held, self.is_open = True, False

    def release(self) -> None:
        """It opens again with the next full image, or when its time is over."""
        self.is_held = False
        self._timer.start()


class Workers(QObject):
    """The window's tasks in the background."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._gate: Gate | None = None
        self._waiting: list[tuple[Task, Hashable | None]] = []
        self._pool = Tasks(threads=THREADS)
        self._tasks: dict[Task, Hashable | None] = {}
        self.destroyed.connect(self._pool.close)

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
            self._waiting.append((task, key))
        else:
            task.begin(self._pool, key)
        return task

    @Slot()
    def _on_gate_opened(self) -> None:
        waiting, self._waiting = self._waiting, []
        for task, key in waiting:
            # cancelled ones too: they end as the others do
            task.begin(self._pool, None if task.is_cancelled else key)

    def cancel(self, key: Hashable) -> None:
        """Cancel the work for that purpose."""
        for task, other in self._tasks.items():
            if other == key:
                task.cancel()
        # what waits at the gate ends at once: it would keep its data until the gate is opened
        dropped = [task for task, other in self._waiting if other == key and task.is_cancelled]
        self._waiting = [pair for pair in self._waiting if pair[0] not in dropped]
        for task in dropped:
            task.begin(self._pool, None)

    @property
    def is_busy(self) -> bool:
        """Whether any work is waited for."""
        return any(not task.is_cancelled for task in self._tasks)

    def close(self) -> None:
        """Cancel everything; nothing is delivered any more, and the threads end by themselves."""
        for task in self._tasks:
            task.cancel()
        self._waiting.clear()
        self._pool.close()

    @Slot()
    def _forget(self) -> None:
        self._tasks.pop(self.sender(), None)  # type: ignore[call-overload]
