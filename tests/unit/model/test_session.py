"""Sessions: what is saved comes back, what is damaged is refused in a sentence."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from volviz.errors import LoadError
from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.layers import ImageLayer
from volviz.model.light import Light
from volviz.model.parameters import parameter
from volviz.model.scene import Scene, SceneView
from volviz.model.session import (
    VERSION,
    load_session,
    save_session,
    scene_from_dict,
    scene_to_dict,
)
from volviz.model.transfer_function import TransferFunction
from volviz.volume_data.references import VolumeRef


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
scenes = st.builds(
    Scene,
    layers=st.builds(
        ImageLayer,
        volume=st.builds(
            VolumeRef,
            source=st.just("sample:engine"),
            hints=st.sampled_from([(), (("dims", (3, 4, 5)), ("dtype", "uint8"))]),
            content_id=st.text(max_size=5),
        ),
        transfer_function=functions,
        name=st.text(max_size=10),
    ).map(lambda layer: (layer,)),
    light=st.builds(Light, headlight=st.booleans(), position=st.none() | vectors, color=colors),
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


def test_a_text_file_is_no_session(tmp_path: Path) -> None:
    path = tmp_path / "notes.volviz.json"
    path.write_text("dear diary")
    with pytest.raises(LoadError, match="no VolViz session"):
        load_session(path, settings_of)
    with pytest.raises(LoadError, match="cannot be read"):
        load_session(tmp_path / "nowhere.volviz.json", settings_of)
