"""Scenes without a window: read from files, their volumes read when they are needed and kept while they fit."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping
from pathlib import Path

from volviz.custom_gl.registry import known_settings
from volviz.custom_gl.resolve import resolve
from volviz.custom_gl.scene_techniques import drawn_spec, surroundings
from volviz.embedded_session import session_in
from volviz.errors import LoadError
from volviz.io.file_parts import open_reference, read_key
from volviz.model.layers import Layer
from volviz.model.movie import Surroundings
from volviz.model.scene import Scene
from volviz.model.session import SUFFIX, load_session, scene_from_dict
from volviz.volume_data.references import VolumeKey, VolumeRef, content_id
from volviz.volume_data.source import VolumeSource
from volviz.volume_data.volume import Volume

#: Bytes of volumes that are kept beyond those of the present scene.
KEPT_BYTES = 512 << 20


class SceneVolumes:
    """Reads what the layers of scenes name.

    Parameters
    ----------
    known : mapping from VolumeKey to Volume, optional
        What has been read already.
    """

    def __init__(self, known: Mapping[VolumeKey, Volume] | None = None) -> None:
        self._volumes: OrderedDict[VolumeKey, Volume] = OrderedDict(known or {})
        self._sources: dict[VolumeRef, VolumeSource] = {}

    def of(self, scene: Scene, cancel: Callable[[], bool] | None = None) -> dict[VolumeKey, Volume]:
        """The volumes of a scene.

        Raises
        ------
        VolvizError
            A file cannot be read, has no such channel or time point, or `Cancelled`.
        """
        found: dict[VolumeKey, Volume] = {}
        for layer in scene.layers:
            key = layer.key
            if key not in self._volumes:
                self._volumes[key] = read_key(self.source(layer), key, cancel=cancel)
            self._volumes.move_to_end(key)
            found[key] = self._volumes[key]
        spare = sum(v.array.nbytes for key, v in self._volumes.items() if key not in found)
        for key in [key for key in self._volumes if key not in found]:
            if spare <= KEPT_BYTES:
                break
            spare -= self._volumes.pop(key).array.nbytes
        return found

    def source(self, layer: Layer) -> VolumeSource:
        """What a layer is read from, opened once."""
        ref = layer.key.ref
        if ref not in self._sources:
            self._sources[ref] = open_reference(ref)
        return self._sources[ref]

    def changed(self, scene: Scene) -> tuple[str, ...]:
        """Files of a scene that are not what they were when the scene was stored."""
        refs = {layer.key.ref for layer in scene.layers}
        return tuple(sorted(r.source for r in refs if r.content_id and content_id(r.source) != r.content_id))

    def surroundings(self, scene: Scene) -> Surroundings:
        """What moves have to know of the volumes."""
        times = max((self.source(layer).sizes.get("t", 1) for layer in scene.layers), default=1)
        return surroundings(self.of(scene).values(), times)


def framed(scene: Scene, volumes: Mapping[VolumeKey, Volume], size: tuple[int, int]) -> Scene:
    """The scene with a camera in its active view, which frames what is visible where it has none.

    Parameters
    ----------
    scene : Scene
    volumes : mapping from VolumeKey to Volume
        What its layers show.
    size : tuple of 2 ints
        Width and height of the image in pixels.
    """
    if scene.view.camera is not None:
        return scene
    camera = resolve(drawn_spec(scene), volumes).framing_camera(size)
    return scene.with_camera(camera, scene.active_index)


def holds_scene(path: Path) -> bool:
    """Whether a file is a session, or a picture that carries one."""
    if path.name.lower().endswith(SUFFIX):
        return True
    try:
        return path.is_file() and session_in(path) is not None
    except LoadError:
        return False


def load_scene(path: Path) -> Scene:
    """The scene of a session file, or of a picture that carries one.

    Raises
    ------
    LoadError
        It cannot be read, carries none, or is damaged or newer than this program.
    """
    carried = None if path.name.lower().endswith(SUFFIX) else session_in(path)
    if carried is None:
        return load_session(path, known_settings)
    return scene_from_dict(carried, known_settings, path.absolute().parent)
