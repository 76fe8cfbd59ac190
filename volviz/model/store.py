"""The store: the one place where the scene changes, and its history."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field, replace

from psygnal import Signal

from volviz.model.scene import Scene


@dataclass
class _Step:
    scene: Scene
    label: str
    gesture: Hashable | None = field(default=None)


class Store:
    """Holds the present scene and its history; every change goes through `update`.

    Equal values emit nothing. Changes that carry the same `gesture` become one step of the history, so that a
    drag is undone at once. Camera moves are kept out of the history of edits: `update(..., record=False)`.
    """

    changed = Signal(Scene, Scene)
    history_changed = Signal()

    def __init__(self, scene: Scene | None = None, *, limit: int = 200) -> None:
        self._scene = scene if scene is not None else Scene()
        self._past: list[_Step] = []
        self._future: list[_Step] = []
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
            Successive changes with the same gesture are one step; `end_gesture` closes it.
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
            last = self._past[-1] if self._past else None
            if gesture is None or last is None or last.gesture != gesture:
                self._past.append(_Step(old, label, gesture))
                del self._past[: -self._limit]
            self._future.clear()
            self.history_changed.emit()
        self.changed.emit(old, new)
        return True

    def end_gesture(self) -> None:
        """The drag is over: the next change with the same gesture is a step of its own."""
        if self._past:
            self._past[-1].gesture = None

    def cancel_gesture(self, gesture: Hashable) -> None:
        """Take back what a running gesture has changed, as when Escape is pressed during a drag."""
        if self._past and self._past[-1].gesture == gesture:
            step = self._past.pop()
            old, self._scene = self._scene, self._keep_looks(step.scene)
            self.history_changed.emit()
            self.changed.emit(old, self._scene)

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
        scene = replace(scene, comparison=present.comparison, active=present.active)
        scene = replace(scene, active=scene.active_index)
        if [a.volume for a in scene.layers] != [a.volume for a in present.layers]:
            return scene
        cameras = [view.camera for view in present.views]
        cameras += [cameras[0]] * (len(scene.views) - len(cameras))
        views = zip(scene.views, cameras, strict=False)
        return replace(scene, views=tuple(replace(view, camera=camera) for view, camera in views))
