"""The copied script: what it draws, and that no layer of the scene gets lost in it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import volviz
from volviz.model.scene import Scene, SceneView
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.references import VolumeRef
from volviz_ui.session.script import script_of

FUNCTION = TransferFunction.from_points([(0.0, (0, 0, 0, 0)), (200.0, (1, 1, 1, 0.5))]).with_opacity(0.5)


@pytest.fixture(autouse=True)
def beside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where scripts save their picture."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def times_file(tmp_path: Path) -> str:
    """Three time points of 4 x 5 x 6 voxels."""
    array = np.arange(3 * 120, dtype=np.uint16).reshape(3, 4, 5, 6)
    np.save(tmp_path / "times.npy", array)
    return str(tmp_path / "times.npy")


def run(script: str) -> dict[str, Any]:
    names: dict[str, Any] = {}
    exec(script, names)
    return names


def test_channel_time_and_hints_are_those_of_the_layer(times_file: str) -> None:
    layer = volviz.ImageLayer(VolumeRef(times_file, (("spacing", (1.0, 2.0, 3.0)),)), FUNCTION, time=2)
    script = script_of(Scene((layer,)), (32, 24))
    assert f"volviz.load({times_file!r}, spacing=(1.0, 2.0, 3.0), time=2)" in script
    names = run(script)
    assert names["volume"].range == (240, 359)
    assert names["transfer_function"] == FUNCTION
    assert names["picture"].shape == (24, 32, 4)
    first = volviz.ImageLayer(VolumeRef("rgb.tif"), FUNCTION, channel=0)
    assert "volviz.load('rgb.tif', channel=0)" in script_of(Scene((first,)), (32, 24))


def test_values_of_a_layer_are_written(times_file: str) -> None:
    ref = VolumeRef(times_file)
    layer = volviz.ImageLayer(ref, color="orange", window=(10, 90), opacity=0.5, name="mine")
    names = run(script_of(Scene((layer,)), (32, 24)))
    assert names["layer"] == volviz.ImageLayer(
        names["volume"], color=names["layer"].color, window=(10, 90), opacity=0.5
    )
    assert names["layer"].color == pytest.approx(layer.color)
    with_function = volviz.ImageLayer(ref, FUNCTION, opacity=0.25)
    names = run(script_of(Scene((with_function,)), (32, 24)))
    assert names["layer"] == volviz.ImageLayer(names["volume"], FUNCTION, opacity=0.25)


def test_further_layers_are_drawn_or_said_not_to_be(times_file: str) -> None:
    ref = VolumeRef(times_file)
    labels = volviz.LabelLayer(
        ref, {3: "red", 5: (0.5, 0.25, 0)}, names={3: "liver"}, hidden=(1, 2), smooth=False, time=1
    )
    shift = [[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    other = volviz.ImageLayer(ref, FUNCTION, "PET", mode="modulate", time=2, transform=shift, visible=False)
    first = volviz.ImageLayer(ref, FUNCTION)
    layers = (labels, first, other)
    script = script_of(Scene(layers), (32, 24))
    assert "not in the picture" not in script
    assert "    [layer, layer_2, layer_3]," in script
    names = run(script)
    source = names["layer_2"].volume
    assert source.sizes["t"] == 3
    assert names["layer_2"] == volviz.LabelLayer(
        source, {3: "red", 5: (0.5, 0.25, 0)}, names={3: "liver"}, hidden=(1, 2), smooth=False, time=1
    )
    assert names["layer_3"] == volviz.ImageLayer(
        names["layer_3"].volume, FUNCTION, "PET", mode="modulate", time=2, transform=shift, visible=False
    )
    alone = volviz.render(volviz.load(times_file), size=(32, 24), transfer_function=FUNCTION)
    assert not np.array_equal(names["picture"], alone)
    by_slices = script_of(Scene(layers, views=(SceneView("splatting"),)), (32, 24))
    assert by_slices.count("not in the picture") == 2
    assert np.array_equal(
        run(by_slices)["picture"],
        volviz.render(volviz.load(times_file), "splatting", size=(32, 24), transfer_function=FUNCTION),
    )
    assert "layer_2 = volviz.LabelLayer" in script_of(Scene((labels,)), (32, 24))
