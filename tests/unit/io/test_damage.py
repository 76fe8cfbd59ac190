"""Damage in uncompressed files, where no checksum notices it before the reader does."""

from __future__ import annotations

import contextlib

import numpy as np
import pytest

from tests.unit.io.writers import itk, scalars
from volviz.errors import VolvizError
from volviz.io import load


@pytest.mark.parametrize("suffix", [".nii", ".nrrd", ".mha"])
def test_damaged_headers_end_in_a_volume_or_a_sentence(tmp_path, suffix):
    path = itk(tmp_path / f"v{suffix}", scalars((4, 5, 6)))
    content = path.read_bytes()
    rng = np.random.default_rng(4)
    for _ in range(300):
        damaged = bytearray(content)
        for place in rng.integers(0, 500, rng.integers(1, 6)):
            damaged[place] = rng.integers(0, 256)
        path.write_bytes(damaged[: rng.integers(1, len(damaged) + 1)] if rng.random() < 0.2 else damaged)
        with contextlib.suppress(VolvizError):
            load(path)


def test_a_compressed_file_that_unpacks_to_less_than_promised_is_refused(tmp_path):
    import gzip

    head = b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 400 400 400\nencoding: gzip\n\n"
    # a bomb the other way round: the header promises 64 MB, the stream holds 3 MB and packs to 3 KB
    (tmp_path / "v.nrrd").write_bytes(head + gzip.compress(bytes(3_000_000)) + bytes(100_000))
    with pytest.raises(
        VolvizError,
        match=r"cut off: the header promises 64,000,000 bytes of values and the file can hold 3,000,000 at most",
    ):
        load(tmp_path / "v.nrrd")


def test_a_file_in_several_gzip_members_is_read(tmp_path):
    import gzip

    array = scalars((4, 5, 6), "uint8")
    raw = array.tobytes()
    packed = gzip.compress(raw[:50]) + gzip.compress(raw[50:90]) + gzip.compress(raw[90:]) + bytes(512)
    (tmp_path / "v_6x5x4_uint8.raw.gz").write_bytes(packed)
    np.testing.assert_array_equal(load(tmp_path / "v_6x5x4_uint8.raw.gz").array, array)


def test_a_long_stream_is_unpacked_in_blocks_to_the_same_values(tmp_path, monkeypatch):
    from volviz.io import raw_payload

    array = scalars((40, 50, 60), "uint16")
    path = itk(tmp_path / "v.nii.gz", array, compressed=True)
    monkeypatch.setattr(raw_payload, "unpacked_at_once", lambda *_: None)
    monkeypatch.setattr(raw_payload, "BLOCK", 10_000)
    told: list[float] = []
    np.testing.assert_array_equal(load(path, progress=lambda fraction, _: told.append(fraction)).array, array)
    assert len(told) > 20
    assert told == sorted(told)


def test_a_very_long_stream_is_unpacked_on_a_thread_that_can_be_left(tmp_path, monkeypatch):
    from volviz.errors import Cancelled
    from volviz.io import unpacking

    array = scalars((40, 50, 60), "uint16")
    path = itk(tmp_path / "v.nii.gz", array, compressed=True)
    monkeypatch.setattr(unpacking, "SHORT_BYTES", 0)
    np.testing.assert_array_equal(load(path).array, array)
    asked: list[int] = []

    def cancel() -> bool:
        asked.append(1)
        return len(asked) > 4

    with pytest.raises(Cancelled):
        load(path, cancel=cancel)


@pytest.mark.parametrize("way", ["at once", "on a thread", "in blocks"])
def test_values_that_fail_their_checksum_are_refused(tmp_path, monkeypatch, way):
    import gzip

    from volviz.io import raw_payload, unpacking

    if way == "in blocks":
        monkeypatch.setattr(raw_payload, "unpacked_at_once", lambda *_: None)
    elif way == "on a thread":
        monkeypatch.setattr(unpacking, "SHORT_BYTES", 0)
    array = scalars((4, 5, 6), "uint8")
    packed = bytearray(gzip.compress(array.tobytes(), compresslevel=0))
    path = tmp_path / "v_6x5x4_uint8.raw.gz"
    path.write_bytes(packed)
    np.testing.assert_array_equal(load(path).array, array)
    # without compression a changed value changes nothing but the sum
    packed[60] ^= 1
    path.write_bytes(packed)
    with pytest.raises(VolvizError, match="compressed data is damaged"):
        load(path)
