"""The scene, a frozen tree of values, and the store, the one place where it changes."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field, replace
from typing import Any

from psygnal import Signal

from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.comparison import Comparison
from volviz.model.light import Light
from volviz.model.transfer_function import TransferFunction

Color = tuple[float, float, float]


@dataclass(frozen=True)
class VolumeRef:
    """Where a volume comes from, without its array.

    Attributes
    ----------
    source : str
        Path of a file or folder, ``sample:<name>``, or ``array:<number>`` for one handed over by a program.
    hints : tuple of (name, value)
        How to read it (raw dimensions, channel, time point).
    content_id : str
        Changes when the file changes; part of the cache key.
    """

    source: str
    hints: tuple[tuple[str, Hashable], ...] = ()
    content_id: str = ""


@dataclass(frozen=True)
class Layer:
    """One volume in the scene and how it is classified."""

    volume: VolumeRef
    transfer_function: TransferFunction
    name: str = ""
    visible: bool = True
    channel: int = 0
    time: int = 0


@dataclass(frozen=True)
class View:
    """One viewport: technique, its settings, camera.

    Attributes
    ----------
    technique : str
        Id of the technique that draws.
    settings : tuple of (technique id, settings)
        Settings of every technique that was changed; the others have their defaults.
    camera : Camera or None
        None until the first picture is framed.
    """

    technique: str = "raycast"
    settings: tuple[tuple[str, Any], ...] = ()
    camera: Camera | None = None

    def settings_for(self, technique: str, default: Callable[[], Any]) -> Any:
        """Settings of a technique, made by `default` when none are stored."""
        for key, value in self.settings:
            if key == technique:
                return value
        return default()

    def with_settings(self, technique: str, settings: Any) -> View:
        """The view with other settings for a technique."""
        others = tuple(pair for pair in self.settings if pair[0] != technique)
        return replace(self, settings=(*others, (technique, settings)))


@dataclass(frozen=True)
class Scene:
    """Everything that decides the picture, as one value.

    Attributes
    ----------
    layers : tuple of Layer
        What is shown.
    light, clipping, background
        Shared by all views.
    views : tuple of View
        One, or two to four that are compared; they share one camera.
    active : int
        Number of the view that panels and keys act on.
    comparison : Comparison
        How several views are looked at together.
    """

    layers: tuple[Layer, ...] = ()
    light: Light = Light()
    clipping: Clipping = Clipping()
    background: Color | None = None
    views: tuple[View, ...] = (View(),)
    active: int = 0
    comparison: Comparison = Comparison()

    @property
    def layer(self) -> Layer | None:
        """The first layer, the one that single-volume techniques draw."""
        return self.layers[0] if self.layers else None

    @property
    def view(self) -> View:
        """The view that panels and keys act on."""
        return self.views[self.active_index]

    @property
    def active_index(self) -> int:
        """Number of the active view, within those that there are."""
        return min(max(self.active, 0), len(self.views) - 1)

    @property
    def pair(self) -> tuple[int, int] | None:
        """Numbers of the two views that are compared, A and B; None when there is one view only."""
        return self.comparison.pair_of(len(self.views)) if len(self.views) > 1 else None

    @property
    def seen(self) -> tuple[int, ...]:
        """Numbers of the views that are to be seen, or whose difference is."""
        pair = self.pair
        overlaid = pair is not None and self.comparison.mode != "side_by_side"
        return pair if pair is not None and overlaid else tuple(range(len(self.views)))

    def with_layer(self, **changes: Any) -> Scene:
        """The scene with the first layer changed."""
        return replace(self, layers=(replace(self.layers[0], **changes), *self.layers[1:]))

    def with_view(self, index: int | None = None, /, **changes: Any) -> Scene:
        """The scene with one view changed, the active one unless another is named."""
        at = self.active_index if index is None else index
        views = list(self.views)
        views[at] = replace(views[at], **changes)
        return replace(self, views=tuple(views))

    def with_camera(self, camera: Camera | None) -> Scene:
        """The scene seen from another place, in all views."""
        return replace(self, views=tuple(replace(view, camera=camera) for view in self.views))

    def with_view_count(self, count: int) -> Scene:
        """The scene with so many views: new ones repeat the active one, those at the end go."""
        views = (*self.views, *(count - len(self.views)) * (self.view,))[: max(count, 1)]
        comparison = replace(self.comparison, pair=self.comparison.pair if count > 2 else (0, 1))
        return replace(
            self, views=views, active=min(self.active_index, len(views) - 1), comparison=comparison
        )

    def without_view(self, index: int) -> Scene:
        """The scene with one view closed; the last one stays."""
        if len(self.views) == 1:
            return self
        views = (*self.views[:index], *self.views[index + 1 :])
        active = self.active_index - (self.active_index > index)
        comparison = self.comparison.without_view(index, len(self.views))
        return replace(self, views=views, active=min(active, len(views) - 1), comparison=comparison)


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
