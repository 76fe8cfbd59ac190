"""Sessions: what is saved comes back, what is damaged is refused in a sentence."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from volviz.errors import InputError, LoadError
from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.comparison import Comparison
from volviz.model.layers import ImageLayer, LabelLayer
from volviz.model.light import Light
from volviz.model.measurement_edits import with_measurement, with_measurement_changed, without_measurements
from volviz.model.measurements import Measurement, Point
from volviz.model.parameters import parameter
from volviz.model.scene import Scene, SceneView
from volviz.model.session import VERSION, load_session, save_session, scene_from_dict, scene_to_dict
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.references import VolumeRef
from volviz.volume_data.volume import Volume


@dataclass(frozen=True)
class Settings:
    step: float = parameter(0.5, "Step", "Distance.", minimum=0.01, maximum=10.0)
    shading: bool = parameter(False, "Shading", "Light.")
    levels: tuple[float, ...] = parameter((1.0,), "Levels", "Values.", kind="floats")
    distance: float | None = parameter(None, "Distance", "Length.", kind="float", optional=True)


def settings_of(technique: str) -> type[Any] | None:
    return Settings if technique in ("raycast", "slicing") else None


finite = st.floats(-1e6, 1e6, allow_nan=False)
unit = st.floats(0, 1)
vectors = st.tuples(finite, finite, finite)
colors = st.tuples(unit, unit, unit)
functions = st.lists(st.tuples(finite, st.tuples(unit, unit, unit, unit)), min_size=1, max_size=6).map(
    lambda points: TransferFunction.from_points(points, name="mine")
)
cameras = st.builds(
    Camera,
    position=vectors,
    focal_point=st.just((2e6, 0.0, 0.0)),
    view_angle=st.floats(1, 170),
    parallel=st.booleans(),
)
settings = st.builds(
    Settings,
    step=st.floats(0.01, 10),
    shading=st.booleans(),
    levels=st.lists(finite, min_size=1, max_size=4).map(tuple),
    distance=st.none() | finite,
)
refs = st.builds(
    VolumeRef,
    source=st.just("sample:engine"),
    hints=st.sampled_from([(), (("dims", (3, 4, 5)), ("dtype", "uint8"))]),
    content_id=st.text(max_size=5),
)
shared: dict[str, Any] = {
    "volume": refs,
    "name": st.text(max_size=10),
    "visible": st.booleans(),
    "channel": st.none() | st.integers(0, 9),
    "time": st.integers(0, 999),
    "opacity": unit,
    "transform": st.none()
    | vectors.map(lambda v: [[1, 0, 0, v[0]], [0, -2, 0, v[1]], [0, 1, 1, v[2]], [0, 0, 0, 1]]),
}
modes = st.sampled_from(["add", "mask", "modulate"])
windows = st.none() | st.tuples(finite, st.floats(1, 10)).map(lambda w: (w[0], w[0] + w[1]))
labels = st.integers(0, 2**31)
layers = (
    st.builds(ImageLayer, transfer_function=st.none() | functions, mode=modes, **shared)
    | st.builds(ImageLayer, color=st.none() | colors, window=windows, mode=modes, **shared)
    | st.builds(
        LabelLayer,
        colors=st.none() | st.dictionaries(labels, colors, max_size=3),
        names=st.none() | st.dictionaries(labels, st.text(max_size=5), max_size=3),
        hidden=st.lists(labels, max_size=3),
        smooth=st.booleans(),
        **shared,
    )
)
scenes = st.builds(
    Scene,
    layers=st.lists(layers, max_size=3).map(tuple),
    light=st.builds(
        Light, headlight=st.booleans(), position=st.none() | vectors, color=colors, beside_eye=st.booleans()
    ),
    clipping=st.sampled_from([Clipping(), Clipping((0, 5, 1, 4, 2, 9), (((0, 0, 1), (0, 0.6, 0.8)),))]),
    background=st.none() | colors,
    views=st.builds(
        SceneView,
        technique=st.sampled_from(["raycast", "slicing"]),
        settings=settings.map(lambda values: (("slicing", values),)),
        camera=st.none() | cameras,
    ).map(lambda view: (view,)),
)


@given(scenes)
def test_a_scene_survives_json(scene: Scene) -> None:
    text = json.dumps(scene_to_dict(scene))
    assert scene_from_dict(json.loads(text), settings_of) == scene


def session_1() -> Any:
    """What the program wrote before layers had kinds: hints choose channel 1 and time 2 of a file."""
    return json.loads((Path(__file__).parent / "session-1.volviz.json").read_text())


def test_a_session_of_version_1_is_converted() -> None:
    scene = scene_from_dict(session_1(), settings_of)
    (layer,) = scene.layers
    assert isinstance(layer, ImageLayer)
    assert layer.volume == VolumeRef("/data/h.tif", (("spacing", (1.0, 1.0, 2.0)),), "5f-1a")
    assert (layer.channel, layer.time, layer.name, layer.visible) == (1, 2, "h", True)
    assert layer.transfer_function is not None
    assert [point.value for point in layer.transfer_function.points] == [0, 700]
    assert (layer.opacity, layer.mode, layer.transform, layer.color) == (1.0, "add", None, None)
    assert (scene.active, scene.comparison) == (1, Comparison("wipe", (1, 0), 0.25))
    assert scene.light == Light(False, (1.0, 2.0, 3.0))
    assert scene_from_dict(scene_to_dict(scene), settings_of) == scene


def test_a_session_of_one_view_without_hints_is_converted() -> None:
    data = session_1()
    del data["active"], data["comparison"]
    data["layers"][0]["volume"]["hints"] = {}
    scene = scene_from_dict(data, settings_of)
    assert scene.layer is not None
    assert (scene.layer.channel, scene.layer.time, scene.layer.key.ref.hints) == (None, 0, ())
    assert (scene.active, scene.comparison) == (0, Comparison())


def test_parts_of_a_comparison_that_came_later_are_at_their_defaults() -> None:
    data = session_1()
    data["comparison"] = {"mode": "blink", "of the future": 3}
    assert scene_from_dict(data, settings_of).comparison == Comparison("blink")


def test_a_volume_in_memory_cannot_be_saved(tmp_path: Path) -> None:
    scene = Scene((ImageLayer(Volume(np.zeros((2, 2, 2)))),))
    with pytest.raises(InputError, match="references only"):
        save_session(scene, tmp_path / "a.volviz.json")
    assert not list(tmp_path.iterdir())


def a_scene(source: str) -> Scene:
    return Scene(layers=(ImageLayer(VolumeRef(source), TransferFunction.from_points([(0, (1, 0, 0, 0.5))])),))


def test_a_session_moved_together_with_its_data_finds_them(tmp_path: Path) -> None:
    old, new = tmp_path / "old", tmp_path / "new"
    (old / "data").mkdir(parents=True)
    (old / "data" / "head.npy").write_bytes(b"x")
    save_session(a_scene(str(old / "data" / "head.npy")), old / "a.volviz.json")
    old.rename(new)
    scene = load_session(new / "a.volviz.json", settings_of)
    assert scene.layer is not None
    assert scene.layer.volume.source == str(new / "data" / "head.npy")


def test_saving_leaves_the_old_session_when_it_fails(tmp_path: Path) -> None:
    target = tmp_path / "missing" / "a.volviz.json"
    with pytest.raises(LoadError, match="cannot be written"):
        save_session(a_scene("sample:engine"), target)
    good = tmp_path / "b.volviz.json"
    save_session(a_scene("sample:engine"), good)
    assert [path.name for path in tmp_path.iterdir()] == ["b.volviz.json"]


def test_a_technique_that_is_not_there_falls_back(tmp_path: Path) -> None:
    data = scene_to_dict(a_scene("sample:engine"))
    data["views"][0]["technique"] = "from_the_future"
    data["views"][0]["settings"] = {"from_the_future": {"a": 1}, "slicing": {"step": 2.0, "new_one": 3}}
    view = scene_from_dict(data, settings_of).view
    assert view.technique == "raycast"
    assert view.settings == (("slicing", Settings(step=2.0)),)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"kind": "something"}, "no VolViz session"),
        ({"version": VERSION + 1}, "newer VolViz"),
        ({"version": None}, "damaged"),
        ({"layers": 3}, "damaged"),
        ({"layers": 3, "version": 1}, "damaged"),
        ({"layers": [{"kind": "mesh", "volume": {"source": "", "hints": {}, "content_id": ""}}]}, "damaged"),
        ({"comparison": {}}, "damaged"),
        ({"light": {}}, "damaged"),
        ({"clipping": {"crop": [0, 0, 1], "planes": []}}, "damaged"),
        (
            {"views": [{"technique": "raycast", "settings": {"raycast": {"step": -1}}, "camera": None}]},
            "damaged",
        ),
    ],
)
def test_what_is_no_good_session_is_refused_in_a_sentence(change: dict[str, Any], words: str) -> None:
    data = scene_to_dict(a_scene("sample:engine")) | change
    with pytest.raises(LoadError, match=words) as caught:
        scene_from_dict(data, settings_of)
    assert "\n" not in str(caught.value)


def test_a_session_of_version_2_has_one_camera_and_no_cross_hair() -> None:
    scene = a_scene("sample:engine")
    data = scene_to_dict(scene)
    for name in ("cursor", "layout"):
        del data[name]
    for view in data["views"]:
        del view["own_camera"]
    assert scene_from_dict({**data, "version": 2}, settings_of) == scene
    tilt = ((0.8, -0.6, 0.0), (0.6, 0.8, 0.0), (0.0, 0.0, 1.0))
    moved = replace(scene, cursor=(1.0, 2.0, 3.0), layout="large", tilt=tilt)
    assert scene_from_dict(scene_to_dict(moved), settings_of) == moved


def test_measurements_are_kept_and_older_sessions_have_none() -> None:
    scene = a_scene("sample:engine")
    data = scene_to_dict(scene)
    del data["measurements"]
    assert scene_from_dict({**data, "version": 4}, settings_of) == scene
    found = Point((1.0, 2.0, 3.0), ((0.1, 0.0, 0.0), (0.0, 0.2, 0.0), (0.0, 0.0, 0.3)), "isovalue", 42.0)
    measured = with_measurement(scene, Measurement("distance", (found, Point((4.0, 5.0, 6.0))), locked=True))
    named = with_measurement(measured, Measurement("arrow", (found, found), "here", visible=False))
    assert [each.name for each in named.measurements] == ["Distance 1", "here"]
    assert scene_from_dict(json.loads(json.dumps(scene_to_dict(named))), settings_of) == named
    assert without_measurements(named, {0, 1}).measurements == measured.measurements
    assert with_measurement_changed(measured, 0, points=(found, found)) == measured


def test_a_text_file_is_no_session(tmp_path: Path) -> None:
    path = tmp_path / "notes.volviz.json"
    path.write_text("dear diary")
    with pytest.raises(LoadError, match="no VolViz session"):
        load_session(path, settings_of)
    with pytest.raises(LoadError, match="cannot be read"):
        load_session(tmp_path / "nowhere.volviz.json", settings_of)
