"""HDF5 and what is built on it: choice of a data set, axes, geometry, Imaris, BigDataViewer, NeXus, MATLAB."""

import json
import threading
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

import volviz
from tests.unit.io.writers import scalars
from volviz.errors import Cancelled, InputError, LoadError
from volviz.io.hdf5 import reading

VALUES = scalars((4, 5, 6), "uint16")


def written(path: Path, **datasets) -> Path:
    with h5py.File(path, "w") as file:
        for name, values in datasets.items():
            file.create_dataset(name.replace("__", "/"), data=values)
    return path


def notes(volume) -> str:
    return " ".join(volume.metadata["notes"])


def test_one_of_several_data_sets_is_chosen_by_its_path(tmp_path):
    path = written(
        tmp_path / "v.h5", raw=VALUES, group__labels=VALUES[:3] // 2, line=np.arange(9.0), text=b"x"
    )
    with h5py.File(path, "a") as file:
        file["again"] = h5py.SoftLink("/raw")
        file["nowhere"] = h5py.SoftLink("/missing")
    volume = volviz.load(path)
    np.testing.assert_array_equal(volume.array, VALUES)
    assert "'group/labels' (3 x 5 x 6, uint16)" in notes(volume)
    for chosen in ({"series": "group/labels"}, {"dataset": "/group/labels"}, {"series": 1}):
        np.testing.assert_array_equal(volviz.load(path, **chosen).array, VALUES[:3] // 2)
    with pytest.raises(InputError, match=r"there is no data set 'x'; it holds '\w+' \(4 x 5 x 6, uint16\)"):
        volviz.open(path, series="x")
    bare = written(tmp_path / "w.h5", line=np.arange(9.0))
    with pytest.raises(LoadError, match="it holds no data set of numbers with three axes or more"):
        volviz.open(bare)


def test_boxes_of_chunks_are_read_and_reading_is_cancelled(tmp_path, monkeypatch):
    path = tmp_path / "v.h5"
    values = scalars((30, 16, 16), "float32")
    with h5py.File(path, "w") as file:
        file.create_dataset("v", data=values, chunks=(4, 8, 8), compression="gzip")
    monkeypatch.setattr(reading, "_PIECE", 1)
    source = volviz.open(path)
    part = source.read(box=(3, 9, 0, 16, 7, 21))
    np.testing.assert_array_equal(part.array, values[7:21, 0:16, 3:9])
    told: list[float] = []
    with pytest.raises(Cancelled):
        source.read(progress=lambda fraction, _text: told.append(fraction), cancel=lambda: len(told) > 2)
    # and while another one keeps the library busy
    free = threading.Event()
    busy = reading.reader_thread.submit(lambda: free.wait(5))
    begun = time.monotonic()
    with pytest.raises(Cancelled):
        source.read(cancel=lambda: time.monotonic() > begun + 0.1)
    assert time.monotonic() - begun < 0.3
    free.set()
    busy.result()


def test_element_size_and_axistags(tmp_path):
    path = written(tmp_path / "v.h5", v=VALUES, w=scalars((6, 5, 4, 2), "uint8"))
    tags = [{"key": key, "typeFlags": 2, "resolution": 0, "description": ""} for key in "xyzc"]
    with h5py.File(path, "a") as file:
        file["v"].attrs["element_size_um"] = [2.0, 0.5, 0.25]
        file["w"].attrs["axistags"] = json.dumps({"axes": tags})
        second = file["w"][()]
    first = volviz.load(path, series="v")
    assert (first.spacing, first.metadata["length_unit"]) == ((0.25, 0.5, 2), "µm")
    source = volviz.open(path, series="w")
    assert source.sizes == {"c": 2, "z": 4, "y": 5, "x": 6}
    np.testing.assert_array_equal(source.read(channel=1).array, second[..., 1].T)
    assert "cubes of side 1" in notes(source.read())


def test_nexus_says_what_is_shown_and_where_it_lies(tmp_path):
    path = written(tmp_path / "v.nxs", big=np.zeros((9, 9, 9), np.uint8), entry__data__v=VALUES.astype("f4"))
    with h5py.File(path, "a") as file:
        file.attrs["default"] = "entry"
        file["entry"].attrs["default"] = "data"
        data = file["entry/data"]
        data.attrs.update({"signal": "v", "axes": ["z", "y", "x"]})
        data["v"].attrs["units"] = "1/cm"
        for name, values, unit in (
            ("z", [10, 8, 6, 4], "mm"), ("y", 100.0 + np.arange(5), "um"), ("x", 0.5 * np.arange(6), "um")
        ):  # fmt: skip
            data[name] = values
            data[name].attrs["units"] = unit
    volume = volviz.load(path)
    assert volume.dimensions == (6, 5, 4)
    np.testing.assert_allclose(volume.spacing, (0.5, 1, 2000))
    np.testing.assert_allclose(volume.origin, (0, 100, 10000))
    assert volume.direction[2, 2] == -1
    assert (volume.unit, volume.metadata["length_unit"]) == ("1/cm", "µm")
    assert "'entry/data/v'" in notes(volume)


def test_itk_places_its_image(tmp_path):
    path = written(
        tmp_path / "v.h5", ITKImage__0__VoxelData=VALUES, ITKImage__0__Spacing=[0.5, 1.0, 2.0],
        ITKImage__0__Origin=[1.0, 2.0, 3.0], ITKImage__0__Directions=[[0, 1.0, 0], [-1, 0, 0], [0, 0, 1]],
    )  # fmt: skip
    volume = volviz.load(path)
    assert (volume.spacing, volume.origin, volume.metadata["length_unit"]) == ((0.5, 1, 2), (1, 2, 3), "mm")
    np.testing.assert_array_equal(volume.direction, [[0, -1, 0], [1, 0, 0], [0, 0, 1]])


def letters(text: str) -> np.ndarray:
    return np.frombuffer(text.encode(), "S1")


def test_imaris_levels_channels_times_and_extents(tmp_path):
    path = tmp_path / "v.ims"
    fine = scalars((2, 2, 4, 5, 6), "uint8")
    with h5py.File(path, "w") as file:
        image = file.create_group("DataSetInfo/Image")
        for n, (low, high) in enumerate([(10, 16), (0, 2.5), (-4, 4)]):
            image.attrs[f"ExtMin{n}"], image.attrs[f"ExtMax{n}"] = letters(str(low)), letters(str(high))
        image.attrs["Unit"] = letters("um")
        channel = file.create_group("DataSetInfo/Channel 1")
        channel.attrs.update({
            "Name": letters("GFP"), "Color": letters("0.000 1.000 0.000"), "ColorRange": letters("5.0 200.0"),
            "LSMEmissionWavelength": letters("525"),
        })  # fmt: skip
        info = file.create_group("DataSetInfo/TimeInfo")
        for n in (1, 2):
            info.attrs[f"TimePoint{n}"] = letters(f"2020-01-01 00:00:{n:02d}.500")
        for level, step in enumerate((1, 2)):
            for t in range(2):
                for c in range(2):
                    group = file.create_group(f"DataSet/ResolutionLevel {level}/TimePoint {t}/Channel {c}")
                    values = fine[t, c, :, ::step, ::step]
                    # chunks are filled up
                    group.create_dataset("Data", data=np.pad(values, [(0, 4), (0, 3), (0, 2)]))
                    for axis, n in zip("ZYX", values.shape, strict=True):
                        group.attrs[f"ImageSize{axis}"] = letters(str(n))
    source = volviz.open(path)
    assert source.sizes == {"t": 2, "c": 2, "z": 4, "y": 5, "x": 6}
    assert [level.dimensions for level in source.levels] == [(6, 5, 4), (3, 3, 4)]
    assert source.levels[0].spacing == (1, 0.5, 2)
    assert source.levels[0].origin == (10.5, 0.25, -3)
    np.testing.assert_allclose(source.levels[1].spacing, (2, 2.5 / 3, 2))
    np.testing.assert_allclose(source.levels[1].origin, (11, 2.5 / 6, -3))
    assert source.times == (0, 1)
    green = source.channels[1]
    assert (green.name, green.color, green.window, green.wavelength) == ("GFP", (0, 1, 0), (5, 200), 525)
    assert source.description.length_unit == "µm"
    np.testing.assert_array_equal(source.read(0, 1, 1).array, fine[1, 1])
    np.testing.assert_array_equal(
        source.read(1, 0, 1, box=(1, 3, 0, 2, 1, 4)).array, fine[0, 1, 1:4, 0:4:2, 2:6:2]
    )


XML = """<SpimData version="0.2"><BasePath type="relative">.</BasePath><SequenceDescription>
<ImageLoader format="bdv.hdf5"><hdf5 type="relative">v.h5</hdf5></ImageLoader><ViewSetups>
<ViewSetup><id>0</id><name>red</name><voxelSize><unit>micron</unit><size>0.5 0.5 2</size></voxelSize></ViewSetup>
<ViewSetup><id>1</id><name>green</name><voxelSize><unit>micron</unit><size>0.5 0.5 2</size></voxelSize></ViewSetup>
<ViewSetup><id>2</id><name>tile</name><voxelSize><unit>micron</unit><size>0.5 0.5 2</size></voxelSize></ViewSetup>
</ViewSetups></SequenceDescription><ViewRegistrations>
<ViewRegistration timepoint="0" setup="2"><ViewTransform type="affine">
<affine>1 0 0 100 0 1 0 0 0 0 1 0</affine></ViewTransform><ViewTransform type="affine">
<affine>0.5 0 0 0 0 0.5 0 0 0 0 2 0</affine></ViewTransform></ViewRegistration></ViewRegistrations></SpimData>"""


def test_bigdataviewer_setups_are_channels_or_chosen(tmp_path):
    fine = scalars((2, 3, 4, 6, 8), "uint16")
    with h5py.File(tmp_path / "v.h5", "w") as file:
        for s in range(3):
            file[f"s{s:02d}/resolutions"] = [[1.0, 1, 1], [2, 2, 1]]
            for t in range(2):
                for level, values in enumerate((fine[t, s], fine[t, s, :, ::2, ::2])):
                    file[f"t{t:05d}/s{s:02d}/{level}/cells"] = values.view(np.int16)
    assert "No XML beside it" in notes(volviz.load(tmp_path / "v.h5"))
    (tmp_path / "v.xml").write_text(XML)
    for name in ("v.h5", "v.xml"):
        source = volviz.open(tmp_path / name)
        assert source.sizes == {"t": 2, "c": 2, "z": 4, "y": 6, "x": 8}
        assert [channel.name for channel in source.channels] == ["red", "green"]
        assert source.levels[1].spacing == (1, 1, 2)
        assert source.levels[1].origin == (0.25, 0.25, 0)
        np.testing.assert_array_equal(source.read(0, 1, 1).array, fine[1, 1])
        np.testing.assert_array_equal(source.read(1).array, fine[0, 0, :, ::2, ::2])
    tile = volviz.open(tmp_path / "v.xml", series="s02")
    assert (tile.levels[0].origin, tile.levels[0].spacing) == ((100, 0, 0), (0.5, 0.5, 2))
    np.testing.assert_array_equal(tile.read(time=1).array, fine[1, 2])
    (tmp_path / "v.xml").write_text(XML.replace("v.h5", "w.h5"))
    with pytest.raises(LoadError, match=r"^v.xml: the file 'w.h5' with its images does not lie beside it"):
        volviz.open(tmp_path / "v.xml")


def test_matlab_files_of_both_kinds_count_rows_first(tmp_path):
    from scipy.io import savemat

    rows_columns_pages = scalars((5, 6, 4), "int16")
    savemat(tmp_path / "old.mat", {"v": rows_columns_pages, "other": scalars((3, 3, 3)), "text": "x"})
    with h5py.File(tmp_path / "new.mat", "w", userblock_size=512) as file:
        # MATLAB writes the reversed array in C order
        file["v"] = rows_columns_pages.transpose(2, 1, 0)
        file["v"].attrs["MATLAB_class"] = np.bytes_(b"int16")
    with (tmp_path / "new.mat").open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file")
    for name in ("old.mat", "new.mat"):
        volume = volviz.load(tmp_path / name)
        np.testing.assert_array_equal(volume.array, rows_columns_pages.transpose(2, 0, 1))
        assert "rows are taken for y" in notes(volume)
    assert volviz.load(tmp_path / "old.mat", series="other").dimensions == (3, 3, 3)


def test_an_array_of_an_archive_is_chosen_and_read_in_parts(tmp_path):
    values = scalars((3, 4, 5, 6), "float32")
    np.savez_compressed(
        tmp_path / "v.npz", image=values, mask=np.asfortranarray(values[0, :2] > 0), meta=np.arange(3)
    )
    source = volviz.open(tmp_path / "v.npz")
    assert source.sizes == {"t": 3, "z": 4, "y": 5, "x": 6}
    np.testing.assert_array_equal(source.read(time=2, box=(0, 3, 1, 4, 2, 4)).array, values[2, 2:4, 1:4, 0:3])
    np.testing.assert_array_equal(volviz.load(tmp_path / "v.npz", series="mask").array, values[0, :2] > 0)
    with pytest.raises(InputError, match=r"there is no array 'meta'; it holds 'image' \(3 x 4 x 5 x 6"):
        volviz.open(tmp_path / "v.npz", series="meta")
