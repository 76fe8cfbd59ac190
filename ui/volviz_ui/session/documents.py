"""Opening volumes on a worker, with progress and cancel; finding them again when the history goes back."""

from __future__ import annotations

import os
from collections import OrderedDict, deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from psygnal import Signal as Event
from PySide6.QtCore import QObject, Signal

from volviz.custom_gl.layer_set import layer_function
from volviz.errors import InputError
from volviz.model.auto_isovalue import auto_isovalue
from volviz.model.layers import ImageLayer
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.references import VolumeKey, VolumeRef, content_id
from volviz.volume_data.scalars import bricks_of
from volviz.volume_data.source import VolumeSource
from volviz.volume_data.volume import Volume
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.session.volume_cache import VolumeCache
from volviz_ui.session.workers import Task, Workers

SAMPLE_PREFIX = "sample:"
SOURCES = 8
"""Files whose headers are kept."""


@dataclass(frozen=True)
class Opened:
    """What a worker brings: the volume and how to show it at first."""

    key: VolumeKey
    volume: Volume
    source: VolumeSource
    transfer_function: TransferFunction
    technique: str | None = None
    settings: Any = None
    scene: Scene | None = None
    """The whole scene, when a session was opened."""


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

    def __init__(self, store: Store, workers: Workers, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._store = store
        self._workers = workers
        self.cache = VolumeCache()
        self._sources: OrderedDict[VolumeRef, VolumeSource] = OrderedDict()
        self._shown = LoadedScene()
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
        return None if layer is None else self._sources.get(layer.key.ref)

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
        """Read a file, folder or ``sample:<id>`` and show it; the newest request wins.

        A channel is chosen by its number, from 0, or its name; without one, the file shows what it shows by itself.
        """
        text = os.fspath(source)
        if not text.startswith(SAMPLE_PREFIX):
            text = str(Path(text).absolute())
        ref = VolumeRef(text, tuple(hints.items()), content_id(text))
        self._way_back = None
        name = channel if isinstance(channel, str) else None
        number = None if isinstance(channel, str) else channel
        self._start(VolumeKey(ref, number, time), first=True, channel_name=name)

    def open_scene(self, scene: Scene) -> None:
        """Show a whole scene, as from a session file, once its volume has been read."""
        if scene.layer is None:
            if scene.layers:
                error = InputError("it holds labels alone, which cannot be drawn yet; add an image to it.")
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
        self._sources.clear()

    # ------------------------------------------------------------------ inside

    def _start(
        self, key: VolumeKey, *, first: bool, scene: Scene | None = None, channel_name: str | None = None
    ) -> None:
        name = title_of(key.ref)
        # headers are not read again for another time point
        source = None if first else self._sources.get(key.ref)
        task = self._workers.start(
            lambda task: open_volume(key, task, scene, source=source, channel=channel_name, first=first),
            label=name, key="load",
        )  # fmt: skip
        self._task = task
        task.progressed.connect(self.loading_progressed)
        task.succeeded.connect(self._on_first_loaded if first else self._on_loaded_again)
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

    def _on_loaded_again(self, opened: Opened) -> None:
        self._end()
        self._way_back = None
        self._keep(opened)
        self._follow(self._store.scene)

    def _keep(self, opened: Opened) -> None:
        self.cache.put(opened.key, opened.volume)
        self._sources[opened.key.ref] = opened.source
        self._sources.move_to_end(opened.key.ref)
        while len(self._sources) > SOURCES:
            self._sources.popitem(last=False)

    def _on_failed(self, task: Task, error: Exception) -> None:
        if task is not self._task:
            return
        awaited = self._awaited
        self._end()
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
        elif scene.layer is not None and scene.layer.key != self._awaited:
            self._awaited = scene.layer.key
            self._start(scene.layer.key, first=False)

    def _loaded(self, scene: Scene) -> LoadedScene | None:
        """The scene with its volumes, None when one of them must be read."""
        if scene.layer is None:
            return LoadedScene(scene)
        key = scene.layer.key
        if key in self._shown.volumes:
            return LoadedScene(scene, self._shown.volumes)
        volume = self.cache.get(key)
        return None if volume is None else LoadedScene(scene, {key: volume})

    def _show(self, new: LoadedScene) -> None:
        old, self._shown = self._shown, new
        if new.volume is not old.volume and new.volume is not None and self._workers.gate is not None:
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


def title_of(ref: VolumeRef) -> str:
    """What to call a source before it has been read."""
    if ref.source.startswith(SAMPLE_PREFIX):
        return ref.source.removeprefix(SAMPLE_PREFIX)
    return Path(ref.source).name or ref.source


def open_volume(
    key: VolumeKey,
    task: Task,
    scene: Scene | None = None,
    *,
    source: VolumeSource | None = None,
    channel: str | None = None,
    first: bool = True,
) -> Opened:
    """Read a volume and choose how to show it at first, unless a scene says it. Runs on a worker.

    Parameters
    ----------
    key : VolumeKey
    source : VolumeSource, optional
        Of the same file, where it has been opened before.
    channel : str, optional
        Name of the channel, in the place of its number.
    first : bool
        Nothing refers to the channel yet: that of a file which shows its first one by itself gets its number.
    """
    from volviz.io import open as open_source

    ref = key.ref
    task.report(-1.0, "")
    if source is None:
        source = open_source(
            ref.source, progress=task.report, cancel=lambda: task.is_cancelled, **dict(ref.hints)
        )
    if channel is not None:
        key = replace(key, channel=source.channel_number(channel))
    elif first and scene is None and key.channel is None and "c" in source.axes and not source.is_colour:
        key = replace(key, channel=0)
    volume = source.read(
        source.default_level,
        time=key.time,
        channel=key.channel,
        cancel=lambda: task.is_cancelled,
        progress=task.report,
    )
    # lazily computed and needed by every panel: done here, not in the window
    auto_isovalue(volume)
    bricks_of(volume)
    if scene is not None and scene.layer is not None:
        # the editor needs one function, in the place of colour and window, and with the opacity in it
        scene = scene.with_layer(transfer_function=layer_function(scene.layer, volume), opacity=1.0)
        return Opened(key, volume, source, scene.layer.transfer_function, scene=scene)
    preset_id = suggested_preset(ref)
    if preset_id is None:
        return Opened(key, volume, source, TransferFunction.auto(volume))
    from volviz.model.transfer.presets import preset, preset_for

    chosen = preset(preset_id)
    return Opened(key, volume, source, preset_for(chosen, volume), chosen.technique, chosen.settings)


def suggested_preset(ref: VolumeRef) -> str | None:
    """The preset that a bundled sample looks best with."""
    if not ref.source.startswith(SAMPLE_PREFIX):
        return None
    from volviz.io.samples import samples

    wanted = ref.source.removeprefix(SAMPLE_PREFIX)
    return next((sample.preset for sample in samples() if sample.id == wanted), None)


def scene_with(scene: Scene, opened: Opened) -> Scene:
    """The scene with another volume: its own transfer function, nothing cut away, the camera to be framed."""
    if opened.scene is not None:
        return opened.scene
    key = opened.key
    layer = ImageLayer(
        key.ref, opened.transfer_function, opened.volume.name, channel=key.channel, time=key.time
    )
    views = tuple(replace(view, camera=None) for view in scene.views)
    clipping = replace(scene.clipping, crop=None, planes=())
    light = replace(scene.light, position=None)
    return replace(scene, layers=(layer,), views=views, clipping=clipping, light=light)
