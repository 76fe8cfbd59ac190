"""NumPy files and raw files with hints."""

from __future__ import annotations

import gzip

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.unit.io.writers import gzipped, scalars
from volviz.errors import InputError, LoadError
from volviz.io import load
from volviz.io.raw import hints_from_name

FAST = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
TYPES = ["uint8", "int8", "int16", "uint16", "int32", "uint32", "int64", "float32", "float64"]


@given(
    dtype=st.sampled_from([*TYPES, "bool", ">u2", ">f4"]),
    shape=st.tuples(*[st.integers(2, 9)] * 3),
    fortran=st.booleans(),
)
@FAST
def test_a_numpy_file_comes_back_in_any_order_and_type(tmp_path, dtype, shape, fortran):
    array = (
        (scalars(shape, "uint8") > 99)
        if dtype == "bool"
        else scalars(shape, np.dtype(dtype).str).astype(dtype)
    )
    np.save(tmp_path / "v.npy", np.asfortranarray(array) if fortran else array)
    volume = load(tmp_path / "v.npy")
    np.testing.assert_array_equal(volume.array, array)
    assert volume.array.dtype.isnative


@pytest.mark.parametrize("fortran", [False, True])
def test_a_numpy_file_with_four_axes_holds_times_or_colours(tmp_path, fortran):
    order = np.asfortranarray if fortran else np.asarray
    times, colours = scalars((3, 4, 5, 6)), scalars((4, 5, 6, 3), "uint8")
    np.save(tmp_path / "t.npy", order(times))
    np.save(tmp_path / "c.npy", order(colours))
    np.testing.assert_array_equal(load(tmp_path / "t.npy", time=2).array, times[2])
    np.testing.assert_array_equal(load(tmp_path / "c.npy", channel=2).array, colours[..., 2])
    assert "first of 3 time points" in load(tmp_path / "t.npy").metadata["notes"][0]
    assert "brightness" in load(tmp_path / "c.npy").metadata["notes"][0]


def test_numpy_files_that_hold_no_volume_are_refused_in_words(tmp_path):
    cases = {
        "object": (np.array([{}, {}]), "object"),
        "text": (np.full((3, 3, 3), "a"), "cannot be shown"),
        "plane": (np.zeros((3, 3)), "2 axes"),
        "flat": (
            np.zeros((1, 50, 50), np.uint8),
            "at least 2 voxels along every axis, this one has 50 x 50 x 1",
        ),
    }
    for name, (array, words) in cases.items():
        np.save(tmp_path / f"{name}.npy", array, allow_pickle=True)
        with pytest.raises(LoadError, match=words):
            load(tmp_path / f"{name}.npy")
    raw = (tmp_path / "flat.npy").read_bytes()
    for keep in (7, 50, len(raw) - 1):
        (tmp_path / "cut.npy").write_bytes(raw[:keep])
        with pytest.raises(LoadError, match=r"^cut\.npy: "):
            load(tmp_path / "cut.npy")


@given(
    dtype=st.sampled_from(TYPES),
    endian=st.sampled_from(["little", "big"]),
    header=st.integers(0, 70),
    shape=st.tuples(*[st.integers(2, 9)] * 3),
    packed=st.booleans(),
)
@FAST
def test_a_raw_file_comes_back_by_its_hints(tmp_path, dtype, endian, header, shape, packed):
    array = scalars(shape, dtype)
    path = tmp_path / ("v.raw.gz" if packed else "v.raw")
    data = (
        b"h" * header + array.astype(array.dtype.newbyteorder("<" if endian == "little" else ">")).tobytes()
    )
    path.write_bytes(gzip.compress(data) if packed else data)
    volume = load(path, dims=shape[::-1], dtype=dtype, endian=endian, header=header, spacing=(1, 2, 3))
    np.testing.assert_array_equal(volume.array, array)
    assert volume.spacing == (1, 2, 3)
    assert volume.metadata["notes"] == ()


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("head_256x256x225_uint8.raw", ((256, 256, 225), "uint8")),
        ("male_128x256x256_uint8.raw.gz", ((128, 256, 256), "uint8")),
        ("foot-12x34x56-float32.bin", ((12, 34, 56), "float32")),
        ("ushort_10x20x30.raw", ((10, 20, 30), "uint16")),
        ("head_10x20x30_unsigned_short.raw", ((10, 20, 30), "uint16")),
        ("unsigned-char_10x20x30.raw", ((10, 20, 30), "uint8")),
        ("head_10x20x30_signed short.raw", ((10, 20, 30), "int16")),
        ("head_10x20x30_Unsigned_Int.raw", ((10, 20, 30), "uint32")),
        ("head_10x20x30_uint16_t.raw", ((10, 20, 30), "uint16")),
        ("10x20x30.raw", None),
        ("a_10x20x30x40_uint8.raw", None),
        ("engine.raw", None),
    ],
)
def test_the_name_of_a_raw_file_can_say_what_is_in_it(name, expected):
    assert hints_from_name(name) == expected


def test_a_raw_file_with_a_telling_name_needs_no_hints_and_hints_win(tmp_path):
    array = scalars((4, 3, 2), "uint8")
    path = tmp_path / "v_2x3x4_uint8.raw"
    path.write_bytes(array.tobytes())
    np.testing.assert_array_equal(load(path).array, array)
    np.testing.assert_array_equal(load(gzipped(path)).array, array)
    np.testing.assert_array_equal(load(path, dims=(2, 2, 3), dtype="uint16").array.tobytes(), array.tobytes())
    assert "does not say how far" in load(path).metadata["notes"][0]


def test_a_raw_file_can_begin_at_its_end(tmp_path):
    array = scalars((4, 3, 2), "uint16")
    (tmp_path / "v.raw").write_bytes(b"any header" + array.tobytes())
    np.testing.assert_array_equal(
        load(tmp_path / "v.raw", dims=(2, 3, 4), dtype="uint16", header=-1).array, array
    )
    notes = load(tmp_path / "v.raw", dims=(2, 3, 4), dtype="uint16").metadata["notes"]
    assert any("10 bytes longer" in note for note in notes)


@pytest.mark.parametrize(
    ("hints", "words"),
    [
        ({}, "does not say the size"),
        ({"dims": (2, 3, 4)}, "does not say the type"),
        ({"dims": (2, 3), "dtype": "uint8"}, "dims must be three integers"),
        ({"dims": (2, 3, 4.5), "dtype": "uint8"}, "dims must be three integers"),
        ({"dims": (0, 3, 4), "dtype": "uint8"}, "positive"),
        ({"dims": (2, 3, 4), "dtype": "nonsense"}, "unknown"),
        ({"dims": (2, 3, 4), "dtype": "complex64"}, "cannot be shown"),
        ({"dims": (20, 30, 40), "dtype": "uint8"}, "cut off"),
        ({"dims": (10**6, 10**6, 10**6), "dtype": "float64"}, "cut off"),
        ({"dims": (2, 3, 4), "dtype": "uint8", "endian": "middle"}, "endian"),
        ({"dims": (2, 3, 4), "dtype": "uint8", "header": 1.5}, "header must be an integer"),
        ({"dims": (2, 3, 4), "dtype": "uint8", "spacing": (1, 0, 1)}, "spacing must be greater than 0"),
        ({"dims": (2, 3, 4), "dtype": "uint8", "size": 3}, "knows no hint 'size'"),
    ],
)
def test_unusable_hints_are_refused_in_words(tmp_path, hints, words):
    (tmp_path / "v.raw").write_bytes(bytes(24))
    with pytest.raises((LoadError, InputError), match=words):
        load(tmp_path / "v.raw", **hints)


@pytest.mark.parametrize(
    "start",
    [
        b"\x08\0\x08\0UI\x02\0", b"\x08\0\x05\0\x04\0\0\0\x08\0\x08\0\x10\0\x10\0", b"II*\0", b"\x93NUMPY",
        b"# vtk DataFile", b"NRRD0004\n", b"\x08\0" * 4,
    ],
)  # fmt: skip
@pytest.mark.parametrize("packed", [False, True])
def test_a_raw_file_that_begins_like_another_format_is_what_its_name_says_to_the_byte(
    tmp_path, start, packed
):
    array = np.frombuffer((start + bytes(420))[:420], "<u2").reshape(5, 6, 7)
    path = tmp_path / ("v_7x6x5_uint16.raw" + (".gz" if packed else ""))
    path.write_bytes(gzip.compress(array.tobytes()) if packed else array.tobytes())
    np.testing.assert_array_equal(load(path).array, array)


def test_long_doubles_of_numpy_become_doubles(tmp_path):
    array = scalars(dtype="float64")
    np.save(tmp_path / "v.npy", array.astype(np.longdouble))
    volume = load(tmp_path / "v.npy")
    assert volume.array.dtype == np.float64
    np.testing.assert_array_equal(volume.array, array)
