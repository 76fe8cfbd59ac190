"""Work on threads of its own, so that whoever draws or answers the user never waits for it.

A task does its work, keeps what came of it (a result or an error) and calls back. The owner of several holds them in
`Tasks`, where the newest of a key counts; `LatestResult` keeps the results of one key for as long as they are wanted.
Kernels that cut one computation into pieces for all processors (`volviz.kernels.threads`) are another matter: their
caller waits for the whole.
"""

from __future__ import annotations

import atexit
import threading
import weakref
from collections.abc import Callable, Hashable
from typing import Any, Generic, TypeVar

from volviz.errors import Cancelled

Request = TypeVar("Request")
Result = TypeVar("Result")

#: Called with the finished fraction, 0..1, by the work.
Progress = Callable[[float], None]
#: Asked by the work now and then; when it returns True, the work should end with `Cancelled`.
Cancel = Callable[[], bool]
Work = Callable[[Progress, Cancel], Result]
Done = Callable[["BackgroundTask[Any]"], None]


class BackgroundTask(Generic[Result]):
    """One piece of work; made and run by `Tasks`.

    Parameters
    ----------
    key : hashable or None
        What it is for; part of the name of its thread.
    work : callable
        ``work(progress, cancel) -> result``.
    done : callable, optional
        Called with the task when it has ended, on the thread of the work; also after a cancel.

    Attributes
    ----------
    progress : float
        How far the work is, 0..1, as it has told.
    has_begun : bool
        Whether a thread has taken it up.
    """

    def __init__(self, key: Hashable | None, work: Work[Result], done: Done | None = None) -> None:
        self.key = key
        self.done = done
        self.progress = 0.0
        self.has_begun = False
        self._work: Work[Result] | None = work
        self._cancelled = threading.Event()
        self._ended = threading.Event()
        self._result: Result | None = None
        self._error: BaseException | None = None

    @property
    def is_cancelled(self) -> bool:
        """Whether nobody wants the result any more."""
        return self._cancelled.is_set()

    @property
    def has_ended(self) -> bool:
        """Whether there is a result or an error, or the cancelled work has stopped."""
        return self._ended.is_set()

    @property
    def error(self) -> BaseException | None:
        """What the work has raised, if anything."""
        return self._error

    def cancel(self) -> None:
        """Ask the work to stop; from any thread."""
        self._cancelled.set()

    def result(self) -> Result:
        """What the work has returned; to be asked for when the task has ended.

        Raises
        ------
        BaseException
            What the work has raised.
        Cancelled
            The task was cancelled.
        RuntimeError
            It has not ended.
        """
        if not self.has_ended:
            raise RuntimeError(f"The task {self.key!r} has not ended yet.")
        if self._error is not None:
            raise self._error
        return self._result  # type: ignore[return-value]

    def run(self) -> None:
        """Do the work in the calling thread; a cancelled task does nothing."""
        work, self._work = self._work, None
        self.has_begun = True
        try:
            if work is None or self.is_cancelled:
                raise Cancelled("The work was cancelled.")
            self._result = work(self._report, self._cancelled.is_set)
            self.progress = 1.0
        except BaseException as error:  # noqa: BLE001 - raised again where the result is asked for
            self._error = error
        self._ended.set()

    def _report(self, fraction: float) -> None:
        self.progress = fraction


class Tasks:
    """The tasks of one owner; for each key the newest counts.

    Tasks of one key follow one another, so that work that cannot be interrupted (VTK's filters) never piles up: of
    those that wait for a running one, the newest is taken up. A pool runs `threads` tasks at once, whatever their
    keys: there a cancelled task that goes on regardless holds up none.

    Parameters
    ----------
    done : callable, optional
        Called with each task that has ended, on its thread, unless `start` is given another one.
    threads : int, optional
        Makes it a pool of so many threads; by default each key has a thread when it needs one.
    """

    def __init__(self, done: Done | None = None, *, threads: int | None = None) -> None:
        self._done = done
        self._threads = threads
        self._changed = threading.Condition()
        self._waiting: list[BackgroundTask[Any]] = []
        self._running: list[BackgroundTask[Any]] = []
        self._closed = False
        _ALL.add(self)

    def start(
        self, key: Hashable | None, work: Work[Result], done: Done | None = None, *, cancels: bool = True
    ) -> BackgroundTask[Result]:
        """Have work done for a key.

        Parameters
        ----------
        key : hashable or None
            Purpose. Tasks for the same purpose that have not begun are dropped; None stands for none.
        work : callable
            ``work(progress, cancel) -> result``, called on a thread.
        done : callable, optional
            Called with the task when it has ended, on that thread, but not after `close`.
        cancels : bool, default: True
            Cancel the task that is running for this key. Not where requests follow faster than one can be met: each
            would be cancelled, and none ever finished.
        """
        task = BackgroundTask(key, work, done or self._done)
        with self._changed:
            for other in (*self._waiting, *self._running):
                if key is not None and other.key == key and (cancels or not other.has_begun):
                    other.cancel()
            self._waiting.append(task)
            if self._closed:
                task.cancel()
                task.done = None
            self._begin()
        return task

    def _begin(self) -> None:
        """Take up what may run; the lock is held."""
        for task in list(self._waiting):
            if self._threads is None:
                blocked = task.key is not None and any(other.key == task.key for other in self._running)
            else:
                blocked = len(self._running) >= self._threads
            if blocked and not task.is_cancelled:
                continue
            self._waiting.remove(task)
            self._running.append(task)
            task.has_begun = True
            threading.Thread(
                target=self._run, args=(task,), name=f"{THREAD_NAME} {task.key}", daemon=True
            ).start()

    def _run(self, task: BackgroundTask[Any]) -> None:
        task.run()
        done, task.done = task.done, None
        if done is not None:
            done(task)
        # a thread that lingers must not hold on to whoever was called
        done = None
        with self._changed:
            self._running.remove(task)
            self._begin()
            self._changed.notify_all()

    def cancel(self, key: Hashable) -> None:
        """Cancel what is done for a purpose."""
        with self._changed:
            for task in (*self._waiting, *self._running):
                if task.key == key:
                    task.cancel()
            self._begin()

    @property
    def is_busy(self) -> bool:
        """Whether anything is in work that has not been cancelled."""
        with self._changed:
            return any(not task.is_cancelled for task in (*self._waiting, *self._running))

    @property
    def progress(self) -> float:
        """How far the slowest task is, 0..1; 1 when nothing is in work."""
        with self._changed:
            tasks = (*self._waiting, *self._running)
            return min((task.progress for task in tasks if not task.is_cancelled), default=1.0)

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until nothing is in work and everybody has been called: for scripts, never in an event loop.

        Parameters
        ----------
        timeout : float, optional
            Seconds after which to give up.

        Returns
        -------
        bool
            Whether everything has ended.
        """
        with self._changed:
            return self._changed.wait_for(lambda: not self._waiting and not self._running, timeout)

    def close(self) -> None:
        """Cancel everything without waiting for it; nobody is called back any more."""
        with self._changed:
            self._closed = True
            # no thread may hold the last reference to whoever wanted to be called
            self._done = None
            for task in (*self._waiting, *self._running):
                task.done = None
                task.cancel()
            self._begin()


class LatestResult(Generic[Request, Result]):
    """What has been made for the last requests, and what is being made for the newest.

    Parameters
    ----------
    key : str
        Of its tasks among those of their owner.
    keeps : int, default: 1
        Number of results that are kept.
    cancels : bool, default: True
        Whether work that a new request makes useless is cancelled; see `Tasks.start`.
    """

    def __init__(self, key: str, *, keeps: int = 1, cancels: bool = True) -> None:
        self._key = key
        self._keeps = keeps
        self._cancels = cancels
        self._results: list[tuple[Request, Result]] = []
        self._in_work: list[tuple[Request, BackgroundTask[Result]]] = []

    @property
    def last(self) -> Result | None:
        """What was made or asked for last, for whatever request."""
        return self._results[-1][1] if self._results else None

    def held(self, request: Request) -> Result | None:
        """The result of a request, if there is one already."""
        return next((result for other, result in self._results if other == request), None)

    def get(self, tasks: Tasks, request: Request, work: Work[Result]) -> Result | None:
        """The result of a request, or None while it is being made; comes back at once.

        Parameters
        ----------
        tasks : Tasks
            Where the work is done.
        request : object
            Equal requests have equal results.
        work : callable
            Makes the result: ``work(progress, cancel)``. It must not hold on to whoever asks.

        Raises
        ------
        Exception
            What the work for this request has raised; the next call tries again.
        """
        found = self.held(request)
        if found is None:
            self._take_ended(request)
            found = self.held(request)
        if found is not None:
            self._keep(request, found)
            return found
        for other, task in self._in_work:
            if other != request and not task.has_begun:
                task.cancel()
        if not any(other == request and not task.is_cancelled for other, task in self._in_work):
            task = tasks.start(self._key, work, cancels=self._cancels)
            self._in_work.append((request, task))
        return None

    def _keep(self, request: Request, result: Result) -> None:
        others = [pair for pair in self._results if pair[0] != request]
        self._results = [*others, (request, result)][-self._keeps :]

    def _take_ended(self, request: Request) -> None:
        pairs, self._in_work = self._in_work, []
        failed: BackgroundTask[Result] | None = None
        for other, task in pairs:
            if not task.has_ended:
                self._in_work.append((other, task))
            elif task.is_cancelled:
                continue
            elif task.error is None:
                self._keep(other, task.result())
            elif other == request:
                # what went wrong with a former request is of no interest any more
                failed = task
        if failed is not None:
            failed.result()

    def clear(self) -> None:
        """Forget everything, and cancel what is in work."""
        for _, task in self._in_work:
            task.cancel()
        self._in_work.clear()
        self._results.clear()


#: Beginning of the names of the threads; what follows is the key of the task.
THREAD_NAME = "volviz-task"

_ALL: weakref.WeakSet[Tasks] = weakref.WeakSet()


@atexit.register
def _end_all() -> None:
    """Compiled code must not run on while the interpreter is taken down."""
    for tasks in list(_ALL):
        tasks.close()
    for tasks in list(_ALL):
        tasks.wait()
