"""Reading what a window shows, on a worker: a volume and its first look, the layers of a file, a whole scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from volviz.custom_gl.layer_set import layer_function
from volviz.custom_gl.scene_techniques import with_look
from volviz.errors import VolvizError
from volviz.io.entries import Entry
from volviz.io.file_parts import open_reference, read_key
from volviz.model.auto_isovalue import auto_isovalue
from volviz.model.layer_looks import channel_color, channel_function
from volviz.model.layers import ImageLayer, LabelLayer, Layer
from volviz.model.looks.choice import best_look
from volviz.model.looks.look import Look
from volviz.model.movie import Movie
from volviz.model.scene import Scene
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.label_indices import label_indices_of
from volviz.volume_data.references import SAMPLE_PREFIX, VolumeKey, VolumeRef, content_id
from volviz.volume_data.scalars import bricks_of
from volviz.volume_data.source import VolumeSource
from volviz.volume_data.volume import Volume
from volviz_ui.session.workers import Task

#: Channels that may be shown together.
MOST_CHANNELS = 8


@dataclass(frozen=True)
class Opened:
    """What a worker brings: the volume and how to show it at first."""

    key: VolumeKey
    volume: Volume
    source: VolumeSource
    layers: tuple[Layer, ...] = ()
    """The layers that a file becomes: one image, its channels, or its labels."""
    look: Look | None = None
    """How the one image is drawn at first."""
    scene: Scene | None = None
    """The whole scene, when a session was opened."""
    others: Mapping[VolumeKey, Volume] = field(default_factory=dict)
    """Volumes of further layers."""


class SeveralImages(VolvizError):
    """The file holds several images, and nobody has said which one.

    Attributes
    ----------
    key : VolumeKey
        What was to be read.
    entries : sequence of Entry
    adds : bool
        It was to become a further layer.
    """

    def __init__(self, key: VolumeKey, entries: Sequence[Entry], *, adds: bool) -> None:
        super().__init__(f"{title_of(key.ref)}: it holds {len(entries)} images; choose one.")
        self.key = key
        self.entries = entries
        self.adds = adds


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
    adds: bool = False,
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
    adds : bool
        It becomes a further layer: labels become surfaces.

    Raises
    ------
    SeveralImages
        One of them is to be chosen first.
    """
    task.report(-1.0, "")
    # what was known of a file that has changed since then, or has gone, means nothing
    if source is None or content_id(key.ref.source) != key.ref.content_id:
        source = open_source(key.ref, task)
    images = [entry for entry in source.entries if not entry.is_labels]
    if first and scene is None and len(images) > 1 and "series" not in dict(key.ref.hints):
        raise SeveralImages(key, source.entries, adds=adds)
    if channel is not None:
        key = replace(key, channel=source.channel_number(channel))
    elif first and scene is None and key.channel is None and "c" in source.axes and not source.is_colour:
        key = replace(key, channel=0)
    volume = read_volume(source, key, task)
    if adds and source.is_labels:
        return _labels_of(source, key, volume)
    # lazily computed and needed by every panel: done here, not in the window
    auto_isovalue(volume)
    bricks_of(volume)
    if scene is not None and scene.layer is not None:
        return _whole_scene(scene, source, key, volume, task)
    look = None if adds else best_look(volume)
    function = TransferFunction.auto(volume) if look is None else look.transfer_function
    layer = ImageLayer(key.ref, function, volume.name, channel=key.channel, time=key.time)
    return Opened(key, volume, source, (layer,), look)


def open_source(ref: VolumeRef, task: Task) -> VolumeSource:
    """What can be read of a file."""
    return open_reference(ref, progress=task.report, cancel=lambda: task.is_cancelled)


def read_volume(source: VolumeSource, key: VolumeKey, task: Task) -> Volume:
    """The values that a key names."""
    return read_key(source, key, progress=task.report, cancel=lambda: task.is_cancelled)


def _whole_scene(scene: Scene, source: VolumeSource, key: VolumeKey, volume: Volume, task: Task) -> Opened:
    """A scene with the volumes of all its layers; that of the active one has been read."""
    volumes, sources = {key: volume}, {key.ref: source}
    for layer in scene.layers:
        other = layer.key
        if other not in volumes:
            if other.ref not in sources:
                sources[other.ref] = open_source(other.ref, task)
            volumes[other] = read_volume(sources[other.ref], other, task)
    layers = tuple(editable(layer, volumes[layer.key]) for layer in scene.layers)
    scene = replace(scene, layers=layers)
    return Opened(key, volume, source, scene=scene, others=volumes)


def editable(layer: Layer, volume: Volume) -> Layer:
    """A layer as the editor of functions takes it: a function in the place of colour and window."""
    if not isinstance(layer, ImageLayer):
        return layer
    function = layer_function(replace(layer, opacity=1.0), volume)
    return replace(layer, transfer_function=function, color=None, window=None)


def _labels_of(source: VolumeSource, key: VolumeKey, volume: Volume) -> Opened:
    """Labels as a layer, with the names and colours of their file."""
    label_indices_of(volume)
    colors = {label.number: label.color for label in source.labels if label.color is not None}
    names = {label.number: label.name for label in source.labels if label.name}
    layer = LabelLayer(key.ref, colors, names, name=volume.name, channel=key.channel, time=key.time)
    return Opened(key, volume, source, (layer,))


def has_channels(source: VolumeSource | None) -> bool:
    """Whether a file has channels that could be shown together: no colours, and not too many."""
    if source is None or "c" not in source.axes or source.is_colour or source.is_labels:
        return False
    return 1 < source.sizes["c"] <= MOST_CHANNELS


def open_channels(key: VolumeKey, source: VolumeSource, task: Task) -> Opened:
    """All channels of a file as layers, in the colours that it says or the usual ones. Runs on a worker."""
    volumes: dict[VolumeKey, Volume] = {}
    layers = []
    for number, known in enumerate(source.channels):
        each = replace(key, channel=number)
        volume = volumes[each] = read_volume(source, each, task)
        auto_isovalue(volume)
        bricks_of(volume)
        function = channel_function(volume, known.color or channel_color(number), known.window)
        name = known.name or f"Channel {number + 1}"
        layers.append(ImageLayer(key.ref, function, name, channel=number, time=key.time))
    first = replace(key, channel=0)
    return Opened(first, volumes[first], source, tuple(layers), others=volumes)


def scene_with(scene: Scene, opened: Opened) -> Scene:
    """The scene with another volume: its own transfer function, nothing cut away, the camera to be framed.

    What was said of the volume before, where slices lie, measurements, the movie, goes with it; undo brings all back.
    """
    if opened.scene is not None:
        return opened.scene
    views = tuple(replace(view, camera=None) for view in scene.views)
    clipping = replace(scene.clipping, crop=None, planes=())
    light = replace(scene.light, position=None)
    changed = replace(
        scene, layers=opened.layers, active_layer=0, views=views, clipping=clipping, light=light, cursor=None,
        tilt=None, measurements=(), movie=Movie(),
    )  # fmt: skip
    return changed if opened.look is None else with_look(changed, opened.look)
