"""What every reader must do, over the table of readers: a new row is tested without a new test."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import sys
import threading
import time
from pathlib import Path
from typing import Any

import h5py
import mrcfile
import nibabel
import numpy as np
import pytest
import tifffile
from scipy.io import savemat

import volviz
from tests.unit.io import stores
from tests.unit.io.writers import dicom_slice, itk, scalars
from volviz.cli import main
from volviz.errors import Cancelled, InputError, LoadError, VolvizError
from volviz.io import file_dialog_filters, info, load, suffixes
from volviz.io.table import READERS

ARRAY = scalars((12, 40, 50), "int16") // 8


def nifti(folder: Path) -> Path:
    nibabel.save(nibabel.Nifti1Image(ARRAY.T, np.diag([-1.0, -1, 1, 1])), folder / "v.nii.gz")
    return folder / "v.nii.gz"


def vtk_xml(folder: Path) -> Path:
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

    image = vtkImageData()
    image.SetDimensions(*ARRAY.shape[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(ARRAY.ravel(), deep=True))
    writer = vtkXMLImageDataWriter()
    writer.SetFileName(str(folder / "v.vti"))
    writer.SetInputData(image)
    writer.Write()
    return folder / "v.vti"


def tiff(folder: Path) -> Path:
    tifffile.imwrite(folder / "v.tif", ARRAY, photometric="minisblack")
    return folder / "v.tif"


def dicom(folder: Path) -> Path:
    (folder / "series").mkdir()
    for n, pixels in enumerate(ARRAY):
        tags = {"PixelSpacing": [1, 1], "RescaleIntercept": "0", "InstanceNumber": n}
        dicom_slice(folder / "series" / f"{n:02d}.dcm", pixels, (0, 0, n), **tags)
    return folder / "series"


def numpy_file(folder: Path) -> Path:
    np.save(folder / "v.npy", ARRAY)
    return folder / "v.npy"


def raw(folder: Path) -> Path:
    (folder / "v_50x40x12_int16.raw").write_bytes(ARRAY.astype("<i2").tobytes())
    return folder / "v_50x40x12_int16.raw"


def images(folder: Path) -> Path:
    import tifffile

    stack = folder / "pictures"
    stack.mkdir()
    for n, page in enumerate(ARRAY):
        tifffile.imwrite(stack / f"{n:03d}.tif", page)
    return stack


def zarr(folder: Path) -> Path:
    return stores.zipped(stores.image(folder / "v", [ARRAY], [(1, 1, 1)]), folder / "v.zarr.zip")


def mrc(folder: Path) -> Path:
    with mrcfile.new(folder / "v.mrc", ARRAY) as file:
        file.voxel_size = 1.0
    return folder / "v.mrc"


def mgh(folder: Path) -> Path:
    nibabel.save(nibabel.MGHImage(ARRAY.T.copy(), np.diag([-1.0, -1, 1, 1])), folder / "v.mgz")
    return folder / "v.mgz"


#: Pairs of files, values that are scaled slice by slice, and bytes alone; by the file that tests them.
TESTED_ELSEWHERE = {
    **dict.fromkeys(("MINC", "AFNI", "PAR/REC", "Interfile"), "test_neuroimaging.py"),
    "SLC": "test_slc.py",
}


def hdf5(folder: Path) -> Path:
    with h5py.File(folder / "v.h5", "w") as file:
        file.create_dataset("v", data=ARRAY, chunks=True, compression="gzip")
    return folder / "v.h5"


def matlab(folder: Path) -> Path:
    savemat(folder / "v.mat", {"v": ARRAY.transpose(1, 2, 0)}, do_compression=True)
    return folder / "v.mat"


def numpy_archive(folder: Path) -> Path:
    np.savez_compressed(folder / "v.npz", v=ARRAY)
    return folder / "v.npz"


GEOMETRY: dict[str, Any] = {"spacing": (1, 1, 1), "origin": (0, 0, 0)}
WRITERS = {
    "NIfTI": nifti,
    "NRRD": lambda folder: itk(folder / "v.nrrd", ARRAY, compressed=True, **GEOMETRY),
    "MetaImage": lambda folder: itk(folder / "v.mha", ARRAY, compressed=True, **GEOMETRY),
    "VTK image": vtk_xml,
    "MRC": mrc,
    "MGH": mgh,
    "GIPL": lambda folder: itk(folder / "v.gipl", ARRAY, **GEOMETRY),
    "TIFF": tiff,
    "DICOM": dicom,
    "Zarr": zarr,
    "HDF5": hdf5,
    "MATLAB": matlab,
    "NumPy archive": numpy_archive,
    "Pictures": images,
    "NumPy": numpy_file,
    "Raw": raw,
}
by_reader = pytest.mark.parametrize("reader", READERS, ids=lambda reader: reader.name)


@pytest.fixture
def file(reader, tmp_path) -> Path:
    if reader.name in TESTED_ELSEWHERE:
        pytest.skip(f"tests/unit/io/{TESTED_ELSEWHERE[reader.name]} looks at what this format cannot hold")
    assert reader.name in WRITERS, f"say in WRITERS how a {reader.name} file is made"
    return WRITERS[reader.name](tmp_path)


@by_reader
def test_the_same_array_comes_back_from_every_format(reader, file):
    volume = load(file)
    np.testing.assert_array_equal(volume.array, ARRAY)
    np.testing.assert_allclose(volume.index_to_world, np.eye(4), atol=1e-6)
    assert volume.metadata["source"] == str(file)
    assert volume.metadata["format"]
    assert isinstance(volume.metadata["notes"], tuple)


@by_reader
def test_only_the_right_reader_recognises_the_content(reader, file):
    head = b"" if file.is_dir() else _unpacked_head(file)
    knowing = [r.name for r in READERS if r.sniff(head, file)]
    assert knowing[0] == reader.name
    assert set(knowing) <= {reader.name, "Raw"}


@by_reader
def test_a_file_without_its_suffix_is_recognised_by_its_content(reader, file, tmp_path):
    if reader.name == "Raw" or file.is_dir():
        pytest.skip("a raw file has nothing but its name, a folder no suffix")
    bare = file.rename(tmp_path / "download")
    np.testing.assert_array_equal(load(bare).array, ARRAY)


@by_reader
def test_progress_rises_to_one(reader, file):
    told: list[tuple[float, str]] = []
    load(file, progress=lambda fraction, text: told.append((fraction, text)))
    fractions = [fraction for fraction, _ in told]
    assert fractions == sorted(fractions)
    assert fractions[0] >= 0
    assert fractions[-1] == 1
    assert all(text for _, text in told)


@by_reader
@pytest.mark.parametrize("timeout", [0, 1])
def test_loading_can_be_cancelled(reader, file, timeout):
    asked = iter(range(1000))
    with pytest.raises(Cancelled, match="cancelled"):
        load(file, cancel=lambda: next(asked) >= timeout)


@by_reader
def test_info_is_plain_and_goes_into_json(reader, file):
    assert json.loads(json.dumps(info(file)))["dims"] == [50, 40, 12]
    told = json.loads(json.dumps(info(file, statistics=True)))
    assert told["dims"] == [50, 40, 12]
    assert told["dtype"] == "int16"
    assert told["range"] == [float(ARRAY.min()), float(ARRAY.max())]
    assert len(told["direction"]) == 9


@by_reader
def test_hints_replace_what_the_file_says(reader, file):
    volume = load(file, spacing=(1, 2, 3), origin=(4, 5, 6), unit="K", name="mine")
    assert (volume.spacing, volume.origin, volume.unit, volume.name) == ((1, 2, 3), (4, 5, 6), "K", "mine")


@by_reader
@pytest.mark.parametrize("keep", [1, 20, 0.1, 0.5, 0.9])
def test_a_file_that_is_cut_off_is_answered_in_one_sentence_and_nothing_is_printed(reader, file, keep, capfd):
    path = file if file.is_file() else sorted(file.iterdir())[5]
    content = path.read_bytes()
    path.write_bytes(content[: int(keep * len(content)) if isinstance(keep, float) else keep])
    with pytest.raises(LoadError) as caught:
        load(path)
    assert str(caught.value).startswith(f"{path.name}: ") or str(caught.value).startswith("v: ")
    assert "\n" not in str(caught.value)
    assert capfd.readouterr() == ("", "")


@by_reader
def test_damage_anywhere_in_the_file_never_ends_in_anything_but_a_volume_or_a_sentence(reader, file, capfd):
    path = file if file.is_file() else sorted(file.iterdir())[5]
    content = path.read_bytes()
    rng = np.random.default_rng(9)
    for _ in range(60):
        damaged = bytearray(content)
        # most of the damage in the header, where it matters
        reach = len(content) if rng.random() < 0.3 else min(len(content), 600)
        for place in rng.integers(0, reach, rng.integers(1, 6)):
            damaged[place] = rng.integers(0, 256)
        path.write_bytes(damaged)
        started = time.perf_counter()
        with contextlib.suppress(VolvizError):
            load(path)
        assert time.perf_counter() - started < 5
    assert capfd.readouterr() == ("", "")


@by_reader
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere names are always text")
def test_a_name_that_is_no_text_is_opened_and_told(reader, file, capsys):
    named = file.rename(file.with_name(os.fsdecode(b"\xe9 \xff ") + file.name))
    np.testing.assert_array_equal(load(named).array, ARRAY)
    assert main(["info", str(named)]) == 0
    assert reader.name.split()[0].lower() in capsys.readouterr().out.lower()


@by_reader
def test_loading_works_on_a_thread(reader, file):
    result: list[Any] = []
    worker = threading.Thread(target=lambda: result.append(load(file).array.sum()))
    worker.start()
    worker.join(20)
    assert result == [ARRAY.sum()]


@by_reader
def test_a_file_is_opened_by_its_header_alone(reader, file, tmp_path, monkeypatch):
    source = volviz.open(file)
    assert source.axes == ("z", "y", "x")
    assert source.sizes == {"z": 12, "y": 40, "x": 50}
    (level,) = source.levels
    assert level.dimensions == (50, 40, 12)
    np.testing.assert_allclose(level.direction, np.eye(3), atol=1e-6)
    assert source.metadata["source"] == str(file)
    assert source.content_id
    # other values in the same place: what is read now cannot have been read before
    shutil.rmtree(file) if file.is_dir() else file.unlink()
    monkeypatch.setattr(sys.modules[__name__], "ARRAY", ARRAY[:, ::-1] + 1)
    assert WRITERS[reader.name](tmp_path) == file
    np.testing.assert_array_equal(source.read().array, ARRAY)


@by_reader
def test_a_box_is_read_with_its_place(reader, file):
    box = (3, 20, 0, 40, 5, 9)
    part = load(file, box=box)
    np.testing.assert_array_equal(part.array, ARRAY[5:9, 0:40, 3:20])
    np.testing.assert_allclose(part.origin, (3, 0, 5), atol=1e-5)
    moved = volviz.open(file, origin=(1, 2, 3), spacing=(2, 2, 2)).read(box=box)
    assert (moved.origin, moved.spacing) == ((7, 2, 13), (2, 2, 2))


@by_reader
@pytest.mark.parametrize(
    ("part", "words"),
    [
        ({"level": 3}, "only one level, got 3"),
        ({"time": 12}, "only one time point, got 12"),
        ({"channel": 1}, "only one channel, got 1"),
        ({"time": -1}, "only one time point, got -1"),
        ({"box": (0, 50, 0, 40, 0, 13)}, "from 0 to 13 along k, outside the 12 voxels"),
        ({"box": (0, 50, 0, 40, 4, 5)}, "one voxel along k"),
        ({"time": "2"}, "time must be an integer"),
    ],
)
def test_a_part_that_is_not_there_is_refused_in_words(reader, file, part, words):
    with pytest.raises(InputError, match=words) as caught:
        load(file, **part)
    assert "\n" not in str(caught.value)


@by_reader
def test_a_source_is_read_on_several_threads(reader, file):
    source, found = volviz.open(file), []
    boxes = [(0, 50, 0, 40, k, k + 4) for k in range(8)]
    workers = [
        threading.Thread(target=lambda box=box: found.append((box, source.read(box=box).array)))
        for box in boxes
    ]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join(20)
    assert len(found) == len(boxes)
    for box, array in found:
        np.testing.assert_array_equal(array, ARRAY[box[4] : box[5]])


@by_reader
def test_suffixes_are_lower_case_and_in_the_dialog(reader, file):
    everything, *each = file_dialog_filters()
    assert reader.suffixes
    for suffix in reader.suffixes:
        assert suffix.startswith(".")
        assert suffix == suffix.lower()
        assert suffix in suffixes()
        assert f"*{suffix}" in everything
    assert reader.dialog_filter in each


def _unpacked_head(file: Path) -> bytes:
    from volviz.io.loading import _head

    return _head(file)


BAD = {
    "text.nii": (b"hello", "no NIfTI file"),
    "empty.nrrd": (b"", "empty"),
    "noext": (b"\0" * 100, "no reader knows"),
    "huge.nhdr": (
        (
            b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 99999999 99999999 99999999\n"
            b"encoding: raw\ndata file: x.raw\n\n"
        ),
        "x.raw",
    ),
    "neg.mhd": (
        (
            b"ObjectType = Image\nNDims = 3\nDimSize = -4 4 4\n"
            b"ElementType = MET_UCHAR\nElementDataFile = x.raw\n"
        ),
        "size -4 x 4 x 4",
    ),
    "zero.mha": (
        b"ObjectType = Image\nNDims = 3\nDimSize = 0 0 0\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
        "size 0 x 0 x 0",
    ),
    "fake.vti": (b"<VTKFile><ImageData WholeExtent='0 9 0 9 0 9'>", "no image"),
    "huge.vti": (b"<VTKFile type='ImageData'><ImageData WholeExtent='0 99999 0 99999 0 99999'>", "cut off"),
    "mesh.vti": (b"<VTKFile type='PolyData'>", "holds PolyData"),
    "mesh.vtk": (b"# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n", "holds POLYDATA"),
    "huge.vtk": (
        b"# vtk DataFile Version 3.0\nx\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 9999 9999 9999\n",
        "cut off",
    ),
    "fake.tif": (b"II*\0" + bytes(range(60)), "TIFF"),
    "fake.dcm": (bytes(128) + b"DICM" + bytes(range(250)), "no image"),
    "object.npy": (
        b"\x93NUMPY\x01\x00v\x00{'descr': '|O', 'fortran_order': False, 'shape': (3,), }" + b" " * 60 + b"\n",
        "object|unreadable",
    ),
    "notes.txt": (b"some words", "no reader knows"),
    "cells.czi": (b"ZISRAWFILE" + bytes(500), "are not read; save it as OME-TIFF"),
}


@pytest.mark.parametrize("name", BAD)
def test_files_that_are_no_volumes_are_refused_in_words(tmp_path, name, capfd):
    content, words = BAD[name]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(LoadError, match=words) as caught:
        load(tmp_path / name)
    assert str(caught.value).startswith(f"{name}: ")
    assert str(caught.value).endswith(".")
    assert capfd.readouterr() == ("", "")


def test_missing_files_and_unreadable_ones_are_refused_in_words(tmp_path, monkeypatch):
    with pytest.raises(LoadError, match=r"^missing\.nii: there is no such file"):
        load(tmp_path / "missing.nii")
    secret = tmp_path / "secret.nii"
    secret.write_bytes(bytes(400))
    secret.chmod(0)
    if os.geteuid() == 0:
        # root may read everything: let the system say what it says to others
        def refused(*_args: Any, **_kwargs: Any) -> None:
            raise PermissionError(13, "Permission denied")

        monkeypatch.setattr(Path, "open", refused)
    with pytest.raises(LoadError, match=r"^secret\.nii: you may not read it"):
        load(secret)


def test_unknown_hints_and_samples_are_refused_in_words(tmp_path):
    with pytest.raises(InputError, match=r"knows no hint 'tiem'; it takes dims.* time"):
        load(tmp_path, tiem=3)
    with pytest.raises(InputError, match=r"time is chosen when values are read: .*read\(time=\.\.\.\)"):
        volviz.open(tmp_path, time=3)
    with pytest.raises(InputError, match="no sample 'elephant'; there are mri-brain"):
        load("sample:elephant")


def test_vtk_cell_values_lie_at_the_middles_of_the_cells(tmp_path):
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

    image = vtkImageData()
    image.SetExtent(2, 7, 0, 4, 0, 3)
    image.SetSpacing(0.5, 1.0, 2.0)
    image.SetOrigin(10, 20, 30)
    image.SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1)
    values = scalars((3, 4, 5), "float32")
    image.GetCellData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))
    writer = vtkXMLImageDataWriter()
    writer.SetFileName(str(tmp_path / "c.vti"))
    writer.SetInputData(image)
    writer.Write()
    volume = load(tmp_path / "c.vti")
    np.testing.assert_array_equal(volume.array, values)
    # index (2.5, 0.5, 0.5) of the image, turned by a quarter about z
    np.testing.assert_allclose(volume.origin, (10 - 0.5, 20 + 1.25, 30 + 1))
    np.testing.assert_allclose(volume.direction, [[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    assert "cells" in volume.metadata["notes"][0]


@pytest.mark.parametrize("binary", [True, False])
def test_a_legacy_vtk_file_is_read(tmp_path, binary):
    values = scalars((3, 4, 5), "int16")
    head = (
        f"# vtk DataFile Version 3.0\ntitle\n{'BINARY' if binary else 'ASCII'}\nDATASET STRUCTURED_POINTS\n"
        "DIMENSIONS 5 4 3\nSPACING 0.5 1 2\nORIGIN 1 2 3\nPOINT_DATA 60\n"
        "SCALARS density short 1\nLOOKUP_TABLE default\n"
    )
    body = values.astype(">i2").tobytes() if binary else " ".join(map(str, values.ravel())).encode()
    (tmp_path / "v.vtk").write_bytes(head.encode() + body + b"\n")
    volume = load(tmp_path / "v.vtk")
    np.testing.assert_array_equal(volume.array, values)
    assert (volume.spacing, volume.origin) == ((0.5, 1, 2), (1, 2, 3))
    assert volume.metadata["field"] == "density"
    np.testing.assert_array_equal(load(tmp_path / "v.vtk", box=(1, 5, 0, 2, 1, 3)).array, values[1:, :2, 1:])


def test_the_arrays_of_a_vtk_file_are_its_channels(tmp_path):
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

    first, second = scalars((3, 4, 5), "int16"), scalars((3, 4, 5), "float32", 2)
    image = vtkImageData()
    image.SetDimensions(5, 4, 3)
    for name, values in (("density", first), ("heat", second)):
        array = numpy_to_vtk(values.ravel(), deep=True)
        array.SetName(name)
        image.GetPointData().AddArray(array)
    image.GetPointData().SetActiveScalars("heat")
    writer = vtkXMLImageDataWriter()
    writer.SetFileName(str(tmp_path / "v.vti"))
    writer.SetInputData(image)
    writer.Write()
    source = volviz.open(tmp_path / "v.vti")
    assert source.sizes == {"c": 2, "z": 3, "y": 4, "x": 5}
    assert [channel.name for channel in source.channels] == ["density", "heat"]
    np.testing.assert_array_equal(source.read().array, second)
    np.testing.assert_array_equal(source.read(channel=0).array, first)
    assert "heat is shown" in source.read().metadata["notes"][0]


def test_reading_vtk_leaves_its_messages_where_they_were(tmp_path):
    from vtkmodules.vtkCommonCore import vtkLogger, vtkOutputWindow

    before = vtkOutputWindow.GetInstance(), vtkLogger.GetCurrentVerbosityCutoff()
    (tmp_path / "v.vti").write_bytes(
        b"<VTKFile type='ImageData'><ImageData WholeExtent='0 9 0 9 0 9'>" + b" " * 900
    )
    with pytest.raises(LoadError):
        load(tmp_path / "v.vti")
    assert (vtkOutputWindow.GetInstance(), vtkLogger.GetCurrentVerbosityCutoff()) == before
