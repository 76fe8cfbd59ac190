"""The one table of readers. A new format is one module and one row here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from volviz.io import (
    dicom,
    hdf5,
    image_stack,
    matlab,
    metaimage,
    mrc,
    neuroimaging,
    nifti,
    npz_files,
    nrrd,
    numpy_files,
    plain_headers,
    raw,
    slc,
    tiff,
    vtk_files,
    vtk_kinds,
    zarr,
)
from volviz.io.file_source import FileSource
from volviz.io.reader import LoadRequest


@dataclass(frozen=True)
class Reader:
    """One row of the table of formats.

    Attributes
    ----------
    name : str
        What people call the format; also the label in the file dialog.
    suffixes : tuple of str
        Lower case, with the dot; the longest suffix that fits decides.
    sniff : callable(head, path) -> bool
        Whether the first bytes of a file (`HEAD_BYTES` at most, decompressed if it is gzipped) are of this
        format.
    open : callable(LoadRequest) -> FileSource
        Reads headers, as far as the format has any; imports what it needs when called.
    reads_gzip : bool
        It unpacks what gzip has packed while it reads; other packed files are unpacked beforehand.
    """

    name: str
    suffixes: tuple[str, ...]
    sniff: Callable[[bytes, Path], bool]
    open: Callable[[LoadRequest], FileSource]
    reads_gzip: bool = False

    @property
    def dialog_filter(self) -> str:
        """Entry for a file dialog: ``NIfTI (*.nii *.nii.gz)``."""
        return f"{self.name} ({' '.join('*' + s for s in self.suffixes)})"


#: Asked in this order; the raw reader comes last because it believes a name.
READERS: tuple[Reader, ...] = (
    Reader("NIfTI", nifti.SUFFIXES, nifti.sniff, nifti.open_source, reads_gzip=True),
    Reader("NRRD", nrrd.SUFFIXES, nrrd.sniff, nrrd.open_source),
    Reader("MetaImage", metaimage.SUFFIXES, metaimage.sniff, metaimage.open_source),
    Reader("VTK image", vtk_files.SUFFIXES, vtk_kinds.sniff, vtk_files.open_source),
    Reader("SLC", slc.SUFFIXES, slc.sniff, slc.open_source),
    Reader("MRC", mrc.SUFFIXES, mrc.sniff, mrc.open_source),
    Reader("MGH", neuroimaging.MGH_SUFFIXES, neuroimaging.sniff_mgh, neuroimaging.open_mgh, reads_gzip=True),
    # before HDF5, in which MINC 2 is kept
    Reader("MINC", neuroimaging.MINC_SUFFIXES, neuroimaging.sniff_minc, neuroimaging.open_minc),
    Reader(
        "AFNI", neuroimaging.AFNI_SUFFIXES, neuroimaging.sniff_afni, neuroimaging.open_afni, reads_gzip=True
    ),
    Reader("PAR/REC", neuroimaging.PARREC_SUFFIXES, neuroimaging.sniff_parrec, neuroimaging.open_parrec),
    Reader(
        "GIPL",
        plain_headers.GIPL_SUFFIXES,
        plain_headers.sniff_gipl,
        plain_headers.open_gipl,
        reads_gzip=True,
    ),
    Reader(
        "Interfile",
        plain_headers.INTERFILE_SUFFIXES,
        plain_headers.sniff_interfile,
        plain_headers.open_interfile,
    ),
    # before TIFF: the first 128 bytes of a DICOM file are free and often hold a TIFF header
    Reader("DICOM", dicom.SUFFIXES, dicom.sniff, dicom.open_source, reads_gzip=True),
    Reader("Zarr", zarr.SUFFIXES, zarr.sniff, zarr.open_source),
    Reader("HDF5", hdf5.SUFFIXES, hdf5.sniff, hdf5.open_source),
    Reader("MATLAB", matlab.SUFFIXES, matlab.sniff, matlab.open_source),
    Reader("NumPy archive", npz_files.SUFFIXES, npz_files.sniff, npz_files.open_source),
    Reader("TIFF", tiff.SUFFIXES, tiff.sniff, tiff.open_source),
    Reader("Pictures", image_stack.SUFFIXES, image_stack.sniff, image_stack.open_source),
    Reader("NumPy", numpy_files.SUFFIXES, numpy_files.sniff, numpy_files.open_source),
    Reader("Raw", raw.SUFFIXES, raw.sniff, raw.open_source, reads_gzip=True),
)
