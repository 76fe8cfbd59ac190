"""Ties a widget to one value of the scene, in either direction.

`show_value` carries a value from the scene to a widget, `send_value` the widget's values to the store, and
`send_gesture` tells the store while it is being dragged. All hold the widget weakly: a closed panel disappears although
the store lives on. Commands and gestures that change more than the value of one widget call `Store.update` themselves.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable, Hashable
from typing import Any, TypeVar

from PySide6.QtCore import QObject, QSignalBlocker, SignalInstance
from shiboken6 import isValid

from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz_ui.session.documents import Documents

Value = TypeVar("Value")


def show_value(
    source: Store | Documents,
    read: Callable[[Any], Value],
    apply: Callable[[Value], object],
    *,
    now: bool = True,
) -> None:
    """Call `apply` with a value of the scene whenever that value is another one.

    Parameters
    ----------
    source : Store or Documents
        Where the scene is; documents give a `LoadedScene`, once the volumes of a new one are there.
    read : callable
        Takes what the source gives, gives the value. Must not refer to the widget, or the widget stays alive.
    apply : bound method of a QObject
        Takes the value; the object's signals are blocked meanwhile: showing a value never sends it back.
    now : bool
        Also call it at once with the present value.
    """
    method = weakref.WeakMethod(apply)  # type: ignore[type-var]

    def deliver(value: Value) -> None:
        call = method()
        owner = None if call is None else call.__self__
        if owner is None or (isinstance(owner, QObject) and not isValid(owner)):
            source.changed.disconnect(on_changed, missing_ok=True)
            return
        if isinstance(owner, QObject):
            blocker = QSignalBlocker(owner)
            try:
                call(value)
            finally:
                blocker.unblock()
        else:
            call(value)

    def on_changed(old: Any, new: Any) -> None:
        before, after = read(old), read(new)
        if before is not after and before != after:
            deliver(after)

    source.changed.connect(on_changed)
    if now:
        deliver(read(source.scene if isinstance(source, Store) else source.shown))


def send_value(
    signal: SignalInstance,
    store: Store,
    write: Callable[[Scene, Any], Scene],
    *,
    label: str,
    gesture: Hashable | None = None,
) -> None:
    """Make every value that a widget emits a change of the scene.

    Parameters
    ----------
    signal : Qt signal with one argument
        Emitted by the widget when the user has changed it.
    store : Store
        What is changed.
    write : callable
        Takes a scene and the value, gives the new scene. Must not refer to the widget.
    label : str
        Words for the undo menu.
    gesture : hashable, optional
        Key of the gesture that the widget begins and ends (`send_gesture`).
    """
    # the connection belongs to the widget and ends with it; nothing in it refers to the widget
    signal.connect(
        lambda value: store.update(lambda scene: write(scene, value), label=label, gesture=gesture)
    )


def send_gesture(started: SignalInstance, finished: SignalInstance, store: Store, key: Hashable) -> None:
    """Make what a widget emits between two of its signals one gesture of the store.

    Parameters
    ----------
    started, finished : Qt signals
        Emitted when the widget is taken hold of, and let go.
    store : Store
        Where the gesture is.
    key : hashable
        Key of the gesture.
    """
    started.connect(lambda: store.begin_gesture(key))
    finished.connect(lambda: store.end_gesture(key))
