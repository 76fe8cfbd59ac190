"""`open`: axes, times, channels and labels come from the header, and little is read for a small part."""

from __future__ import annotations

import json
import tracemalloc

import nibabel
import numpy as np
import pytest
import tifffile

import volviz
from tests.unit.io import stores
from tests.unit.io.writers import dicom_slice, itk, rotation, scalars
from volviz.cli import main
from volviz.errors import InputError, LoadError
from volviz.io import info, load
from volviz.io.file_source import FileSource
from volviz.volume_data.description import Channel, Statistics
from volviz.volume_data.orientation import LETTERS, direction_of, orientation_of

MAGENTA, GREEN = (np.arange(256)[None] * np.array(part)[:, None] for part in ((1, 0, 1), (0, 1, 0)))


def test_a_hyperstack_of_imagej_tells_times_colours_and_windows(tmp_path):
    array = scalars((3, 4, 2, 5, 6), "uint16")
    metadata = {"axes": "TZCYX", "finterval": 0.5, "mode": "composite", "Ranges": (10.0, 500.0, 20.0, 800.0),
                "LUTs": [MAGENTA.astype(np.uint8), GREEN.astype(np.uint8)]}  # fmt: skip
    tifffile.imwrite(tmp_path / "h.tif", array, imagej=True, metadata=metadata)
    source = volviz.open(tmp_path / "h.tif")
    assert source.axes == ("t", "c", "z", "y", "x")
    assert source.sizes == {"t": 3, "c": 2, "z": 4, "y": 5, "x": 6}
    assert source.times == (0.0, 0.5, 1.0)
    assert source.channels == (
        Channel(color=(1, 0, 1), window=(10, 500)),
        Channel(color=(0, 1, 0), window=(20, 800)),
    )
    for time, channel in ((0, 0), (2, 1)):
        np.testing.assert_array_equal(source.read(time=time, channel=channel).array, array[time, :, channel])
    part = source.read(time=1, channel=1, box=(2, 6, 1, 3, 1, 4))
    np.testing.assert_array_equal(part.array, array[1, 1:4, 1, 1:3, 2:6])
    assert part.origin == pytest.approx((2 * part.spacing[0], part.spacing[1], part.spacing[2]))
    with pytest.raises(InputError, match=r"h\.tif|h: time must lie in 0\.\.2, got 12"):
        source.read(time=12)


@pytest.mark.parametrize("axes", ["TCZYX", "CTZYX", "ZTCYX"])
def test_ome_tells_names_colours_wavelengths_and_times(tmp_path, axes):
    sizes = {"T": 2, "C": 3, "Z": 4, "Y": 5, "X": 6}
    array = scalars(tuple(sizes[a] for a in axes), "uint8")
    metadata = {
        "axes": axes, "TimeIncrement": 200.0, "TimeIncrementUnit": "ms", "PhysicalSizeX": 0.5,
        "Channel": {"Name": ["DAPI", "GFP", "dirt"], "Color": [0x0000FFFF, 16711935, -16776961],
                    "EmissionWavelength": [461.0, 0.5, 600.0], "EmissionWavelengthUnit": ["nm", "µm", "nm"]},
    }  # fmt: skip
    tifffile.imwrite(tmp_path / "v.ome.tif", array, ome=True, photometric="minisblack", metadata=metadata)
    source = volviz.open(tmp_path / "v.ome.tif")
    assert source.sizes == {"t": 2, "c": 3, "z": 4, "y": 5, "x": 6}
    assert source.times == (0.0, 0.2)
    assert source.units["t"] == "s"
    assert [channel.name for channel in source.channels] == ["DAPI", "GFP", "dirt"]
    assert [channel.color for channel in source.channels] == [(0, 0, 1), (0, 1, 0), (1, 0, 0)]
    assert [channel.wavelength for channel in source.channels] == [461, 500, 600]
    index = tuple({"T": 1, "C": 2}.get(a, slice(None)) for a in axes)
    np.testing.assert_array_equal(source.read(time=1, channel=2).array, array[index])
    np.testing.assert_array_equal(
        source.read(time=1, channel=2, box=(0, 6, 2, 4, 1, 3)).array, array[index][1:3, 2:4]
    )


def test_times_of_planes_come_before_the_increment(tmp_path):
    planes = {"DeltaT": [0.0, 0.0, 1.5, 1.5], "TheT": [0, 0, 1, 1], "TheZ": [0, 1, 0, 1], "TheC": [0] * 4}
    tifffile.imwrite(
        tmp_path / "v.ome.tif", scalars((2, 2, 5, 6), "uint8"), ome=True, photometric="minisblack",
        metadata={"axes": "TZYX", "TimeIncrement": 9.0, "Plane": planes},
    )  # fmt: skip
    assert volviz.open(tmp_path / "v.ome.tif").times == (0.0, 1.5)


@pytest.mark.parametrize("kind", [nibabel.Nifti1Image, nibabel.Nifti2Image])
@pytest.mark.parametrize("ending", [".nii", ".nii.gz"])
def test_a_nifti_of_four_axes_tells_times_window_and_labels(tmp_path, kind, ending):
    array = scalars((6, 5, 4, 3), "int16")
    image = kind(array, np.diag([-2.0, -2, 3, 1]))
    image.header.set_xyzt_units("mm", "msec")
    image.header["pixdim"][4] = 250
    image.header["toffset"] = 1000
    image.header["cal_min"], image.header["cal_max"] = -5, 90
    image.header.set_intent("label")
    nibabel.save(image, tmp_path / f"v{ending}")
    source = volviz.open(tmp_path / f"v{ending}")
    assert source.sizes == {"t": 3, "z": 4, "y": 5, "x": 6}
    assert source.times == (1.0, 1.25, 1.5)
    assert source.channels == (Channel(window=(-5, 90)),)
    assert source.is_labels
    for time in range(3):
        np.testing.assert_array_equal(source.read(time=time).array, array[..., time].T)
        part = source.read(time=time, box=(1, 4, 0, 5, 2, 4))
        np.testing.assert_array_equal(part.array, array[1:4, :, 2:4, time].T)
        assert part.origin == pytest.approx((2, 0, 6))
    assert "first of 3 time points" in source.read().metadata["notes"][0]


def test_a_nifti_without_a_unit_of_time_tells_no_times(tmp_path):
    nibabel.save(nibabel.Nifti1Image(scalars((6, 5, 4, 3), "int16"), np.eye(4)), tmp_path / "v.nii")
    source = volviz.open(tmp_path / "v.nii")
    assert (source.sizes["t"], source.times, source.units["t"]) == (3, None, "")


def test_time_points_of_dicom_tell_their_times(tmp_path):
    stack = scalars((4, 9, 8), "int16") // 64
    for time in range(3):
        for n, pixels in enumerate(stack):
            tags = {
                "TemporalPositionIdentifier": time + 1,
                "TriggerTime": str(40 * time),
                "InstanceNumber": n,
            }
            dicom_slice(tmp_path / f"{time}-{n}.dcm", pixels + time, (0, 0, n), **tags)
    source = volviz.open(tmp_path)
    assert source.sizes == {"t": 3, "z": 4, "y": 9, "x": 8}
    assert source.times == (0.0, 0.04, 0.08)
    assert (source.unit, source.name) == ("HU", "DICOM CT 4 slices")
    for time in range(3):
        np.testing.assert_array_equal(source.read(time=time).array, stack + time - 1024)
    part = source.read(time=2, box=(1, 5, 2, 9, 1, 3))
    np.testing.assert_array_equal(part.array, stack[1:3, 2:9, 1:5] + 2 - 1024)
    # the header counts from the first voxel of the box
    np.testing.assert_allclose(part.origin, (1 * 0.7, 2 * 1.1, 1))


def test_a_box_of_a_dicom_folder_decodes_its_slices_alone(tmp_path):
    for n, pixels in enumerate(scalars((6, 9, 8), "int16") // 64):
        dicom_slice(tmp_path / f"{n}.dcm", pixels, (0, 0, n))
    source = volviz.open(tmp_path)
    (tmp_path / "0.dcm").unlink()
    (tmp_path / "5.dcm").unlink()
    assert source.read(box=(0, 8, 0, 9, 1, 5)).dimensions == (8, 9, 4)
    with pytest.raises(LoadError):
        source.read()


@pytest.mark.parametrize("order", ["C", "F"])
def test_an_array_of_four_axes_has_time_points(tmp_path, order):
    array = np.asarray(scalars((3, 4, 5, 6), "float32"), order=order)
    np.save(tmp_path / "v.npy", array)
    source = volviz.open(tmp_path / "v.npy")
    assert source.sizes == {"t": 3, "z": 4, "y": 5, "x": 6}
    for time in range(3):
        np.testing.assert_array_equal(source.read(time=time).array, array[time])
        part = source.read(time=time, box=(2, 5, 0, 4, 1, 3))
        np.testing.assert_array_equal(part.array, array[time, 1:3, 0:4, 2:5])


def test_colours_have_three_channels_and_are_shown_as_their_brightness(tmp_path):
    rgb = scalars((4, 5, 6, 3), "uint8")
    tifffile.imwrite(tmp_path / "rgb.tif", rgb, photometric="rgb", metadata=None)
    source = volviz.open(tmp_path / "rgb.tif")
    assert source.sizes == {"c": 3, "z": 4, "y": 5, "x": 6}
    assert [channel.name for channel in source.channels] == ["red", "green", "blue"]
    np.testing.assert_allclose(source.read().array, rgb @ np.array([0.2126, 0.7152, 0.0722]), atol=0.51)
    for channel in range(3):
        np.testing.assert_array_equal(source.read(channel=channel).array, rgb[..., channel])
    assert np.array_equal(load(tmp_path / "rgb.tif").array, source.read().array)


@pytest.mark.parametrize("name", ["huge.nhdr", "huge.nii"])
def test_of_a_file_that_fits_no_memory_a_box_is_read(tmp_path, name):
    """2000^3 floats: 32 GB that are mostly a hole in the file."""
    n, corner = 2000, scalars((4, 4, 4), "float32")
    if name == "huge.nii":
        image = nibabel.Nifti1Image(np.zeros((2, 2, 2), np.float32), np.diag([-1.0, -1, 1, 1]))
        head = bytearray(image.to_bytes()[:352])
        head[42:48] = np.array([n, n, n], "<i2").tobytes()
        path = data = tmp_path / name
    else:
        head = bytearray()
        path, data = tmp_path / name, tmp_path / "huge.raw"
        path.write_text(
            f"NRRD0004\ntype: float\ndimension: 3\nsizes: {n} {n} {n}\n"
            "encoding: raw\nendian: little\ndata file: huge.raw\n\n"
        )
    with data.open("wb") as stream:
        stream.write(head)
        stream.truncate(len(head) + 4 * n**3)
        for k in range(4):
            for j in range(4):
                stream.seek(len(head) + 4 * (((k + 7) * n + j + 100) * n + 50))
                stream.write(corner[k, j].tobytes())
    tracemalloc.start()
    source = volviz.open(path)
    assert source.levels[0].dimensions == (n, n, n)
    part = source.read(box=(50, 54, 100, 104, 7, 11))
    assert tracemalloc.get_traced_memory()[1] < 4 * 4 * n * n + 2**24
    tracemalloc.stop()
    np.testing.assert_array_equal(part.array, corner)


def test_of_compressed_values_what_lies_behind_is_not_unpacked(tmp_path):
    array = scalars((20, 30, 40), "int16")
    nibabel.save(nibabel.Nifti1Image(array.T, np.eye(4)), tmp_path / "v.nii.gz")
    packed = (tmp_path / "v.nii.gz").read_bytes()
    source = volviz.open(tmp_path / "v.nii.gz")
    # the end is missing: nothing but the first slices can be read
    (tmp_path / "v.nii.gz").write_bytes(packed[: len(packed) // 2])
    np.testing.assert_array_equal(source.read(box=(0, 40, 0, 30, 2, 8)).array, array[2:8])
    with pytest.raises(LoadError, match=r"cut off|damaged"):
        source.read()


def test_samples_open_and_are_read_in_parts():
    source = volviz.open("sample:ct-chest")
    assert (source.name, source.unit, source.axes) == ("CT chest", "HU", ("z", "y", "x"))
    whole, part = source.read(), source.read(box=(10, 30, 20, 50, 3, 9))
    np.testing.assert_array_equal(part.array, whole.array[3:9, 20:50, 10:30])
    assert part.metadata["source"] == "sample:ct-chest"
    computed = volviz.open("sample:sphere", unit="m")
    assert (computed.unit, computed.sizes) == ("m", {"z": 64, "y": 64, "x": 64})
    assert computed.read(box=(0, 64, 0, 64, 30, 34)).dimensions == (64, 64, 4)


def test_info_tells_what_the_whole_file_holds(tmp_path, capsys):
    metadata = {"axes": "TZCYX", "finterval": 2.0}
    tifffile.imwrite(tmp_path / "h.tif", scalars((3, 4, 2, 5, 6), "uint16"), imagej=True, metadata=metadata)
    assert main(["info", str(tmp_path / "h.tif"), "--json", "--time", "2"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["sizes"] == {"t": 3, "c": 2, "z": 4, "y": 5, "x": 6}
    assert told["times"] == [0, 2, 4]
    assert main(["info", str(tmp_path / "h.tif")]) == 0
    printed = capsys.readouterr().out
    assert "time points: 3, from 0 to 4 s" in printed
    assert "channels:    2" in printed


def test_info_reads_headers_alone_unless_asked_for_statistics(tmp_path, capsys):
    array = scalars((4, 5, 6), "int16")
    (tmp_path / "v.nrrd").write_bytes(
        b"NRRD0004\ntype: short\ndimension: 3\nsizes: 6 5 4\nencoding: raw\nendian: little\nspacings: 1 1 2\n\n"
        + array.astype("<i2").tobytes()
    )
    reads = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(FileSource, "read_volume", lambda *_: reads.append(1))
        told = info(tmp_path / "v.nrrd")
        assert main(["info", str(tmp_path / "v.nrrd")]) == 0
    assert not reads
    assert (told["dims"], told["dtype"], told["bytes"], told["range"]) == ([6, 5, 4], "int16", 240, None)
    assert "range" not in capsys.readouterr().out
    assert info(tmp_path / "v.nrrd", statistics=True)["range"] == [array.min(), array.max()]
    assert main(["info", str(tmp_path / "v.nrrd"), "--statistics"]) == 0
    assert f"range:       {array.min():g} to {array.max():g}" in capsys.readouterr().out


def test_info_notices_a_packed_file_that_is_cut_off(tmp_path):
    nibabel.save(nibabel.Nifti1Image(scalars((20, 20, 20), "int16"), np.eye(4)), tmp_path / "v.nii.gz")
    packed = (tmp_path / "v.nii.gz").read_bytes()
    (tmp_path / "v.nii.gz").write_bytes(packed[:-100])
    with pytest.raises(LoadError, match="cut off"):
        info(tmp_path / "v.nii.gz")


def test_a_box_of_rescaled_values_has_the_type_of_the_whole(tmp_path):
    array = np.zeros((4, 5, 6), np.int16)
    array[0, 0, 0] = 3000
    image = nibabel.Nifti1Image(array.T, np.eye(4))
    nibabel.save(image, tmp_path / "v.nii")
    content = bytearray((tmp_path / "v.nii").read_bytes())
    # slope and intercept: up to 58976, beyond int16
    content[112:120] = np.array([20.0, -1024.0], "<f4").tobytes()
    (tmp_path / "v.nii").write_bytes(content)
    box = volviz.open(tmp_path / "v.nii").read(box=(2, 4, 2, 4, 1, 4))
    assert box.array.dtype == load(tmp_path / "v.nii").array.dtype == np.int32
    assert (box.array == -1024).all()


def test_a_pipe_and_a_folder_of_other_files_are_told_in_true_words(tmp_path):
    import os

    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "v.nrrd")
        with pytest.raises(LoadError, match="no file but a pipe"):
            load(tmp_path / "v.nrrd")
    folder = tmp_path / "scans"
    folder.mkdir()
    (folder / "notes.txt").write_text("nothing")
    with pytest.raises(LoadError, match="no DICOM slices and no numbered pictures"):
        load(folder)
    for name in ("a.nii", "b.nii"):
        nibabel.save(nibabel.Nifti1Image(scalars((3, 4, 5), "int16"), np.eye(4)), folder / name)
    with pytest.raises(LoadError, match=r"this one holds a.nii, b.nii: open one of them"):
        load(folder)


def test_a_meta_image_may_tell_its_range(tmp_path):
    head = (
        "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = MET_UCHAR\n{}ElementDataFile = LOCAL\n"
    )
    for text, expected in (
        ("ElementMin = 3\nElementMax = 200\n", Statistics(3, 200)),
        ("ElementMin = 3\n", None),
        ("ElementMin = 3\nElementMax = nan\n", None),
    ):
        (tmp_path / "v.mha").write_bytes(head.format(text).encode() + bytes(range(24)))
        assert volviz.open(tmp_path / "v.mha").statistics() == expected


def test_an_orientation_replaces_the_directions_of_the_file_around_its_first_voxel(tmp_path):
    path = itk(tmp_path / "v.nrrd", scalars((4, 5, 6)), direction=rotation(3))
    as_it_is, turned = load(path), load(path, orientation="sra", length_unit="µm")
    np.testing.assert_array_equal(turned.array, as_it_is.array)
    assert turned.origin == as_it_is.origin
    assert turned.spacing == as_it_is.spacing
    assert turned.metadata["length_unit"] == "µm"
    # i leads upwards, j to the right, k to the front
    np.testing.assert_allclose(turned.direction, [[0, -1, 0], [0, 0, -1], [1, 0, 0]], atol=1e-12)
    for code in ("LPX", "LR", "LLS", "LRS", 3):
        with pytest.raises(InputError, match="three letters such as LPS"):
            load(path, orientation=code)


def test_the_code_nearest_to_directions_names_every_axis_once():
    for code in ("LPS", "RAS", "SRA", "IPL"):
        assert orientation_of(direction_of(code)) == code
    turn = rotation(1)
    code = orientation_of(turn)
    assert len({LETTERS[letter][0] for letter in code}) == 3


def test_levels_keep_their_places_under_an_orientation(tmp_path):
    arrays, places = [scalars((8, 8, 8)), scalars((4, 4, 4))], [(0, 0, 0), (0.5, 0.5, 0.5)]
    path = stores.image(tmp_path / "v", arrays, [(1, 1, 1), (2, 2, 2)], translations=places)
    fine, coarse = volviz.open(path, orientation="RAS").levels
    np.testing.assert_allclose(np.subtract(coarse.origin, fine.origin), (-0.5, -0.5, 0.5))
