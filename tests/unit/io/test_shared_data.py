"""Real files that the project may not ship; skipped where they are not at hand."""

from __future__ import annotations

import numpy as np
import pytest

from volviz.errors import LoadError
from volviz.io import load

#: Array shape (z, y, x), type, spacing (x, y, z), range: what an independent reader said.
KNOWN = {
    "engine.nii.gz": ((128, 256, 256), "uint8", (1, 1, 1), (0, 255)),
    "bonsai.nii.gz": ((256, 256, 256), "uint8", (1, 1, 1), (0, 255)),
    "3DCT_lung.mha": ((129, 157, 115), "int16", (1.366, 1.366, 2.5), (-1255, 1474)),
    "dicom_ct_head": ((93, 64, 64), "int16", (3.2, 3.2, 1.5), (0, 3926)),
    "FLAIR.nrrd": ((140, 160, 124), "uint8", (1, 1, 1), (0, 255)),
    "pcasl.nii.gz": ((20, 68, 52), "int16", (3, 3, 6), None),
    "raw/tooth.nhdr": ((161, 94, 103), "uint16", None, (0, 1300)),
    "raw/male_128x256x256_uint8.raw.gz": ((256, 256, 128), "uint8", (1, 1, 1), (1, 254)),
    "mri-stack-calibrated.tif": ((27, 226, 186), "uint8", (1, 1, 5), (0, 255)),
    "xyzct-mitosis.tif": ((5, 196, 171), "uint16", None, None),
    "hydrogenAtom.mha": ((128, 128, 128), "uint8", (1, 1, 1), None),
    "marschnerlobb.mha": ((43, 43, 43), "uint8", (1, 1, 1), None),
    "nucleon.mha": ((41, 41, 41), "uint8", (1, 1, 1), None),
}


@pytest.mark.parametrize("name", KNOWN)
def test_real_files_have_the_known_size_type_spacing_and_range(shared_data, name):
    shape, dtype, spacing, limits = KNOWN[name]
    volume = load(shared_data / name)
    assert volume.array.shape == shape
    assert volume.array.dtype == np.dtype(dtype)
    if spacing is not None:
        assert volume.spacing == pytest.approx(spacing, abs=2e-3)
    if limits is not None:
        assert volume.range == limits


def test_the_range_over_all_time_points_is_the_known_one(shared_data):
    ranges = [load(shared_data / "pcasl.nii.gz", time=t).range for t in range(10)]
    assert (min(low for low, _ in ranges), max(high for _, high in ranges)) == (0, 2640)
    both = [
        load(shared_data / "xyzct-mitosis.tif", time=t, channel=c).range for t in range(3) for c in range(2)
    ]
    assert (min(low for low, _ in both), max(high for _, high in both)) == (1576, 51107)


def test_a_raw_file_is_read_by_hints(shared_data):
    volume = load(shared_data / "raw" / "walnut.raw", dims=(128, 96, 114), dtype="uint16")
    assert volume.range == (0, 22526)
    same = load(shared_data / "raw" / "tooth.raw", dims=(103, 94, 161), dtype="uint16", endian="big")
    np.testing.assert_array_equal(same.array, load(shared_data / "raw" / "tooth.nhdr").array)


@pytest.mark.parametrize(
    "name", ["FLAIR.nrrd", "3DCT_lung.mha", "bonsai.nii.gz", "engine.nii.gz", "nucleon.mha"]
)
def test_simpleitk_reads_the_same_values_at_the_same_places(shared_data, name):
    import SimpleITK

    image, volume = SimpleITK.ReadImage(str(shared_data / name)), load(shared_data / name)
    np.testing.assert_array_equal(volume.array, SimpleITK.GetArrayViewFromImage(image))
    corner = tuple(n - 1 for n in volume.dimensions)
    np.testing.assert_allclose(
        (volume.index_to_world @ (*corner, 1))[:3], image.TransformIndexToPhysicalPoint(corner), atol=1e-3
    )


def test_big_endian_floats_with_nan_are_read_and_the_nan_counted(shared_data):
    import nibabel

    volume = load(shared_data / "nan_float_big_endian.nii")
    wanted = np.asarray(nibabel.load(shared_data / "nan_float_big_endian.nii").dataobj)
    np.testing.assert_array_equal(volume.array, wanted.T)
    assert volume.nonfinite_count == np.isnan(wanted).sum() > 0


def test_the_sheared_ct_is_resampled_and_it_is_said(shared_data):
    volume = load(shared_data / "shear.nii.gz")
    assert volume.shear == pytest.approx(0, abs=1e-6)
    assert any("sheared by 18.5 degrees" in note for note in volume.metadata["notes"])


@pytest.mark.parametrize("name", ["not-nifti.nii", "nifti1.hdr", "MR_truncated.dcm", "badVR.dcm", "."])
def test_bad_files_are_refused_in_words(shared_data, name, capfd):
    with pytest.raises(LoadError) as caught:
        load(shared_data / "bad" / name)
    assert "\n" not in str(caught.value)
    assert capfd.readouterr() == ("", "")
