"""DICOM as scanners and converters write it: rounded headers, gaps, tilts, mosaics, doses, palettes, codecs."""

from __future__ import annotations

import gc

import numpy as np
import pytest
from pydicom.dataset import Dataset
from pydicom.sequence import Sequence

import volviz
from tests.unit.io.writers import dicom_slice, scalars
from volviz.errors import LoadError
from volviz.io import load

STACK = scalars((6, 5, 7), "int16") // 40
PLANE = [1, 0, 0, 0, 1, 0]


def stack(folder, places, pixels=STACK, tags=lambda n: {}):
    folder.mkdir()
    for n, place in enumerate(places):
        dicom_slice(folder / f"s{n:03d}.dcm", pixels[n % len(pixels)], place, InstanceNumber=n + 1, **tags(n))
    return folder


def along_z(values):
    return [(0.0, 0.0, float(z)) for z in values]


def item(**parts):
    """A functional group: attributes given as ``Sequence__Attribute=value``."""
    outer = Dataset()
    for path, value in parts.items():
        name, attribute = path.split("__")
        inner = getattr(outer, name)[0] if name in outer else Dataset()
        setattr(inner, attribute, value)
        setattr(outer, name, Sequence([inner]))
    return outer


def enhanced(path, pixels, groups, **tags):
    """One multi-frame file whose frames have the given functional groups."""
    shared = item(
        PixelMeasuresSequence__PixelSpacing=[1.1, 0.7],
        PixelMeasuresSequence__SliceThickness="2.5",
        PlaneOrientationSequence__ImageOrientationPatient=PLANE,
    )
    given = {
        "NumberOfFrames": len(pixels), "ImagePositionPatient": None, "ImageOrientationPatient": None,
        "PixelSpacing": None, "SharedFunctionalGroupsSequence": Sequence([shared]),
        "PerFrameFunctionalGroupsSequence": Sequence(groups),
    }  # fmt: skip
    return dicom_slice(path, pixels, (0, 0, 0), **(given | tags))


def at(z, **more):
    return item(PlanePositionSequence__ImagePositionPatient=[0, 0, float(z)], **more)


# ------------------------------------------------------------------ numbers of headers are no keys


@pytest.mark.parametrize("step", [0.004, 0.0005, 2.5, 400.0])
def test_slices_of_any_distance_make_one_volume(tmp_path, step):
    volume = load(stack(tmp_path / "d", along_z(step * np.arange(6))))
    np.testing.assert_array_equal(volume.array, STACK - 1024)
    assert volume.spacing[2] == pytest.approx(step)
    assert volume.metadata["notes"] == ()


@pytest.mark.parametrize(
    "tags",
    [
        lambda n: {"ImageOrientationPatient": [1, 2e-7 * (n % 2), 0, -2e-7 * (n % 2), 1, 0]},
        lambda n: {"PixelSpacing": [[0.48828125, 0.48828125], [0.488281, 0.488281]][n % 2]},
        lambda n: {"PixelRepresentation": n % 2},
    ],
    ids=["orientation", "spacing", "sign"],
)
def test_headers_that_differ_by_a_rounding_make_one_volume(tmp_path, tags):
    positive = np.abs(STACK)
    volume = load(stack(tmp_path / "d", along_z(range(6)), positive, tags))
    np.testing.assert_array_equal(volume.array, positive - 1024)


def test_positions_rounded_to_a_tenth_are_no_gaps(tmp_path):
    volume = load(stack(tmp_path / "d", along_z(np.round(0.65 * np.arange(12), 1))))
    assert volume.dimensions == (7, 5, 12)
    assert volume.spacing[2] == pytest.approx(0.65, rel=0.02)


# ------------------------------------------------------------------ lattices


def test_missing_slices_are_filled_between_their_neighbours_and_it_is_said(tmp_path):
    kept = [0, 1, 3, 4, 5]
    volume = load(stack(tmp_path / "d", along_z(2.0 * np.array(kept)), STACK[kept]))
    assert volume.dimensions == (7, 5, 6)
    np.testing.assert_array_equal(volume.array[kept], STACK[kept] - 1024)
    middle = (STACK[1].astype(float) + STACK[3]) / 2 - 1024
    np.testing.assert_allclose(volume.array[2], middle, atol=0.5)
    assert "1 of 6 slices are missing" in volume.metadata["notes"][0]


def test_uneven_slices_are_resampled_and_it_is_said(tmp_path):
    places = np.array([0.0, 2.0, 5.0, 6.9, 9.0, 12.0])
    ramp = np.broadcast_to((100 * places)[:, None, None], (6, 5, 7)).astype(np.int16)
    volume = load(stack(tmp_path / "d", along_z(places), ramp))
    depths = volume.origin[2] + volume.spacing[2] * np.arange(volume.dimensions[2])
    np.testing.assert_allclose(volume.array[:, 2, 3], 100 * depths - 1024, atol=0.51)
    assert any("resampled" in note for note in volume.metadata["notes"])


def test_slices_of_several_stacks_are_refused(tmp_path):
    with pytest.raises(LoadError, match="more are missing than there are"):
        load(stack(tmp_path / "d", along_z([0, 2, 4, 100, 102, 104])))


def test_slices_shifted_against_one_another_are_refused(tmp_path):
    places = [(3.0 * (n % 3), 0.0, 2.0 * n) for n in range(6)]
    with pytest.raises(LoadError, match="shifted against one another by up to"):
        load(stack(tmp_path / "d", places))


@pytest.mark.parametrize("degrees", [15, 19.3, -25])
def test_a_tilted_gantry_is_resampled_and_every_value_stays_at_its_place(tmp_path, degrees):
    tilt = np.radians(degrees)
    shape = (8, 30, 20)
    step = np.array([0.0, 2.5 * np.sin(tilt), 2.5 * np.cos(tilt)])
    k, j, i = np.meshgrid(*map(np.arange, shape), indexing="ij")
    world = np.stack([0.7 * i, 1.1 * j, np.zeros(shape)], -1) + k[..., None] * step
    field = (world @ np.array([20.0, 10.0, 30.0])).round().astype(np.int16)
    volume = load(stack(tmp_path / "d", [tuple(n * step) for n in range(8)], field))
    assert volume.shear == pytest.approx(0, abs=1e-6)
    assert any("sheared by" in note and "resampled" in note for note in volume.metadata["notes"])
    for n in ((1, 5, 6), (4, 12, 10), (6, 20, 15)):
        place = world[n]
        index = volume.world_to_index @ np.append(place, 1.0)
        low = np.floor(index[:3]).astype(int)
        part = index[:3] - low
        found = sum(
            volume.array[low[2] + c, low[1] + b, low[0] + a]
            * np.prod(np.where([a, b, c], part, 1 - part))
            for a in (0, 1) for b in (0, 1) for c in (0, 1)
        )  # fmt: skip
        assert found == pytest.approx(field[n] - 1024, abs=1.5)


def test_images_of_several_orientations_are_no_volume(tmp_path):
    folder = tmp_path / "d"
    folder.mkdir()
    for n, plane in enumerate((PLANE, [1, 0, 0, 0, 0, -1], [0, 1, 0, 0, 0, -1])):
        dicom_slice(folder / f"{n}.dcm", STACK[n], (0, 0, 0), orientation=plane)
    with pytest.raises(LoadError, match=r"3 images of different orientation .* localizer"):
        load(folder)


# ------------------------------------------------------------------ frames


def test_every_frame_has_its_own_rescaling(tmp_path):
    groups = [
        at(n, PixelValueTransformationSequence__RescaleSlope=str(n + 1),
           PixelValueTransformationSequence__RescaleIntercept="-5")
        for n in range(6)
    ]  # fmt: skip
    volume = load(enhanced(tmp_path / "e.dcm", STACK, groups))
    np.testing.assert_array_equal(volume.array, STACK * np.arange(1, 7)[:, None, None] - 5)


def test_frames_of_several_times_are_told_apart_by_what_they_say(tmp_path):
    order = [(z, t) for z in range(3) for t in ((1, 2) if z != 1 else (2, 1))]
    groups = [at(z, FrameContentSequence__TemporalPositionIndex=t) for z, t in order]
    pixels = np.stack([np.full((5, 7), 100 * t + z, np.int16) for z, t in order])
    path = enhanced(tmp_path / "e.dcm", pixels, groups)
    for time in (0, 1):
        wanted = 100 * (time + 1) + np.arange(3) - 1024
        np.testing.assert_array_equal(load(path, time=time).array[:, 0, 0], wanted)


def test_echoes_are_told_apart_and_named(tmp_path):
    folder = tmp_path / "d"
    folder.mkdir()
    for n, (z, echo) in enumerate([(0, 20), (0, 10), (1, 10), (1, 20), (2, 20), (2, 10)]):
        dicom_slice(folder / f"{n}.dcm", np.full((5, 7), echo, np.int16), (0, 0, z), EchoTime=str(echo))
    volume = load(folder)
    assert np.all(volume.array == 10 - 1024)
    assert any("echo time 10, 20" in note for note in volume.metadata["notes"])
    assert np.all(load(folder, time=1).array == 20 - 1024)


def test_files_of_many_frames_that_make_one_stack_are_joined(tmp_path):
    folder = tmp_path / "d"
    folder.mkdir()
    enhanced(folder / "a.dcm", STACK[:3], [at(2.5 * n) for n in range(3)])
    enhanced(folder / "b.dcm", STACK[3:], [at(2.5 * n) for n in range(3, 6)])
    np.testing.assert_array_equal(load(folder).array, STACK - 1024)
    assert load(folder / "b.dcm").dimensions == (7, 5, 3)


@pytest.mark.parametrize("rise", [3.0, -3.0])
def test_a_dose_lies_where_its_offsets_say(tmp_path, rise):
    path = dicom_slice(
        tmp_path / "dose.dcm", np.abs(STACK), (-10, -20, 30), Modality="RTDOSE", NumberOfFrames=6,
        GridFrameOffsetVector=[rise * n for n in range(6)], DoseGridScaling="0.001", DoseUnits="GY",
        RescaleSlope=None, RescaleIntercept=None,
    )  # fmt: skip
    volume = load(path)
    assert volume.unit == "Gy"
    for n in (0, 5):
        place = (-10 + 0.7 * 2, -20 + 1.1 * 3, 30 + rise * n)
        assert volume.value_at(place) == pytest.approx(0.001 * abs(int(STACK[n, 3, 2])), rel=1e-5)


def test_nuclear_medicine_lies_where_its_detector_says(tmp_path):
    detector = Dataset()
    detector.ImagePositionPatient, detector.ImageOrientationPatient = [12, -30, -250], [1, 0, 0, 0, 0, -1]
    path = dicom_slice(
        tmp_path / "nm.dcm", STACK, (0, 0, 0), Modality="NM", NumberOfFrames=6, SpacingBetweenSlices="-3.5",
        DetectorInformationSequence=Sequence([detector]), ImagePositionPatient=None, ImageOrientationPatient=None,
    )  # fmt: skip
    volume = load(path)
    assert volume.value_at((12 + 0.7 * 2, -30 - 3.5 * 4, -250 - 1.1 * 3)) == STACK[4, 3, 2] - 1024


def test_a_mosaic_is_cut_into_its_slices(tmp_path):
    folder = tmp_path / "d"
    folder.mkdir()
    tiles = scalars((2, 4, 5, 7), "int16") // 40
    for t, slices in enumerate(tiles):
        image = slices.reshape(2, 2, 5, 7).transpose(0, 2, 1, 3).reshape(10, 14)
        path = dicom_slice(
            folder / f"{t}.dcm", image, (-3.5 * 0.7, -2.5 * 1.1, 0), ImageType=["ORIGINAL", "PRIMARY", "M", "MOSAIC"],
            SpacingBetweenSlices="3", AcquisitionNumber=t + 1,
        )  # fmt: skip
        import pydicom

        data = pydicom.dcmread(path)
        block = data.private_block(0x19, "SIEMENS MR HEADER", create=True)
        block.add_new(0x0A, "US", 4)
        data.save_as(path)
    volume = load(folder)
    np.testing.assert_array_equal(volume.array, tiles[0] - 1024)
    np.testing.assert_allclose(volume.origin, (0, 0, 0), atol=1e-9)
    assert volume.spacing == pytest.approx((0.7, 1.1, 3))
    np.testing.assert_array_equal(load(folder, time=1).array, tiles[1] - 1024)


def test_a_segmentation_becomes_a_map_of_its_labels(tmp_path):
    masks = np.zeros((3, 8, 8), np.uint8)
    masks[0, 2, 3] = masks[1, 4, 4] = masks[2, 6, 1] = 1
    segments = [Dataset(), Dataset()]
    for number, segment in enumerate(segments, start=1):
        segment.SegmentNumber, segment.SegmentLabel = number, f"part {number}"
    groups = [
        at(z, SegmentIdentificationSequence__ReferencedSegmentNumber=s)
        for z, s in ((0, 1), (2.5, 1), (7.5, 2))
    ]
    path = enhanced(
        tmp_path / "seg.dcm", masks, groups, Modality="SEG", SegmentationType="BINARY", BitsAllocated=1, BitsStored=1,
        HighBit=0, SegmentSequence=Sequence(segments), RescaleSlope=None, RescaleIntercept=None,
        PixelData=np.packbits(masks.ravel(), bitorder="little").tobytes(),
    )  # fmt: skip
    volume = load(path)
    assert volume.dimensions == (8, 8, 4)
    assert sorted(np.argwhere(volume.array == 1).tolist()) == [[0, 2, 3], [1, 4, 4]]
    assert np.argwhere(volume.array == 2).tolist() == [[3, 6, 1]]
    source = volviz.open(path)
    assert source.is_labels
    assert [(label.number, label.name) for label in source.labels] == [(1, "part 1"), (2, "part 2")]


# ------------------------------------------------------------------ pixels


def test_a_palette_is_shown_by_the_brightness_of_its_colours_and_it_is_said(tmp_path):
    import struct

    index = np.arange(35, dtype=np.uint8).reshape(5, 7)
    falling = struct.pack("<256H", *(257 * (255 - n) for n in range(256)))
    tables = {f"{c}PaletteColorLookupTableData": falling for c in ("Red", "Green", "Blue")}
    descriptors = {f"{c}PaletteColorLookupTableDescriptor": [256, 0, 16] for c in ("Red", "Green", "Blue")}
    folder = tmp_path / "d"
    folder.mkdir()
    for n in range(3):
        dicom_slice(
            folder / f"{n}.dcm", index + n, (0, 0, n), PhotometricInterpretation="PALETTE COLOR", RescaleSlope=None,
            RescaleIntercept=None, Modality="US", **tables, **descriptors,
        )  # fmt: skip
    volume = load(folder)
    np.testing.assert_allclose(volume.array[0], 257 * (255 - index.astype(int)), atol=1)
    assert any("palette" in note for note in volume.metadata["notes"])


@pytest.mark.parametrize("interpretation", ["MONOCHROME1", "MONOCHROME2"])
@pytest.mark.parametrize(
    ("syntax", "encode"),
    [
        ("1.2.840.10008.1.2.4.57", "ljpeg_encode"),
        ("1.2.840.10008.1.2.4.80", "jpegls_encode"),
        ("1.2.840.10008.1.2.4.90", "jpeg2k_encode"),
        ("1.2.840.10008.1.2.5", None),
    ],
    ids=["JPEG lossless", "JPEG-LS", "JPEG 2000", "RLE"],
)
def test_compressed_pixels_are_those_that_were_stored_and_itk_agrees(
    tmp_path, syntax, encode, interpretation
):
    import imagecodecs
    import pydicom
    import SimpleITK
    from pydicom.encaps import encapsulate
    from pydicom.uid import UID

    folder = tmp_path / "d"
    folder.mkdir()
    stored = (scalars((3, 16, 24), "uint16") >> 4).astype(np.uint16)
    for n, pixels in enumerate(stored):
        path = dicom_slice(
            folder / f"{n}.dcm",
            pixels,
            (0, 0, n),
            BitsStored=12,
            HighBit=11,
            PhotometricInterpretation=interpretation,
        )
        data = pydicom.dcmread(path)
        if encode is None:
            data.compress(UID(syntax))
        else:
            options = {"level": 0, "codecformat": "j2k"} if encode == "jpeg2k_encode" else {}
            options = {"bitspersample": 12} if encode == "ljpeg_encode" else options
            data.PixelData = encapsulate([getattr(imagecodecs, encode)(pixels, **options)])
            data["PixelData"].VR = "OB"
            data.file_meta.TransferSyntaxUID = UID(syntax)
        data.save_as(path)
    volume = load(folder)
    np.testing.assert_array_equal(volume.array, stored.astype(np.int32) - 1024)
    assert volume.array.dtype == np.int16
    if interpretation == "MONOCHROME2":
        other = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage([str(folder / f"{n}.dcm") for n in range(3)]))
        np.testing.assert_array_equal(volume.array, other)


@pytest.mark.parametrize("implicit", [False, True])
def test_files_without_meta_information_are_read(tmp_path, implicit):
    import pydicom

    folder = stack(tmp_path / "d", along_z(range(6)))
    for path in folder.iterdir():
        data = pydicom.dcmread(path)
        del data.file_meta
        data.save_as(path, implicit_vr=implicit, little_endian=True, enforce_file_format=False)
    np.testing.assert_array_equal(load(folder).array, STACK - 1024)


# ------------------------------------------------------------------ where files lie


def test_a_folder_with_hundreds_of_other_files_and_deep_folders_is_searched(tmp_path):
    disc = tmp_path / "disc"
    disc.mkdir()
    for n in range(600):
        (disc / f"a{n:03d}.dll").write_bytes(b"MZ" + bytes(200))
    deep = disc / "b" / "c" / "d" / "e" / "f" / "g" / "h"
    deep.mkdir(parents=True)
    stack(deep / "series", along_z(range(6)))
    assert load(disc).dimensions == (7, 5, 6)


@pytest.mark.filterwarnings("ignore:Implicitly cleaning up:ResourceWarning")
def test_a_dicomdir_opens_what_it_lists(tmp_path):
    from pydicom.fileset import FileSet

    study = {"StudyInstanceUID": "1.2.3", "StudyTime": "1200", "StudyID": "1", "SeriesNumber": 1}
    folder = stack(tmp_path / "d", along_z(range(6)), tags=lambda _n: study)
    files = FileSet()
    for path in sorted(folder.iterdir()):
        files.add(path)
    files.write(tmp_path / "disc")
    for asked in (tmp_path / "disc" / "DICOMDIR", tmp_path / "disc"):
        np.testing.assert_array_equal(load(asked).array, STACK - 1024)
    del files
    gc.collect()


def test_numbers_of_a_raw_file_do_not_pass_for_dicom():
    from volviz.io.dicom.finding import looks_like_dicom

    rng = np.random.default_rng(4)
    for value in (8, 0x0008_0005 & 0xFFFF, 88):
        raw = rng.integers(0, 4000, 300).astype("<u2")
        raw[0] = value
        assert not looks_like_dicom(raw.tobytes())
