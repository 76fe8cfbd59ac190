"""Opening volumes on a worker, with progress and cancel; finding them again when the history goes back."""

from __future__ import annotations

import os
from collections import OrderedDict, deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from psygnal import Signal as Event
from PySide6.QtCore import QObject, Signal

from volviz.errors import InputError
from volviz.io.file_parts import box_again, box_in_full, shown_part, whole_of
from volviz.model.clipping import Clipping, Crop
from volviz.model.layer_edits import with_added, with_layers_instead
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.volume_data.references import (
    VolumeKey,
    VolumeRef,
    content_id,
    reference_to,
)
from volviz.volume_data.source import VolumeSource
from volviz.volume_data.volume import Volume
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.session.opening import (
    Opened,
    SeveralImages,
    has_channels,
    open_channels,
    open_volume,
    scene_with,
    title_of,
)
from volviz_ui.session.volume_cache import VolumeCache
from volviz_ui.session.workers import Task, Workers

SOURCES = 8
"""Files whose headers are kept."""
FRAMES_BUDGET = 384 << 20
"""Bytes of time points that are kept or have been read ahead, with the texels made of them."""


class Documents(QObject):
    """Keeps the volumes of the scene at hand.

    Attributes
    ----------
    changed : signal (LoadedScene, LoadedScene)
        What is shown is something else: the old and the new. It follows every change of the store as soon as the
        volumes of the new scene are there; while a file is being read (again, after undo) the former pair stays.
        A listener that changes the scene is heard after all have taken the change before.
    """

    changed = Event(LoadedScene, LoadedScene)
    loading_started = Signal(str)
    loading_progressed = Signal(float, str)
    loading_ended = Signal()
    opened = Signal(object)
    failed = Signal(str, object)
    """What was to be opened, and the error."""
    choice_needed = Signal(object)
    """A `SeveralImages`: a file holds several images."""

    def __init__(
        self,
        store: Store,
        workers: Workers,
        parent: QObject | None = None,
        *,
        corrections: Callable[[VolumeRef], Mapping[str, Any]] = lambda _ref: {},
    ) -> None:
        super().__init__(parent)
        self._corrections = corrections
        self._store = store
        self._workers = workers
        self.cache = VolumeCache()
        #: Time points of the data that is shown.
        self.frames = VolumeCache(FRAMES_BUDGET)
        self._sources: OrderedDict[VolumeRef, VolumeSource] = OrderedDict()
        self._shown = LoadedScene()
        self._read: dict[VolumeKey, Volume] = {}
        self._shown = self._loaded(store.scene) or self._shown
        self._changes: deque[tuple[LoadedScene, LoadedScene]] = deque()
        self._awaited: VolumeKey | None = None
        self._task: Task | None = None
        self._way_back: Callable[[], bool] | None = None
        store.changed.connect(self._on_scene_changed)

    # ------------------------------------------------------------------ asking

    @property
    def shown(self) -> LoadedScene:
        """What is shown now."""
        return self._shown

    @property
    def volume(self) -> Volume | None:
        """The volume that is shown now."""
        return self._shown.volume

    @property
    def source(self) -> VolumeSource | None:
        """Where the volume that is shown comes from: its other time points and channels can be read of it."""
        layer = self._shown.scene.layer
        return None if layer is None else self._sources.get(whole_of(layer.key.ref))

    def source_of(self, ref: VolumeRef) -> VolumeSource | None:
        """Where the data of a layer comes from; None where it is not known any more."""
        return self._sources.get(ref)

    def at_hand(self, key: VolumeKey) -> Volume | None:
        """A volume that need not be read."""
        return (
            self._shown.volumes.get(key) or self._read.get(key) or self.frames.get(key) or self.cache.get(key)
        )

    @property
    def is_current(self) -> bool:
        """Whether the scene of the store is the one that is shown, and no volume is awaited for it."""
        return self._shown.scene is self._store.scene

    @property
    def is_loading(self) -> bool:
        """Whether a volume is being read."""
        return self._task is not None

    # ------------------------------------------------------------------ opening

    def open(
        self, source: str | os.PathLike[str], *, channel: int | str | None = None, time: int = 0, **hints: Any
    ) -> None:
        """Read a file, folder, URL or ``sample:<id>`` and show it; the newest request wins.

        A channel is chosen by its number, from 0, or its name; without one, the file shows what it shows by itself.
        """
        ref = self._reference_to(source, hints)
        self._way_back = None
        name = channel if isinstance(channel, str) else None
        number = None if isinstance(channel, str) else channel
        self._start(VolumeKey(ref, number, time), first=True, channel_name=name)

    def add(self, source: str | os.PathLike[str], **hints: Any) -> None:
        """Read a file, folder or ``sample:<id>`` and show it as a further layer."""
        if self._store.scene.layer is None:
            self.open(source, **hints)
            return
        key = VolumeKey(self._reference_to(source, hints), None, 0)
        self._way_back = None
        self._run(key, lambda task: open_volume(key, task, adds=True), self._on_added)

    def _reference_to(self, source: str | os.PathLike[str], hints: Mapping[str, Any]) -> VolumeRef:
        """The reference to a file, with what was corrected about it; what is asked for counts first."""
        ref = reference_to(source, hints)
        return replace(ref, hints=tuple({**self._corrections(ref), **dict(ref.hints)}.items()))

    def correct(self, hints: Mapping[str, Any], instead_of: Sequence[str]) -> None:
        """Read the file of the active layer anew, with other hints in the place of those that are named."""
        layer = self._shown.scene.layer
        if layer is None:
            return
        ref = layer.key.ref
        kept = {name: value for name, value in ref.hints if name not in instead_of}
        corrected = replace(ref, hints=tuple({**kept, **hints}.items()))

        def changed(scene: Scene) -> Scene:
            layers = tuple(
                replace(layer, volume=corrected) if layer.volume == ref else layer for layer in scene.layers
            )
            # it may have become a thousand times as large
            views = tuple(replace(view, camera=None) for view in scene.views)
            return replace(scene, layers=layers, views=views)

        self._way_back = self._store.undo
        self._store.update(changed, label=self.tr("Correct what was understood"))

    @property
    def finer_box(self) -> bool:
        """Whether a box of what is shown can be read at a finer level: the file has one, and all of it is shown."""
        layer, source = self._shown.scene.layer, self.source
        if layer is None or source is None:
            return False
        level, box = shown_part(source, layer.key.ref)
        return level > 0 and box is None

    @property
    def shows_box(self) -> bool:
        """Whether a box of the file is shown instead of all of it."""
        layer = self._shown.scene.layer
        return layer is not None and "box" in dict(layer.key.ref.hints)

    def show_box_in_full(self) -> None:
        """Read what the crop box shows at the finest level at which it fits, and show that alone."""
        layer, source, crop = self._shown.scene.layer, self.source, self._shown.scene.clipping.crop
        if layer is not None and source is not None and crop is not None:
            crop = Clipping(crop).crop_within(self._shown.volumes[layer.key].dimensions)
            ref = box_in_full(source, layer.key.ref, crop)
            self._show_part(layer.key.ref, ref, None, self.tr("This box in full"))

    def show_whole_again(self) -> None:
        """Show all of the file again, with the box that was shown as the crop box."""
        layer, source = self._shown.scene.layer, self.source
        if layer is not None and source is not None:
            whole, crop = box_again(source, layer.key.ref)
            self._show_part(layer.key.ref, whole, crop, self.tr("The whole volume"))

    def _show_part(self, old: VolumeRef, new: VolumeRef, crop: Crop | None, label: str) -> None:
        """Let all layers of a file show another part of it; cancelling the reading takes that back."""

        def changed(scene: Scene) -> Scene:
            layers = tuple(
                replace(layer, volume=new) if layer.volume == old else layer for layer in scene.layers
            )
            return replace(scene, layers=layers, clipping=replace(scene.clipping, crop=crop))

        self._way_back = self._store.undo
        self._store.update(changed, label=label)

    def show_all_channels(self) -> None:
        """Show all channels of the file that the active layer shows, each as a layer, in the place of that layer."""
        layer, source = self._shown.scene.layer, self.source
        if layer is not None and source is not None and has_channels(source):
            key = layer.key
            self._way_back = None
            self._run(key, lambda task: open_channels(key, source, task), self._on_channels)

    def open_scene(self, scene: Scene) -> None:
        """Show a whole scene, as from a session file, once its volume has been read."""
        if scene.layer is None:
            if scene.layers:
                error = InputError(
                    "it holds labels alone, which the window shows beside an image; add one to it."
                )
                self.failed.emit(self.tr("The session"), error)
            return
        self._way_back = None
        refs = [layer.key.ref for layer in scene.layers]
        layers = tuple(
            replace(layer, volume=replace(ref, content_id=content_id(ref.source)))
            for layer, ref in zip(scene.layers, refs, strict=True)
        )
        scene = replace(scene, layers=layers)
        self._start(scene.layer.key, first=True, scene=scene)

    def cancel(self) -> None:
        """Give up what is being read."""
        if self._task is not None:
            self._task.cancel()
            self._end()
            self._return_to_shown()

    def undo(self) -> None:
        """One step back; a file that has left the cache is read again."""
        self._way_back = self._store.redo
        self._store.undo()

    def redo(self) -> None:
        """One step forward again."""
        self._way_back = self._store.undo
        self._store.redo()

    def close(self) -> None:
        """Stop listening and let go of all volumes."""
        self._store.changed.disconnect(self._on_scene_changed, missing_ok=True)
        self._task = None
        self._shown = LoadedScene()
        self.cache.clear()
        self.frames.clear()
        self._sources.clear()

    # ------------------------------------------------------------------ inside

    def _start(
        self, key: VolumeKey, *, first: bool, scene: Scene | None = None, channel_name: str | None = None
    ) -> None:
        # headers are not read again for another time point
        source = None if first else self._sources.get(whole_of(key.ref))
        self._run(
            key,
            lambda task: open_volume(key, task, scene, source=source, channel=channel_name, first=first),
            self._on_first_loaded if first else self._on_loaded_again,
        )

    def _run(self, key: VolumeKey, work: Callable[[Task], Opened], done: Callable[[Opened], None]) -> None:
        """Read on a worker; the newest request wins."""
        name = title_of(key.ref)
        task = self._workers.start(work, label=name, key="load")
        self._task = task
        task.progressed.connect(self.loading_progressed)
        task.succeeded.connect(done)
        task.failed.connect(lambda error: self._on_failed(task, error))
        self.loading_started.emit(name)

    def _end(self) -> None:
        self._task = None
        self._awaited = None
        self.loading_ended.emit()

    def _on_first_loaded(self, opened: Opened) -> None:
        self._end()
        self._keep(opened)
        is_first = self._store.scene.layer is None
        self._store.update(
            lambda scene: scene_with(scene, opened),
            label=self.tr("Open %1").replace("%1", opened.volume.name),
        )
        if is_first:
            # there is nothing to go back to: an empty window is not a state anybody made
            self._store.clear_history()
        self.opened.emit(opened)

    def _on_added(self, opened: Opened) -> None:
        self._end()
        self._keep(opened)
        self._store.update(
            lambda scene: with_added(scene, opened.layers),
            label=self.tr("Add %1").replace("%1", opened.volume.name),
        )

    def _on_channels(self, opened: Opened) -> None:
        self._end()
        self._keep(opened)
        self._store.update(
            lambda scene: with_layers_instead(scene, opened.key.ref, opened.layers),
            label=self.tr("All channels"),
        )

    def _on_loaded_again(self, opened: Opened) -> None:
        self._end()
        self._way_back = None
        self._keep(opened)
        self._follow(self._store.scene)

    def _keep(self, opened: Opened) -> None:
        # several may be read one after the other, and all are needed before any is shown
        read = {opened.key: opened.volume, **opened.others}
        self._read |= read
        for key, volume in read.items():
            self.cache.put(key, volume)
        ref = whole_of(opened.key.ref)
        self._sources[ref] = opened.source
        self._sources.move_to_end(ref)
        while len(self._sources) > SOURCES:
            self._sources.popitem(last=False)

    def _on_failed(self, task: Task, error: Exception) -> None:
        if task is not self._task:
            return
        awaited = self._awaited
        self._end()
        if isinstance(error, SeveralImages):
            self.choice_needed.emit(error)
            return
        self.failed.emit(task.label, error)
        if awaited is not None:
            self._return_to_shown()

    def _return_to_shown(self) -> None:
        """Make the scene show again what is at hand, after a file of the history could not be read."""
        if self.is_current or self._shown.volume is None:
            return
        way_back, self._way_back = self._way_back, None
        if way_back is not None:
            way_back()
        if not self.is_current:
            layers = self._shown.scene.layers
            self._store.update(lambda scene: replace(scene, layers=layers), label=self.tr("Keep the volume"))

    def _on_scene_changed(self, _old: Scene, new: Scene) -> None:
        self._follow(new)

    def _follow(self, scene: Scene) -> None:
        """Show a scene once its volumes are there."""
        loaded = self._loaded(scene)
        if loaded is not None:
            if self._awaited is not None:
                self._workers.cancel("load")
                self._end()
            self._show(loaded)
        else:
            missing = next(key for key in keys_of(scene) if self.at_hand(key) is None)
            if missing != self._awaited:
                self._awaited = missing
                self._start(missing, first=False)

    def _loaded(self, scene: Scene) -> LoadedScene | None:
        """The scene with its volumes, None when one of them must be read."""
        keys = keys_of(scene)
        if set(keys) == set(self._shown.volumes):
            return LoadedScene(scene, self._shown.volumes)
        volumes: dict[VolumeKey, Volume] = {}
        for key in keys:
            volume = self.at_hand(key)
            if volume is None:
                return None
            volumes[key] = volume
        return LoadedScene(scene, volumes)

    def _show(self, new: LoadedScene) -> None:
        old, self._shown = self._shown, new
        self._read = {}
        is_new = new.volume is not None and new.volume not in old.volumes.values()
        if is_new and self._workers.gate is not None:
            # the histograms wait until the first image has been drawn
            self._workers.gate.shut()
        self._changes.append((old, new))
        if len(self._changes) > 1:
            return
        while self._changes:
            try:
                self.changed.emit(*self._changes[0])
            finally:
                self._changes.popleft()


def keys_of(scene: Scene) -> list[VolumeKey]:
    """What the layers of a scene show; nothing of one that has no image, which nobody draws."""
    return [] if scene.layer is None else [layer.key for layer in scene.layers]
