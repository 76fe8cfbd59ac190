"""DICOM: synthetic series with every irregularity that the reader promises to handle."""

from __future__ import annotations

import json

import numpy as np
import pytest

import volviz
from tests.unit.io.writers import dicom_slice, gzipped, rotation, scalars
from volviz.errors import InputError, LoadError
from volviz.io import info, load

STACK = scalars((6, 5, 7), "int16") // 40


def series(folder, stack=STACK, *, step=(0, 0, 2.5), origin=(-10, 20, 30), order=None, prefix="s", **tags):
    folder.mkdir(exist_ok=True)
    places = np.asarray(origin) + np.arange(len(stack))[:, None] * np.asarray(step, float)
    for name, n in enumerate(order if order is not None else range(len(stack))):
        dicom_slice(folder / f"{prefix}{name:03d}.dcm", stack[n], places[n], InstanceNumber=name + 1, **tags)
    return folder


@pytest.mark.parametrize("seed", range(4))
def test_slices_in_any_order_and_orientation_become_a_volume(tmp_path, seed):
    matrix = rotation(seed, mirrored=bool(seed % 2))
    order = np.random.default_rng(seed).permutation(len(STACK))
    folder = series(
        tmp_path / "d",
        step=matrix[:, 2] * 2.5,
        order=order,
        ImageOrientationPatient=[round(float(v), 12) for v in (*matrix[:, 0], *matrix[:, 1])],
    )
    volume = load(folder)
    # which end of the stack comes first is free: the value must lie at the place the header gives it
    for n in range(len(STACK)):
        for row, column in ((0, 0), (4, 6), (2, 3)):
            place = np.array([-10, 20, 30]) + matrix @ (0.7 * column, 1.1 * row, 2.5 * n)
            assert volume.value_at(place) == STACK[n, row, column] - 1024
    np.testing.assert_allclose(volume.spacing, (0.7, 1.1, 2.5), rtol=1e-6)
    assert volume.unit == "HU"
    assert volume.array.dtype == np.int16
    assert volume.metadata["notes"] == ()


def test_simpleitk_places_the_same_voxels_at_the_same_points(tmp_path):
    import SimpleITK

    matrix = rotation(8)
    folder = series(
        tmp_path / "d",
        step=matrix[:, 2] * 2.5,
        ImageOrientationPatient=[round(float(v), 12) for v in (*matrix[:, 0], *matrix[:, 1])],
    )
    image = SimpleITK.ReadImage(SimpleITK.ImageSeriesReader.GetGDCMSeriesFileNames(str(folder)))
    volume = load(folder)
    for index in ((0, 0, 0), (6, 4, 5), (3, 2, 1)):
        assert volume.value_at(image.TransformIndexToPhysicalPoint(index)) == image[index]


def test_one_file_opens_its_whole_series_and_says_so(tmp_path):
    folder = series(tmp_path / "d")
    series(folder, STACK[:3], prefix="other", SeriesInstanceUID="9.9")
    volume = load(folder / "s002.dcm")
    assert volume.dimensions == (7, 5, 6)
    assert "one of 6 slices" in volume.metadata["notes"][0]


def test_of_several_series_the_largest_is_taken_and_others_can_be_chosen(tmp_path):
    folder = series(tmp_path / "d", STACK[:3], prefix="a", SeriesInstanceUID="9.9")
    series(folder / "deeper", prefix="b")
    volume = load(folder)
    assert volume.dimensions == (7, 5, 6)
    assert "largest of 2 series" in volume.metadata["notes"][0]
    assert load(folder, series=1).dimensions == (7, 5, 3)
    entries = volviz.open(folder).entries
    assert [(entry.name, entry.sizes, entry.title) for entry in entries] == [
        ("0", (6, 5, 7), "CT"), ("1", (3, 5, 7), "CT"),
    ]  # fmt: skip
    assert load(folder, series=entries[1].name).dimensions == (7, 5, 3)
    assert load(folder, series="9.9").dimensions == (7, 5, 3)
    with pytest.raises(InputError, match="series must be"):
        load(folder, series=5)


def test_a_scout_image_in_the_series_is_left_out(tmp_path):
    folder = series(tmp_path / "d")
    dicom_slice(folder / "scout.dcm", scalars((9, 9), "int16"), (0, 0, 0), orientation=(0, 1, 0, 0, 0, -1))
    volume = load(folder)
    assert volume.dimensions == (7, 5, 6)
    assert "1 slices of another size" in volume.metadata["notes"][0]


def test_several_images_at_each_position_are_time_points(tmp_path):
    folder = series(tmp_path / "d", TemporalPositionIdentifier=1, prefix="a")
    series(folder, STACK + 7, TemporalPositionIdentifier=2, prefix="b")
    np.testing.assert_array_equal(load(folder).array, STACK - 1024)
    np.testing.assert_array_equal(load(folder, time=1).array, STACK + 7 - 1024)
    assert "first of 2 time points" in load(folder).metadata["notes"][0]


@pytest.mark.parametrize(
    ("slope", "intercept", "dtype"), [("1", "-1024", "int16"), ("0.5", "3", "float32"), ("2", "0", "int16")]
)
def test_stored_values_are_rescaled(tmp_path, slope, intercept, dtype):
    volume = load(series(tmp_path / "d", RescaleSlope=slope, RescaleIntercept=intercept))
    np.testing.assert_allclose(volume.array, STACK * float(slope) + float(intercept), rtol=1e-6)
    assert volume.array.dtype == np.dtype(dtype)


def test_each_slice_may_have_its_own_rescaling(tmp_path):
    folder = tmp_path / "d"
    folder.mkdir()
    for n, pixels in enumerate(STACK):
        dicom_slice(
            folder / f"{n}.dcm",
            pixels,
            (0, 0, n),
            RescaleSlope=str(0.5 * (n + 1)),
            RescaleIntercept="0",
            Modality="PT",
            Units="BQML",
        )
    volume = load(folder)
    np.testing.assert_allclose(volume.array, STACK * (0.5 * np.arange(1, 7))[:, None, None], rtol=1e-6)
    assert volume.unit == "Bq/ml"


def test_a_unit_is_claimed_only_where_the_header_gives_one(tmp_path):
    assert load(series(tmp_path / "mr", Modality="MR")).unit == ""
    assert load(series(tmp_path / "us", RescaleType="US")).unit == ""


def test_slightly_uneven_slices_are_drawn_and_it_is_said(tmp_path):
    folder = tmp_path / "d"
    folder.mkdir()
    for n, z in enumerate((0.0, 2.5, 5.05, 7.5)):
        dicom_slice(folder / f"{n}.dcm", STACK[n], (0, 0, z))
    volume = load(folder)
    assert volume.spacing[2] == pytest.approx(2.5)
    assert "their mean distance is taken" in volume.metadata["notes"][0]


def test_slices_without_position_are_stacked_by_number_and_it_is_said(tmp_path):
    folder = series(tmp_path / "d", ImagePositionPatient=None, SpacingBetweenSlices="4")
    volume = load(folder)
    np.testing.assert_array_equal(volume.array, STACK - 1024)
    assert volume.spacing == pytest.approx((0.7, 1.1, 4.0))
    assert "does not say where the slices lie" in volume.metadata["notes"][0]


def test_a_single_slice_is_no_volume(tmp_path):
    folder = series(tmp_path / "d", STACK[:1])
    with pytest.raises(LoadError, match="at least 2 voxels"):
        load(folder)


def test_colours_are_shown_as_brightness(tmp_path):
    folder = tmp_path / "d"
    folder.mkdir()
    rgb = scalars((3, 4, 5, 3), "uint8")
    for n in range(3):
        dicom_slice(
            folder / f"{n}.dcm", rgb[n, ..., 0], (0, 0, n), Modality="OT", SamplesPerPixel=3,
            PhotometricInterpretation="RGB", PlanarConfiguration=0, PixelData=rgb[n].tobytes(),
            RescaleSlope=None, RescaleIntercept=None,
        )  # fmt: skip
    np.testing.assert_allclose(load(folder).array, rgb @ np.array([0.2126, 0.7152, 0.0722]), atol=0.51)
    np.testing.assert_array_equal(load(folder, channel=2).array, rgb[..., 2])


def test_an_enhanced_file_holds_its_frames_in_any_order(tmp_path):
    from pydicom.dataset import Dataset
    from pydicom.sequence import Sequence

    order = [3, 0, 5, 1, 4, 2]

    def item(name, **tags):
        inner, outer = Dataset(), Dataset()
        for tag, value in tags.items():
            setattr(inner, tag, value)
        setattr(outer, name, Sequence([inner]))
        return outer

    shared = item("PixelMeasuresSequence", PixelSpacing=[1.1, 0.7], SliceThickness="2.5")
    plane = item("PlaneOrientationSequence", ImageOrientationPatient=[1, 0, 0, 0, 1, 0])
    shared.PlaneOrientationSequence = plane.PlaneOrientationSequence
    frames = Sequence(
        [item("PlanePositionSequence", ImagePositionPatient=[-10, 20, 30 + 2.5 * n]) for n in order]
    )
    dicom_slice(
        tmp_path / "e.dcm", STACK[order], (0, 0, 0), NumberOfFrames=6, ImagePositionPatient=None,
        ImageOrientationPatient=None, PixelSpacing=None, SharedFunctionalGroupsSequence=Sequence([shared]),
        PerFrameFunctionalGroupsSequence=frames,
    )  # fmt: skip
    volume = load(tmp_path / "e.dcm")
    np.testing.assert_array_equal(volume.array, STACK - 1024)
    np.testing.assert_allclose(volume.spacing, (0.7, 1.1, 2.5))
    np.testing.assert_allclose(volume.origin, (-10, 20, 30))


def test_compressed_pixels_are_decoded(tmp_path):
    import pydicom
    from pydicom.uid import RLELossless

    folder = series(tmp_path / "d")
    for path in folder.iterdir():
        data = pydicom.dcmread(path)
        data.compress(RLELossless)
        data.save_as(path)
    np.testing.assert_array_equal(load(folder).array, STACK - 1024)


def test_nothing_about_the_patient_is_kept(tmp_path):
    folder = series(tmp_path / "d", SeriesDescription="Secret protocol")
    told = json.dumps(info(folder)) + repr(load(folder)) + repr(dict(load(folder).metadata))
    for secret in ("Secret", "Person", "4711", "1970", "2020", "Hospital", "protocol"):
        assert secret not in told.replace(str(tmp_path), "")


def test_a_slice_that_is_cut_off_is_left_out_of_a_folder_and_refused_as_a_file(tmp_path):
    folder = series(tmp_path / "d")
    last = folder / "s005.dcm"
    last.write_bytes(last.read_bytes()[:-20])
    volume = load(folder)
    assert volume.dimensions == (7, 5, 5)
    assert "s005.dcm is cut off" in volume.metadata["notes"][0]
    with pytest.raises(LoadError, match=r"^s005\.dcm: the file is cut off"):
        load(last)


def test_a_file_of_another_series_that_is_cut_off_is_no_matter(tmp_path):
    folder = series(tmp_path / "d")
    other = dicom_slice(folder / "a.dcm", STACK[0], (0, 0, 0), SeriesInstanceUID="1.2.3.9")
    other.write_bytes(other.read_bytes()[:-20])
    volume = load(folder / "s002.dcm")
    assert volume.dimensions == (7, 5, 6)
    assert not any("a.dcm" in note for note in volume.metadata["notes"])


def test_a_file_opens_the_slices_of_its_own_kind_even_when_others_are_more(tmp_path):
    folder = series(tmp_path / "d")
    series(folder, np.zeros((9, 4, 4), np.int16), prefix="scout")
    dicom_slice(folder / "frames.dcm", STACK[:2], (0, 0, 0), NumberOfFrames=2)
    assert load(folder / "s002.dcm").dimensions == (7, 5, 6)
    assert load(folder / "scout003.dcm").dimensions == (4, 4, 9)


def test_pixels_that_share_their_colours_are_no_file_that_is_cut_off(tmp_path):
    folder = tmp_path / "d"
    folder.mkdir()
    rng = np.random.default_rng(3)
    for n in range(3):
        # two pixels: Y Y Cb Cr; without colour, brightness is Y
        pixels = np.full((4, 8, 2), 128, np.uint8)
        pixels.reshape(-1, 4)[:, :2] = n * 40 + rng.integers(0, 9, (16, 2))
        tags = {"SamplesPerPixel": 3, "PhotometricInterpretation": "YBR_FULL_422", "PlanarConfiguration": 0}
        dicom_slice(
            folder / f"{n}.dcm", pixels[..., 0], (0, 0, n), PixelData=pixels.tobytes(), Modality="US",
            RescaleSlope=None, RescaleIntercept=None, RescaleType=None, **tags,
        )  # fmt: skip
    volume = load(folder)
    assert volume.dimensions == (8, 4, 3)
    np.testing.assert_allclose(volume.array.mean(axis=(1, 2)), [4, 44, 84], atol=1.5)


def test_a_packed_slice_is_unpacked_and_refused_as_the_single_image_that_it_is(tmp_path):
    path = gzipped(dicom_slice(tmp_path / "v.dcm", STACK[0], (0, 0, 0)))
    with pytest.raises(LoadError, match=r"at least 2 voxels|single|one slice"):
        load(path)


def test_a_folder_of_packed_slices_opens_as_if_unpacked(tmp_path):
    slices = scalars((4, 6, 5))
    for n, pixels in enumerate(slices):
        path = dicom_slice(tmp_path / f"{n}.dcm", pixels, (0, 0, 2.5 * n), RescaleIntercept="0")
        if n != 1:
            gzipped(path)
            path.unlink()
    for opened in (tmp_path, tmp_path / "0.dcm.gz"):
        volume = load(opened)
        np.testing.assert_array_equal(volume.array, slices)
        assert volume.spacing == (0.7, 1.1, 2.5)
    packed = tmp_path / "3.dcm.gz"
    packed.write_bytes(packed.read_bytes()[:-50])
    assert load(tmp_path).dimensions == (5, 6, 3)


def test_folders_without_volumes_are_refused_in_words(tmp_path):
    (tmp_path / "empty").mkdir()
    (tmp_path / "texts").mkdir()
    for n in range(5):
        (tmp_path / "texts" / f"{n}.txt").write_bytes(bytes(300))
    for name in ("empty", "texts"):
        with pytest.raises(LoadError, match=rf"^{name}: no DICOM slices and no numbered pictures were found"):
            load(tmp_path / name)


def test_a_file_of_random_bytes_behind_a_dicom_mark_is_refused_in_words(tmp_path):
    for seed in range(20):
        noise = np.random.default_rng(seed).bytes(500)
        (tmp_path / "fake.dcm").write_bytes(bytes(128) + b"DICM" + noise)
        with pytest.raises(LoadError, match=r"^fake\.dcm: "):
            load(tmp_path / "fake.dcm")


def test_a_folder_of_files_that_are_all_cut_off_and_a_flat_slide_are_refused_in_true_words(tmp_path):
    for n in range(2):
        path = dicom_slice(tmp_path / f"{n}.dcm", scalars((4, 5)), (0, 0, n))
        path.write_bytes(path.read_bytes()[:-9])
    with pytest.raises(LoadError, match="all of its images are cut off"):
        load(tmp_path)
    slide = tmp_path / "slide.dcm"
    dicom_slice(
        slide, scalars((3, 4, 5)), (0, 0, 0), SOPClassUID="1.2.840.10008.5.1.4.1.1.77.1.6", NumberOfFrames=3
    )
    with pytest.raises(LoadError, match="one flat image in tiles"):
        load(slide)
