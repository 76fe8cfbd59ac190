"""BigDataViewer's HDF5 files, with the XML beside them that places their images.

Source: "BigDataViewer", file formats (imagej.net/plugins/bdv): tNNNNN/sNN/L/cells, sNN/resolutions; SpimData in XML.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import LoadError
from volviz.io.entries import Entry, choose_entry
from volviz.io.hdf5.reading import StoredDataset, numbers
from volviz.io.pyramid import StoredLevel, pyramid_source
from volviz.io.reader import stem
from volviz.io.units import length_unit
from volviz.volume_data.description import Channel

if TYPE_CHECKING:
    from pathlib import Path
    from xml.etree.ElementTree import Element

    import h5py
    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.pyramid import Index
    from volviz.io.reader import LoadRequest

_FRAME = re.compile(r"t(\d{5})$")
_SETUP = re.compile(r"s(\d{2,})$")


@dataclass(frozen=True)
class Setup:
    """One view of the specimen: a channel, angle or tile.

    Attributes
    ----------
    name : str
    unit : str
    affine : ndarray of shape (3, 4)
        From voxels (x, y, z) of its finest level to the world.
    """

    name: str = ""
    unit: str = ""
    affine: npt.NDArray[np.float64] = field(default_factory=lambda: np.eye(4)[:3])


def is_bigdataviewer(file: h5py.File) -> bool:
    """Whether an HDF5 file is one of BigDataViewer."""
    return any(_FRAME.match(name) for name in file) and any(_SETUP.match(name) for name in file)


def bigdataviewer_source(
    request: LoadRequest, path: Path, file: h5py.File, xml: Element | None, suffixes: tuple[str, ...]
) -> FileSource:
    """Levels of a setup; setups that share size and place are channels.

    Parameters
    ----------
    path : Path
        Of the HDF5 file.
    xml : Element or None
        What describes it.

    Raises
    ------
    LoadError
        It holds no image.
    """
    frames = sorted(name for name in file if _FRAME.match(name))
    names = [name for name in sorted(file) if _SETUP.match(name) and f"{frames[0]}/{name}/0/cells" in file]
    if not names:
        raise request.error("it holds no image at its first time point; the file is incomplete.")
    described = {} if xml is None else setups_of(request, xml)
    if xml is None:
        request.note("No XML beside it says how large its voxels are; they are taken for cubes of side 1.")
    views = [_view(file, frames[0], name, described.get(int(name[1:]), Setup())) for name in names]
    groups: list[list[_View]] = []
    for view in views:
        group = next((group for group in groups if view.goes_with(group[0])), None)
        if group is None:
            groups.append([view])
        else:
            group.append(view)
    entries = [
        Entry(first.name, (len(frames), len(group), *first.shapes[0]), first.dtype.name, first.setup.name)
        for group in groups
        for first in group[:1]
    ]
    group = groups[choose_entry(request, entries)]
    first = group[0]
    factors = _factors(request, file, first)
    levels = []
    for number, (shape, factor) in enumerate(zip(first.shapes, factors, strict=False)):
        # a voxel of a level is the mean of a block, whose middle lies between the first and the last voxel
        matrix = first.setup.affine.copy()
        matrix[:, 3] += matrix[:, :3] @ ((factor - 1.0) / 2.0)
        matrix[:, :3] *= factor
        cells = _Cells(path, frames, [view.name for view in group], number, first.dtype)
        levels.append(StoredLevel((len(frames), len(group), *shape), request.geometry(matrix), cells.read))
    names = [view.setup.name for view in group]
    return pyramid_source(
        request,
        "TCZYX",
        levels,
        first.dtype,
        channels=[Channel(name) for name in names] if any(names) else (),
        length_unit=first.setup.unit,
        format="BigDataViewer",
        name=stem(request.path, suffixes),
        entries=entries,
    )


@dataclass(frozen=True)
class _View:
    """A setup as it is stored: the sizes (z, y, x) of its levels and the type of its values."""

    name: str
    shapes: list[tuple[int, ...]]
    dtype: np.dtype[Any]
    setup: Setup

    def goes_with(self, other: _View) -> bool:
        """Whether both are channels of one image."""
        same = (self.shapes, self.dtype) == (other.shapes, other.dtype)
        return same and np.allclose(self.setup.affine, other.setup.affine)


def _view(file: h5py.File, frame: str, name: str, setup: Setup) -> _View:
    shapes: list[tuple[int, ...]] = []
    while f"{frame}/{name}/{len(shapes)}/cells" in file:
        shapes.append(tuple(map(int, file[f"{frame}/{name}/{len(shapes)}/cells"].shape)))
    stored = file[f"{frame}/{name}/0/cells"].dtype
    # the format began with unsigned numbers alone, stored as signed ones; newer programs write what they mean
    return _View(name, shapes, np.dtype(np.uint16) if stored == np.int16 else stored, setup)


def _factors(request: LoadRequest, file: h5py.File, view: _View) -> npt.NDArray[np.float64]:
    """Voxels (x, y, z) of the finest level in one of each level."""
    listed = f"{view.name}/resolutions"
    factors = np.asarray(file[listed][()] if listed in file else np.ones((1, 3)), np.float64)
    if (
        factors.ndim != 2
        or factors.shape[1:] != (3,)
        or not np.all(np.isfinite(factors))
        or np.min(factors) <= 0
    ):
        raise request.error("the factors of its levels are unreadable; the file is damaged.")
    return factors


class _Cells:
    """Reads a time point and setup of a level."""

    def __init__(
        self, path: Path, frames: list[str], setups: list[str], level: int, dtype: np.dtype[Any]
    ) -> None:
        self._path = path
        self._frames = frames
        self._setups = setups
        self._level = level
        self._dtype = dtype

    def read(self, index: Index, request: LoadRequest) -> npt.NDArray[Any]:
        time, setup, *space = index
        assert isinstance(time, int)
        assert isinstance(setup, int)
        name = f"{self._frames[time]}/{self._setups[setup]}/{self._level}/cells"
        return StoredDataset(self._path, name, self._dtype).read(tuple(space), request)


def xml_of(path: Path) -> Element:
    """The root of a SpimData file.

    Raises
    ------
    LoadError
        It is no XML, or none of this kind.
    """
    # expat neither fetches external entities nor expands internal ones without bound
    import xml.etree.ElementTree as ET

    try:
        root = ET.fromstring(path.read_bytes())  # noqa: S314
    except (ET.ParseError, ValueError, LookupError):
        raise LoadError(f"{path.name}: this XML file is damaged; get it again.") from None
    if root.tag != "SpimData":
        raise LoadError(
            f"{path.name}: this XML file describes no BigDataViewer data set; open the data itself."
        )
    return root


def data_of(root: Element, path: Path) -> Path:
    """The HDF5 file that a SpimData file names.

    Raises
    ------
    LoadError
        The data is of another kind, or not there.
    """
    loader = root.find("SequenceDescription/ImageLoader")
    kind = "" if loader is None else loader.get("format", "")
    if kind != "bdv.hdf5" or loader is None:
        raise LoadError(
            f"{path.name}: its images are stored as {kind or 'nothing known'}, not as HDF5; "
            "open the folder with the data."
        )
    found = (loader.findtext("hdf5") or "").strip()
    folder = (root.findtext("BasePath") or ".").strip()
    data = path.parent / folder / found
    if not found or not data.is_file():
        raise LoadError(
            f"{path.name}: the file {found!r} with its images does not lie beside it; put both into one folder."
        )
    return data


def setups_of(request: LoadRequest, root: Element) -> dict[int, Setup]:
    """Names, voxel sizes and places of the setups, by number; places are those of the first time point."""
    found: dict[int, Setup] = {}
    for element in root.iterfind("SequenceDescription/ViewSetups/ViewSetup"):
        number = numbers(element.findtext("id", ""), 1)
        if number is None:
            continue
        size = numbers(element.findtext("voxelSize/size", ""), 3)
        affine = np.eye(4)[:3]
        if size is not None and min(size) > 0:
            affine = np.c_[np.diag(size), np.zeros(3)]
        unit = length_unit(element.findtext("voxelSize/unit", ""))
        name = (element.findtext("name") or "").strip()
        found[int(number[0])] = Setup(name, unit or "", affine)
    seen: set[int] = set()
    for element in root.iterfind("ViewRegistrations/ViewRegistration"):
        number = numbers(element.get("setup", ""), 1)
        if number is None or int(number[0]) in seen:
            continue
        seen.add(int(number[0]))
        matrix = np.eye(4)
        for step in element.iterfind("ViewTransform/affine"):
            rows = numbers(step.text or "", 12)
            if rows is None:
                request.note("A transform of its XML is unreadable and left out.")
                continue
            # the first one listed is applied last
            matrix = matrix @ np.vstack([np.reshape(rows, (3, 4)), (0, 0, 0, 1)])
        known = found.get(int(number[0]), Setup())
        if len(element):
            found[int(number[0])] = Setup(known.name, known.unit, matrix[:3])
    return found
