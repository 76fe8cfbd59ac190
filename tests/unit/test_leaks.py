"""The leak checks find what they are there for."""

from __future__ import annotations

import threading

from tests import leaks


def test_a_thread_left_running_is_found_and_named(monkeypatch: object) -> None:
    watch = leaks.Watch(objects=False)
    end = threading.Event()
    thread = threading.Thread(target=end.wait, name="forgotten")
    thread.start()
    assert leaks.wait_for_threads(watch.threads, grace=0.05) == ["thread 'forgotten' is still running"]
    end.set()
    thread.join()
    assert watch.leaks() == []


def test_a_thread_that_ends_within_the_grace_is_none() -> None:
    watch = leaks.Watch(objects=False)
    threading.Timer(0.05, lambda: None).start()
    assert watch.leaks() == []


def test_a_pool_that_lives_as_long_as_the_process_names_itself_so() -> None:
    watch = leaks.Watch(objects=False)
    end = threading.Event()
    thread = threading.Thread(target=end.wait, name="volviz-shared-test")
    thread.start()
    assert watch.leaks() == []
    end.set()
    thread.join()
