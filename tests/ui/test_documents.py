"""Scenes with their volumes: one event, once both are there, heard by all in the same order."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest
from PySide6.QtWidgets import QApplication

from volviz.model.camera import Camera
from volviz.model.light import Light
from volviz.model.store import Store
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene, volume_of
from volviz_ui.session.workers import Workers
from volviz_ui.widgets.binding import show_value

Wait = Callable[..., None]
CAMERA = Camera((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0))


@pytest.fixture
def store() -> Store:
    return Store()


@pytest.fixture
def documents(qapp: QApplication, store: Store) -> Iterator[Documents]:
    workers = Workers()
    documents = Documents(store, workers)
    yield documents
    documents.close()
    workers.close()


def opened(documents: Documents, path: str, wait_for: Wait) -> LoadedScene:
    before = documents.volume
    documents.open(path)
    wait_for(lambda: documents.volume is not before)
    return documents.shown


def test_a_scene_is_shown_together_with_its_volume(
    store: Store, documents: Documents, ball_file: str, other_file: str, wait_for: Wait
) -> None:
    told: list[tuple[LoadedScene, LoadedScene]] = []
    documents.changed.connect(lambda old, new: told.append((old, new)))
    first = opened(documents, ball_file, wait_for)
    assert first.scene is store.scene
    assert first.volume.dimensions == (32, 32, 32)
    assert first.transfer_function is first.scene.layer.transfer_function
    second = opened(documents, other_file, wait_for)
    store.update(lambda scene: replace(scene, light=Light(headlight=False)))
    assert [new.scene.light.headlight for _old, new in told] == [True, True, False]
    assert [old for old, _new in told[1:]] == [new for _old, new in told[:-1]]
    assert documents.volume is second.volume
    assert documents.is_current


def test_the_old_pair_stays_while_a_volume_is_read_again(
    store: Store, documents: Documents, ball_file: str, other_file: str, wait_for: Wait
) -> None:
    opened(documents, ball_file, wait_for)
    shown = opened(documents, other_file, wait_for)
    documents.cache.clear()
    told: list[tuple[LoadedScene, LoadedScene]] = []
    documents.changed.connect(lambda old, new: told.append((old, new)))
    documents.undo()
    store.update(lambda scene: replace(scene, light=Light(headlight=False)))
    assert documents.is_loading
    assert not documents.is_current
    assert documents.shown is shown
    assert told == []
    wait_for(lambda: documents.is_current)
    ((old, new),) = told
    assert old is shown
    assert (new.volume.dimensions, new.scene.light.headlight) == ((32, 32, 32), False)


def test_giving_up_returns_to_the_pair_that_is_shown(
    store: Store, documents: Documents, ball_file: str, other_file: str, wait_for: Wait
) -> None:
    opened(documents, ball_file, wait_for)
    shown = opened(documents, other_file, wait_for)
    documents.cache.clear()
    documents.undo()
    documents.cancel()
    assert documents.is_current
    assert documents.volume is shown.volume
    assert store.scene.layers == shown.scene.layers


def test_all_hear_of_changes_in_their_order_though_a_listener_changes_the_scene(
    store: Store, documents: Documents, ball_file: str, wait_for: Wait
) -> None:
    def frame(_old: LoadedScene, new: LoadedScene) -> None:
        if new.scene.view.camera is None:
            store.update(lambda scene: scene.with_camera(CAMERA), record=False)

    heard: list[Camera | None] = []
    documents.changed.connect(frame)
    documents.changed.connect(lambda _old, new: heard.append(new.scene.view.camera))
    opened(documents, ball_file, wait_for)
    assert heard == [None, CAMERA]
    assert documents.shown.scene.view.camera == CAMERA


def test_a_value_is_delivered_when_its_volume_is_there(
    store: Store, documents: Documents, ball_file: str, wait_for: Wait
) -> None:
    class Shelf:
        def __init__(self) -> None:
            self.values: list[object] = []

        def take(self, value: object) -> None:
            self.values.append(value)

    shelf = Shelf()
    show_value(documents, volume_of, shelf.take)
    assert shelf.values == [None]
    shown = opened(documents, ball_file, wait_for)
    store.update(lambda scene: scene.with_camera(CAMERA))
    assert shelf.values == [None, shown.volume]
