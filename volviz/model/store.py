"""The store: the one place where the scene changes, and its history."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

from psygnal import Signal

from volviz.errors import VolvizError
from volviz.model.scene import Scene


@dataclass
class _Step:
    """An entry of the history.

    Attributes
    ----------
    scene : Scene
        The scene without this step and those after it.
    label : str
        What happened.
    gesture : hashable or None
        Key of the running gesture that goes on changing the scene within this step.
    """

    scene: Scene
    label: str
    gesture: Hashable | None = None


class Store:
    """Holds the present scene and its history; every change goes through `update`.

    Equal values emit nothing. Camera moves are kept out of the history of edits: `update(..., record=False)`.

    A gesture (a drag, a turn of the wheel, a key held down) is known by a key. What is changed with its key
    between `begin_gesture` and `end_gesture` is one step of the history, which `undo` and `cancel_gesture`
    take back as a whole, whatever else changes the scene meanwhile: several gestures may run at once.

    Attributes
    ----------
    changed : signal (Scene, Scene)
        The scene is another one: the old and the new.
    history_changed : signal ()
        There are other steps to undo or redo.
    interaction_changed : signal (bool)
        The first gesture has begun (True), or the last one has ended (False).
    """

    changed = Signal(Scene, Scene)
    history_changed = Signal()
    interaction_changed = Signal(bool)

    def __init__(self, scene: Scene | None = None, *, limit: int = 200) -> None:
        self._scene = scene if scene is not None else Scene()
        self._past: list[_Step] = []
        self._future: list[_Step] = []
        self._gestures: set[Hashable] = set()
        self._limit = limit

    @property
    def scene(self) -> Scene:
        """The present scene."""
        return self._scene

    @property
    def undo_label(self) -> str | None:
        """What `undo` would take back, None when there is nothing."""
        return self._past[-1].label if self._past else None

    @property
    def redo_label(self) -> str | None:
        """What `redo` would do again, None when there is nothing."""
        return self._future[-1].label if self._future else None

    def update(
        self,
        change: Scene | Callable[[Scene], Scene],
        *,
        label: str = "Change",
        gesture: Hashable | None = None,
        record: bool = True,
    ) -> bool:
        """Replace the scene.

        Parameters
        ----------
        change : Scene or callable
            The new scene, or a function from the old to the new one.
        label : str
            What happened, for the undo menu.
        gesture : hashable, optional
            Key of a running gesture, whose changes are one step. A key that is not running makes no difference:
            the change is a step of its own.
        record : bool
            False leaves the history alone (camera).

        Returns
        -------
        bool
            Whether anything changed.
        """
        old = self._scene
        new = change(old) if callable(change) else change
        if new == old:
            return False
        self._scene = new
        if record:
            place = self._place_of(gesture)
            if place is None:
                self._past.append(_Step(old, label, gesture if self.has_gesture(gesture) else None))
                del self._past[: -self._limit]
            else:
                for later in self._past[place + 1 :]:
                    later.scene = with_change(later.scene, old, new)
            self._future.clear()
            self.history_changed.emit()
        self.changed.emit(old, new)
        return True

    # ------------------------------------------------------------------ gestures

    @property
    def is_interacting(self) -> bool:
        """Whether any gesture is running."""
        return bool(self._gestures)

    def has_gesture(self, key: Hashable) -> bool:
        """Whether the gesture of that key is running."""
        return key in self._gestures

    def begin_gesture(self, key: Hashable) -> None:
        """A drag or the like begins; a second call before its end does nothing."""
        is_first = not self._gestures
        self._gestures.add(key)
        if is_first:
            self.interaction_changed.emit(True)

    def end_gesture(self, key: Hashable) -> None:
        """The gesture is over; nothing happens when it is not running. One that changed nothing leaves no step."""
        place = self._place_of(key)
        if place is not None:
            step = self._past[place]
            step.gesture = None
            if self._keep_looks(step.scene) == self._keep_looks(self._scene_after(place)):
                del self._past[place]
                self.history_changed.emit()
        self._leave(key)

    def cancel_gesture(self, key: Hashable) -> None:
        """Take back what a running gesture has changed and end it, as when Escape is pressed during a drag.

        What others have changed meanwhile stays.
        """
        place = self._place_of(key)
        if place is not None:
            after, before = self._scene_after(place), self._past.pop(place).scene
            for later in self._past[place:]:
                later.scene = with_change(later.scene, after, before)
            old, self._scene = self._scene, self._keep_looks(with_change(self._scene, after, before))
            self.history_changed.emit()
            self.changed.emit(old, self._scene)
        self._leave(key)

    def _leave(self, key: Hashable) -> None:
        if key in self._gestures:
            self._gestures.remove(key)
            if not self._gestures:
                self.interaction_changed.emit(False)

    def _place_of(self, gesture: Hashable | None) -> int | None:
        """Index of the step of a running gesture, None while it has changed nothing."""
        return next((i for i, step in enumerate(self._past) if gesture and step.gesture == gesture), None)

    def _scene_after(self, place: int) -> Scene:
        """The scene with a step of the past and without those after it."""
        return self._past[place + 1].scene if place + 1 < len(self._past) else self._scene

    # ------------------------------------------------------------------ history

    def undo(self) -> bool:
        """Go back one step; cameras and the way of comparing stay. False when there is none."""
        return self._travel(self._past, self._future)

    def redo(self) -> bool:
        """Go forward again. False when there is nothing to do again."""
        return self._travel(self._future, self._past)

    def clear_history(self) -> None:
        """Forget all steps."""
        self._past.clear()
        self._future.clear()
        self.history_changed.emit()

    def _travel(self, source: list[_Step], target: list[_Step]) -> bool:
        if not source:
            return False
        step = source.pop()
        target.append(_Step(self._scene, step.label))
        old, self._scene = self._scene, self._keep_looks(step.scene)
        self.history_changed.emit()
        self.changed.emit(old, self._scene)
        return True

    def _keep_looks(self, scene: Scene) -> Scene:
        """An older scene looked at as now: the present cameras, active view and way of comparing.

        A scene that shows another volume keeps its own cameras.
        """
        present = self._scene
        scene = replace(
            scene, comparison=present.comparison, active=present.active, active_layer=present.active_layer
        )
        scene = replace(scene, active=scene.active_index)
        if [a.volume for a in scene.layers] != [a.volume for a in present.layers]:
            return scene
        cameras = [view.camera for view in present.views]
        cameras += [cameras[0]] * (len(scene.views) - len(cameras))
        views = zip(scene.views, cameras, strict=False)
        return replace(scene, views=tuple(replace(view, camera=camera) for view, camera in views))


def with_change(value: Any, old: Any, new: Any) -> Any:
    """`value` with what has changed from `old` to `new`, field by field and item by item.

    Parts that `value` does not have, or has in another number, stay as they are in `value`.
    """
    if old == new:
        return value
    if value == old:
        return new
    if isinstance(value, tuple) and isinstance(old, tuple) and isinstance(new, tuple):
        same_length = len(value) == len(old) == len(new)
        return tuple(map(with_change, value, old, new)) if same_length else value
    if not is_dataclass(value) or isinstance(value, type):
        return new
    if not type(value) is type(old) is type(new):
        return value
    names = [each.name for each in fields(value)]
    parts = {
        name: with_change(getattr(value, name), getattr(old, name), getattr(new, name)) for name in names
    }
    try:
        return replace(value, **parts)
    except VolvizError:
        return new  # some of these values do not go together
