"""NRRD and MetaImage against SimpleITK, and headers written by hand."""

from __future__ import annotations

import bz2
import gzip
import re
import tracemalloc
import zlib
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import volviz
from tests.unit.io.writers import ORIGIN, SPACING, itk, rotation, scalars
from volviz.errors import InputError, LoadError
from volviz.io import load

TYPES = ["uint8", "int8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64"]
FAST = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@given(
    suffix=st.sampled_from([".nrrd", ".nhdr", ".mha", ".mhd"]),
    dtype=st.sampled_from(TYPES),
    shape=st.tuples(*[st.integers(2, 9)] * 3),
    seed=st.integers(0, 999),
    mirrored=st.booleans(),
    compressed=st.booleans(),
)
@FAST
def test_values_and_geometry_come_back_as_simpleitk_wrote_them(
    tmp_path, suffix, dtype, shape, seed, mirrored, compressed
):
    array = scalars(shape, dtype, seed)
    direction = rotation(seed, mirrored=mirrored)
    volume = load(itk(tmp_path / f"v{suffix}", array, direction=direction, compressed=compressed))
    np.testing.assert_array_equal(volume.array, array)
    assert volume.array.dtype == array.dtype
    np.testing.assert_allclose(volume.spacing, SPACING, rtol=1e-6)
    np.testing.assert_allclose(volume.origin, ORIGIN, atol=1e-5)
    np.testing.assert_allclose(volume.direction, direction, atol=1e-6)


@pytest.mark.parametrize("suffix", [".nrrd", ".mha"])
def test_colours_are_shown_as_brightness_and_one_component_can_be_chosen(tmp_path, suffix):
    rgb = scalars((4, 5, 6, 3), "uint8")
    path = itk(tmp_path / f"rgb{suffix}", rgb, vector=True)
    volume = load(path)
    np.testing.assert_allclose(volume.array, rgb @ np.array([0.2126, 0.7152, 0.0722]), atol=0.51)
    assert "brightness" in volume.metadata["notes"][0]
    np.testing.assert_array_equal(load(path, channel=2).array, rgb[..., 2])


@pytest.mark.parametrize("suffix", [".nrrd", ".mha", ".mhd"])
@pytest.mark.parametrize("compressed", [False, True])
def test_one_time_point_of_four_dimensions_is_taken(tmp_path, suffix, compressed):
    array = scalars((3, 4, 5, 6))
    image = SimpleITK.GetImageFromArray(array, isVector=False)
    image.SetSpacing((0.5, 0.6, 0.7, 2.0))
    image.SetOrigin((1, 2, 3, 0))
    path = tmp_path / f"t{suffix}"
    SimpleITK.WriteImage(image, str(path), compressed)
    volume = load(path, time=1)
    np.testing.assert_array_equal(volume.array, array[1])
    np.testing.assert_allclose(volume.spacing, (0.5, 0.6, 0.7))
    np.testing.assert_allclose(volume.origin, (1, 2, 3))
    assert "first of 3 time points" in load(path).metadata["notes"][0]
    with pytest.raises(InputError, match="time must lie"):
        load(path, time=-4)


def nrrd(path: Path, lines: str, data: bytes = b"") -> Path:
    path.write_bytes(b"NRRD0004\n" + lines.encode() + b"\n\n" + data)
    return path


BASE = "type: short\ndimension: 3\nsizes: 4 3 2\n"


@pytest.mark.parametrize("end", ["little", "big"])
@pytest.mark.parametrize("encoding", ["raw", "gzip", "gz", "bzip2", "ascii", "hex"])
def test_every_nrrd_encoding_and_byte_order_is_read(tmp_path, encoding, end):
    array = scalars((2, 3, 4))
    raw = array.astype("<i2" if end == "little" else ">i2").tobytes()
    text = " ".join(str(v) for v in array.ravel()).encode()
    data = {"raw": raw, "gzip": gzip.compress(raw), "gz": gzip.compress(raw), "bzip2": bz2.compress(raw)}
    data["hex"] = b"\n".join(raw.hex(" ").encode()[at : at + 61] for at in range(0, 200, 61))
    path = nrrd(tmp_path / "v.nrrd", f"{BASE}encoding: {encoding}\nendian: {end}", data.get(encoding, text))
    np.testing.assert_array_equal(load(path).array, array)


@pytest.mark.parametrize(
    ("space", "signs"),
    [
        ("left-posterior-superior", (1, 1, 1)),
        ("LPS", (1, 1, 1)),
        ("right-anterior-superior", (-1, -1, 1)),
        ("RAS", (-1, -1, 1)),
        ("left-anterior-superior", (1, -1, 1)),
        ("LAS", (1, -1, 1)),
    ],
)
def test_every_nrrd_space_is_turned_to_lps(tmp_path, space, signs):
    directions = "space directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)"
    path = nrrd(
        tmp_path / "v.nrrd", f"{BASE}encoding: raw\nendian: little\nspace: {space}\n{directions}", bytes(48)
    )
    volume = load(path)
    np.testing.assert_array_equal(volume.direction, np.diag(signs))
    np.testing.assert_array_equal(volume.origin, np.multiply((10, 20, 30), signs))
    assert volume.spacing == (2, 3, 4)


def test_units_of_values_and_lengths_are_taken_from_the_nrrd_header(tmp_path):
    lines = f'{BASE}encoding: raw\nendian: little\nspacings: 1 2 3\nunits: "um" "um" "um"\nsample units: "HU"'
    volume = load(nrrd(tmp_path / "v.nrrd", lines, bytes(48)))
    assert (volume.unit, volume.metadata["length_unit"], volume.spacing) == ("HU", "µm", (1, 2, 3))


@pytest.mark.parametrize("kind", ["list", "vector", "RGB-color"])
def test_a_nrrd_with_its_components_first_is_read(tmp_path, kind):
    array = scalars((2, 3, 4, 3), "uint8")
    lines = (
        "type: uchar\ndimension: 4\nsizes: 3 4 3 2\nencoding: raw\n"
        f"kinds: {kind} domain domain domain\nspace: LPS\nspace directions: none (1,0,0) (0,1,0) (0,0,1)"
    )
    np.testing.assert_array_equal(
        load(nrrd(tmp_path / "v.nrrd", lines, array.tobytes()), channel=1).array, array[..., 1]
    )


def test_a_nrrd_with_a_list_of_volumes_last_is_read(tmp_path):
    array = scalars((5, 2, 3, 4), "uint8")
    lines = (
        "type: uchar\ndimension: 4\nsizes: 4 3 2 5\nencoding: gzip\nkinds: domain domain domain list\n"
        "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1) none"
    )
    path = nrrd(tmp_path / "v.nrrd", lines, gzip.compress(array.tobytes()))
    np.testing.assert_array_equal(load(path, channel=3).array, array[3])
    assert "first of 5 channels" in load(path).metadata["notes"][0]


def test_values_beside_the_header_may_be_skipped_to_listed_or_numbered(tmp_path):
    array = scalars((2, 3, 4))
    head = f"{BASE}endian: little\nencoding: raw\n"
    (tmp_path / "a.raw").write_bytes(b"two\nlines\n1234567" + array.tobytes())
    nrrd(tmp_path / "skip.nhdr", f"{head}line skip: 2\nbyte skip: 7\ndata file: a.raw")
    nrrd(tmp_path / "end.nhdr", f"{head}byte skip: -1\ndata file: a.raw")
    for n in range(2):
        (tmp_path / f"part{n + 1:03d}.raw").write_bytes(array[n].tobytes())
    nrrd(tmp_path / "numbered.nhdr", f"{head}data file: part%03d.raw 1 2 1 2")
    (tmp_path / "listed.nhdr").write_bytes(
        f"NRRD0004\n{head}data file: LIST 2\npart001.raw\npart002.raw\n".encode()
    )
    for name in ("skip", "end", "numbered", "listed"):
        np.testing.assert_array_equal(load(tmp_path / f"{name}.nhdr").array, array, err_msg=name)


def meta(path: Path, lines: str, data: bytes = b"") -> Path:
    path.write_bytes(b"ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\n" + lines.encode() + data)
    return path


def test_metaimages_in_parts_in_text_and_in_big_endian_are_read(tmp_path):
    array = scalars((2, 3, 4))
    for n in range(2):
        (tmp_path / f"part{n + 1:02d}.raw").write_bytes(array[n].tobytes())
    (tmp_path / "tail.raw").write_bytes(b"12345" + array.tobytes())
    text = " ".join(str(v) for v in array.ravel())
    kind = "ElementType = MET_SHORT\n"
    paths = [
        meta(tmp_path / "list.mhd", f"{kind}ElementDataFile = LIST\npart01.raw\npart02.raw\n"),
        meta(tmp_path / "numbered.mhd", f"{kind}ElementDataFile = part%02d.raw 1 2 1\n"),
        meta(tmp_path / "tail.mhd", f"{kind}HeaderSize = -1\nElementDataFile = tail.raw\n"),
        meta(tmp_path / "text.mha", f"BinaryData = False\n{kind}ElementDataFile = LOCAL\n{text}"),
        meta(
            tmp_path / "big.mha",
            f"BinaryDataByteOrderMSB = True\n{kind}ElementDataFile = LOCAL\n",
            array.astype(">i2").tobytes(),
        ),
    ]
    for path in paths:
        np.testing.assert_array_equal(load(path).array, array, err_msg=path.name)


def test_the_rows_of_a_metaimage_matrix_are_axes(tmp_path):
    lines = "TransformMatrix = 0 1 0 0 0 1 1 0 0\nElementSpacing = 2 3 4\nElementType = MET_UCHAR\n"
    path = meta(tmp_path / "v.mha", f"{lines}ElementDataFile = LOCAL\n", bytes(24))
    np.testing.assert_array_equal(load(path).direction.ravel(), SimpleITK.ReadImage(str(path)).GetDirection())
    np.testing.assert_array_equal(load(path).direction[:, 0], (0, 1, 0))


@pytest.mark.parametrize("suffix", [".nrrd", ".nhdr", ".mha", ".mhd"])
@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("keep", [0.2, 0.6, 0.98])
def test_files_that_are_cut_off_are_refused_in_words(tmp_path, suffix, compressed, keep):
    itk(tmp_path / f"v{suffix}", scalars((20, 20, 20)), compressed=compressed)
    largest = max(tmp_path.iterdir(), key=lambda p: p.stat().st_size)
    raw = largest.read_bytes()
    largest.write_bytes(raw[: int(keep * len(raw))])
    with pytest.raises(LoadError, match=r"^v\.[\w.]+: .*(cut off|damaged)"):
        load(tmp_path / f"v{suffix}")


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ("type: block\ndimension: 3\nsizes: 4 3 2\nencoding: raw", "type 'block'"),
        (f"{BASE}encoding: base64", "encoding 'base64'"),
        ("type: short\ndimension: 3\nsizes: 2 3 2\nencoding: hex", "hexadecimal"),
        ("type: short\ndimension: 4\nsizes: 4 3 2\nencoding: raw", "dimensions"),
        ("type: short\ndimension: 2\nsizes: 4 3\nencoding: raw", "needs three axes, this file has 2"),
        ("type: short\nsizes: 4 three 2\nencoding: raw", "no readable"),
        (f"{BASE}encoding: raw\ndata file: nowhere.raw", "nowhere.raw"),
        (f"{BASE}encoding: raw\nspace directions: (1,0,0) (2,0,0) (0,0,1)\nspace: LPS", "span space"),
        (f"{BASE}encoding: raw\nspace directions: (1,0,0) (0,1,0)\nspace: LPS", "do not fit"),
        ("type: short\ndimension: 3\nsizes: 4 -3 2\nencoding: raw", "no volume has"),
        ("type: short\ndimension: 3\nsizes: 99999999 99999999 99999999\nencoding: gzip", "cut off"),
        (
            f"type: short\ndimension: 3\nsizes: {'9' * 99} 3 2\nencoding: raw",
            r"promises more than 10\^15 bytes",
        ),
        (
            f"{BASE}encoding: raw\ndata file: slice%d.raw 1 999999999999 1",
            "numbers the data files unreadably",
        ),
        (f"type: {'nonsense ' * 99}\ndimension: 3\nsizes: 4 3 2\nencoding: raw", r"^.{1,140}$"),
        (f"{BASE}encoding: raw\nspace directions: (1e200,0,0) (0,1,0) (0,0,1)\nspace: LPS", "span space"),
    ],
)
def test_unusable_nrrd_headers_are_refused_in_words(tmp_path, lines, words):
    with pytest.raises(LoadError, match=words):
        load(nrrd(tmp_path / "v.nrrd", lines, bytes(48)))


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ("ElementDataFile = LOCAL\n", "none"),
        ("ElementType = MET_STRING\nElementDataFile = LOCAL\n", "MET_STRING"),
        ("ElementType = MET_UCHAR\n", "ElementDataFile"),
        ("ElementType = MET_UCHAR\nElementDataFile = nowhere.raw\n", "nowhere.raw"),
        ("ElementType = MET_UCHAR\nElementSpacing = 1 one 1\nElementDataFile = LOCAL\n", "numbers"),
        ("ElementType = MET_UCHAR\nTransformMatrix = 1 0 0 1\nElementDataFile = LOCAL\n", "TransformMatrix"),
        ("ElementType = MET_UCHAR\nElementNumberOfChannels = many\nElementDataFile = LOCAL\n", "many"),
        ("DimSize = 0 3 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n", "size"),
        ("DimSize = nan 3 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n", "size nan x 3 x 2"),
        ("DimSize = 1e308 3 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n", r"size 1e\+308 x 3 x 2"),
        ("DimSize = 4.5 3 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n", "size 4.5 x 3 x 2"),
        ("ElementSpacing = 1e300 1 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n", "unusable"),
        ("ElementType = MET_UCHAR\nElementDataFile = s%d.raw 1 999999999999 1\n", "unreadably"),
        ("ElementType = MET_UCHAR\nOffset = " + "x" * 999 + "\nElementDataFile = LOCAL\n", r"^.{1,140}$"),
    ],
)
def test_unusable_metaimage_headers_are_refused_in_words(tmp_path, lines, words):
    with pytest.raises(LoadError, match=words):
        load(meta(tmp_path / "v.mha", lines, bytes(24)))


@pytest.mark.parametrize("suffix", [".mha", ".mhd"])
def test_a_metaimage_of_two_dimensions_is_no_volume(tmp_path, suffix):
    with pytest.raises(LoadError, match=r"9 x 7 x 1 .* stack of images"):
        load(itk(tmp_path / f"v{suffix}", scalars((7, 9))))
    lines = (
        "NDims = 2\nDimSize = 4 6\nElementSpacing = 1 1 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
    )
    with pytest.raises(LoadError, match=r"4 x 6 x 1 .* stack of images"):
        load(meta(tmp_path / "spacing.mha", lines, bytes(24)))


@pytest.mark.parametrize("comment", ["# made by hand", "Comment = a = b", "made by hand"])
@pytest.mark.parametrize("lines", [1, 40_000])
def test_a_metaimage_may_begin_with_comments_and_have_a_long_header(tmp_path, comment, lines):
    array = scalars((2, 3, 4))
    head = f"{comment}\n" * lines + "NDims = 3\nDimSize = 4 3 2\nElementType = MET_SHORT\n"
    more = "Seq_Frame0000_X = 3\n" * lines + "ElementDataFile = LOCAL\n"
    (tmp_path / "v.mha").write_bytes((head + more).encode() + array.tobytes())
    np.testing.assert_array_equal(load(tmp_path / "v.mha").array, array)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_negative_distance_of_a_metaimage_turns_the_axis(tmp_path, axis):
    steps = np.array([2.0, 3.0, 4.0])
    steps[axis] *= -1
    spacing = " ".join(str(v) for v in steps)
    lines = f"Offset = 1 2 3\nElementSpacing = {spacing}\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
    volume = load(meta(tmp_path / "v.mha", lines, bytes(24)))
    np.testing.assert_array_equal(volume.direction * volume.spacing, np.diag(steps))
    assert volume.origin == (1, 2, 3)


def test_packed_values_at_the_end_of_a_file_of_their_own_are_found(tmp_path):
    array = scalars((2, 3, 4))
    packed = zlib.compress(array.tobytes())
    (tmp_path / "v.zraw").write_bytes(b"anything" + packed)
    lines = f"ElementType = MET_SHORT\nCompressedData = True\nCompressedDataSize = {len(packed)}\nHeaderSize = -1\n"
    path = meta(tmp_path / "v.mhd", f"{lines}ElementDataFile = v.zraw\n")
    np.testing.assert_array_equal(load(path).array, array)


@pytest.mark.parametrize(("encoding", "pack"), [("gzip", gzip.compress), ("bzip2", bz2.compress)])
@pytest.mark.parametrize("before", [0, 7, 352])
def test_the_last_values_of_a_packed_stream_are_those_of_byte_skip_minus_one(
    tmp_path, encoding, pack, before
):
    array = scalars((2, 3, 4))
    raw = bytes(before) + array.tobytes()
    lines = f"{BASE}endian: little\nencoding: {encoding}\nbyte skip: -1"
    np.testing.assert_array_equal(load(nrrd(tmp_path / "v.nrrd", lines, pack(raw))).array, array)
    # two members of a stream: its last four bytes are no size of the whole
    parts = pack(raw[:20]) + pack(raw[20:])
    np.testing.assert_array_equal(load(nrrd(tmp_path / "two.nrrd", lines, parts)).array, array)
    with pytest.raises(LoadError, match="cut off"):
        load(nrrd(tmp_path / "short.nrrd", lines, pack(array.tobytes()[1:])))


def test_a_detached_header_over_a_packed_nifti_file_finds_its_values(tmp_path):
    array = scalars((5, 6, 7))
    itk(tmp_path / "v.nii.gz", array)
    lines = "type: short\ndimension: 3\nsizes: 7 6 5\nendian: little\nencoding: gzip\nbyte skip: -1\n"
    path = nrrd(tmp_path / "v.nhdr", f"{lines}data file: v.nii.gz")
    np.testing.assert_array_equal(load(path).array, array)
    np.testing.assert_array_equal(load(path, box=(0, 7, 0, 6, 2, 4)).array, array[2:4])


@pytest.mark.parametrize("kind", ["int64", "uint64"])
def test_whole_numbers_in_text_keep_all_their_digits(tmp_path, kind):
    array = np.array([2**53 + 1, np.iinfo(kind).max, np.iinfo(kind).min, 5] * 6, kind).reshape(2, 3, 4)
    lines = f"type: {kind}\ndimension: 3\nsizes: 4 3 2\nencoding: text"
    text = ",".join(str(v) for v in array.ravel()).encode()
    np.testing.assert_array_equal(load(nrrd(tmp_path / "v.nrrd", lines, text)).array, array)


@pytest.mark.parametrize(
    ("number", "words"),
    [("200", "cannot hold"), ("1.5", "int8"), ("one", "not all numbers"), ("nan", "int8")],
)
def test_numbers_in_text_that_are_none_of_their_type_are_refused(tmp_path, number, words):
    lines = "type: int8\ndimension: 3\nsizes: 4 3 2\nencoding: text"
    with pytest.raises(LoadError, match=words):
        load(nrrd(tmp_path / "v.nrrd", lines, f"{number} ".encode() * 24))
    for whole in ("7", "7.0", "0.7e1"):
        assert load(nrrd(tmp_path / "v.nrrd", lines, f"{whole} ".encode() * 24)).array.max() == 7


def test_long_texts_take_little_more_memory_than_their_values(tmp_path):
    array = scalars((64, 64, 128))
    text = " ".join(str(v) for v in array.ravel()).encode()
    lines = "type: short\ndimension: 3\nsizes: 128 64 64\nencoding: text"
    path = nrrd(tmp_path / "v.nrrd", lines, text)
    tracemalloc.start()
    try:
        np.testing.assert_array_equal(load(path).array, array)
        assert tracemalloc.get_traced_memory()[1] < 32 * 2**20
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ("lines", "has_spacing"),
    [
        ("spacings: 1 2 3\naxis mins: 10 20 30", True),
        ("spacings: 1 2 3\naxis mins: 10 20 30\ncenters: cell cell cell", True),
        ("spacings: 1 2 3\naxis mins: 10 20 30\ncenterings: node node node", True),
        ("spacings: 1 2 3\naxis mins: 0 0 0\ncenters: cell node ???", True),
        ("spacings: 1 2 3\ncenters: cell cell cell", True),
        ("spacings: 1 -2 3", True),
        ("axis mins: 10 20 30\naxis maxs: 14 26 34\ncenters: cell cell cell", False),
        ("axis mins: 10 20 30\naxis maxs: 14 26 34\ncenters: node node node", False),
    ],
)
def test_spacings_and_ends_of_axes_of_a_nrrd_are_read_as_by_simpleitk(tmp_path, lines, has_spacing):
    path = nrrd(tmp_path / "v.nrrd", f"{BASE}encoding: raw\nendian: little\n{lines}", bytes(48))
    volume, image = load(path), SimpleITK.ReadImage(str(path))
    np.testing.assert_allclose(volume.origin, image.GetOrigin())
    np.testing.assert_array_equal(volume.direction.ravel(), image.GetDirection())
    # SimpleITK takes 1 where there are the ends of an axis alone
    ends = (4 / 3, 3, 4) if "node" in lines else (1, 2, 2)
    np.testing.assert_allclose(volume.spacing, image.GetSpacing() if has_spacing else ends)


SEGMENTS = """\
Segment0_ID:=Segment_1
Segment0_Name:=liver
Segment0_Color:=1 0.5 0
Segment0_Layer:=0
Segment0_LabelValue:=1
Segment1_ID:=Segment_2
Segment1_Layer:=1
Segment1_LabelValue:=2
Segment2_ID:=Segment_3
Segment2_Name:=vein
Segment2_Layer:=2
Segment2_LabelValue:=3"""


def test_layers_of_a_segmentation_are_channels_of_labels_with_names_and_colours(tmp_path):
    array = scalars((2, 3, 4, 3), "uint8")
    lines = (
        "type: uchar\ndimension: 4\nsizes: 3 4 3 2\nencoding: raw\nkinds: list domain domain domain\n"
        f"space: LPS\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n{SEGMENTS}"
    )
    path = nrrd(tmp_path / "v.seg.nrrd", lines, array.tobytes())
    source = volviz.open(path)
    assert source.is_labels
    assert [(label.number, label.name, label.color) for label in source.labels] == [
        (1, "liver", (1.0, 0.5, 0.0)), (2, "Segment_2", None), (3, "vein", None),
    ]  # fmt: skip
    assert [channel.name for channel in source.channels] == ["liver", "Segment_2", "vein"]
    volume = load(path)
    np.testing.assert_array_equal(volume.array, array[..., 0])
    assert "first of 3 channels" in volume.metadata["notes"][0]
    np.testing.assert_array_equal(load(path, channel=2).array, array[..., 2])


def test_one_layer_of_a_segmentation_names_all_its_labels(tmp_path):
    lines = f"{BASE}encoding: raw\nendian: little\n" + re.sub(r"Layer:=\d", "Layer:=0", SEGMENTS)
    source = volviz.open(nrrd(tmp_path / "v.nrrd", lines, bytes(48)))
    assert source.is_labels
    assert [label.number for label in source.labels] == [1, 2, 3]
    assert [channel.name for channel in source.channels] == ["liver, Segment_2, vein"]
    # layers of old files all hold the number 1, which has no name then
    lines = re.sub(r"LabelValue:=\d", "LabelValue:=1", SEGMENTS)
    source = volviz.open(
        nrrd(tmp_path / "v.nrrd", f"{BASE}encoding: raw\nendian: little\n{lines}", bytes(48))
    )
    assert source.labels == ()
