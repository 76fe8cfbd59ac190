"""TIFF against tifffile's writer, with ImageJ and OME metadata."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
import tifffile
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.unit.io.writers import scalars
from volviz.errors import InputError, LoadError
from volviz.io import load

FAST = settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@given(
    dtype=st.sampled_from(["uint8", "int16", "uint16", "uint32", "float32", "float64"]),
    shape=st.tuples(st.integers(2, 6), st.integers(2, 20), st.integers(2, 20)),
    order=st.sampled_from("<>"),
    big=st.booleans(),
    compression=st.sampled_from([None, "zlib", "lzw"]),
)
@FAST
def test_the_pages_of_a_tiff_are_slices(tmp_path, dtype, shape, order, big, compression):
    array = scalars(shape, dtype)
    path = tmp_path / "v.tif"
    tifffile.imwrite(
        path,
        array,
        byteorder=order,
        bigtiff=big,
        compression=compression,
        photometric="minisblack",
        metadata=None,
    )
    volume = load(path)
    np.testing.assert_array_equal(volume.array, array)
    assert volume.array.dtype == array.dtype
    assert volume.spacing == (1, 1, 1)
    assert "does not say how far" in volume.metadata["notes"][0]


def imagej(path, array, axes, **metadata):
    tifffile.imwrite(
        path,
        array,
        imagej=True,
        resolution=(4.0, 2.0),
        metadata={"axes": axes, "spacing": 1.5, "unit": "um", **metadata},
    )
    return path


def test_imagej_spacing_and_unit_are_taken(tmp_path):
    array = scalars((4, 5, 6), "uint16")
    volume = load(imagej(tmp_path / "v.tif", array, "ZYX"))
    np.testing.assert_array_equal(volume.array, array)
    assert volume.spacing == pytest.approx((0.25, 0.5, 1.5))
    assert volume.metadata["length_unit"] == "µm"
    assert volume.metadata["notes"] == ()


def test_one_time_point_and_channel_of_a_hyperstack_is_read(tmp_path):
    array = scalars((3, 4, 2, 5, 6), "uint16")
    path = imagej(tmp_path / "h.tif", array, "TZCYX")
    np.testing.assert_array_equal(load(path).array, array[0, :, 0])
    np.testing.assert_array_equal(load(path, time=2, channel=1).array, array[2, :, 1])
    assert len(load(path).metadata["notes"]) == 2
    with pytest.raises(InputError, match=r"channel must lie in 0\.\.1"):
        load(path, channel=2)


@pytest.mark.parametrize("axes", ["TCZYX", "CTZYX", "ZCTYX"])
def test_ome_axes_and_physical_sizes_are_taken(tmp_path, axes):
    sizes = {"T": 2, "C": 3, "Z": 4, "Y": 5, "X": 6}
    array = scalars(tuple(sizes[a] for a in axes), "uint8")
    path = tmp_path / "v.ome.tif"
    physical = {"PhysicalSizeX": 0.2, "PhysicalSizeY": 0.3, "PhysicalSizeZ": 1.5}
    physical |= {f"PhysicalSize{a}Unit": "nm" for a in "XYZ"}
    tifffile.imwrite(path, array, ome=True, photometric="minisblack", metadata={"axes": axes, **physical})
    volume = load(path, time=1, channel=2)
    index = tuple({"T": 1, "C": 2}.get(a, slice(None)) for a in axes)
    np.testing.assert_array_equal(volume.array, array[index])
    assert volume.spacing == pytest.approx((0.2, 0.3, 1.5))
    assert volume.metadata["length_unit"] == "nm"
    assert volume.name == "v"


def test_colours_are_shown_as_brightness(tmp_path):
    rgb = scalars((4, 5, 6, 3), "uint16")
    tifffile.imwrite(tmp_path / "rgb.tif", rgb, photometric="rgb", metadata=None)
    volume = load(tmp_path / "rgb.tif")
    np.testing.assert_allclose(volume.array, rgb @ np.array([0.2126, 0.7152, 0.0722]), atol=0.51)
    np.testing.assert_array_equal(load(tmp_path / "rgb.tif", channel=0).array, rgb[..., 0])


def test_a_contiguous_stack_behind_one_page_is_read(tmp_path):
    array = scalars((40, 5, 6), "uint16")
    tifffile.imwrite(tmp_path / "v.tif", array, imagej=True, metadata={"axes": "ZYX"})
    raw = (tmp_path / "v.tif").read_bytes()
    with tifffile.TiffFile(tmp_path / "v.tif") as file:
        pointer = file.pages[0].tags["ImageDescription"]
        second = file.pages[1].offset
    assert pointer is not None
    # large ImageJ stacks have one page and all the pixels behind it: cut the chain of pages after the first
    place = raw.rindex(second.to_bytes(4, "little" if raw[:2] == b"II" else "big"))
    (tmp_path / "v.tif").write_bytes(raw[:place] + bytes(4) + raw[place + 4 :])
    np.testing.assert_array_equal(load(tmp_path / "v.tif").array, array)


def test_the_largest_of_several_images_is_taken(tmp_path):
    with tifffile.TiffWriter(tmp_path / "v.tif") as writer:
        writer.write(scalars((3, 9, 9), "uint8"), photometric="minisblack")
        writer.write(scalars((4, 20, 20), "uint8"), photometric="minisblack")
    assert load(tmp_path / "v.tif").dimensions == (20, 20, 4)
    assert load(tmp_path / "v.tif", series=0).dimensions == (9, 9, 3)
    assert "largest of 2 images" in load(tmp_path / "v.tif").metadata["notes"][0]
    with pytest.raises(InputError, match="series must lie"):
        load(tmp_path / "v.tif", series=2)


def test_a_single_large_image_is_no_volume(tmp_path):
    tifffile.imwrite(tmp_path / "flat.tif", np.zeros((5000, 5000), np.uint8), compression="zlib")
    with pytest.raises(LoadError, match=r"5000 x 5000 x 1 .* stack of images"):
        load(tmp_path / "flat.tif")


@pytest.mark.parametrize("compression", [None, "zlib"])
@pytest.mark.parametrize("keep", [4, 8, 60, 0.3, 0.6, 0.97])
def test_a_file_that_is_cut_off_is_refused_in_words(tmp_path, keep, compression):
    path = tmp_path / "v.tif"
    tifffile.imwrite(path, scalars((6, 40, 40), "uint8"), compression=compression, photometric="minisblack")
    raw = path.read_bytes()
    path.write_bytes(raw[: int(keep * len(raw)) if isinstance(keep, float) else keep])
    if keep == 0.97 and compression is None:
        # all pixels are there, only directory entries of later pages are not
        np.testing.assert_array_equal(load(path).array, scalars((6, 40, 40), "uint8"))
        return
    with pytest.raises(LoadError, match=r"^v\.tif: .*(cut off|damaged|holds no image|is missing)"):
        load(path)


def overwritten(path, page, tag, value):
    """The file with another value of a tag whose value lies in the directory itself (4 bytes)."""
    with tifffile.TiffFile(path) as file:
        place = file.pages[page].tags[tag].valueoffset
    with path.open("r+b") as stream:
        stream.seek(place)
        stream.write(value.to_bytes(4, "little"))
    return path


def test_a_page_that_claims_another_size_is_refused_before_memory_is_asked_for(tmp_path):
    path = tmp_path / "v.tif"
    tifffile.imwrite(path, scalars((4, 16, 16), "uint16"), photometric="minisblack")
    overwritten(path, 2, "ImageLength", 2**31)
    tracemalloc.start()
    try:
        with pytest.raises(LoadError, match="page 2 has another size"):
            load(path)
        assert tracemalloc.get_traced_memory()[1] < 20e6
    finally:
        tracemalloc.stop()


def test_a_page_in_more_pieces_than_the_file_lists_is_refused_at_once(tmp_path):
    path = tmp_path / "v.tif"
    tifffile.imwrite(path, scalars((16, 16), "uint8"), compression="zlib", rowsperstrip=1)
    with pytest.raises(LoadError, match="promises more pixels"):
        load(overwritten(path, 0, "ImageLength", 100_000))
