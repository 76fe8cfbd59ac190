"""The one table of readers. A new format is one module and one row here.

The rows are plain values, and a module is imported when a file may be of its kind: importing all of them takes longer
than reading most volumes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from typing import TYPE_CHECKING, Any

from volviz.io import endings

if TYPE_CHECKING:
    from pathlib import Path

    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest

#: Anywhere in the first bytes, in small letters or capitals.
ANYWHERE = -1


@dataclass(frozen=True)
class Reader:
    """One row of the table of formats.

    Attributes
    ----------
    name : str
        What people call the format; also the label in the file dialog.
    suffixes : tuple of str
        Lower case, with the dot; the longest suffix that fits decides.
    module : str
        Below `volviz.io`. Its ``sniff(head, path)`` says whether the first bytes of a file (`HEAD_BYTES` at most,
        decompressed if it is gzipped) are of this format, its ``open_source(LoadRequest)`` reads headers, as far as
        the format has any, and gives the source.
    marks : tuple of (place, bytes)
        A file whose first bytes have none of these there, and whose name has none of the suffixes, is none of this
        format, and the module is not asked; without marks it is asked about every file.
    kind : str
        Of a module with several formats: ``sniff_<kind>`` and ``open_<kind>`` are meant.
    reads_gzip : bool
        It unpacks what gzip has packed while it reads; other packed files are unpacked beforehand.
    reads_folders : bool
        It is asked about folders, too.
    """

    name: str
    suffixes: tuple[str, ...]
    module: str
    marks: tuple[tuple[int, bytes], ...] = ()
    kind: str = ""
    reads_gzip: bool = False
    reads_folders: bool = False

    @property
    def dialog_filter(self) -> str:
        """Entry for a file dialog: ``NIfTI (*.nii *.nii.gz)``."""
        return f"{self.name} ({' '.join('*' + s for s in self.suffixes)})"

    def sniff(self, head: bytes, path: Path) -> bool:
        """Whether a file or folder is of this format, by its first bytes (of a folder none)."""
        if path.is_dir():
            return self.reads_folders and bool(self._module.sniff(head, path))
        if self.marks and not self._is_marked(head) and not path.name.lower().endswith(self.suffixes):
            return False
        return bool(getattr(self._module, f"sniff_{self.kind}" if self.kind else "sniff")(head, path))

    def open(self, request: LoadRequest) -> FileSource:
        """The source of a file or folder."""
        opening = getattr(self._module, f"open_{self.kind}" if self.kind else "open_source")
        source: FileSource = opening(request)
        return source

    @cached_property
    def _module(self) -> Any:
        return import_module(f"volviz.io.{self.module}")

    def _is_marked(self, head: bytes) -> bool:
        return any(
            mark in head.lower() if place == ANYWHERE else head.startswith(mark, place)
            for place, mark in self.marks
        )


_HDF5 = b"\x89HDF\r\n\x1a\n"
_ZIP = (0, b"PK\x03\x04")

#: Asked in this order; the raw reader comes last because it believes a name.
READERS: tuple[Reader, ...] = (
    Reader(
        "NIfTI", endings.NIFTI, "nifti", reads_gzip=True,
        marks=tuple((0, size.to_bytes(4, order)) for size in (348, 540) for order in ("little", "big")),
    ),
    Reader("NRRD", endings.NRRD, "nrrd", ((0, b"NRRD000"),)),
    Reader("MetaImage", endings.METAIMAGE, "metaimage", ((ANYWHERE, b"objecttype"), (ANYWHERE, b"ndims"))),
    Reader("VTK image", endings.VTK, "vtk_files", ((0, b"# vtk DataFile"), (ANYWHERE, b"<vtkfile"))),
    Reader("SLC", endings.SLC, "slc", ((ANYWHERE, b"11111"),)),
    Reader("MRC", endings.MRC, "mrc", ((208, b"MAP"),)),
    Reader("MGH", endings.MGH, "neuroimaging", ((0, b"\0\0\0\x01"),), "mgh", reads_gzip=True),
    # before HDF5, in which MINC 2 is kept
    Reader("MINC", endings.MINC, "neuroimaging", ((0, b"CDF"), (0, _HDF5)), "minc"),
    Reader("AFNI", endings.AFNI, "neuroimaging", ((ANYWHERE, b"-attribute"),), "afni", reads_gzip=True),
    Reader("PAR/REC", endings.PARREC, "neuroimaging", ((0, b"# === DATA DESCRIPTION"),), "parrec"),
    Reader(
        "GIPL", endings.GIPL, "plain_headers", ((252, b"\xef\xff\xe9\xb0"), (252, b"\x2a\xe3\x89\xb8")), "gipl",
        reads_gzip=True,
    ),
    Reader("Interfile", endings.INTERFILE, "plain_headers", ((ANYWHERE, b"interfile"),), "interfile"),
    # before TIFF: the first 128 bytes of a DICOM file are free and often hold a TIFF header
    Reader(
        "DICOM", endings.DICOM, "dicom", ((128, b"DICM"), (0, b"\x02\0"), (0, b"\x08\0")),
        reads_gzip=True, reads_folders=True,
    ),
    Reader("Zarr", endings.ZARR, "zarr", (_ZIP,), reads_folders=True),
    Reader(
        "HDF5", endings.HDF5, "hdf5",
        (*((place, _HDF5) for place in (0, 512, 1024, 2048)), (ANYWHERE, b"<spimdata")),
    ),
    Reader("MATLAB", endings.MATLAB, "matlab", ((0, b"MATLAB"),)),
    Reader("NumPy archive", endings.NPZ, "npz_files", (_ZIP,)),
    Reader("TIFF", endings.TIFF, "tiff", ((0, b"II"), (0, b"MM"))),
    Reader(
        "Pictures", endings.PICTURES, "image_stack", ((0, b"\x89PNG"), (0, b"\xff\xd8\xff"), (0, b"BM")),
        reads_folders=True,
    ),
    Reader("NumPy", endings.NUMPY, "numpy_files", ((0, b"\x93NUMPY"),)),
    Reader("Raw", endings.RAW, "raw", reads_gzip=True),
)  # fmt: skip
