"""From a store to a source: its images, plain arrays, N5 and precomputed volumes."""

from __future__ import annotations

import hashlib
import json
import re
import zipfile
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.axes import axis_letter, usual_axes
from volviz.io.endings import ZARR
from volviz.io.entries import choose_entry
from volviz.io.geometry import Geometry
from volviz.io.pyramid import StoredLevel, pyramid_source
from volviz.io.reader import stem
from volviz.io.units import length_unit
from volviz.io.zarr import ome
from volviz.io.zarr.finding import find, is_multiscale
from volviz.io.zarr.store import METADATA_FILES, Store, root_in_zip

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest
    from volviz.io.zarr.finding import Found
    from volviz.io.zarr.store import Node, StoredArray


def sniff(head: bytes, path: Path) -> bool:
    """Whether this is a folder or zip file with the metadata of a store at its root."""
    if path.is_dir():
        if any((path / name).is_file() for name in METADATA_FILES[:4]):
            return True
        return any(
            _describes(path / name, key) for name, key in (("attributes.json", ""), ("info", "scales"))
        )
    if not head.startswith(b"PK\x03\x04"):
        return False
    try:
        with zipfile.ZipFile(path) as archive:
            return root_in_zip(archive.namelist()) is not None
    except (OSError, zipfile.BadZipFile, ValueError, NotImplementedError):
        return False


def is_store_address(address: str) -> bool:
    """Whether a URL names a store and no single file."""
    path = re.split(r"[?#]", address)[0].rstrip("/")
    return address.startswith(("s3://", "gs://")) or bool(
        re.search(r"\.(zarr|n5)(/|$)", path) and not path.endswith(".zip")
    )


def open_source(request: LoadRequest) -> FileSource:
    """The image that is asked for, or the largest one."""
    store = Store.of(request)
    found = find(store, request)
    chosen = found[choose_entry(request, [each.entry for each in found])]
    if is_multiscale(chosen.node):
        return _image(request, store, chosen, found)
    if chosen.node.driver == "neuroglancer_precomputed":
        return _precomputed(request, store, chosen.node)
    return _plain(request, store, chosen, found)


def _image(request: LoadRequest, store: Store, chosen: Found, found: Sequence[Found]) -> FileSource:
    node = chosen.node
    multiscales = node.ome["multiscales"]
    multiscale = multiscales[0]
    if not isinstance(multiscale, dict):
        raise request.error("its list of levels is unreadable; the store is damaged.")
    if len(multiscales) > 1:
        request.note(
            f"Its metadata describes {len(multiscales)} pyramids of this image; the first one is shown."
        )
    rank = _rank(request, store, node, multiscale)
    placed = ome.levels_of(request, multiscale, rank)
    arrays = [_array(request, store, f"{node.path}/{level.path}") for level in placed]
    for level, array in zip(placed, arrays, strict=True):
        if len(array.shape) != rank:
            raise request.error(
                f"its level '{level.path}' has {len(array.shape)} axes, the first one {rank}; the store is damaged."
            )
    if min(min(array.shape) for array in arrays) < 1:
        raise request.error("one of its levels is empty; the store is damaged.")
    axes = ome.axes_of(multiscale, rank)
    unit, factors = ome.length_of_axes(request, axes)
    lattices = ome.geometries(request, axes, placed, [array.shape for array in arrays], factors)
    labels = node.ome.get("image-label")
    count = next((n for axis, n in zip(axes, arrays[0].shape, strict=False) if axis.letter == "T"), 0)
    name = multiscale.get("name")
    own = name if isinstance(name, str) and name.strip("/ ") else ""
    return pyramid_source(
        request,
        "".join(axis.letter for axis in axes),
        [StoredLevel(a.shape, g, a.read) for a, g in zip(arrays, lattices, strict=True)],
        arrays[0].dtype,
        colour=False,
        channels=ome.channels_of(node.ome),
        times=ome.times_of(axes, placed[0], count),
        is_labels=isinstance(labels, dict),
        labels=ome.labels_of(labels) if isinstance(labels, dict) else (),
        length_unit=unit,
        format="OME-Zarr",
        name=own or stem(request.path, ZARR),
        content=_content(request, store),
        entries=[each.entry for each in found],
    )


def _rank(request: LoadRequest, store: Store, node: Node, multiscale: dict[str, Any]) -> int:
    """Number of axes: that of the first level's array."""
    datasets = multiscale.get("datasets")
    first = datasets[0] if isinstance(datasets, list) and datasets else None
    path = first.get("path") if isinstance(first, dict) else None
    if not isinstance(path, str):
        raise request.error("its metadata lists no levels; the store is damaged.")
    return len(_array(request, store, f"{node.path}/{path}").shape)


def _array(request: LoadRequest, store: Store, path: str) -> StoredArray:
    inside = [part for part in path.split("/") if part]
    node = None if ".." in inside else store.node("/".join(inside))
    if node is None or not node.is_array:
        raise request.error(
            f"the array '{'/'.join(inside)}', which its metadata names, is not there; the store is incomplete."
        )
    return store.array(node)


def _plain(request: LoadRequest, store: Store, chosen: Found, found: Sequence[Found]) -> FileSource:
    """An array without a description of its axes, or with names alone."""
    node = chosen.node
    array = store.array(node)
    shape = array.shape
    if not 3 <= len(shape) <= 5 or min(shape) < 1:
        raise request.error(
            f"the array has {len(shape)} axes; a volume has z, y, x, and at most time and channel."
        )
    names = node.attributes.get("_ARRAY_DIMENSIONS") or node.attributes.get("axes") or list(array.names)
    # N5 and its viewers count x first
    axes = "XYZCT"[: len(shape)] if node.driver == "n5" else usual_axes(shape, array.dtype)
    letters = [axis_letter(name) for name in names] if isinstance(names, list) else []
    if len(letters) == len(shape) and set("ZYX") <= set(letters) and len(set(letters)) == len(letters):
        axes = "".join(letters)
    spacing, unit = _spacing(node, axes)
    if spacing is None:
        request.note("The array does not say how large its voxels are; they are taken for cubes of side 1.")
    return pyramid_source(
        request,
        axes,
        [StoredLevel(shape, Geometry(spacing or (1.0, 1.0, 1.0)), array.read)],
        array.dtype,
        colour="S" in axes,
        length_unit=unit,
        format="N5" if node.driver == "n5" else "Zarr",
        name=stem(request.path, ZARR),
        content=_content(request, store),
        entries=[each.entry for each in found],
    )


def _spacing(node: Node, axes: str) -> tuple[tuple[float, float, float] | None, str]:
    """``resolution`` and ``units`` (or ``pixelResolution``) of N5 and of Zarr arrays made from it."""
    said = node.attributes.get("pixelResolution")
    inner = said if isinstance(said, dict) else {}
    numbers = inner.get("dimensions") or node.attributes.get("resolution")
    units = inner.get("unit") or node.attributes.get("units")
    try:
        values = [float(v) for v in numbers] if isinstance(numbers, list) else []
    except (TypeError, ValueError):
        values = []
    if len(values) == 3:
        values = values if axes.startswith("X") else values[::-1] if inner else values
        order = [letter for letter in axes if letter in "XYZ"]
        by_letter = dict(zip(order, values, strict=True))
        unit = length_unit(units[0] if isinstance(units, list) and units else units) or ""
        x, y, z = (by_letter[letter] for letter in "XYZ")
        if min(x, y, z) > 0 and np.isfinite([x, y, z]).all():
            return (x, y, z), unit
    return None, ""


def _precomputed(request: LoadRequest, store: Store, node: Node) -> FileSource:
    """Neuroglancer's volumes: sizes x, y, z, channel; lengths in nanometres."""
    levels, arrays = [], []
    for number, scale in enumerate(node.metadata["scales"]):
        array = store.array(node, scale_index=number)
        origin = np.asarray(array.opened.domain.origin[:3], np.float64)
        resolution = np.asarray(scale.get("resolution") if isinstance(scale, dict) else None, np.float64)
        if resolution.shape != (3,):
            raise request.error(f"the resolution of its scale {number} is unreadable; the store is damaged.")
        # a voxel lies around its centre, half a voxel from the border from which the format counts
        lattice = request.geometry(np.c_[np.diag(resolution), resolution * (origin + 0.5)])
        arrays.append(array)
        levels.append(StoredLevel(array.shape, lattice, array.read))
    labels = node.metadata.get("type") == "segmentation"
    return pyramid_source(
        request,
        "XYZC",
        levels,
        arrays[0].dtype,
        is_labels=labels,
        length_unit="nm",
        format="Neuroglancer precomputed",
        name=stem(request.path, ZARR),
        content=_content(request, store),
    )


def _content(request: LoadRequest, store: Store) -> str:
    source = f"{request.source}\n{store.content}"
    return hashlib.sha1(source.encode("utf-8", "surrogateescape"), usedforsecurity=False).hexdigest()


def _describes(path: Path, key: str) -> bool:
    """Whether a file is a JSON object, with a key."""
    try:
        with path.open("rb") as stream:
            found = json.loads(stream.read(1 << 20))
    except (OSError, ValueError, RecursionError):
        return False
    return (
        isinstance(found, dict)
        and (not key or key in found)
        and (
            bool(key)
            or bool({"n5", "dimensions", "multiscales", "dataType", "downsamplingFactors"} & found.keys())
        )
    )
