"""Files of any format that are packed as a whole."""

from __future__ import annotations

import bz2
import gc
import gzip
import lzma
import tempfile
import zipfile
from pathlib import Path
from types import SimpleNamespace

import imagecodecs
import numpy as np
import pytest
import tifffile

import volviz
from tests.unit.io.writers import dicom_slice, itk, scalars
from volviz.errors import Cancelled, LoadError
from volviz.io import load, packed_files

PACK = {
    ".gz": gzip.compress,
    ".bz2": bz2.compress,
    ".xz": lzma.compress,
    ".zst": lambda data: bytes(imagecodecs.zstd_encode(data)),
}


def plain(folder, name):
    """A file of the format that a name says, with the same values in each."""
    array = scalars()
    path = folder / name
    if path.suffix == ".npy":
        np.save(path, array)
    elif path.suffix == ".tif":
        tifffile.imwrite(path, array, imagej=False, photometric="minisblack")
    elif path.suffix == ".raw":
        path.write_bytes(array.tobytes())
    elif path.suffix == ".vti":
        import pyvista

        grid = pyvista.ImageData(dimensions=array.shape[::-1])
        grid["v"] = array.ravel()
        grid.save(path)
    else:
        itk(path, array)
    return path, array


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    """An empty folder for temporary files."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


@pytest.mark.parametrize("packing", PACK)
@pytest.mark.parametrize(
    "name", ["v.nrrd", "v.mha", "v.npy", "v.tif", "v.vti", "v.vtk", "v.nii", "v_9x7x5_int16.raw"]
)
def test_a_packed_file_opens_as_if_unpacked(tmp_path, temporary, name, packing):
    path, array = plain(tmp_path, name)
    packed = path.with_name(path.name + packing)
    packed.write_bytes(PACK[packing](path.read_bytes()))
    expected = load(path)
    path.unlink()
    source = volviz.open(packed)
    volume = source.read()
    np.testing.assert_array_equal(volume.array, array)
    np.testing.assert_array_equal(volume.index_to_world, expected.index_to_world)
    assert volume.metadata["source"] == str(packed)
    assert volume.name == expected.name
    np.testing.assert_array_equal(source.read(box=(0, 9, 0, 7, 1, 3)).array, array[1:3])
    del source
    gc.collect()
    assert list(temporary.iterdir()) == []


def test_a_packed_dicom_slice_stack_is_found_by_its_content(tmp_path, temporary):
    path = dicom_slice(tmp_path / "a.dcm", scalars((3, 4, 5)), (0, 0, 0), NumberOfFrames=3)
    packed = tmp_path / "b"
    packed.write_bytes(gzip.compress(path.read_bytes()))
    assert load(packed).dimensions == load(path).dimensions


@pytest.mark.parametrize("packing", PACK)
def test_damaged_packed_files_are_refused_in_words_and_leave_nothing_behind(tmp_path, temporary, packing):
    path, _ = plain(tmp_path, "v.nrrd")
    raw = PACK[packing](path.read_bytes())
    packed = tmp_path / f"v.nrrd{packing}"
    # imagecodecs writes no checksum, so that damage among the values cannot be seen: the first block is damaged
    harm = raw[:9] + b"\xff" * 20 + raw[29:] if packing == ".zst" else raw[:40] + bytes(40) + raw[80:]
    for part in (raw[: len(raw) // 2], raw[:12], harm):
        packed.write_bytes(part)
        with pytest.raises(LoadError, match=r"^v\.nrrd\.\w+: .*(damaged|cut off)"):
            load(packed)
    assert list(temporary.iterdir()) == []


def test_what_a_packed_file_holds_must_be_a_volume_that_finds_room(tmp_path, temporary, monkeypatch):
    packed = tmp_path / "notes.txt.gz"
    packed.write_bytes(gzip.compress(b"not a volume"))
    with pytest.raises(LoadError, match="no reader knows"):
        load(packed)
    path, _ = plain(tmp_path, "v.npy")
    packed = tmp_path / "v.npy.gz"
    packed.write_bytes(gzip.compress(path.read_bytes()))
    with pytest.raises(Cancelled):
        load(packed, cancel=lambda: True)
    header = tmp_path / "v.nhdr.gz"
    header.write_bytes(gzip.compress(b"NRRD0004\ntype: short\ndata file: v.raw\n"))
    with pytest.raises(LoadError, match="unpack it first"):
        load(header)
    monkeypatch.setattr(packed_files.shutil, "disk_usage", lambda _: SimpleNamespace(free=0))
    with pytest.raises(LoadError, match="more room than is free"):
        load(packed)
    assert list(temporary.iterdir()) == []


def zipped(path: Path, *files: Path) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in files:
            archive.write(file, f"inside/{file.name}")
        archive.writestr("__MACOSX/inside/._v", b"of the system")
    return path


def test_a_zip_file_with_one_volume_opens(tmp_path):
    array = scalars()
    path = zipped(tmp_path / "v.zip", itk(tmp_path / "v.nrrd", array))
    source = volviz.open(path)
    assert source.metadata["source"] == str(path)
    np.testing.assert_array_equal(source.read().array, array)
    pair = itk(tmp_path / "w.mhd", array)
    np.testing.assert_array_equal(
        volviz.load(zipped(tmp_path / "w.zip", pair, tmp_path / "w.raw")).array, array
    )


def test_a_zip_file_of_slices_opens_as_their_folder_does(tmp_path):
    pages = [tmp_path / f"slice{n}.tif" for n in range(5)]
    for page, pixels in zip(pages, scalars(), strict=True):
        tifffile.imwrite(page, pixels)
    np.testing.assert_array_equal(volviz.load(zipped(tmp_path / "v.zip", *pages)).array, scalars())


def test_zip_files_without_one_volume_are_refused_in_words(tmp_path):
    first, second = tmp_path / "a.nrrd", tmp_path / "b.nrrd"
    zipped(tmp_path / "two.zip", itk(first, scalars()), itk(second, scalars()))
    with pytest.raises(LoadError, match=r"two.zip: it holds 2 files \(a.nrrd, b.nrrd\)"):
        volviz.load(tmp_path / "two.zip")
    (tmp_path / "notes.txt").write_text("nothing to see")
    with pytest.raises(LoadError, match="what is packed in it cannot be read"):
        volviz.load(zipped(tmp_path / "text.zip", tmp_path / "notes.txt"))
    whole = zipped(tmp_path / "cut.zip", first).read_bytes()
    (tmp_path / "cut.zip").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(LoadError, match="zip file is damaged"):
        volviz.load(tmp_path / "cut.zip")
