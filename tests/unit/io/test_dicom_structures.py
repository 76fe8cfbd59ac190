"""Outlines of a structure set become labels, on the lattice of their images or one of their own."""

from __future__ import annotations

import numpy as np
import pydicom
import pytest

import volviz
from tests.unit.io.writers import dicom_slice, rotation, scalars
from volviz.errors import LoadError

SHAPE = (5, 40, 50)
SPACING = np.array([0.8, 1.2, 2.5])
TURN = rotation(4)
START = np.array([5.0, -20, 30])


def world(points):
    """World positions of indices (i, j, k)."""
    return START + (np.asarray(points) * SPACING) @ TURN.T


def circle(middle, radius, k, *, corners=120):
    """Corners in index coordinates of a circle in units of columns and rows."""
    angle = np.linspace(0, 2 * np.pi, corners, endpoint=False)
    return np.stack(
        [middle[0] + radius * np.cos(angle), middle[1] + radius * np.sin(angle), np.full(corners, k)], 1
    )


def written(path, structures, *, series="1.2.3.4.5", kind="CLOSED_PLANAR"):
    """`structures`: number, name, colour and outlines in world coordinates."""
    meta = pydicom.dataset.FileMetaDataset()
    meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
    meta.MediaStorageSOPClassUID = pydicom.uid.RTStructureSetStorage
    meta.MediaStorageSOPInstanceUID = "1.2.3"
    data = pydicom.Dataset()
    data.file_meta = meta
    data.SOPClassUID, data.SOPInstanceUID, data.Modality = meta.MediaStorageSOPClassUID, "1.2.3", "RTSTRUCT"
    data.PatientName = "Secret^Person"
    image, study, frame = pydicom.Dataset(), pydicom.Dataset(), pydicom.Dataset()
    image.SeriesInstanceUID = series
    study.RTReferencedSeriesSequence = [image]
    frame.RTReferencedStudySequence = [study]
    data.ReferencedFrameOfReferenceSequence = [frame]
    data.StructureSetROISequence, data.ROIContourSequence = [], []
    for number, name, color, outlines in structures:
        roi, owner = pydicom.Dataset(), pydicom.Dataset()
        roi.ROINumber, roi.ROIName = number, name
        owner.ReferencedROINumber, owner.ROIDisplayColor = number, list(color)
        owner.ContourSequence = []
        for outline in outlines:
            contour = pydicom.Dataset()
            contour.ContourGeometricType, contour.NumberOfContourPoints = kind, len(outline)
            contour.ContourData = [f"{v:.6f}" for v in np.ravel(outline)]
            owner.ContourSequence.append(contour)
        data.StructureSetROISequence.append(roi)
        data.ROIContourSequence.append(owner)
    data.save_as(path, enforce_file_format=True)
    return path


@pytest.fixture
def images(tmp_path):
    for k, pixels in enumerate(scalars(SHAPE)):
        dicom_slice(
            tmp_path / f"{k}.dcm", pixels, world([0, 0, k]), orientation=TURN[:, :2].T.ravel(),
            PixelSpacing=[SPACING[1], SPACING[0]],
        )  # fmt: skip
    return tmp_path


def test_outlines_are_filled_on_the_lattice_of_their_images(images):
    ring = [world(circle((20, 18), radius, 1)) for radius in (12, 6)]
    disc = [world(circle((40, 30), 5, k)) for k in (2, 3)]
    path = written(images / "rs.dcm", [(3, "ring", (255, 0, 0), ring), (7, "disc", (0, 255, 0), disc)])
    source = volviz.open(path)
    assert source.is_labels
    assert [(one.number, one.name, one.color) for one in source.labels] == [
        (3, "ring", (1.0, 0.0, 0.0)), (7, "disc", (0.0, 1.0, 0.0)),
    ]  # fmt: skip
    labels, image = source.read(), volviz.load(images)
    np.testing.assert_allclose(labels.index_to_world, image.index_to_world, atol=1e-4)
    j, i = np.mgrid[: SHAPE[1], : SHAPE[2]]
    expected = np.zeros(SHAPE)
    from_ring, from_disc = np.hypot(i - 20, j - 18), np.hypot(i - 40, j - 30)
    expected[1][(from_ring < 12) & (from_ring > 6)] = 3
    expected[2:4, from_disc < 5] = 7
    # polygons have their corners on the circles
    clear = np.ones(SHAPE, bool)
    clear[1] = np.minimum(abs(from_ring - 12), abs(from_ring - 6)) > 0.05
    clear[2:4] = abs(from_disc - 5) > 0.05
    np.testing.assert_array_equal(labels.array[clear], expected[clear])
    assert clear.mean() > 0.99
    assert "Secret" not in str(labels.metadata)
    part = source.read(box=(15, 30, 10, 30, 1, 3))
    np.testing.assert_array_equal(part.array, labels.array[1:3, 10:30, 15:30])


def test_outlines_without_images_get_a_lattice_of_their_own(tmp_path):
    outlines = [world(circle((20, 18), 10, k)) for k in range(4)]
    path = written(tmp_path / "rs.dcm", [(1, "ball", (0, 0, 255), outlines)])
    volume = volviz.load(path)
    assert "do not lie in its folder" in " ".join(volume.metadata["notes"])
    inside = np.argwhere(volume.array)[:, ::-1]
    places = np.c_[inside, np.ones(len(inside))] @ volume.index_to_world[:3].T
    index = (places - START) @ TURN / SPACING
    assert np.hypot(index[:, 0] - 20, index[:, 1] - 18).max() < 10
    area = len(inside) * np.prod(volume.spacing) / (4 * SPACING[2])
    np.testing.assert_allclose(area, np.pi * 100 * SPACING[0] * SPACING[1], rtol=0.02)
    np.testing.assert_allclose(sorted(set(np.round(index[:, 2], 3))), [0, 1, 2, 3], atol=1e-3)


def test_overlaps_and_what_encloses_nothing_are_said(images):
    outlines = [world(circle((20, 18), 10, 1))]
    two = [
        (1, "a", (0, 0, 255), outlines),
        (2, "b", (0, 0, 255), [*outlines, world(circle((20, 18), 9, 40))]),
    ]
    volume = volviz.load(written(images / "rs.dcm", two))
    assert set(np.unique(volume.array)) == {0, 2}
    notes = " ".join(volume.metadata["notes"])
    assert "overlap" in notes
    assert "1 outlines lie outside" in notes
    with pytest.raises(LoadError, match="no closed outlines"):
        volviz.load(written(images / "points.dcm", [(1, "a", (0, 0, 255), outlines)], kind="POINT"))
