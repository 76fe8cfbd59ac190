"""Transfer functions of other programs, and the user's own presets."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tests.unit.transfer.functions import functions
from volviz.errors import InputError, LoadError
from volviz.model.transfer.channels import simplified
from volviz.model.transfer.color_spaces import between, lab_to_rgb, rgb_to_lab
from volviz.model.transfer.formats import (
    colormap_colors,
    from_colormap,
    read_preset_file,
    read_transfer_function,
    to_dat,
    write_transfer_function,
)
from volviz.model.transfer.own_presets import OwnPresets
from volviz.model.transfer.presets import preset

PROBE = np.linspace(-130, 130, 211) + 0.013

# the volume property that Slicer's manual shows
SLICER = """1
1
0.9
0.1
0.2
10
14 -3024 0 -86.9767 0 45.3791 0.169643 139.919 0.589286 347.907 0.607143 1224.16 0.607143 3071 0.616071
4 0 1 255 1
28 -3024 0 0 0 -86.9767 0 0.25098 1 45.3791 1 0 0 139.919 1 0.894893 0.894893 347.907 1 1 0.25098 \
1224.16 1 1 1 3071 0.827451 0.658824 1
"""


def test_a_slicer_volume_property_is_read_in_hu(tmp_path) -> None:
    path = tmp_path / "bone.vp"
    path.write_text(SLICER)
    found = read_preset_file(path)
    assert (found.label, found.unit, len(found.transfer_function.points)) == ("bone", "HU", 7)
    np.testing.assert_allclose(
        found.transfer_function.evaluate([139.919, 45.3791]),
        [[1, 0.894893, 0.894893, 0.589286], [1, 0, 0, 0.169643]],
    )


@pytest.mark.parametrize("ident", ["ct-bone", "ct-lung", "ct-muscle"])
def test_a_volume_property_we_wrote_is_read_back(ident, tmp_path) -> None:
    path = tmp_path / "x.vp"
    write_transfer_function(preset(ident), path)
    found = read_transfer_function(path)
    np.testing.assert_allclose(
        found.evaluate(PROBE * 10), preset(ident).transfer_function.evaluate(PROBE * 10), atol=1e-6
    )


def test_vtk_reads_the_colours_and_opacities_that_we_write_for_paraview(tmp_path) -> None:
    function = preset("ct-bone").transfer_function
    path = tmp_path / "bone.json"
    write_transfer_function(function, path, paraview=True)
    (data,) = json.loads(path.read_text())
    from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
    from vtkmodules.vtkRenderingCore import vtkColorTransferFunction

    colors, opacity = vtkColorTransferFunction(), vtkPiecewiseFunction()
    colors.FillFromDataPointer(len(data["RGBPoints"]) // 4, data["RGBPoints"])
    for row in np.reshape(data["Points"], (-1, 4)):
        opacity.AddPoint(*row)
    for v in (-500.0, 150.0, 250.0, 900.0):
        np.testing.assert_allclose(
            [*colors.GetColor(v), opacity.GetValue(v)], function.evaluate([v])[0], atol=1e-6
        )
    np.testing.assert_allclose(
        read_transfer_function(path).evaluate(PROBE), function.evaluate(PROBE), atol=1e-9
    )


def paraview(tmp_path, data):
    path = tmp_path / "pv.json"
    path.write_text(json.dumps(data))
    return read_transfer_function(path)


def test_a_paraview_colour_map_over_0_to_1_is_relative_with_rising_opacity(tmp_path) -> None:
    found = paraview(tmp_path, [{"Name": "two", "RGBPoints": [0, 0, 0, 0, 1, 1, 0.5, 0]}])
    assert (found.name, found.domain) == ("two", "relative")
    np.testing.assert_allclose(found.evaluate([0.5]), [[0.5, 0.25, 0, 0.5]])


def test_a_paraview_map_from_minus_1_to_1_is_spread_over_the_data(tmp_path) -> None:
    found = paraview(tmp_path, {"RGBPoints": [-1, 0, 0, 0, 1, 1, 1, 1], "ColorSpace": "RGB"})
    assert found.domain == "relative"
    assert [p.value for p in found.resolved((10.0, 20.0)).points] == [10.0, 20.0]


def test_colours_follow_vtk_in_hsv_and_lab(tmp_path) -> None:
    from vtkmodules.vtkRenderingCore import vtkColorTransferFunction

    for space in ("HSV", "Lab"):
        rows = [0, 0.1, 0.3, 0.9, 100, 0.9, 0.8, 0.2, 200, 0.2, 0.1, 0.1]
        found = paraview(tmp_path, {"RGBPoints": rows, "ColorSpace": space})
        theirs = vtkColorTransferFunction()
        getattr(theirs, f"SetColorSpaceTo{space}")()
        for row in np.reshape(rows, (-1, 4)):
            theirs.AddRGBPoint(*row)
        for v in np.linspace(3, 197, 23):
            np.testing.assert_allclose(found.evaluate([v])[0, :3], theirs.GetColor(v), atol=0.01)


def test_steps_and_categories_are_flat_pieces(tmp_path) -> None:
    from vtkmodules.vtkRenderingCore import vtkColorTransferFunction

    rows = [-10, 1, 0, 0, 0, 0, 1, 0, 20, 0, 0, 1]
    found = paraview(tmp_path, {"RGBPoints": rows, "ColorSpace": "Step"})
    theirs = vtkColorTransferFunction()
    theirs.SetColorSpaceToStep()
    for row in np.reshape(rows, (-1, 4)):
        theirs.AddRGBPoint(*row)
    for v in (-12.0, -9.0, -0.1, 0.1, 11.0, 25.0):
        np.testing.assert_allclose(found.evaluate([v])[0, :3], theirs.GetColor(v))
    found = paraview(tmp_path, {"IndexedColors": [1, 0, 0, 0, 1, 0, 0, 0, 1], "Annotations": ["0", "a"]})
    for v, color in ((0.0, (1, 0, 0)), (0.32, (1, 0, 0)), (0.34, (0, 1, 0)), (0.9, (0, 0, 1))):
        np.testing.assert_allclose(found.evaluate([v])[0, :3], color)


def test_a_midpoint_moves_where_half_of_the_opacity_is_reached(tmp_path) -> None:
    rows = {"RGBPoints": [0, 1, 1, 1, 10, 1, 1, 1], "Points": [0, 0, 0.2, 0, 10, 1, 0.5, 0]}
    found = paraview(tmp_path, rows)
    assert found.evaluate([2.0])[0, 3] == pytest.approx(0.5)


@given(arrays(np.uint8, (256, 4)))
def test_any_raw_table_comes_back_byte_for_byte(table) -> None:
    import tempfile
    from pathlib import Path

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "any.dat"
        path.write_bytes(table.tobytes())
        assert to_dat(read_transfer_function(path), (0.0, 255.0)) == table.tobytes()


def test_a_smooth_raw_table_becomes_few_points(tmp_path) -> None:
    path = tmp_path / "smooth.dat"
    write_transfer_function(preset("classic").transfer_function, path, (0.0, 255.0))
    assert len(path.read_bytes()) == 1024
    assert len(simplified(read_transfer_function(path), 1.5 / 255).points) < 16


@given(functions)
def test_our_own_file_gives_back_an_equal_function(function) -> None:
    import tempfile
    from pathlib import Path

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "own.json"
        write_transfer_function(replace(function, name="own"), path)
        assert read_transfer_function(path) == replace(function, name="own")


def test_plain_function_data_are_read_too(tmp_path) -> None:
    path = tmp_path / "plain.json"
    function = preset("mri").transfer_function
    path.write_text(json.dumps(function.to_dict()))
    assert read_transfer_function(path) == function


def test_colour_maps_are_known_by_name() -> None:
    viridis = from_colormap("viridis")
    assert viridis.domain == "relative"
    np.testing.assert_allclose(viridis.evaluate([0.0, 1.0])[:, 3], (0, 1))
    np.testing.assert_allclose(
        viridis.evaluate(np.linspace(0, 1, 256))[:, :3], colormap_colors("viridis"), atol=1 / 256
    )
    assert [p.value for p in from_colormap("gray", (-5.0, 5.0)).points] == [-5.0, 5.0]
    with pytest.raises(InputError, match="no colour map called"):
        from_colormap("not a map")


@given(arrays(np.float64, (5, 3), elements=st.floats(0, 1)))
def test_lab_and_back_is_the_same_colour(rgb) -> None:
    np.testing.assert_allclose(lab_to_rgb(rgb_to_lab(rgb)), rgb, atol=1e-6)


def test_lab_of_white_and_of_red_are_the_published_ones() -> None:
    np.testing.assert_allclose(rgb_to_lab([1, 1, 1]), (100, 0, 0), atol=0.01)
    np.testing.assert_allclose(rgb_to_lab([1, 0, 0]), (53.24, 80.09, 67.20), atol=0.05)
    assert between((1, 0, 0), (0, 0, 1), 1.0, "HSV") == pytest.approx((0, 0, 1))


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.json", b"{"),
        ("a.json", b"[]"),
        ("a.json", b"3"),
        ("a.json", b'{"RGBPoints": [1, 2, 3]}'),
        ("a.json", b'{"RGBPoints": []}'),
        ("a.json", b'{"RGBPoints": [0, 0, 0, NaN, 1, 1, 1, 1]}'),
        ("a.json", b'{"points": 3}'),
        ("a.vp", b"1\n2\n"),
        ("a.vp", b"hello"),
        ("a.vp", SLICER.replace("14 -3024", "15 -3024").encode()),
        ("a.dat", b"1" * 1023),
        ("a.txt", b""),
        ("missing.vp", None),
    ],
)
def test_what_is_no_transfer_function_is_refused_in_one_sentence(name, content, tmp_path) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(LoadError, match=name) as error:
        read_transfer_function(path)
    assert "\n" not in str(error.value)


def test_own_presets_are_saved_renamed_and_deleted(tmp_path) -> None:
    own = OwnPresets(tmp_path / "settings" / "presets")
    assert own.all() == {}
    stored = own.save(replace(preset("mri"), technique="half_angle", settings={"slices": 9}), "My  head / Ä")
    assert stored.label == "My head / Ä"
    assert OwnPresets(own.folder).all()["My head / Ä"] == stored
    assert stored.technique == "half_angle"
    own.save(preset("fire"), "Other")
    with pytest.raises(InputError, match="already"):
        own.rename("Other", "My head / Ä")
    own.rename("My head / Ä", "Brain")
    assert list(own.all()) == ["Brain", "Other"]
    own.delete("Other")
    assert list(own.all()) == ["Brain"]
    assert len(list(own.folder.iterdir())) == 1


def test_saving_under_the_same_name_replaces_the_preset(tmp_path) -> None:
    own = OwnPresets(tmp_path)
    own.save(preset("mri"), "One")
    own.save(preset("fire"), "One")
    assert own.all()["One"].transfer_function.points == preset("fire").transfer_function.points
    assert len(list(tmp_path.iterdir())) == 1


def test_different_names_never_share_a_file(tmp_path) -> None:
    own = OwnPresets(tmp_path)
    for label in ("a b", "a-b", "A b", "日本", "中国"):
        own.save(preset("mri"), label)
    assert set(own.all()) == {"a b", "a-b", "A b", "日本", "中国"}


def test_a_damaged_file_is_named_and_the_others_stay_usable(tmp_path) -> None:
    own = OwnPresets(tmp_path)
    own.save(preset("mri"), "Good")
    (tmp_path / "bad.json").write_text("{")
    assert list(own.all()) == ["Good"]
    assert len(own.damaged()) == 1
    with pytest.raises(InputError, match="needs a name"):
        own.save(preset("mri"), "  ")
    with pytest.raises(InputError, match="no preset of your own"):
        own.delete("None")
