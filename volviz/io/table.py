"""The one table of readers. A new format is one module and one row here."""

from __future__ import annotations

from volviz.io import dicom, metaimage, nifti, nrrd, numpy_files, raw, tiff, vtk_files
from volviz.io.reader import Reader

#: Asked in this order; the raw reader comes last because it believes a name.
READERS: tuple[Reader, ...] = (
    Reader("NIfTI", nifti.SUFFIXES, nifti.sniff, nifti.open_source),
    Reader("NRRD", nrrd.SUFFIXES, nrrd.sniff, nrrd.open_source),
    Reader("MetaImage", metaimage.SUFFIXES, metaimage.sniff, metaimage.open_source),
    Reader("VTK image", vtk_files.SUFFIXES, vtk_files.sniff, vtk_files.open_source),
    # before TIFF: the first 128 bytes of a DICOM file are free and often hold a TIFF header
    Reader("DICOM", dicom.SUFFIXES, dicom.sniff, dicom.open_source),
    Reader("TIFF", tiff.SUFFIXES, tiff.sniff, tiff.open_source),
    Reader("NumPy", numpy_files.SUFFIXES, numpy_files.sniff, numpy_files.open_source),
    Reader("Raw", raw.SUFFIXES, raw.sniff, raw.open_source),
)
