"""Axes and geometry of a data set, as the conventions of several programs write them.

Sources: ilastik ("axistags", ilastik.org), PlantSeg and Fiji's HDF5 plug-ins ("element_size_um"), NeXus (NXdata,
manual.nexusformat.org), ITK (ITKImage), MATLAB 7.3.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.axes import axis_letter, usual_axes
from volviz.io.geometry import Geometry
from volviz.io.hdf5.reading import numbers, text
from volviz.io.units import converted, length_unit

if TYPE_CHECKING:
    import h5py

    from volviz.io.reader import LoadRequest

#: Differences of even positions from one another, as a fraction of their distance.
_EVEN = 1e-3


@dataclass(frozen=True)
class Lattice:
    """Axes of a data set and where its voxels lie."""

    axes: str
    geometry: Geometry = field(default_factory=Geometry)
    length_unit: str = ""
    colour: bool = False


def lattice_of(request: LoadRequest, dataset: h5py.Dataset) -> Lattice:
    """What is written beside a data set, the most explicit first."""
    named = _named_axes(request, dataset)
    axes = named or usual_axes(dataset.shape, dataset.dtype)
    colour = "S" in axes
    for look in (_itk, _element_size, _axistags_resolution, _nexus, _resolution):
        found = look(request, dataset, axes)
        if found is not None:
            geometry, unit = found
            return Lattice(axes, geometry, unit, colour)
    request.note("The file does not say how large its voxels are; they are taken for cubes of side 1.")
    return Lattice(axes, colour=colour)


def _named_axes(request: LoadRequest, dataset: h5py.Dataset) -> str:
    """Letters of the axes where the file names all of space, each once; else an empty text."""
    if "MATLAB_class" in dataset.attrs:
        request.note("MATLAB counts rows first: rows are taken for y, columns for x, pages for z.")
        return matlab_axes(dataset.shape[::-1])[::-1]
    names: list[Any] = [str(tag.get("key", "")) for tag in _axistags(dataset)]
    if len(names) != dataset.ndim:
        names = [dimension.label for dimension in dataset.dims]
    if not any(names):
        names = _nexus_axes(dataset)
    letters = "".join(axis_letter(name) for name in names)
    known = letters.replace("-", "")
    fits = len(letters) == dataset.ndim and set("ZYX") <= set(letters) and len(set(known)) == len(known)
    return letters if fits else ""


def matlab_axes(shape: Sequence[int]) -> str:
    """Axes of an array of MATLAB by its sizes there: rows, columns, pages, and a fourth one."""
    if len(shape) == 4 and shape[2] in (3, 4):
        # a stack of colour images
        return "YXSZ"
    return "YXZTC"[: len(shape)]


def _spatial(axes: str, values: Sequence[float]) -> tuple[float, float, float]:
    """Values (x, y, z) of those in the order of the axes of space."""
    by_letter = dict(zip((letter for letter in axes if letter in "XYZ"), values, strict=True))
    return by_letter["X"], by_letter["Y"], by_letter["Z"]


def _placed(
    request: LoadRequest, steps: Sequence[float], starts: Sequence[float] = (0, 0, 0)
) -> Geometry | None:
    return request.geometry(np.c_[np.diag(steps), starts]) if all(steps) else None


def _itk(request: LoadRequest, dataset: h5py.Dataset, axes: str) -> tuple[Geometry, str] | None:
    owner = dataset.parent
    if not {"Spacing", "Origin", "Directions"} <= set(owner) or axes[-3:] != "ZYX":
        return None
    spacing, origin = numbers(owner["Spacing"][()], 3), numbers(owner["Origin"][()], 3)
    rows = numbers(owner["Directions"][()], 9)
    if spacing is None or origin is None or rows is None:
        return None
    # each row is the direction of an axis of the image
    return request.geometry(np.c_[np.reshape(rows, (3, 3)).T * spacing, origin]), "mm"


def _element_size(request: LoadRequest, dataset: h5py.Dataset, axes: str) -> tuple[Geometry, str] | None:
    sizes = numbers(dataset.attrs.get("element_size_um"), 3)
    geometry = None if sizes is None else _placed(request, _spatial(axes, sizes))
    return None if geometry is None else (geometry, "µm")


def _resolution(request: LoadRequest, dataset: h5py.Dataset, axes: str) -> tuple[Geometry, str] | None:
    sizes = numbers(dataset.attrs.get("resolution"), 3)
    geometry = None if sizes is None else _placed(request, _spatial(axes, sizes))
    unit = length_unit(text(dataset.attrs.get("units", dataset.attrs.get("unit", "")))) or ""
    return None if geometry is None else (geometry, unit)


def _axistags(dataset: h5py.Dataset) -> list[dict[str, Any]]:
    try:
        listed = json.loads(text(dataset.attrs.get("axistags", "")))["axes"]
    except (ValueError, KeyError, TypeError, RecursionError):
        return []
    return listed if isinstance(listed, list) and all(isinstance(tag, dict) for tag in listed) else []


def _axistags_resolution(
    request: LoadRequest, dataset: h5py.Dataset, axes: str
) -> tuple[Geometry, str] | None:
    tags = _axistags(dataset)
    if len(tags) != len(axes):
        return None
    found = [
        numbers(tag.get("resolution"), 1) for tag, letter in zip(tags, axes, strict=True) if letter in "XYZ"
    ]
    sizes = [each[0] for each in found if each is not None and each[0] > 0]
    geometry = _placed(request, _spatial(axes, sizes)) if len(sizes) == 3 else None
    return None if geometry is None else (geometry, "")


def nexus_default(file: h5py.File) -> str:
    """Path of the data set that NeXus wants to be shown, empty where there is none."""
    owner: Any = file
    for _ in range(8):
        signal = text(owner.attrs.get("signal", ""))
        if signal and signal in owner and hasattr(owner[signal], "shape"):
            return str(owner[signal].name).strip("/")
        following = text(owner.attrs.get("default", ""))
        if not following or following not in owner or not hasattr(owner[following], "keys"):
            return ""
        owner = owner[following]
    return ""


def _nexus_axes(dataset: h5py.Dataset) -> list[str]:
    """Names of the axes of a signal, one for each dimension; none where NeXus does not say it."""
    owner = dataset.parent
    if text(owner.attrs.get("signal", "")) != str(dataset.name).rpartition("/")[2]:
        return []
    axes = owner.attrs.get("axes")
    names = [text(name) for name in np.ravel(axes)] if axes is not None else []
    if len(names) == 1 and ":" in names[0]:
        names = names[0].split(":")
    return names if len(names) == dataset.ndim else []


def _nexus(request: LoadRequest, dataset: h5py.Dataset, axes: str) -> tuple[Geometry, str] | None:
    """Positions along the axes of space, which must be even: their distance and the first one."""
    steps: dict[str, float] = {}
    starts: dict[str, float] = {}
    units: dict[str, str] = {}
    for name, letter, size in zip(_nexus_axes(dataset), axes, dataset.shape, strict=False):
        if letter not in "XYZ" or name not in dataset.parent:
            continue
        along = dataset.parent[name]
        values = numbers(along[()], size) if getattr(along, "shape", None) == (size,) else None
        if values is None or size < 2:
            continue
        differences = np.diff(values)
        steps[letter], starts[letter] = float(np.mean(differences)), values[0]
        if np.ptp(differences) > _EVEN * abs(steps[letter]):
            request.note(f"The positions along its axis {name!r} are uneven; their mean distance is taken.")
        units[letter] = length_unit(text(along.attrs.get("units", ""))) or ""
    if not steps:
        return None
    unit = next((units[letter] for letter in "XYZ" if units.get(letter)), "")
    for letter, own in units.items():
        steps[letter], starts[letter] = (converted(v, own, unit) for v in (steps[letter], starts[letter]))
    missing = [letter.lower() for letter in "XYZ" if letter not in steps]
    known = abs(steps[next(letter for letter in "XYZ" if letter in steps)])
    if missing:
        request.note(
            f"The file has no positions along {', '.join(missing)}; voxels are as long there as elsewhere."
        )
    geometry = _placed(
        request, [steps.get(letter, known) for letter in "XYZ"], [starts.get(letter, 0.0) for letter in "XYZ"]
    )
    return None if geometry is None else (geometry, unit)
