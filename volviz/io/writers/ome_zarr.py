"""OME-Zarr 0.4 (Zarr 2) and 0.5 (Zarr 3) by tensorstore, with a pyramid of means (labels: of nearest values).

Source: "Next-generation file formats" 0.4 and 0.5 (ngff.openmicroscopy.org) for multiscales, axes, transformations and
the channels of "omero".
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from volviz.kernels.halving import halved

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.writers.content import Content
    from volviz.io.writers.request import SaveRequest

#: Voxels along an axis of a chunk.
CHUNK = 64
#: A level whose longest axis is not longer needs no coarser one.
SMALL = 128

_UNITS = {
    "Å": "angstrom",
    "nm": "nanometer",
    "µm": "micrometer",
    "mm": "millimeter",
    "cm": "centimeter",
    "m": "meter",
}

Version = Literal["0.4", "0.5"]


def write_04(content: Content, request: SaveRequest) -> None:
    """Version 0.4, which more programs read."""
    _write(content, request, "0.4")


def write_05(content: Content, request: SaveRequest) -> None:
    """Version 0.5."""
    _write(content, request, "0.5")


def _write(content: Content, request: SaveRequest, version: Version) -> None:
    leading = [n for n in (content.time_count, content.channel_count) if n]
    factors = pyramid_factors(content)
    arrays = []
    for level, factor in enumerate(factors):
        shape = (*leading, *reduced_shape(content.shape, factor))
        arrays.append(create_array(request, version, str(level), shape, content))
    number = 0
    for time in content.frames:
        for channel in range(content.channel_count or 1):
            array = content.array(time, channel, request)
            first, last = content.span(number)
            number += 1
            index = tuple(at for at, n in ((time, content.time_count), (channel, content.channel_count)) if n)
            for level, store in enumerate(arrays):
                if level:
                    step = tuple(b // a for a, b in zip(factors[level - 1], factors[level], strict=True))
                    array = halved(array, step, is_labels=content.is_labels)
                # finest takes most of the time
                request.report(first + (last - first) * (0.0 if level == 0 else 0.8))
                _fill(store, index, array, request)
    write_metadata(content, request, version, factors)


def _fill(store: Any, index: tuple[int, ...], array: npt.NDArray[Any], request: SaveRequest) -> None:
    """Chunk row by chunk row, so that it can be cancelled."""
    for start in range(0, array.shape[0], CHUNK):
        request.check()
        rows = slice(start, min(start + CHUNK, array.shape[0]))
        store[(*index, rows)].write(array[rows]).result()


def create_array(
    request: SaveRequest,
    version: Version,
    name: str,
    shape: tuple[int, ...],
    content: Content,
    *,
    may_exist: bool = False,
) -> Any:
    """The array of a level, empty; one that exists is gone on with where it may."""
    import tensorstore

    extra = len(shape) - 3
    chunks = [1] * extra + [min(CHUNK, n) for n in shape[extra:]]
    axes = [axis for axis, n in (("t", content.time_count), ("c", content.channel_count)) if n] + [
        "z",
        "y",
        "x",
    ]
    kvstore = {"driver": "file", "path": str(request.path / name)}
    spec: dict[str, Any]
    if version == "0.4":
        spec = {
            "driver": "zarr", "kvstore": kvstore,
            "metadata": {
                "shape": shape, "chunks": chunks, "dtype": content.dtype.str, "dimension_separator": "/",
                "compressor": {"id": "zstd", "level": 3} if request.compress else None, "fill_value": 0,
            },
        }  # fmt: skip
    else:
        codecs: list[dict[str, Any]] = [{"name": "bytes", "configuration": {"endian": "little"}}]
        if request.compress:
            codecs.append({"name": "zstd", "configuration": {"level": 3}})
        spec = {
            "driver": "zarr3", "kvstore": kvstore,
            "metadata": {
                "shape": shape, "data_type": content.dtype.name, "dimension_names": axes, "fill_value": 0,
                "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": chunks}}, "codecs": codecs,
            },
        }  # fmt: skip
    return tensorstore.open(spec, create=True, open=may_exist).result()


def pyramid_factors(content: Content) -> list[tuple[int, int, int]]:
    """How many voxels of the finest level, along (z, y, x), one of each level takes the place of.

    The longer edges of a voxel wait until the shorter ones have caught up, so that voxels become cubes.
    """
    factors = [(1, 1, 1)]
    spacing = np.asarray(content.lattice.spacing[::-1])
    while max(shape := reduced_shape(content.shape, factors[-1])) > SMALL:
        edges = spacing * factors[-1]
        halve = [edge < 1.5 * edges.min() and n >= 4 for edge, n in zip(edges, shape, strict=True)]
        if not any(halve):
            # flat volumes: whatever is long
            halve = [n > SMALL for n in shape]
        z, y, x = (factor * (2 if yes else 1) for factor, yes in zip(factors[-1], halve, strict=True))
        factors.append((z, y, x))
    return factors


def reduced_shape(shape: tuple[int, ...], factor: tuple[int, int, int]) -> tuple[int, ...]:
    """Voxels along (z, y, x) of a level whose voxels take the place of so many of the finest one."""
    reduced = shape
    at = (1, 1, 1)
    # as many halvings as lead there, each of which rounds up
    while at != factor:
        step = tuple(2 if a < f else 1 for a, f in zip(at, factor, strict=True))
        reduced = tuple(-(-n // s) for n, s in zip(reduced, step, strict=True))
        at = (at[0] * step[0], at[1] * step[1], at[2] * step[2])
    return reduced


def write_metadata(
    content: Content,
    request: SaveRequest,
    version: Version,
    factors: list[tuple[int, int, int]],
    coarser: Literal["mean", "nearest", "mode"] | None = None,
) -> None:
    """What the arrays are; `coarser` says how the levels were made (default: as `save` makes them)."""
    coarser = coarser or ("nearest" if content.is_labels else "mean")
    axes: list[dict[str, str]] = []
    if content.time_count:
        axes.append({"name": "t", "type": "time", **({"unit": "second"} if content.even_times else {})})
    if content.channel_count:
        axes.append({"name": "c", "type": "channel"})
    unit = {"unit": _UNITS[content.length_unit]} if content.length_unit in _UNITS else {}
    axes += [{"name": axis, "type": "space", **unit} for axis in "zyx"]
    start, step = content.even_times or (0.0, 1.0)
    spacing, origin = np.asarray(content.lattice.spacing[::-1]), np.asarray(content.lattice.origin[::-1])
    datasets = []
    for level, factor in enumerate(factors):
        # the middle of a block of voxels lies between its first and its last; the nearest is the first
        shift = 0.0 if coarser == "nearest" else (np.asarray(factor) - 1) / 2
        scale = [step] * bool(content.time_count) + [1.0] * bool(content.channel_count)
        translation = [start] * bool(content.time_count) + [0.0] * bool(content.channel_count)
        datasets.append({
            "path": str(level),
            "coordinateTransformations": [
                {"type": "scale", "scale": [*scale, *(spacing * factor).tolist()]},
                {"type": "translation", "translation": [*translation, *(origin + shift * spacing).tolist()]},
            ],
        })  # fmt: skip
    multiscale = {"name": content.name, "axes": axes, "datasets": datasets,
                  "type": coarser}  # fmt: skip
    attributes: dict[str, Any] = {"multiscales": [multiscale]}
    if content.channel_count:
        attributes["omero"] = {"channels": [_channel(content, at) for at in range(content.channel_count)]}
    if content.is_labels:
        attributes["image-label"] = {
            "colors": [
                {"label-value": label.number, "rgba": [*(round(255 * part) for part in label.color), 255]}
                for label in content.labels if label.color is not None
            ],
            "properties": [{"label-value": label.number, "name": label.name} for label in content.labels],
        }  # fmt: skip
    if version == "0.4":
        multiscale["version"] = version
        _save(request, ".zgroup", {"zarr_format": 2})
        _save(request, ".zattrs", attributes)
    else:
        attributes = {"ome": {"version": version, **attributes}}
        _save(request, "zarr.json", {"zarr_format": 3, "node_type": "group", "attributes": attributes})


def _channel(content: Content, number: int) -> dict[str, Any]:
    channel = content.channels[number]
    red, green, blue = (round(255 * part) for part in channel.color or (1.0, 1.0, 1.0))
    found: dict[str, Any] = {
        "label": content.channel_names()[number], "color": f"{red:02X}{green:02X}{blue:02X}", "active": True,
    }  # fmt: skip
    # without a window that of the type, which is what others take it for
    limits = np.iinfo(content.dtype) if content.dtype.kind in "ui" else None
    least, most = (int(limits.min), int(limits.max)) if limits else channel.window or (0.0, 1.0)
    start, end = channel.window or (least, most)
    found["window"] = {"start": start, "end": end, "min": least, "max": most}
    return found


def _save(request: SaveRequest, name: str, values: dict[str, Any]) -> None:
    (request.path / name).write_text(json.dumps(values, indent=1, ensure_ascii=False), encoding="utf-8")
