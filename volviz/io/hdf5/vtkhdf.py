"""VTKHDF files (.vtkhdf): images of VTK in HDF5.

Source: "VTKHDF File Format", docs.vtk.org: a group VTKHDF with the attributes Type, WholeExtent, Origin, Spacing and
Direction; the arrays have the order z, y, x, before them time steps, behind them components.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.entries import Entry, choose_entry
from volviz.io.hdf5.finding import is_of_numbers
from volviz.io.hdf5.reading import StoredDataset, numbers, text
from volviz.io.pyramid import StoredLevel, pyramid_source
from volviz.io.reader import stem
from volviz.volume_data.references import content_id

if TYPE_CHECKING:
    import h5py
    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.pyramid import Index
    from volviz.io.reader import LoadRequest

_GROUP = "VTKHDF"
_DATA = ("PointData", "CellData")


def is_vtkhdf(file: h5py.File) -> bool:
    """Whether an HDF5 file is one of VTK."""
    return _GROUP in file


def vtkhdf_source(request: LoadRequest, file: h5py.File, suffixes: tuple[str, ...]) -> FileSource:
    """The array at points or cells that is asked for, else the active or the largest one.

    Raises
    ------
    LoadError
        No image, no arrays, sizes that do not fit.
    """
    group = file[_GROUP]
    kind = text(group.attrs.get("Type", ""))
    if kind != "ImageData":
        raise request.error(f"it holds {kind or 'nothing that it names'}, no image; save it as ImageData.")
    extent = numbers(group.attrs.get("WholeExtent"), 6)
    if extent is None or any(high < low for low, high in zip(extent[::2], extent[1::2], strict=True)):
        raise request.error("its header gives no size that a volume can have; the file is damaged.")
    points = tuple(int(high - low) + 1 for low, high in zip(extent[::2], extent[1::2], strict=True))[::-1]
    cells = tuple(max(n - 1, 1) for n in points)
    steps = int((numbers(group["Steps"].attrs.get("NSteps"), 1) or [0])[0]) if "Steps" in group else 0
    entries = _entries(group, steps)
    if not entries:
        raise request.error(
            "the VTK file holds no numbers at its points or cells; save it with an array of scalars."
        )
    active = f"PointData/{text(group['PointData'].attrs.get('Scalars', ''))}" if "PointData" in group else ""
    names = [entry.name for entry in entries]
    if request.hints.series is None and active in names:
        chosen = entries[names.index(active)]
        if len(entries) > 1:
            request.note(f"The active array {chosen.words} is shown; series= chooses another.")
    else:
        chosen = entries[choose_entry(request, entries, what="array")]
    is_cell = chosen.name.startswith("CellData/")
    offsets = _offsets(group, chosen.name, steps)
    stored = chosen.sizes[1:] if steps else chosen.sizes
    wanted = cells if is_cell else points
    if stored[:3] != wanted or (offsets and not 0 <= min(offsets) <= max(offsets) < chosen.sizes[0]):
        raise request.error("its values do not fit its dimensions; the file is damaged or cut off.")
    if is_cell:
        request.note("The values belong to cells; they are shown at the middles of the cells.")
    direction = numbers(group.attrs.get("Direction"), 9) or list(np.eye(3).flat)
    spacing = numbers(group.attrs.get("Spacing"), 3) or [1.0, 1.0, 1.0]
    with np.errstate(over="ignore", invalid="ignore"):
        matrix = np.reshape(direction, (3, 3)) * np.asarray(spacing)
        # the value of a cell lies in its middle
        first = np.array(extent[::2]) + (0.5 if is_cell else 0.0)
        start = np.asarray(numbers(group.attrs.get("Origin"), 3) or [0.0, 0.0, 0.0]) + matrix @ first
    dataset = group[chosen.name]
    return pyramid_source(
        request,
        ("T" if steps else "") + "ZYX" + "S" * (len(stored) - 3),
        [
            StoredLevel(
                (steps, *stored) if steps else stored,
                request.geometry(np.c_[matrix, start]),
                _Steps(StoredDataset(request.path, f"{_GROUP}/{chosen.name}"), offsets).read,
            )
        ],
        dataset.dtype,
        times=numbers(group["Steps/Values"][()], steps) if steps and "Values" in group["Steps"] else None,
        format="VTKHDF",
        name=stem(request.path, suffixes),
        content=content_id(str(request.path)),
        entries=entries if len(entries) > 1 else (),
    )


@dataclass(frozen=True)
class _Steps:
    """Reads a time step where it is stored: steps with the same values may share one place."""

    dataset: StoredDataset
    offsets: list[int]

    def read(self, index: Index, request: LoadRequest) -> npt.NDArray[Any]:
        if self.offsets and isinstance(index[0], int):
            index = (self.offsets[index[0]], *index[1:])
        return self.dataset.read(index, request)


def _offsets(group: Any, name: str, steps: int) -> list[int]:
    """Where each step lies along the first axis of an array; empty without steps."""
    owner, _, array = name.partition("/")
    path = f"Steps/{owner}Offsets/{array}"
    found = numbers(group[path][()], steps) if path in group else None
    return list(range(steps)) if found is None else [int(n) for n in found]


def _entries(group: Any, steps: int) -> list[Entry]:
    """The arrays of numbers at points and at cells."""
    axes = 4 if steps else 3
    return [
        Entry(f"{owner}/{name}", tuple(map(int, group[owner][name].shape)), group[owner][name].dtype.name)
        for owner in _DATA
        if owner in group
        for name in group[owner]
        if is_of_numbers(group[owner][name]) and group[owner][name].ndim in (axes, axes + 1)
    ]
