"""Small files of every format, written by libraries other than the readers under test."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import Any

import numpy as np
import SimpleITK

SPACING = (0.7, 1.1, 2.3)
ORIGIN = (-12.5, 30.25, 7.0)


def rotation(seed: int, *, mirrored: bool = False) -> np.ndarray:
    """A random orthonormal 3 x 3 matrix."""
    rng = np.random.default_rng(seed)
    matrix, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    if (np.linalg.det(matrix) < 0) != mirrored:
        matrix[:, 0] *= -1
    return matrix


def scalars(shape: tuple[int, ...] = (5, 7, 9), dtype: str = "int16", seed: int = 1) -> np.ndarray:
    """Random values over much of the type's range."""
    rng = np.random.default_rng(seed)
    kind = np.dtype(dtype)
    if kind.kind == "f":
        return rng.normal(0, 1000, shape).astype(kind)
    limits = np.iinfo(kind)
    return rng.integers(limits.min, limits.max, shape, dtype=kind.newbyteorder("="), endpoint=True)


def itk(
    path: Path, array: np.ndarray, *, direction: Any = None, compressed: bool = False, **more: Any
) -> Path:
    """Whatever SimpleITK writes: NIfTI, NRRD, MetaImage, VTK."""
    image = SimpleITK.GetImageFromArray(array, isVector=more.get("vector", False))
    if image.GetDimension() == 3:
        image.SetSpacing(more.get("spacing", SPACING))
        image.SetOrigin(more.get("origin", ORIGIN))
        if direction is not None:
            image.SetDirection(np.asarray(direction).ravel().tolist())
    SimpleITK.WriteImage(image, str(path), compressed)
    return path


def gzipped(path: Path) -> Path:
    """The file packed beside itself, ``.gz`` appended."""
    target = path.with_name(path.name + ".gz")
    target.write_bytes(gzip.compress(path.read_bytes()))
    return target


def dicom_slice(
    path: Path, pixels: np.ndarray, position: Any, *, orientation: Any = (1, 0, 0, 0, 1, 0), **tags: Any
) -> Path:
    """One uncompressed CT slice; keywords replace fields of its header, None removes them."""
    import pydicom
    from pydicom.dataset import FileMetaDataset
    from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian, generate_uid

    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = CTImageStorage
    meta.MediaStorageSOPInstanceUID = generate_uid()
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    data = pydicom.Dataset()
    data.file_meta = meta
    data.SOPClassUID, data.SOPInstanceUID = CTImageStorage, meta.MediaStorageSOPInstanceUID
    data.PatientName, data.PatientID, data.PatientBirthDate = "Secret^Person", "ID-4711", "19700101"
    data.StudyDate, data.InstitutionName = "20200202", "Secret Hospital"
    data.Modality, data.SeriesInstanceUID = "CT", "1.2.3.4.5"
    data.ImagePositionPatient = [float(v) for v in position]
    data.ImageOrientationPatient = [float(v) for v in orientation]
    data.PixelSpacing = [1.1, 0.7]
    data.SamplesPerPixel, data.PhotometricInterpretation = 1, "MONOCHROME2"
    data.Rows, data.Columns = pixels.shape[-2:]
    data.BitsAllocated = data.BitsStored = 8 * pixels.dtype.itemsize
    data.HighBit, data.PixelRepresentation = data.BitsStored - 1, int(pixels.dtype.kind == "i")
    data.RescaleSlope, data.RescaleIntercept, data.RescaleType = "1", "-1024", "HU"
    data.PixelData = np.ascontiguousarray(pixels).tobytes()
    for name, value in tags.items():
        if value is None:
            delattr(data, name)
        else:
            setattr(data, name, value)
    data.save_as(path, enforce_file_format=True)
    return path
