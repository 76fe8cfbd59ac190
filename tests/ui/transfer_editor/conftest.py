"""An editor in a window, on a small volume, with presets in a folder of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication, QWidget

from volviz.model.layers import ImageLayer
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.model.transfer.function import TransferFunction
from volviz.model.transfer.own_presets import OwnPresets
from volviz.volume_data.references import VolumeKey, VolumeRef
from volviz.volume_data.volume import Volume
from volviz_ui.session.documents import Documents
from volviz_ui.session.workers import Workers
from volviz_ui.transfer_editor import TransferEditor

NONE = Qt.KeyboardModifier.NoModifier


def start_function() -> TransferFunction:
    return TransferFunction.from_points(
        [
            (-500, (0.1, 0.1, 0.4, 0.0)),
            (0, (0.8, 0.2, 0.2, 0.1)),
            (400, (0.9, 0.8, 0.5, 0.3)),
            (1000, (1.0, 1.0, 0.9, 0.8)),
        ]
    )


def ct_like() -> Volume:
    values = np.random.default_rng(1).normal(40, 300, (24, 32, 28))
    values[:, :, :9] = -1000
    values[0, 0, 0], values[1, 1, 1] = -1024, 1500
    return Volume(values.clip(-1024, 1500).astype(np.int16), unit="HU", name="test")


@pytest.fixture
def store() -> Store:
    return Store(Scene(layers=(ImageLayer(VolumeRef("array:1"), start_function()),)))


@pytest.fixture
def documents(qapp, store) -> Iterator[Documents]:
    """What is shown of the store, with a volume."""
    documents = documents_of(store, ct_like())
    yield documents
    documents.close()


def documents_of(store: Store, volume: Volume) -> Documents:
    """The scene of a store, loaded."""
    documents = Documents(store, Workers())
    show(documents, store, volume)
    return documents


def show(documents: Documents, store: Store, volume: Volume) -> None:
    """Let the first layer show another volume that has been read."""
    ref = VolumeRef(f"array:{id(volume)}")
    documents.cache.put(VolumeKey(ref), volume)
    store.update(lambda scene: scene.with_layer(volume=ref), record=False)


@pytest.fixture
def editor(qtbot, store, documents, tmp_path) -> Iterator[TransferEditor]:
    editor = TransferEditor(store, documents, own_presets=OwnPresets(tmp_path / "presets"))
    qtbot.addWidget(editor)
    editor.resize(1100, 240)
    with qtbot.waitExposed(editor):
        editor.show()
    qtbot.waitUntil(lambda: editor.counter.is_done, timeout=120000)
    editor.plot.set_fine_opacity(False)
    editor.plot.setFocus()
    yield editor
    editor.close_workers()


def send(widget: QWidget, kind: QEvent.Type, at: QPointF, button, buttons, modifiers=NONE) -> None:
    event = QMouseEvent(kind, at, widget.mapToGlobal(at), button, buttons, modifiers)
    QApplication.sendEvent(widget, event)


LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def drag() -> Callable[..., None]:
    """Press, four moves, release; ``release=False`` leaves the button down."""

    def act(
        widget: QWidget, start: QPointF, end: QPointF, *, modifiers=NONE, button=LEFT, release: bool = True
    ) -> None:
        nothing = Qt.MouseButton.NoButton
        send(widget, QEvent.Type.MouseButtonPress, start, button, button, modifiers)
        for t in (0.25, 0.5, 0.75, 1.0):
            send(widget, QEvent.Type.MouseMove, start + (end - start) * t, nothing, button, modifiers)
        if release:
            send(widget, QEvent.Type.MouseButtonRelease, end, button, nothing, modifiers)

    return act


@pytest.fixture
def place(editor) -> Callable[[int], QPointF]:
    """Pixel of a control point."""

    def of(index: int) -> QPointF:
        point = editor.model.function.points[index]
        return editor.plot.places.point(point.value, point.opacity)

    return of
