"""Work in the background: the newest counts, cancel, errors, closing while it runs; nobody waits for it."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest

from tests.waiting import refuse_to_wait
from volviz.errors import Cancelled, LoadError
from volviz.tasks import THREAD_NAME, BackgroundTask, LatestResult, Tasks


@pytest.fixture
def tasks() -> Iterator[Tasks]:
    made = Tasks()
    yield made
    made.close()
    assert made.wait(20)


class Slow:
    """Work that goes on until it is told to end, or cancelled."""

    def __init__(self, result: Any = None, *, listens: bool = True) -> None:
        self.go, self.begun, self.was_cancelled = threading.Event(), threading.Event(), False
        self._result, self._listens = result, listens

    def __call__(self, progress: Any, cancel: Any) -> Any:
        self.begun.set()
        progress(0.5)
        while not self.go.wait(0.002):
            if cancel() and self._listens:
                self.was_cancelled = True
                raise Cancelled("as wished.")
        return self._result


def running() -> set[str]:
    return {thread.name for thread in threading.enumerate() if thread.name.startswith(THREAD_NAME)}


# ---------------------------------------------------------------------- tasks


def test_a_task_has_progress_and_a_result(tasks: Tasks) -> None:
    slow, ended = Slow(7), []
    task = tasks.start("number", slow, lambda task: ended.append((task, threading.current_thread())))
    assert slow.begun.wait(20)
    assert (task.progress, task.has_ended, tasks.is_busy) == (0.5, False, True)
    assert tasks.progress == 0.5
    assert f"{THREAD_NAME} number" in running()
    with pytest.raises(RuntimeError, match="not ended"):
        task.result()
    assert not tasks.wait(0.01)
    slow.go.set()
    assert tasks.wait(20)
    assert task.result() == 7
    assert (task.progress, tasks.progress, tasks.is_busy) == (1.0, 1.0, False)
    while not ended:
        time.sleep(0.001)
    assert ended[0][0] is task
    assert ended[0][1] is not threading.current_thread()


def test_an_error_is_kept_and_raised_where_the_result_is_taken(tasks: Tasks) -> None:
    def fails(_progress: Any, _cancel: Any) -> None:
        raise LoadError("no such file.")

    task = tasks.start("load", fails)
    assert tasks.wait(20)
    assert not task.is_cancelled
    for _ in range(2):
        with pytest.raises(LoadError, match="no such file"):
            task.result()


def test_a_cancelled_task_stops_and_has_no_result(tasks: Tasks) -> None:
    slow = Slow()
    task = tasks.start("mesh", slow)
    assert slow.begun.wait(20)
    tasks.cancel("other")
    assert not task.is_cancelled
    tasks.cancel("mesh")
    assert tasks.wait(20)
    assert slow.was_cancelled
    with pytest.raises(Cancelled):
        task.result()


def test_of_one_key_the_newest_is_done_and_others_go_on(tasks: Tasks) -> None:
    first, other = Slow(), Slow("other")
    began: list[int] = []

    def numbered(number: int) -> Any:
        def work(_progress: Any, _cancel: Any) -> int:
            began.append(number)
            return number

        return work

    # one that cannot be interrupted: until it has ended, the newer ones wait
    first._listens = False
    old = tasks.start("mesh", first)
    beside = tasks.start("values", other)
    assert first.begun.wait(20)
    assert other.begun.wait(20)
    newer = [tasks.start("mesh", numbered(number)) for number in range(5)]
    assert began == []
    first.go.set()
    other.go.set()
    assert tasks.wait(20)
    assert began == [4]
    assert [task.is_cancelled for task in (old, *newer)] == [True] * 5 + [False]
    assert newer[-1].result() == 4
    assert beside.result() == "other"


def test_what_runs_may_be_let_finish(tasks: Tasks) -> None:
    first, second, third = Slow(1), Slow(2), Slow(3)
    for slow in (first, second, third):
        slow.go.set()
    first.go.clear()
    old = tasks.start("stand-in", first, cancels=False)
    assert first.begun.wait(20)
    passed_over = tasks.start("stand-in", second, cancels=False)
    newest = tasks.start("stand-in", third, cancels=False)
    first.go.set()
    assert tasks.wait(20)
    assert (old.result(), newest.result()) == (1, 3)
    assert passed_over.is_cancelled
    assert not second.begun.is_set()


def test_in_a_pool_a_cancelled_task_holds_up_none_and_no_more_run_than_it_has_threads() -> None:
    pool = Tasks(threads=2)
    stubborn, next_one, third = Slow(listens=False), Slow(2), Slow(3)
    pool.start("load", stubborn)
    assert stubborn.begun.wait(20)
    pool.start("load", next_one)
    assert next_one.begun.wait(20)
    pool.start("other", third)
    assert not third.begun.wait(0.05)
    next_one.go.set()
    assert third.begun.wait(20)
    for slow in (stubborn, third):
        slow.go.set()
    assert pool.wait(20)


def test_closing_ends_the_threads_without_waiting_and_calls_nobody() -> None:
    called: list[BackgroundTask[Any]] = []
    tasks = Tasks(called.append)
    slow, later = Slow(), Slow()
    tasks.start("mesh", slow)
    waiting = tasks.start("mesh", later)
    assert slow.begun.wait(20)
    begin = time.monotonic()
    slow._listens = False
    tasks.close()
    assert time.monotonic() - begin < 1.0
    assert running()
    slow.go.set()
    assert tasks.wait(20)
    assert waiting.is_cancelled
    assert not later.begun.is_set()
    late = tasks.start("mesh", later)
    assert tasks.wait(20)
    assert late.is_cancelled
    assert called == []


def test_the_program_ends_while_work_is_running() -> None:
    program = """
import threading, time
from volviz.tasks import Tasks
begun = threading.Event()
def work(progress, cancel):
    begun.set()
    while not cancel():
        time.sleep(0.001)
    print("cancelled")
tasks = Tasks()
tasks.start("mesh", work)
assert begun.wait(20)
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, timeout=60
    )
    assert (done.returncode, done.stdout.strip()) == (0, "cancelled"), done.stderr


# ---------------------------------------------------------------------- results


def test_a_result_is_there_when_its_task_has_ended_and_stays(tasks: Tasks) -> None:
    made: LatestResult[str, int] = LatestResult("mesh")
    slow = Slow(1)
    assert made.get(tasks, "a", slow) is None
    assert made.get(tasks, "a", slow) is None
    assert made.last is None
    slow.go.set()
    assert tasks.wait(20)
    assert made.get(tasks, "a", slow) == 1
    assert (made.last, made.held("a"), made.held("b")) == (1, 1, None)
    # another one is made meanwhile
    assert made.get(tasks, "b", Slow(2)) is None
    assert made.get(tasks, "a", slow) == 1


def test_a_new_request_cancels_the_one_in_work(tasks: Tasks) -> None:
    made: LatestResult[str, int] = LatestResult("mesh")
    old, new = Slow(1), Slow(2)
    assert made.get(tasks, "a", old) is None
    assert old.begun.wait(20)
    assert made.get(tasks, "b", new) is None
    assert new.begun.wait(20)
    assert old.was_cancelled
    new.go.set()
    assert tasks.wait(20)
    assert made.get(tasks, "b", new) == 2
    assert made.held("a") is None


def test_of_a_series_that_is_not_cancelled_the_last_one_and_the_one_in_work_are_made(tasks: Tasks) -> None:
    made: LatestResult[int, int] = LatestResult("stand-in", keeps=3, cancels=False)
    works = [Slow(number) for number in range(3)]
    for number, work in enumerate(works):
        assert made.get(tasks, number, work) is None
    assert works[0].begun.wait(20)
    for work in works:
        work.go.set()
    assert tasks.wait(20)
    assert made.get(tasks, 2, works[2]) == 2
    assert made.held(0) == 0
    assert not works[1].begun.is_set()


def test_a_request_that_comes_back_takes_the_place_of_the_one_that_waits(tasks: Tasks) -> None:
    made: LatestResult[str, int] = LatestResult("stand-in", cancels=False)
    first, second = Slow(1), Slow(2)
    made.get(tasks, "a", first)
    assert first.begun.wait(20)
    made.get(tasks, "b", second)
    made.get(tasks, "a", first)
    first.go.set()
    assert tasks.wait(20)
    assert made.get(tasks, "a", first) == 1
    assert not second.begun.is_set()


def test_so_many_results_are_kept_as_are_wanted(tasks: Tasks) -> None:
    made: LatestResult[int, int] = LatestResult("stand-in", keeps=2)
    for number in (0, 1, 0, 2):
        made.get(tasks, number, lambda _progress, _cancel, number=number: number)
        assert tasks.wait(20)
        assert made.get(tasks, number, lambda _progress, _cancel: -1) == number
    assert [made.held(number) for number in range(3)] == [0, None, 2]
    made.clear()
    assert (made.last, made.held(2)) == (None, None)


def test_an_error_is_raised_once_and_only_for_its_own_request(tasks: Tasks) -> None:
    made: LatestResult[str, int] = LatestResult("mesh", cancels=False)

    def fails(_progress: Any, _cancel: Any) -> int:
        raise LoadError("no mesh.")

    made.get(tasks, "wrong", fails)
    assert tasks.wait(20)
    with pytest.raises(LoadError):
        made.get(tasks, "wrong", fails)
    # it is tried again
    assert made.get(tasks, "wrong", fails) is None
    assert tasks.wait(20)
    assert made.get(tasks, "right", lambda _progress, _cancel: 3) is None
    assert tasks.wait(20)
    assert made.get(tasks, "right", fails) == 3


def test_asking_never_waits(tasks: Tasks, monkeypatch: pytest.MonkeyPatch) -> None:
    made: LatestResult[str, int] = LatestResult("mesh")
    slow = Slow(1)
    with monkeypatch.context() as patch:
        refuse_to_wait(patch)
        assert made.get(tasks, "a", slow) is None
        assert made.get(tasks, "b", slow) is None
        tasks.close()
