"""Whoever answers the user must not wait for a thread."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING

from volviz.tasks import THREAD_NAME

if TYPE_CHECKING:
    import pytest


def refuse_to_wait(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Let the main thread neither join a thread, nor wait for an event for a while, nor sleep.

    Returns
    -------
    list of str
        What it tried all the same, for where the error that it got is swallowed.
    """
    tried: list[str] = []

    def refuse(what: str) -> None:
        if threading.current_thread() is threading.main_thread():
            tried.append(what)
            raise AssertionError(f"the main thread waits: {what}")

    join, wait, sleep = threading.Thread.join, threading.Event.wait, time.sleep

    def join_instead(thread: threading.Thread, timeout: float | None = None) -> None:
        refuse(f"join of {thread.name}")
        join(thread, timeout)

    def wait_instead(event: threading.Event, timeout: float | None = None) -> bool:
        # without limit it is what `Thread.start` does until the thread lives
        if timeout is not None:
            refuse("Event.wait")
        return wait(event, timeout)

    def sleep_instead(seconds: float) -> None:
        refuse("sleep")
        sleep(seconds)

    monkeypatch.setattr(threading.Thread, "join", join_instead)
    monkeypatch.setattr(threading.Event, "wait", wait_instead)
    monkeypatch.setattr(time, "sleep", sleep_instead)
    return tried


def join_tasks(seconds: float = 120.0) -> None:
    """Wait until all work in the background has ended, as the program does when it ends."""
    end = time.monotonic() + seconds
    for thread in threading.enumerate():
        if thread.name.startswith(THREAD_NAME):
            thread.join(max(end - time.monotonic(), 0.0))
