"""Headers that are read without pydicom say the same as those that it reads."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pydicom
import pytest

from tests.unit.io.writers import dicom_slice, scalars
from volviz.io.dicom import headers
from volviz.io.dicom.headers import read_frames
from volviz.io.dicom.quick_headers import quick_header

#: Files of many scanners and syntaxes that come with pydicom.
FILES = [
    path
    for path in (Path(pydicom.__file__).parent / "data" / "test_files").rglob("*")
    if path.suffix == ".dcm"
]


def by_pydicom(path, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(headers, "quick_header", lambda _: None)
        return read_frames(path)


def test_frames_of_real_files_are_those_that_pydicom_gives(monkeypatch):
    quick = 0
    for path in FILES:
        with path.open("rb") as stream:
            quick += quick_header(stream) is not None
        assert read_frames(path) == by_pydicom(path, monkeypatch), path.name
    assert quick > len(FILES) / 3


@pytest.mark.parametrize(
    "syntax", ["ImplicitVRLittleEndian", "ExplicitVRLittleEndian", "ExplicitVRBigEndian"]
)
@pytest.mark.parametrize("undefined", [True, False])
def test_sequences_in_between_are_passed_over(tmp_path, monkeypatch, syntax, undefined):
    path = dicom_slice(tmp_path / "a.dcm", scalars((6, 5)), (1, 2, 3))
    data = pydicom.dcmread(path)
    inner = pydicom.Dataset()
    inner.Rows, inner.SeriesInstanceUID = 99, "9.9"
    inner.ReferencedImageSequence = [pydicom.Dataset()]
    data.ReferencedStudySequence = [inner, inner]
    data["ReferencedStudySequence"].is_undefined_length = undefined
    inner.is_undefined_length_sequence_item = undefined
    if syntax == "ExplicitVRBigEndian":
        data.PixelData = scalars((6, 5)).byteswap().tobytes()
        data["PixelData"].VR = "OW"
    data.file_meta.TransferSyntaxUID = getattr(pydicom.uid, syntax)
    pydicom.dcmwrite(path, data, implicit_vr="Implicit" in syntax, little_endian="Little" in syntax)
    content = path.read_bytes()
    assert (quick_header(io.BytesIO(content)) is not None) == ("Little" in syntax)
    (frame,) = read_frames(path)
    assert (frame.rows, frame.columns, frame.file.series) == (6, 5, "1.2.3.4.5")
    assert frame.position == (1, 2, 3)
    assert (frame,) == by_pydicom(path, monkeypatch)


def test_long_headers_are_read_on_and_odd_ones_left_to_pydicom(tmp_path, monkeypatch):
    path = dicom_slice(tmp_path / "a.dcm", scalars((6, 5)), (1, 2, 3), ImageComments="x" * 10)
    data = pydicom.dcmread(path)
    data.add_new(0x00091010, "OB", bytes(200_000))
    data.save_as(path)
    with path.open("rb") as stream:
        assert quick_header(stream) is not None
    assert read_frames(path) == by_pydicom(path, monkeypatch)
    content = path.read_bytes()
    # the header names another form than it has
    path.write_bytes(content.replace(b"1.2.840.10008.1.2.1\0", b"1.2.840.10008.1.2\0\0\0"))
    with path.open("rb") as stream:
        assert quick_header(stream) is None
    assert read_frames(path) == by_pydicom(path, monkeypatch) != ()


def test_damaged_headers_are_left_to_pydicom_or_say_the_same(tmp_path, monkeypatch):
    path = dicom_slice(tmp_path / "a.dcm", scalars((6, 5)), (1, 2, 3))
    content = path.read_bytes()
    rng = np.random.default_rng(5)
    for _ in range(60):
        damaged = bytearray(content)
        damaged[rng.integers(132, len(content) - 60)] = rng.integers(0, 256)
        path.write_bytes(damaged)
        with path.open("rb") as stream:
            quick_header(stream)
        read_frames(path)
