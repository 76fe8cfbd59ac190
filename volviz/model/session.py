"""Scenes as JSON: session files, with a schema version and step-wise converters.

A session names its volumes by path and hints; neither arrays nor anything else out of a header is stored.
"""

from __future__ import annotations

import dataclasses
import json
import os
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, get_args

import numpy as np

from volviz.errors import LoadError, VolvizError
from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.comparison import MOST_VIEWS, Comparison
from volviz.model.layers import ImageLayer, LabelLayer, Layer
from volviz.model.light import Light
from volviz.model.measurements import measurement_from_dict, measurement_to_dict
from volviz.model.movie import Movie
from volviz.model.movies.files import movie_from_dict, movie_to_dict
from volviz.model.parameters import make_settings, parameters_of, setting_values
from volviz.model.scene import LAYOUTS, Scene, SceneView
from volviz.model.time_range import TimeRange
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.references import VolumeRef

#: Version that this program writes.
VERSION = 5
_LAYER_KINDS: dict[str, type[ImageLayer | LabelLayer]] = {"image": ImageLayer, "labels": LabelLayer}
KIND = "volviz session"
SUFFIX = ".volviz.json"

SettingsOf = Callable[[str], type[Any] | None]


def scene_to_dict(scene: Scene, folder: Path | None = None) -> dict[str, Any]:
    """Plain data for JSON; `scene_from_dict` gives back an equal scene.

    Parameters
    ----------
    scene : Scene
        What to describe; its layers show references.
    folder : Path, optional
        Where the session will lie: paths of volumes are stored relative to it as well, so that a session may
        be moved together with its data.

    Raises
    ------
    InputError
        A layer shows a volume in memory, which no file can name.
    """
    return {
        "kind": KIND,
        "version": VERSION,
        "layers": [_layer_to_dict(layer, folder) for layer in scene.layers],
        "light": dataclasses.asdict(scene.light),
        "clipping": dataclasses.asdict(scene.clipping),
        "background": scene.background,
        "views": [_view_to_dict(view) for view in scene.views],
        "active": scene.active,
        "comparison": dataclasses.asdict(scene.comparison),
        "cursor": scene.cursor,
        "tilt": scene.tilt,
        "layout": scene.layout,
        "active_layer": scene.active_layer,
        "measurements": [measurement_to_dict(each) for each in scene.measurements],
        "time_range": scene.time_range,
        "movie": movie_to_dict(scene.movie, lambda frame: _key_frame_to_dict(frame, folder)),
    }


def scene_from_dict(data: Any, settings_of: SettingsOf, folder: Path | None = None) -> Scene:
    """The scene that `scene_to_dict` described.

    Parameters
    ----------
    data : object
        What JSON gave, of any version up to `VERSION`.
    settings_of : callable
        Takes the id of a technique, gives its settings class, or None when there is no such technique: then
        its settings are left out, and a view that draws with it draws by ray casting.
    folder : Path, optional
        Where the session lies; a volume that is found relative to it is taken from there.

    Raises
    ------
    LoadError
        Not a session, from a newer program, or damaged.
    """
    if not isinstance(data, Mapping) or data.get("kind") != KIND:
        raise LoadError("this is no VolViz session; open volumes as files and sessions as *.volviz.json.")
    version = data.get("version")
    if not isinstance(version, int) or version < 1:
        raise LoadError("the session does not say which version it has; it is damaged.")
    if version > VERSION:
        raise LoadError(
            f"the session was written by a newer VolViz (version {version} of the format, this program knows "
            f"{VERSION}); update VolViz to open it."
        )
    try:
        converted = dict(data)
        for step in range(version, VERSION):
            converted = CONVERTERS[step](converted)
        return _scene(converted, settings_of, folder)
    except VolvizError as error:
        raise LoadError(f"the session is damaged: {error}") from error
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise LoadError(f"the session is damaged: {type(error).__name__} at {error}.") from error


def save_session(scene: Scene, path: str | os.PathLike[str]) -> None:
    """Write a session; a file that is already there is replaced only when the new one is complete.

    Raises
    ------
    LoadError
        The file cannot be written.
    """
    target = Path(path)
    part = target.with_name(target.name + ".part")
    try:
        text = json.dumps(scene_to_dict(scene, target.absolute().parent), indent=1)
        part.write_text(text + "\n", encoding="utf-8")
        part.replace(target)
    except OSError as error:
        raise LoadError(f"{target.name} cannot be written: {error.strerror or error}.") from error


def load_session(path: str | os.PathLike[str], settings_of: SettingsOf) -> Scene:
    """Read a session file.

    Raises
    ------
    LoadError
        It cannot be read or is no session.
    """
    source = Path(path)
    try:
        data = json.loads(source.read_text(encoding="utf-8"))
    except OSError as error:
        raise LoadError(f"{source.name} cannot be read: {error.strerror or error}.") from error
    except ValueError as error:
        raise LoadError(f"{source.name} is no VolViz session; it is not even JSON.") from error
    return scene_from_dict(data, settings_of, source.absolute().parent)


def _layer_to_dict(layer: Layer, folder: Path | None) -> dict[str, Any]:
    ref = layer.key.ref
    volume: dict[str, Any] = {"source": ref.source, "hints": dict(ref.hints), "content_id": ref.content_id}
    if folder is not None and Path(ref.source).is_absolute():
        with suppress(ValueError):  # another drive on Windows: there is no way from here to there
            volume["relative"] = relative = Path(os.path.relpath(ref.source, folder)).as_posix()
            if not relative.startswith("../"):
                # data beside the session: where both lie is nobody's business
                volume["source"] = relative
    values = {field.name: getattr(layer, field.name) for field in dataclasses.fields(layer)}
    if isinstance(layer, ImageLayer) and layer.transfer_function is not None:
        values["transfer_function"] = layer.transfer_function.to_dict()
    kind = next(kind for kind, made in _LAYER_KINDS.items() if isinstance(layer, made))
    return {"kind": kind, **values, "volume": volume}


def _key_frame_to_dict(scene: Scene, folder: Path | None) -> dict[str, Any]:
    """The scene of a key frame, which has no movie of its own."""
    return scene_to_dict(dataclasses.replace(scene, movie=Movie()), folder)


def _view_to_dict(view: SceneView) -> dict[str, Any]:
    settings = {technique: setting_values(values) for technique, values in view.settings}
    camera = None if view.camera is None else dataclasses.asdict(view.camera)
    return {
        "technique": view.technique,
        "settings": settings,
        "camera": camera,
        "own_camera": view.own_camera,
    }


def _scene(data: dict[str, Any], settings_of: SettingsOf, folder: Path | None) -> Scene:
    light, clipping = data["light"], data["clipping"]
    position = light["position"]
    views = tuple(_view(view, settings_of) for view in data["views"])[:MOST_VIEWS] or (SceneView(),)
    return Scene(
        layers=tuple(_layer(layer, folder) for layer in data["layers"]),
        light=Light(
            bool(light["headlight"]),
            None if position is None else _numbers(position, 3),
            _numbers(light["color"], 3),
            # absent where the session was written before a light could stand there
            bool(light.get("beside_eye", False)),
        ),
        clipping=Clipping(clipping["crop"], tuple((tuple(o), tuple(n)) for o, n in clipping["planes"])),
        background=None if data["background"] is None else _numbers(data["background"], 3),
        views=views,
        active=min(max(int(data["active"]), 0), len(views) - 1),
        comparison=_comparison(data["comparison"]),
        cursor=None if data["cursor"] is None else _numbers(data["cursor"], 3),
        layout=LAYOUTS[LAYOUTS.index(data["layout"])],
        # absent where the session was written before there were several layers to choose from
        active_layer=int(data.get("active_layer", 0)),
        # likewise of tilted slices
        tilt=None if data.get("tilt") is None else _rotation(data["tilt"]),
        # likewise of time points
        time_range=_time_range(data.get("time_range", "fixed")),
        measurements=tuple(measurement_from_dict(each) for each in data["measurements"]),
        movie=movie_from_dict(data["movie"], lambda frame: scene_from_dict(frame, settings_of, folder)),
    )


def _comparison(data: Mapping[str, Any]) -> Comparison:
    first, second = data["pair"]
    return Comparison(**{**data, "pair": (int(first), int(second))})


def _rotation(rows: Any) -> Any:
    """Rows of a rotation matrix."""
    matrix = np.array([_numbers(row, 3) for row in rows])
    if matrix.shape != (3, 3) or not np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-6):
        raise ValueError("a tilt that is no rotation")
    return tuple(tuple(float(v) for v in row) for row in matrix)


def _time_range(value: Any) -> TimeRange:
    choices: tuple[TimeRange, ...] = get_args(TimeRange)
    return choices[choices.index(value)]


def _layer(data: dict[str, Any], folder: Path | None) -> Layer:
    volume = data["volume"]
    source = str(volume["source"])
    if folder is not None and "relative" in volume:
        beside = Path(os.path.normpath(folder / volume["relative"]))
        if beside.exists() or source == volume["relative"]:
            source = str(beside)
    hints = tuple((str(k), tuple(v) if isinstance(v, list) else v) for k, v in volume["hints"].items())
    values = {name: value for name, value in data.items() if name not in ("kind", "volume")}
    if values.get("transfer_function") is not None:
        values["transfer_function"] = TransferFunction.from_dict(values["transfer_function"])
    return _LAYER_KINDS[data["kind"]](VolumeRef(source, hints, str(volume["content_id"])), **values)


def _view(data: dict[str, Any], settings_of: SettingsOf) -> SceneView:
    technique, camera = str(data["technique"]), data["camera"]
    view = SceneView(
        technique if settings_of(technique) is not None else SceneView().technique,
        camera=None if camera is None else _camera(camera),
        own_camera=bool(data["own_camera"]),
    )
    for technique, values in data["settings"].items():
        kind: Any = settings_of(technique)
        if kind is not None:
            known = {p.name for p in parameters_of(kind)}
            # a setting that a newer or older program does not have is left at its default
            kept = {name: value for name, value in values.items() if name in known}
            view = view.with_settings(technique, make_settings(kind, kept, owner=technique))
    return view


def _camera(data: dict[str, Any]) -> Camera:
    scale = data["parallel_scale"]
    return Camera(
        _numbers(data["position"], 3),
        _numbers(data["focal_point"], 3),
        _numbers(data["view_up"], 3),
        float(data["view_angle"]),
        bool(data["parallel"]),
        None if scale is None else float(scale),
    )


def _numbers(values: Any, count: int) -> Any:
    numbers = tuple(float(v) for v in values)
    if len(numbers) != count:
        raise ValueError(f"{count} numbers, got {len(numbers)}")
    return numbers


def _to_version_2(data: dict[str, Any]) -> dict[str, Any]:
    """Layers of more than one kind, with channel and time of their own, which were hints for the reader before.

    The active view and the way of comparing came into version 1 by and by; where they are absent, as their
    parts may be, they are at their defaults.
    """
    layers = []
    for layer in data["layers"]:
        hints = dict(layer["volume"]["hints"])
        chosen = {"channel": hints.pop("channel", None), "time": hints.pop("time", 0)}
        layers.append({**layer, **chosen, "kind": "image", "volume": {**layer["volume"], "hints": hints}})
    known = dataclasses.asdict(Comparison())
    told = {name: value for name, value in data.get("comparison", {}).items() if name in known}
    return {**data, "layers": layers, "active": data.get("active", 0), "comparison": {**known, **told}}


def _to_version_3(data: dict[str, Any]) -> dict[str, Any]:
    """Views with cameras of their own, a cursor, and views of unequal size."""
    views = [{**view, "own_camera": False} for view in data["views"]]
    return {**data, "views": views, "cursor": None, "layout": "grid"}


def _to_version_4(data: dict[str, Any]) -> dict[str, Any]:
    """Movies."""
    return {**data, "movie": {"steps": [], "fps": 24, "title": "", "stamp": False}}


def _to_version_5(data: dict[str, Any]) -> dict[str, Any]:
    """Measurements."""
    return {**data, "measurements": []}


#: Takes the data of a version, gives that of the next one; applied one after another.
CONVERTERS: Mapping[int, Callable[[dict[str, Any]], dict[str, Any]]] = {
    1: _to_version_2,
    2: _to_version_3,
    3: _to_version_4,
    4: _to_version_5,
}
