"""Regions over value and gradient stay with their function, wherever that goes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from volviz.custom_gl.registry import techniques
from volviz.custom_gl.technique import drawn_function, unused_regions
from volviz.model.layers import ImageLayer
from volviz.model.scene import Scene
from volviz.model.session import scene_from_dict, scene_to_dict
from volviz.model.transfer.formats import read_preset_file, read_transfer_function, write_transfer_function
from volviz.model.transfer.function import TransferFunction
from volviz.model.transfer.function_2d import Region, TransferFunction2D
from volviz.model.transfer.own_presets import OwnPresets
from volviz.model.transfer.presets import Preset, preset_for
from volviz.volume_data.references import VolumeRef
from volviz.volume_data.volume import Volume

REGIONS = TransferFunction2D(
    (
        Region("ellipse", 120.5, 80.0, 3.25, 40.0, (1.0, 0.5, 0.25), 0.35, 0.7),
        Region("triangle", -20.0, 55.0, 0.0, 12.5, (0.1, 0.2, 0.3), 1.0, 0.0),
    )
)
FUNCTION = replace(
    TransferFunction.from_points([(0.0, (0, 0, 0, 0)), (200.0, (1, 1, 1, 1))], name="borders"),
    by_gradient=REGIONS,
)


def test_a_file_of_ours_keeps_them(tmp_path: Path) -> None:
    path = tmp_path / "borders.json"
    write_transfer_function(FUNCTION, path)
    assert read_transfer_function(path) == FUNCTION
    assert read_preset_file(path).transfer_function == FUNCTION


def test_a_preset_of_the_user_keeps_them_also_when_they_are_switched_off(tmp_path: Path) -> None:
    own = OwnPresets(tmp_path)
    off = replace(FUNCTION, by_gradient=replace(REGIONS, enabled=False))
    for function in (FUNCTION, off):
        own.save(Preset("own:borders", "Borders", "Of borders.", function), "Borders")
        assert own.all()["Borders"].transfer_function.by_gradient == function.by_gradient
        volume = Volume(np.arange(64).reshape(4, 4, 4))
        assert preset_for(own.all()["Borders"], volume).by_gradient == function.by_gradient


def test_a_session_keeps_them() -> None:
    scene = Scene(layers=(ImageLayer(VolumeRef("sample:engine"), FUNCTION),))
    back = scene_from_dict(scene_to_dict(scene), lambda technique: None)
    assert back.layer is not None
    assert back.layer.transfer_function == FUNCTION


@pytest.mark.parametrize("technique", list(techniques()))
def test_every_technique_draws_them_or_says_why_not(technique: str) -> None:
    info = techniques()[technique]
    settings = info.settings()
    words = unused_regions(info, settings)
    drawn = drawn_function(info, settings, FUNCTION)
    if info.by_gradient:
        assert words == ""
        assert drawn is FUNCTION
    else:
        assert words.endswith(".")
        assert info.label in words
        assert drawn == replace(FUNCTION, by_gradient=None)
    off = replace(FUNCTION, by_gradient=replace(REGIONS, enabled=False))
    assert drawn_function(info, settings, off).by_gradient is None


@pytest.mark.parametrize("mode", ["maximum", "minimum", "average", "attenuated_maximum"])
def test_modes_that_classify_one_value_a_ray_say_so(mode: str) -> None:
    info = techniques()["raycast"]
    words = unused_regions(info, info.settings(mode=mode))
    assert "one value per ray" in words
