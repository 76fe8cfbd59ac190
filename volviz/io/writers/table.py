"""The one table of writers. A new format is one function and one row here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from volviz.io.writers import metaimage, nifti, nrrd, numpy_files, ome_zarr, tiff, vti

if TYPE_CHECKING:
    from volviz.io.writers.content import Content
    from volviz.io.writers.request import SaveRequest

#: What a file can say of its values beside the values themselves.
Fact = Literal["spacing", "origin", "direction", "length unit", "unit", "channel names", "colours", "labels"]

_EVERY = "u1 i1 u2 i2 u4 i4 u8 i8 f4 f8"


@dataclass(frozen=True)
class Writer:
    """One row of the table of formats that are written.

    Attributes
    ----------
    id : str
        For ``format=`` and ``--format``.
    name : str
        What people call the format.
    suffixes : tuple of str
        Lower case, with the dot; the longest one that fits a name decides, then the order of the table.
    write : callable(Content, SaveRequest) -> None
        Writes to the path of the request; imports what it needs when called.
    types : str
        Types of values that it holds, as NumPy abbreviates them.
    keeps : frozenset of str
        What it can say of its values (`Fact`); the rest is lost, which `save` tells.
    seconds : {"any", "even", "even from 0", "none"}
        Which times of time points it can say.
    time : bool
        It holds several time points.
    folder : bool
        It is a folder, not a file.
    """

    id: str
    name: str
    suffixes: tuple[str, ...]
    write: Callable[[Content, SaveRequest], None]
    keeps: frozenset[Fact]
    types: str = _EVERY
    seconds: Literal["any", "even", "even from 0", "none"] = "none"
    time: bool = True
    folder: bool = False

    @property
    def dialog_filter(self) -> str:
        """Entry for a file dialog: ``NIfTI (*.nii *.nii.gz)``."""
        return f"{self.name} ({' '.join('*' + s for s in self.suffixes)})"

    def takes(self, dtype: np.dtype[np.generic]) -> bool:
        """Whether it holds values of this type."""
        return dtype.str[1:] in self.types.split()


_PLACE: frozenset[Fact] = frozenset({"spacing", "origin", "direction"})

WRITERS: tuple[Writer, ...] = (
    Writer("nrrd", "NRRD", (".nrrd",), nrrd.write, _PLACE | {"length unit", "unit", "colours"}, seconds="even"),
    Writer(
        "nifti", "NIfTI", (".nii.gz", ".nii"), nifti.write, _PLACE | {"length unit", "colours"}, seconds="even"
    ),
    Writer("metaimage", "MetaImage", (".mha",), metaimage.write, _PLACE | {"length unit", "colours"}),
    Writer("vti", "VTK image", (".vti",), vti.write, _PLACE | {"channel names", "colours"}, time=False),
    Writer(
        "imagej", "TIFF for ImageJ", (".tif", ".tiff"), tiff.write_imagej,
        frozenset({"spacing", "length unit", "colours"}), types="u1 u2 f4", seconds="even from 0",
    ),
    Writer(
        "ome-tiff", "OME-TIFF", (".ome.tif", ".ome.tiff", ".tif", ".tiff"), tiff.write_ome,
        frozenset({"spacing", "length unit", "channel names", "colours"}), types="u1 i1 u2 i2 u4 i4 f4 f8",
        seconds="any",
    ),
    Writer(
        "ome-zarr", "OME-Zarr 0.5", (".ome.zarr", ".zarr"), ome_zarr.write_05,
        frozenset({"spacing", "origin", "length unit", "channel names", "labels"}), seconds="even", folder=True,
    ),
    Writer(
        "ome-zarr-0.4", "OME-Zarr 0.4", (".ome.zarr", ".zarr"), ome_zarr.write_04,
        frozenset({"spacing", "origin", "length unit", "channel names", "labels"}), seconds="even", folder=True,
    ),
    Writer("npy", "NumPy", (".npy",), numpy_files.write, frozenset({"colours"})),
)  # fmt: skip
