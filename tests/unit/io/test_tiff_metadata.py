"""What ImageJ, OME and LSM say beside the pixels, and TIFF files whose first image is not the volume."""

from __future__ import annotations

import numpy as np
import pytest
import tifffile

from tests.unit.io.writers import scalars
from volviz.errors import LoadError
from volviz.io import load

STACK = scalars((5, 6, 7), "uint16")


def imagej(path, array=STACK, resolution=(5.0, 5.0), **metadata):
    tifffile.imwrite(path, array, imagej=True, resolution=resolution, metadata={"axes": "ZYX", **metadata})
    return path


def notes(volume):
    return " ".join(volume.metadata["notes"])


def test_imagej_leaves_out_a_distance_of_one(tmp_path):
    volume = load(imagej(tmp_path / "v.tif", unit="micron"))
    assert volume.spacing == pytest.approx((0.2, 0.2, 1.0))
    assert volume.metadata["length_unit"] == "µm"


@pytest.mark.parametrize(("given", "z"), [("2,5", 2.5), (-2.5, 2.5), ("1e-1", 0.1)])
def test_imagej_distances_with_a_comma_or_a_sign_are_read(tmp_path, given, z):
    assert load(imagej(tmp_path / "v.tif", spacing=given, unit="mm")).spacing == pytest.approx((0.2, 0.2, z))


@pytest.mark.parametrize("given", ["nan", "", "inf", "0"])
def test_imagej_distances_that_are_none_are_told(tmp_path, given):
    volume = load(imagej(tmp_path / "v.tif", spacing=given, unit="mm"))
    assert volume.spacing == pytest.approx((0.2, 0.2, 0.2))
    assert "distance of slices is no number" in notes(volume)


def test_imagej_units_of_slices_are_converted_to_those_of_pixels(tmp_path):
    volume = load(
        imagej(tmp_path / "v.tif", resolution=(0.005, 0.005), unit="nm", zunit="micron", spacing=2.5)
    )
    assert volume.spacing == pytest.approx((200, 200, 2500))
    assert volume.metadata["length_unit"] == "nm"


@pytest.mark.parametrize("unit", ["\\u00B5m", "\\u03BCm", "um", "micron", "Micrometer"])
def test_all_ways_to_write_micrometres_are_one(tmp_path, unit):
    assert load(imagej(tmp_path / "v.tif", unit=unit, spacing=2)).metadata["length_unit"] == "µm"


@pytest.mark.parametrize(
    ("c0", "c1", "vunit", "unit"), [(-1000.0, 0.5, "HU", "HU"), (-32768.0, 1.0, "Gray Value", "")]
)
def test_calibrated_values_are_those_that_imagej_shows(tmp_path, c0, c1, vunit, unit):
    volume = load(imagej(tmp_path / "v.tif", cf=0, c0=c0, c1=c1, vunit=vunit))
    np.testing.assert_allclose(volume.array, c0 + c1 * STACK.astype(float), rtol=1e-6)
    assert volume.unit == unit


def test_a_curved_calibration_is_not_applied_and_it_is_said(tmp_path):
    volume = load(imagej(tmp_path / "v.tif", cf=2, c0=1.0, c1=2.0, vunit="OD"))
    np.testing.assert_array_equal(volume.array, STACK)
    assert "by a curve that is not applied" in notes(volume)


def ome(path, *images):
    with tifffile.TiffWriter(path, ome=True) as writer:
        for array, metadata in images:
            writer.write(array, metadata={"axes": "ZYX", **metadata})
    return path


def sizes(x, y, z, units=("µm", "µm", "µm")):
    given = {f"PhysicalSize{a}": v for a, v in zip("XYZ", (x, y, z), strict=True) if v is not None}
    return given | {
        f"PhysicalSize{a}Unit": u for a, u in zip("XYZ", units, strict=True) if f"PhysicalSize{a}" in given
    }


def test_ome_has_a_unit_for_every_axis(tmp_path):
    volume = load(ome(tmp_path / "v.ome.tif", (STACK, sizes(200, 300, 1.5, ("nm", "nm", "µm")))))
    assert volume.spacing == pytest.approx((200, 300, 1500))
    assert volume.metadata["length_unit"] == "nm"


def test_ome_units_that_are_not_written_are_micrometres(tmp_path):
    given = {"PhysicalSizeX": 200, "PhysicalSizeXUnit": "nm", "PhysicalSizeY": 0.3, "PhysicalSizeZ": 1.5}
    assert load(ome(tmp_path / "v.ome.tif", (STACK, given))).spacing == pytest.approx((200, 300, 1500))


def test_ome_sizes_are_those_of_the_image_that_is_shown(tmp_path):
    path = ome(tmp_path / "v.ome.tif", (STACK[:2], sizes(9, 9, 9)), (STACK, sizes(0.2, 0.3, 1.5)))
    assert load(path).spacing == pytest.approx((0.2, 0.3, 1.5))
    assert load(path, series=0).spacing == pytest.approx((9, 9, 9))


@pytest.mark.parametrize(
    ("given", "spacing", "words"),
    [
        ((0.2, 0.2, None), (0.2, 0.2, 0.2), "how far its slices lie apart"),
        ((None, None, 3.0), (3.0, 3.0, 3.0), "distance of slices alone"),
        ((0.2, None, 0.5), (0.2, 0.2, 0.5), ""),
    ],
)
def test_what_ome_leaves_out_is_taken_from_another_axis_and_told(tmp_path, given, spacing, words):
    volume = load(ome(tmp_path / "v.ome.tif", (STACK, sizes(*given))))
    assert volume.spacing == pytest.approx(spacing)
    assert volume.metadata["length_unit"] == "µm"
    assert words in notes(volume)


def test_a_part_of_an_ome_set_names_what_is_missing(tmp_path):
    text = (
        '<OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06"><Image ID="Image:0"><Pixels ID="Pixels:0" '
        'DimensionOrder="XYZCT" Type="uint16" SizeX="7" SizeY="6" SizeZ="10" SizeC="1" SizeT="1"><Channel ID="C:0" '
        'SamplesPerPixel="1"/>'
        + "".join(
            f'<TiffData IFD="{n % 5}" FirstZ="{n}" PlaneCount="1">'
            f'<UUID FileName="part_{n // 5}.ome.tif">urn:uuid:{n // 5}</UUID></TiffData>'
            for n in range(10)
        )
        + "</Pixels></Image></OME>"
    )
    tifffile.imwrite(tmp_path / "part_0.ome.tif", STACK, description=text, metadata=None)
    with pytest.raises(LoadError, match=r"set of files, of which part_1\.ome\.tif does not lie beside it"):
        load(tmp_path / "part_0.ome.tif")


def test_four_axes_without_names_are_those_of_the_same_numpy_file(tmp_path):
    array = scalars((2, 5, 6, 7), "uint16")
    tifffile.imwrite(tmp_path / "v.tif", array)
    np.save(tmp_path / "v.npy", array)
    for time in (0, 1):
        for name in ("v.tif", "v.npy"):
            np.testing.assert_array_equal(load(tmp_path / name, time=time).array, array[time])


def test_an_overview_before_the_stack_is_not_the_volume(tmp_path):
    with tifffile.TiffWriter(tmp_path / "v.tif") as writer:
        writer.write(scalars((300, 300), "uint16"), metadata=None)
        writer.write(STACK, metadata=None)
    volume = load(tmp_path / "v.tif")
    np.testing.assert_array_equal(volume.array, STACK)
    assert "series=" in notes(volume)


@pytest.mark.parametrize(
    ("photometric", "words"), [("miniswhite", "meant to look white"), ("palette", "palette")]
)
def test_pixels_that_do_not_mean_brightness_are_told(tmp_path, photometric, words):
    table = {"colormap": np.zeros((3, 256), np.uint16)} if photometric == "palette" else {}
    array = STACK.astype(np.uint8)
    tifffile.imwrite(tmp_path / "v.tif", array, photometric=photometric, metadata=None, **table)
    volume = load(tmp_path / "v.tif")
    np.testing.assert_array_equal(volume.array, array)
    assert words in notes(volume)
