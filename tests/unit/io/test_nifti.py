"""NIfTI against nibabel and SimpleITK."""

from __future__ import annotations

import itertools
from pathlib import Path

import nibabel
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from nibabel.orientations import apply_orientation, inv_ornt_aff

from tests.unit.io.writers import gzipped, itk, rotation, scalars
from volviz.errors import InputError, LoadError
from volviz.io import load
from volviz.io import open as open_source

LPS = np.diag([-1.0, -1.0, 1.0, 1.0])
TYPES = ["uint8", "int8", "int16", "uint16", "int32", "uint32", "int64", "float32", "float64"]


def affine_of(seed: int, *, mirrored: bool = False) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3] = rotation(seed, mirrored=mirrored) * (0.7, 1.1, 2.3)
    matrix[:3, 3] = (-12.5, 30.25, 7.0)
    return matrix


def save(path: Path, array_xyz: np.ndarray, affine: np.ndarray, kind: type = nibabel.Nifti1Image) -> Path:
    nibabel.save(kind(array_xyz, affine), path)
    return path


@given(
    dtype=st.sampled_from(TYPES),
    shape=st.tuples(*[st.integers(2, 9)] * 3),
    seed=st.integers(0, 999),
    mirrored=st.booleans(),
    order=st.sampled_from("<>"),
    kind=st.sampled_from([nibabel.Nifti1Image, nibabel.Nifti2Image]),
    suffix=st.sampled_from([".nii", ".nii.gz"]),
)
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_values_and_geometry_come_back_as_nibabel_wrote_them(
    tmp_path, dtype, shape, seed, mirrored, order, kind, suffix
):
    array = scalars(shape, dtype, seed)
    affine = affine_of(seed, mirrored=mirrored)
    header = kind.header_class(endianness=order)
    header.set_data_dtype(dtype)
    path = tmp_path / f"v{suffix}"
    nibabel.save(kind(array, affine, header), path)
    volume = load(path)
    assert volume.array.dtype == np.dtype(dtype)
    np.testing.assert_array_equal(volume.array, array.T)
    np.testing.assert_allclose(volume.index_to_world, LPS @ affine, atol=2e-5)


def test_all_48_axis_orders_and_flips_show_the_same_value_at_the_same_place(tmp_path):
    array = scalars((7, 9, 11), "int16", 3)
    affine = np.array([[1.2, 0.1, 0, -20], [0, 0.9, 0.2, 5], [-0.1, 0, 2.0, 30], [0, 0, 0, 1.0]])
    place = LPS @ affine @ (2, 6, 4, 1)
    path = tmp_path / "v.nii"
    for axes in itertools.permutations(range(3)):
        for flips in itertools.product((1, -1), repeat=3):
            orientation = np.array(list(zip(axes, flips, strict=True)), float)
            turned = apply_orientation(array, orientation)
            volume = load(save(path, turned, affine @ inv_ornt_aff(orientation, array.shape)))
            index = volume.world_to_index @ place
            np.testing.assert_allclose(index, np.rint(index), atol=1e-4)
            assert volume.value_at(place[:3]) == array[2, 6, 4], (axes, flips)


def test_the_qform_is_taken_when_there_is_no_sform(tmp_path):
    image = nibabel.Nifti1Image(scalars(), None)
    image.set_qform(affine_of(4, mirrored=True), code=1)
    image.set_sform(None, code=0)
    nibabel.save(image, tmp_path / "q.nii")
    np.testing.assert_allclose(
        load(tmp_path / "q.nii").index_to_world, LPS @ affine_of(4, mirrored=True), atol=1e-5
    )


@given(seed=st.integers(0, 10_000), mirrored=st.booleans())
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_rotation_survives_the_quaternion_of_the_qform(tmp_path, seed, mirrored):
    image = nibabel.Nifti1Image(scalars((2, 3, 4)), None)
    image.set_qform(affine_of(seed, mirrored=mirrored), code=2)
    image.set_sform(None, code=0)
    nibabel.save(image, tmp_path / "q.nii")
    np.testing.assert_allclose(load(tmp_path / "q.nii").index_to_world, LPS @ image.affine, atol=1e-5)


def test_half_turns_survive_the_quaternion_of_the_qform(tmp_path):
    for axis in range(3):
        turn = -np.eye(4)
        turn[axis, axis] = turn[3, 3] = 1
        image = nibabel.Nifti1Image(scalars((2, 3, 4)), None)
        image.set_qform(turn, code=1)
        image.set_sform(None, code=0)
        nibabel.save(image, tmp_path / "q.nii")
        np.testing.assert_allclose(load(tmp_path / "q.nii").index_to_world, LPS @ turn, atol=1e-6)


def test_the_sform_wins_over_a_different_qform(tmp_path):
    image = nibabel.Nifti1Image(scalars(), None)
    image.set_qform(affine_of(4), code=1)
    image.set_sform(affine_of(5), code=3)
    nibabel.save(image, tmp_path / "both.nii")
    np.testing.assert_allclose(load(tmp_path / "both.nii").index_to_world, LPS @ affine_of(5), atol=1e-5)


def test_a_file_without_orientation_says_so(tmp_path):
    image = nibabel.Nifti1Image(scalars(), None)
    image.header.set_zooms((0.7, 1.1, 2.3))
    image.set_qform(None, code=0)
    image.set_sform(None, code=0)
    image.header.set_zooms((0.7, 1.1, 2.3))
    nibabel.save(image, tmp_path / "none.nii")
    volume = load(tmp_path / "none.nii")
    assert volume.spacing == pytest.approx((0.7, 1.1, 2.3))
    np.testing.assert_array_equal(volume.direction, np.diag([-1, -1, 1]))
    assert "does not say how it lies in space" in volume.metadata["notes"][0]


@pytest.mark.parametrize(("unit", "factor"), [("mm", 1.0), ("micron", 1e-3), ("meter", 1e3), (None, 1.0)])
def test_lengths_are_given_in_millimetres(tmp_path, unit, factor):
    image = nibabel.Nifti1Image(scalars(), affine_of(2))
    image.header.set_xyzt_units(unit)
    nibabel.save(image, tmp_path / "u.nii")
    volume = load(tmp_path / "u.nii")
    assert volume.spacing == pytest.approx((0.7 * factor, 1.1 * factor, 2.3 * factor), rel=1e-5)
    assert volume.metadata["length_unit"] == "mm"


def test_micrometres_come_out_as_in_itk(tmp_path):
    import SimpleITK

    image = nibabel.Nifti1Image(scalars(), affine_of(2))
    image.header.set_xyzt_units("micron")
    nibabel.save(image, tmp_path / "u.nii")
    assert load(tmp_path / "u.nii").spacing == pytest.approx(
        SimpleITK.ReadImage(str(tmp_path / "u.nii")).GetSpacing()
    )


@pytest.mark.parametrize("seed", range(6))
def test_geometry_equals_what_simpleitk_reads(tmp_path, seed):
    import SimpleITK

    path = save(tmp_path / "s.nii.gz", scalars(), affine_of(seed, mirrored=bool(seed % 2)))
    image, volume = SimpleITK.ReadImage(str(path)), load(path)
    np.testing.assert_allclose(volume.origin, image.GetOrigin(), atol=1e-4)
    np.testing.assert_allclose(volume.spacing, image.GetSpacing(), rtol=1e-5)
    np.testing.assert_allclose(volume.direction.ravel(), image.GetDirection(), atol=1e-5)
    np.testing.assert_array_equal(volume.array, SimpleITK.GetArrayFromImage(image))


def scaled(path: Path, array: np.ndarray, slope: float, intercept: float) -> Path:
    image = nibabel.Nifti1Image(array, np.eye(4))
    image.header.set_data_dtype(array.dtype)
    nibabel.save(image, path)
    raw = bytearray(path.read_bytes())
    raw[112:120] = np.array([slope, intercept], "<f4").tobytes()
    path.write_bytes(raw)
    return path


@pytest.mark.parametrize(
    ("dtype", "slope", "intercept", "expected"),
    [
        ("int16", 0.5, 3.0, "float32"),
        ("uint8", 1.0, -1024.0, "int16"),
        ("uint8", 8.0, -1024.0, "int16"),
        ("int16", 0.0, 5.0, "int16"),
        ("int16", np.nan, np.nan, "int16"),
        ("int32", 0.5, 0.0, "float64"),
        ("float64", 2.0, 1.0, "float64"),
    ],
)
def test_stored_values_are_scaled_in_the_smallest_type_that_holds_them(
    tmp_path, dtype, slope, intercept, expected
):
    array = scalars((5, 6, 7), dtype)
    volume = load(scaled(tmp_path / "s.nii", array, slope, intercept))
    plain = slope == 0 or np.isnan(slope)
    wanted = array.T if plain else array.T.astype(np.float64) * slope + intercept
    np.testing.assert_allclose(volume.array, wanted, rtol=1e-6)
    assert volume.array.dtype == np.dtype(expected)


def test_one_time_point_of_a_series_is_read_and_the_choice_is_said(tmp_path):
    array = scalars((4, 5, 6, 3))
    for path in (tmp_path / "t.nii", tmp_path / "t.nii.gz"):
        save(path, array, np.eye(4))
        first = load(path)
        np.testing.assert_array_equal(first.array, array[..., 0].T)
        assert "first of 3 time points" in first.metadata["notes"][0]
        third = load(path, time=2)
        np.testing.assert_array_equal(third.array, array[..., 2].T)
        assert third.metadata["notes"] == ()
        with pytest.raises(InputError, match=r"time must lie in 0\.\.2, got 3"):
            load(path, time=3)


def test_components_of_a_vector_are_channels(tmp_path):
    array = scalars((4, 5, 6, 1, 3), "float32")
    path = save(tmp_path / "v.nii", array, np.eye(4))
    np.testing.assert_array_equal(load(path, channel=2).array, array[..., 0, 2].T)
    assert "first of 3 channels" in load(path).metadata["notes"][0]


def test_colours_are_shown_as_brightness(tmp_path):
    rgb = scalars((4, 5, 6, 3), "uint8")
    kind = np.dtype([("R", "u1"), ("G", "u1"), ("B", "u1")])
    path = save(tmp_path / "rgb.nii", rgb.view(kind)[..., 0], np.eye(4))
    volume = load(path)
    wanted = rgb @ np.array([0.2126, 0.7152, 0.0722])
    np.testing.assert_allclose(volume.array, wanted.T, atol=0.51)
    assert "brightness" in volume.metadata["notes"][0]
    np.testing.assert_array_equal(load(path, channel=1).array, rgb[..., 1].T)


def test_complex_values_are_shown_as_their_magnitude(tmp_path):
    array = (scalars(dtype="float32") + 1j * scalars(dtype="float32", seed=2)).astype(np.complex64)
    volume = load(save(tmp_path / "c.nii", array, np.eye(4)))
    np.testing.assert_allclose(volume.array, np.abs(array).T, rtol=1e-6)


def test_header_and_image_may_be_two_files_opened_by_either(tmp_path):
    array = scalars()
    save(tmp_path / "pair.img", array, affine_of(1), nibabel.Nifti1Pair)
    for name in ("pair.img", "pair.hdr"):
        volume = load(tmp_path / name)
        np.testing.assert_array_equal(volume.array, array.T)
        np.testing.assert_allclose(volume.index_to_world, LPS @ affine_of(1), atol=1e-5)
        assert volume.name == "pair"


@pytest.mark.parametrize("kind", [nibabel.AnalyzeImage, nibabel.Spm99AnalyzeImage, nibabel.Spm2AnalyzeImage])
@pytest.mark.parametrize("has_matrix", [False, True])
@pytest.mark.parametrize("order", "<>")
def test_an_analyze_file_lies_and_is_scaled_as_nibabel_reads_it(tmp_path, kind, has_matrix, order):
    array = scalars(dtype="float32")
    image = kind(array, np.diag([-2.0, 3.0, 4.0, 1.0]), kind.header_class(endianness=order))
    has_scale = kind is not nibabel.AnalyzeImage
    image.set_data_dtype(np.int16 if has_scale else np.float32)
    nibabel.save(image, tmp_path / "old.img")
    if not has_matrix:
        (tmp_path / "old.mat").unlink(missing_ok=True)
    expected = nibabel.load(tmp_path / "old.img")
    for name in ("old.img", "old.hdr"):
        volume = load(tmp_path / name)
        np.testing.assert_allclose(volume.array, expected.get_fdata().T, rtol=1e-5)
        np.testing.assert_allclose(volume.index_to_world, LPS @ expected.affine, atol=1e-5)
    is_told = has_matrix and has_scale
    assert any("does not say how it lies" in note for note in volume.metadata["notes"]) is not is_told


def test_the_origin_and_the_ranges_of_an_analyze_header_count_where_nothing_else_does(tmp_path):
    array = scalars(dtype="int16")
    nibabel.save(nibabel.AnalyzeImage(array, None), tmp_path / "old.img")
    header = bytearray((tmp_path / "old.hdr").read_bytes())
    header[253:259] = np.array([2, 3, 4], "<i2").tobytes()
    header[124:132] = np.array([50, -10], "<f4").tobytes()
    header[140:148] = np.array([3000, 0], "<i4").tobytes()
    (tmp_path / "old.hdr").write_bytes(header)
    volume, expected = load(tmp_path / "old.hdr"), nibabel.load(tmp_path / "old.img")
    np.testing.assert_allclose(volume.array, expected.get_fdata().T, rtol=1e-5, atol=1e-3)
    np.testing.assert_allclose(volume.index_to_world, LPS @ expected.affine, atol=1e-5)
    (tmp_path / "old.mat").write_bytes(b"no matrix of MATLAB")
    np.testing.assert_allclose(load(tmp_path / "old.hdr").origin, volume.origin)


def test_sizes_of_0_beyond_the_third_are_1(tmp_path):
    array = scalars()
    path = save(tmp_path / "v.nii", array[..., None], affine_of(1))
    raw = bytearray(path.read_bytes())
    raw[40:50] = np.array([4, *array.shape, 0], "<i2").tobytes()
    path.write_bytes(raw)
    np.testing.assert_array_equal(load(path).array, array.T)


def test_a_slope_without_an_intercept_is_applied_and_told(tmp_path):
    path = save(tmp_path / "v.nii", scalars(), affine_of(1))
    raw = bytearray(path.read_bytes())
    raw[112:120] = np.array([2.0, np.nan], "<f4").tobytes()
    path.write_bytes(raw)
    volume = load(path)
    np.testing.assert_array_equal(volume.array, 2 * scalars().T.astype(np.int32))
    assert any("intercept" in note for note in volume.metadata["notes"])


def test_nan_and_infinity_stay_and_are_counted(tmp_path):
    array = scalars(dtype="float32")
    array[0, 0, 0], array[1, 2, 3] = np.nan, np.inf
    volume = load(save(tmp_path / "n.nii", array, np.eye(4)))
    np.testing.assert_array_equal(volume.array, array.T)
    assert volume.nonfinite_count == 2
    assert np.isfinite(volume.range).all()


@pytest.mark.parametrize("keep", [0, 100, 348, 353, 400, 0.5, 0.99])
@pytest.mark.parametrize("packed", [False, True])
def test_a_file_that_is_cut_off_is_refused_in_words(tmp_path, keep, packed):
    path = save(tmp_path / "v.nii", scalars((20, 20, 20)), np.eye(4))
    if packed:
        path = gzipped(path)
    raw = path.read_bytes()
    path.write_bytes(raw[: int(keep * len(raw)) if isinstance(keep, float) else keep])
    with pytest.raises(LoadError, match=r"v\.nii.*: .*[.;]"):
        load(path)


def test_a_gzipped_file_may_be_called_nii(tmp_path):
    path = gzipped(save(tmp_path / "v.nii", scalars(), np.eye(4)))
    np.testing.assert_array_equal(load(path.rename(tmp_path / "w.nii")).array, scalars().T)


def test_a_tilted_gantry_is_resampled_and_a_slight_shear_is_kept_exactly(tmp_path):
    affine = np.eye(4)
    for degrees, fits in ((7.9, True), (8.1, False), (18.5, False)):
        affine[1, 2] = np.sin(np.radians(degrees))
        affine[2, 2] = np.cos(np.radians(degrees))
        path = save(tmp_path / "s.nii", scalars(), affine)
        if fits:
            volume = load(path)
            np.testing.assert_allclose(volume.index_to_world, LPS @ affine, atol=1e-6)
            assert volume.shear == pytest.approx(degrees, abs=1e-4)
        else:
            volume = load(path)
            assert volume.shear == pytest.approx(0, abs=1e-6)
            assert any(f"sheared by {degrees} degrees" in note for note in volume.metadata["notes"])


def test_simpleitk_agrees_on_a_file_it_wrote(tmp_path):
    array = scalars(dtype="uint16")
    direction = rotation(11)
    volume = load(itk(tmp_path / "i.nii.gz", array, direction=direction))
    np.testing.assert_array_equal(volume.array, array)
    np.testing.assert_allclose(volume.direction, direction, atol=1e-6)
    np.testing.assert_allclose(volume.origin, (-12.5, 30.25, 7.0), atol=1e-5)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("bits", [80, 128])
def test_numbers_of_128_bits_are_read_as_doubles(tmp_path, bits, order):
    import struct
    from fractions import Fraction

    values = [0.0, 1.0, -2.5, 0.1, 1e-300, 1.7e308, np.inf, -np.inf, np.nan, 12345.678, -1e10, 3.0]

    def packed(value: float) -> bytes:
        sign = int(np.signbit(value)) << 15
        if not np.isfinite(value):
            exponent, fraction = 0x7FFF, Fraction(int(np.isnan(value)), 2)
        elif value == 0:
            exponent, fraction = 0, Fraction(0)
        else:
            significand, power = np.frexp(abs(value))
            exponent, fraction = int(power) - 1 + 16383, 2 * Fraction(float(significand)) - 1
        if bits == 128:
            whole = int(fraction * 2**112) | (sign | exponent) << 112
            return whole.to_bytes(16, "little")
        leading = 0 if value == 0 else 1 << 63
        return (
            (leading | int(fraction * 2**63)).to_bytes(8, "little")
            + struct.pack("<H", sign | exponent)
            + b"\1\2\0\0\0\7"
        )

    header = nibabel.Nifti1Header(endianness=order)
    header.set_data_shape((2, 2, 3))
    header["datatype"], header["bitpix"], header["vox_offset"], header["magic"] = 1536, 128, 352, b"n+1"
    numbers = [packed(value)[:: 1 if order == "<" else -1] for value in values]
    (tmp_path / "v.nii").write_bytes(header.binaryblock + bytes(4) + b"".join(numbers))
    volume = load(tmp_path / "v.nii")
    assert volume.array.dtype == np.float64
    np.testing.assert_array_equal(volume.array.ravel(), values)
    assert any("128-bit" in note for note in volume.metadata["notes"])
    assert open_source(tmp_path / "v.nii").read(box=(0, 2, 0, 2, 1, 3)).array.shape == (2, 2, 2)
