"""Zarr stores for tests, written by tensorstore."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import tensorstore

from tests.unit.io.writers import scalars


def array(folder: Path, values, *, version: int = 2, chunks=None, shards=None, names=None, **more) -> Path:
    """An array of a store; chunks that hold the fill value alone are not written."""
    values = np.asarray(values)
    chunks = list(chunks or [max(n // 2, 1) for n in values.shape])
    spec: dict[str, Any] = {"kvstore": {"driver": "file", "path": f"{folder}/"}}
    if version == 2:
        spec |= {"driver": "zarr", "metadata": {
            "shape": values.shape, "chunks": chunks, "dtype": values.dtype.str, "dimension_separator": "/",
            "compressor": {"id": "zlib", "level": 1}, **more,
        }}  # fmt: skip
    else:
        inner: list[Any] = [{"name": "bytes", "configuration": {"endian": "little"}}, {"name": "zstd"}]
        codecs = inner if shards is None else [
            {"name": "sharding_indexed", "configuration": {"chunk_shape": chunks, "codecs": inner}}
        ]  # fmt: skip
        spec |= {"driver": "zarr3", "metadata": {
            "shape": values.shape, "data_type": values.dtype.name, "codecs": codecs,
            "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": list(shards or chunks)}},
            **({"dimension_names": list(names)} if names else {}), **more,
        }}  # fmt: skip
    opened = tensorstore.open(spec, create=True, delete_existing=True).result()
    opened.write(values).result()
    return folder


def group(folder: Path, attributes: dict[str, Any] | None = None, *, version: int = 2) -> Path:
    """A group with attributes; those of OME under their name in version 3."""
    folder.mkdir(parents=True, exist_ok=True)
    if version == 2:
        (folder / ".zgroup").write_text('{"zarr_format": 2}')
        (folder / ".zattrs").write_text(json.dumps(attributes or {}))
    else:
        own = {
            "zarr_format": 3,
            "node_type": "group",
            "attributes": {"ome": {"version": "0.5", **(attributes or {})}},
        }
        (folder / "zarr.json").write_text(json.dumps(own))
    return folder


def image(
    folder: Path, levels, scales, *, axes="zyx", units=None, translations=None, version=2, extra=None, **kind
) -> Path:
    """An image of several levels with scale and translation each."""
    names = {"t": "time", "c": "channel"}
    described = [
        {
            "name": name,
            "type": names.get(name, "space"),
            **({"unit": units[name]} if units and name in units else {}),
        }
        for name in axes
    ]
    datasets = []
    for n, (values, scale) in enumerate(zip(levels, scales, strict=True)):
        array(folder / f"s{n}", values, version=version, **kind)
        steps = [{"type": "scale", "scale": list(scale)}]
        if translations:
            steps.append({"type": "translation", "translation": list(translations[n])})
        datasets.append({"path": f"s{n}", "coordinateTransformations": steps})
    multiscale = {"version": "0.4", "name": "", "axes": described, "datasets": datasets}
    return group(folder, {"multiscales": [multiscale], **(extra or {})}, version=version)


def zipped(folder: Path, target: Path, inside: str = "") -> Path:
    """A folder as a zip file, without compression."""
    with zipfile.ZipFile(target, "w") as archive:
        for path in sorted(folder.rglob("*")):
            if path.is_file():
                archive.write(path, inside + str(path.relative_to(folder)))
    return target


def small(shape=(6, 8, 10), dtype="uint16"):
    """Values that differ everywhere."""
    return scalars(shape, dtype)
