"""Bundled presets: what is in them, and how they adapt to data of another unit."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from volviz.errors import InputError, LoadError
from volviz.model.transfer.function import TransferFunction
from volviz.model.transfer.presets import Preset, preset, preset_for, presets, read_preset
from volviz.volume_data.volume import Volume


def volume(low: float, high: float, dtype: str = "int16", unit: str = "", seed: int = 1) -> Volume:
    values = np.random.default_rng(seed).uniform(low, high, (12, 13, 14))
    values[0, 0, :2] = low, high
    return Volume(values.astype(dtype), unit=unit)


def test_the_presets_users_expect_are_there_in_a_fixed_order() -> None:
    wanted = ["ct-bone", "ct-muscle", "ct-lung", "ct-angio", "mri", "microscopy", "engine"]
    assert set(wanted) | {"classic", "jet-classic", "grey-classic"} <= set(presets())
    assert next(iter(presets())) == "ct-bone"
    assert list(presets()) == list(presets())


@pytest.mark.parametrize("ident", list(presets()))
def test_every_preset_survives_its_file_and_shows_something(ident: str) -> None:
    one = preset(ident)
    assert Preset.from_dict(json.loads(json.dumps(one.to_dict()))) == one
    assert one.label
    assert one.description.endswith(".")
    shown = (-1024.0, 2000.0) if one.unit == "HU" else (0.0, 1.0)
    assert one.transfer_function.visible_range(shown) is not None
    assert TransferFunction.preset(ident).name == ident


def test_the_classic_table_has_its_nine_colours_at_every_28th_entry() -> None:
    table = TransferFunction.preset("classic").bake((0.0, 255.0), 256)
    np.testing.assert_allclose(table[28 * 3], (0, 1, 1, 0.5), atol=1e-5)
    np.testing.assert_allclose(table[28 * 5], (1, 1, 0, 0.8), atol=1e-5)
    np.testing.assert_allclose(table[14], (0, 0, 0.75, 0.05), atol=1e-5)
    np.testing.assert_allclose(table[225:], np.tile((0.5, 0, 0, 0), (31, 1)), atol=1e-5)


def test_hu_presets_keep_their_values_on_data_in_hu() -> None:
    function = preset("ct-bone").transfer_function
    assert preset_for("ct-bone", volume(-1024, 1800, unit="HU")) == function
    assert preset_for("ct-bone", volume(-1024, 1800)) == function


def test_hu_presets_move_by_1024_on_ct_without_its_intercept() -> None:
    values = np.random.default_rng(2).normal(1060, 30, (20, 20, 20))
    values[:, :, :8] = 20
    values[5, 5, 5] = 3000
    shifted = preset_for("ct-bone", Volume(values.astype(np.uint16)))
    assert shifted == preset("ct-bone").transfer_function.shifted(1024.0)


def test_hu_presets_spread_over_the_range_of_8_bit_data() -> None:
    function = preset_for("ct-bone", volume(0, 255, "uint8"))
    assert function.domain == "data"
    assert function.points[0].value == pytest.approx(0.0, abs=2)
    assert function.points[-1].value == pytest.approx(255.0, abs=2)


def test_relative_presets_ignore_outliers_only_where_they_say_so() -> None:
    values = np.random.default_rng(3).uniform(0, 100, (40, 40, 40)).astype(np.float32)
    values[1, 1, 1] = 1e6
    data = Volume(values)
    assert preset_for("mri", data).points[-1].value == pytest.approx(100, rel=0.02)
    assert preset_for("grey-classic", data).points[-1].value == pytest.approx(1e6)


def test_constant_data_do_not_break_a_relative_preset() -> None:
    function = preset_for("grey-classic", Volume(np.full((4, 4, 4), 7, np.uint8)))
    assert [p.value for p in function.points] == [7.0, 8.0]


def test_an_unknown_preset_is_answered_with_near_names() -> None:
    with pytest.raises(InputError, match="did you mean ct-bone"):
        preset("ct-bones")


def test_a_file_that_holds_no_preset_is_refused_in_words(tmp_path) -> None:
    path = tmp_path / "broken.json"
    for text, word in [
        ("{", "not JSON"),
        ("[1]", "not an object"),
        ("{}", "transfer_function"),
        ('{"transfer_function": {"points": [[1, 2]]}}', "control point"),
        ('{"version": 99, "transfer_function": {}}', "newer"),
    ]:
        path.write_text(text)
        with pytest.raises(LoadError, match=word):
            read_preset(path)
    with pytest.raises(LoadError, match="cannot be read"):
        read_preset(tmp_path / "missing.json")


def test_technique_and_settings_travel_with_a_preset() -> None:
    one = replace(preset("mri"), technique="half_angle", settings={"slices": 128})
    again = Preset.from_dict(json.loads(json.dumps(one.to_dict())))
    assert (again.technique, again.settings) == ("half_angle", {"slices": 128})
