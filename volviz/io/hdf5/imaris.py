"""Imaris files (.ims): levels, channels, time points in HDF5.

Source: "Imaris 5.5 file format" (Bitplane, imaris.oxinst.com): DataSet/ResolutionLevel r/TimePoint t/Channel c/Data,
DataSetInfo with attributes that are arrays of single letters.
"""

from __future__ import annotations

from datetime import datetime
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.hdf5.reading import StoredDataset, numbers, text
from volviz.io.pyramid import StoredLevel, pyramid_source
from volviz.io.reader import stem
from volviz.io.units import length_unit
from volviz.volume_data.description import Channel

if TYPE_CHECKING:
    from collections.abc import Sequence

    import h5py
    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.pyramid import Index
    from volviz.io.reader import LoadRequest


def is_imaris(file: h5py.File) -> bool:
    """Whether an HDF5 file is one of Imaris."""
    return "DataSetInfo" in file and "DataSet/ResolutionLevel 0/TimePoint 0/Channel 0/Data" in file


def imaris_source(request: LoadRequest, file: h5py.File, suffixes: tuple[str, ...]) -> FileSource:
    """Levels by their extents, channels with names, colours and windows, times.

    Raises
    ------
    LoadError
        Sizes that do not fit.
    """
    about = file["DataSetInfo"]
    frames = _count(file["DataSet/ResolutionLevel 0"], "TimePoint")
    channels = _count(file["DataSet/ResolutionLevel 0/TimePoint 0"], "Channel")
    image = about.get("Image")
    low, high = (_extents(image, key) for key in ("ExtMin", "ExtMax"))
    unit = length_unit(text(image.attrs.get("Unit", "um"))) if image is not None else ""
    if unit is None:
        request.note(f"Its unit of length {text(image.attrs['Unit'])!r} is not known.")
    if low is None or high is None or np.any(np.asarray(high) <= np.asarray(low)):
        request.note("The file does not say how large its voxels are; they are taken for cubes of side 1.")
        low, high = None, None
    levels, dtype, finest = [], None, None
    for number in range(_count(file["DataSet"], "ResolutionLevel")):
        owner = file[f"DataSet/ResolutionLevel {number}/TimePoint 0/Channel 0"]
        stored = owner["Data"]
        size = _size(owner, stored.shape)
        finest = finest or size
        dtype = dtype or stored.dtype
        box = (
            np.subtract(high, low) if low is not None and high is not None else np.asarray(finest, float)
        ) / size
        # extents are those of the borders of voxels; without them the first voxel of the finest level lies at 0
        first = (low if low is not None else np.full(3, -0.5)) + box / 2.0
        lattice = request.geometry(np.c_[np.diag(box), first])
        shape = (frames, channels, *size[::-1])
        levels.append(StoredLevel(shape, lattice, _Frames(StoredDataset, request, number).read))
    assert dtype is not None
    return pyramid_source(
        request,
        "TCZYX",
        levels,
        dtype,
        channels=[_channel(about.get(f"Channel {number}")) for number in range(channels)],
        times=_times(about.get("TimeInfo"), frames),
        length_unit=unit or "",
        format="Imaris",
        name=stem(request.path, suffixes),
    )


class _Frames:
    """Reads a time point and channel of a level, each of which is a data set of its own, padded to whole chunks."""

    def __init__(self, dataset: type[StoredDataset], request: LoadRequest, level: int) -> None:
        self._make = dataset
        self._path = request.path
        self._level = level

    def read(self, index: Index, request: LoadRequest) -> npt.NDArray[Any]:
        time, channel, *space = index
        name = f"DataSet/ResolutionLevel {self._level}/TimePoint {time}/Channel {channel}/Data"
        return self._make(self._path, name).read(tuple(space), request)


def _count(owner: Any, what: str) -> int:
    count = 0
    while f"{what} {count}" in owner:
        count += 1
    return count


def _size(owner: Any, stored: tuple[int, ...]) -> tuple[int, int, int]:
    """Voxels (x, y, z): those that are meant, not those that chunks were filled up with."""
    found = [numbers(owner.attrs.get(f"ImageSize{axis}"), 1) for axis in "XYZ"]
    sizes = [
        int(each[0]) if each is not None and 0 < each[0] <= have else have
        for each, have in zip(found, stored[::-1], strict=True)
    ]
    return sizes[0], sizes[1], sizes[2]


def _extents(image: Any, key: str) -> list[float] | None:
    found = [None if image is None else numbers(image.attrs.get(f"{key}{axis}"), 1) for axis in range(3)]
    known = [each[0] for each in found if each is not None]
    return known if len(known) == 3 else None


def _channel(owner: Any) -> Channel:
    if owner is None:
        return Channel()
    color = numbers(owner.attrs.get("Color"), 3)
    limits = numbers(owner.attrs.get("ColorRange"), 2)
    length = numbers(owner.attrs.get("LSMEmissionWavelength"), 1)
    red, green, blue = (min(max(v, 0.0), 1.0) for v in color) if color else (0.0, 0.0, 0.0)
    return Channel(
        text(owner.attrs.get("Name", "")),
        (red, green, blue)
        if color and text(owner.attrs.get("ColorMode", "BaseColor")) == "BaseColor"
        else None,
        (limits[0], limits[1]) if limits and limits[0] < limits[1] else None,
        length[0] if length and length[0] > 0 else None,
    )


def _times(owner: Any, count: int) -> Sequence[float] | None:
    """Seconds since the first time point."""
    if owner is None:
        return None
    found = []
    for number in range(1, count + 1):
        try:
            found.append(datetime.fromisoformat(text(owner.attrs.get(f"TimePoint{number}", ""))))
        except ValueError:
            return None
    try:
        return [(each - found[0]).total_seconds() for each in found]
    except TypeError:
        return None
