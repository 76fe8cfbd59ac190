"""The two binding helpers, the workers and the cache, without the window."""

from __future__ import annotations

import dataclasses
import gc
import threading
import time
import weakref
from collections.abc import Callable

import numpy as np
import pytest
from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QApplication, QCheckBox

from tests.ui.conftest import settle
from tests.waiting import join_tasks
from volviz.errors import LoadError
from volviz.model.light import Light
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.volume_data.references import VolumeKey, VolumeRef
from volviz.volume_data.volume import Volume
from volviz_ui.session.volume_cache import VolumeCache
from volviz_ui.session.workers import Task, Workers
from volviz_ui.widgets.binding import send_value, show_value

Wait = Callable[..., None]


class Box(QCheckBox):
    shown = 0

    def show_headlight(self, on: bool) -> None:
        self.shown += 1
        self.setChecked(on)


def with_headlight(scene: Scene, on: bool) -> Scene:
    return dataclasses.replace(scene, light=dataclasses.replace(scene.light, headlight=on))


def bound_box(store: Store) -> Box:
    box = Box()
    show_value(store, lambda scene: scene.light.headlight, box.show_headlight)
    send_value(box.toggled, store, with_headlight, label="Headlight")
    return box


def test_a_widget_and_the_store_follow_each_other(qapp: QApplication) -> None:
    store = Store()
    box = bound_box(store)
    assert box.isChecked()
    box.click()
    assert not store.scene.light.headlight
    assert store.undo_label == "Headlight"
    store.undo()
    assert box.isChecked()
    assert store.redo_label == "Headlight"


def test_showing_a_value_does_not_send_it_back(qapp: QApplication) -> None:
    store = Store()
    box = bound_box(store)
    changes = []
    store.changed.connect(lambda old, new: changes.append(new))
    store.update(lambda scene: with_headlight(scene, False))
    assert len(changes) == 1
    assert not box.isChecked()


def test_values_that_stay_are_not_shown_again(qapp: QApplication) -> None:
    store = Store()
    box = bound_box(store)
    shown = box.shown
    store.update(lambda scene: dataclasses.replace(scene, background=(1.0, 0.0, 0.0)))
    assert box.shown == shown
    store.update(lambda scene: dataclasses.replace(scene, light=Light(headlight=False)))
    assert box.shown == shown + 1


def test_the_store_does_not_keep_a_widget_alive(qapp: QApplication) -> None:
    store = Store()
    box = bound_box(store)
    reference = weakref.ref(box)
    box.deleteLater()
    del box
    settle(qapp)
    gc.collect()
    assert reference() is None
    store.update(lambda scene: with_headlight(scene, False))


class Listener(QObject):
    got = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.values: list[object] = []
        self.threads: list[int] = []

    def take(self, value: object) -> None:
        self.values.append(value)
        self.threads.append(threading.get_ident())


@pytest.fixture
def workers(qapp: QApplication) -> Workers:
    made = Workers()
    yield made
    made.close()
    settle(qapp)
    made.deleteLater()
    settle(qapp)


def test_results_and_errors_arrive_on_the_gui_thread(workers: Workers, wait_for: Wait) -> None:
    done, failed = Listener(), Listener()
    workers.start(lambda task: threading.get_ident()).succeeded.connect(done.take)

    def fails(task: Task) -> None:
        raise LoadError("no such file.")

    workers.start(fails).failed.connect(failed.take)
    wait_for(lambda: done.values and failed.values)
    assert done.values[0] != threading.get_ident()
    assert isinstance(failed.values[0], LoadError)
    assert done.threads == failed.threads == [threading.get_ident()]
    wait_for(lambda: not workers.is_busy)


def test_for_one_purpose_the_newest_wins(workers: Workers, wait_for: Wait) -> None:
    done = Listener()

    def slow(task: Task, number: int) -> int:
        for step in range(20):
            time.sleep(0.005)
            task.report(step / 20)
        return number

    for number in range(6):
        workers.start(lambda task, n=number: slow(task, n), key="load").succeeded.connect(done.take)
    wait_for(lambda: not workers._tasks)
    assert done.values == [5]


def test_cancelled_work_says_nothing(workers: Workers, wait_for: Wait) -> None:
    everything = Listener()

    def endless(task: Task) -> None:
        while True:
            time.sleep(0.002)
            task.report(0.5, "still at it")

    task = workers.start(endless, key="load")
    task.succeeded.connect(everything.take)
    task.failed.connect(everything.take)
    workers.cancel("load")
    wait_for(lambda: not workers._tasks)
    assert everything.values == []


def test_what_the_work_knows_arrives_before_its_end(workers: Workers, wait_for: Wait) -> None:
    seen = Listener()
    go_on = threading.Event()

    def count(task: Task) -> str:
        task.publish("half")
        assert go_on.wait(20)
        task.publish("all")
        return "done"

    task = workers.start(count)
    task.published.connect(seen.take)
    task.succeeded.connect(seen.take)
    wait_for(lambda: seen.values == ["half"])
    go_on.set()
    wait_for(lambda: seen.values == ["half", "all", "done"])
    assert set(seen.threads) == {threading.get_ident()}


def test_closing_waits_for_nothing_and_nothing_arrives_after_it(workers: Workers, qapp: QApplication) -> None:
    seen = Listener()
    begun, go_on = threading.Event(), threading.Event()

    def stubborn(_task: Task) -> str:
        begun.set()
        go_on.wait(20)
        return "late"

    task = workers.start(stubborn)
    for signal in (task.succeeded, task.failed, task.progressed):
        signal.connect(seen.take)
    assert begun.wait(20)
    workers.close()
    assert not go_on.is_set()
    go_on.set()
    join_tasks()
    settle(qapp)
    assert seen.values == []
    assert not workers.is_busy


def make_volume(kilobytes: int) -> Volume:
    return Volume(np.zeros((kilobytes, 32, 32), np.uint8))


def test_the_cache_keeps_what_was_used_last() -> None:
    cache = VolumeCache(budget=100 * 1024)
    keys = [VolumeKey(VolumeRef(f"file{n}")) for n in range(4)]
    for key in keys[:3]:
        cache.put(key, make_volume(30))
    assert cache.get(keys[0]) is not None
    cache.put(keys[3], make_volume(30))
    assert cache.get(keys[1]) is None
    assert cache.get(keys[0]) is not None
    assert cache.size <= cache.budget


def test_a_volume_larger_than_the_cache_is_kept_alone() -> None:
    cache = VolumeCache(budget=1024)
    cache.put(VolumeKey(VolumeRef("small")), make_volume(2))
    cache.put(VolumeKey(VolumeRef("large")), make_volume(64))
    assert len(cache) == 1
    assert cache.get(VolumeKey(VolumeRef("large"))) is not None
