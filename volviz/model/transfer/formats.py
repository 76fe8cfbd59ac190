"""Transfer functions of other programs, in and out.

=========  ======================================================================
``.json``  Our own presets and functions; ParaView and VTK colour maps (``RGBPoints``, ``Points``).
``.vp``    Volume properties of 3D Slicer: opacities and colours, without shading.
``.dat``   256 entries of RGBA, one byte each (1024 bytes), over the range of data.
name       A colour map by its matplotlib or cmap name, opacity rising from 0 to 1.
=========  ======================================================================
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError, LoadError
from volviz.model.transfer.channels import Channel, ChannelPoint, merged, simplified, straightened, with_ramp
from volviz.model.transfer.color_spaces import between
from volviz.model.transfer.function import ControlPoint, TransferFunction
from volviz.model.transfer.presets import Preset

#: Entries of a raw table.
DAT_ENTRIES = 256


def read_transfer_function(path: str | Path) -> TransferFunction:
    """The transfer function in a file of any known kind.

    Raises
    ------
    LoadError
        The file cannot be read, is of no known kind, or what it says makes no function.
    """
    return read_preset_file(path).transfer_function


def read_preset_file(path: str | Path) -> Preset:
    """The preset in a file of any known kind; other programs' files give one named after the file.

    Raises
    ------
    LoadError
        The file cannot be read, is of no known kind, or what it says makes no function.
    """
    path = Path(path)
    kind = path.suffix.lower()
    readers: dict[str, Callable[[bytes, str], Preset]] = {".json": _json, ".vp": _vp, ".dat": _dat}
    if kind not in readers:
        raise LoadError(
            f"{path}: transfer functions are read from .json, .vp and .dat files; "
            f"this is {kind or 'none of them'}."
        )
    try:
        content = path.read_bytes()
    except OSError as error:
        raise LoadError(f"{path}: cannot be read ({error.strerror or error}).") from None
    try:
        return readers[kind](content, path.stem)
    except (InputError, LoadError, ValueError, KeyError, TypeError, IndexError) as error:
        words = (
            str(error) if isinstance(error, (InputError, LoadError)) else "it is damaged or of another kind."
        )
        raise LoadError(f"{path}: {words}") from None


def write_transfer_function(
    function: TransferFunction | Preset,
    path: str | Path,
    data_range: tuple[float, float] = (0.0, 1.0),
    *,
    paraview: bool = False,
) -> None:
    """Write a function or preset to a file; the ending of the name decides the kind.

    Parameters
    ----------
    function : TransferFunction or Preset
        What to write.
    path : str or Path
        ``.json``, ``.vp`` or ``.dat``.
    data_range : tuple of 2 floats
        Range over which relative functions are spread, and a raw table is sampled.
    paraview : bool
        Write ``.json`` as ParaView reads it instead of as ours.

    Raises
    ------
    InputError
        Another ending.
    LoadError
        The file cannot be written.
    """
    path = Path(path)
    kind = path.suffix.lower()
    preset = function if isinstance(function, Preset) else _preset(function, function.name or path.stem)
    if kind == ".dat":
        content = to_dat(preset.transfer_function, data_range)
    elif kind == ".vp":
        content = to_vp(preset.transfer_function.resolved(data_range)).encode()
    elif kind == ".json":
        data = to_paraview(preset.transfer_function) if paraview else preset.to_dict()
        content = (json.dumps(data, indent=1, ensure_ascii=False) + "\n").encode()
    else:
        raise InputError(f"{path}: transfer functions are written to .json, .vp and .dat files.")
    try:
        path.write_bytes(content)
    except OSError as error:
        raise LoadError(f"{path}: cannot be written ({error.strerror or error}).") from None


def from_colormap(name: str, data_range: tuple[float, float] | None = None) -> TransferFunction:
    """A function with the colours of a matplotlib or cmap colour map, opacity rising from 0 to 1.

    Parameters
    ----------
    name : str
        ``viridis``, ``crameri:batlow``, ``cmocean:ice``, ``tab10_r``, ...
    data_range : tuple of 2 floats, optional
        Values of the first and last colour; relative to the range of the data without it.

    Raises
    ------
    InputError
        No such colour map.
    """
    low, high = data_range if data_range is not None else (0.0, 1.0)
    rising = TransferFunction.from_points(
        [(low, (0, 0, 0, 0)), (high, (0, 0, 0, 1))],
        domain="relative" if data_range is None else "data",
        name=name,
    )
    return with_ramp(rising, colormap_colors(name))


def colormap_colors(name: str, count: int = DAT_ENTRIES) -> npt.NDArray[np.float64]:
    """Colours of a matplotlib or cmap colour map, shape (count, 3), in 0..1.

    Raises
    ------
    InputError
        No such colour map.
    """
    import cmap

    try:
        colors = cmap.Colormap(name)(np.linspace(0.0, 1.0, count))
    except (ValueError, TypeError, KeyError):
        raise InputError(
            f"there is no colour map called {name!r}; try viridis, magma, gray, or see the catalogue of cmap."
        ) from None
    return np.clip(np.asarray(colors, dtype=np.float64)[:, :3], 0.0, 1.0)


# ------------------------------------------------------------------ to the files of other programs


def to_dat(function: TransferFunction, data_range: tuple[float, float]) -> bytes:
    """1024 bytes: 256 entries of RGBA over the range of the data."""
    table = function.bake(data_range, DAT_ENTRIES)
    entries = np.rint(np.clip(table, 0.0, 1.0) * 255.0).astype(np.uint8)
    return bytes(entries.tobytes())


def to_paraview(function: TransferFunction) -> list[dict[str, Any]]:
    """A list with one ParaView preset; overall opacity is multiplied in."""
    colors, opacities = [], []
    for p in function.points:
        colors += [p.value, *p.color]
        # midpoint 0.5 and sharpness 0: straight lines
        opacities += [p.value, p.opacity * function.opacity, 0.5, 0.0]
    return [
        {"Name": function.name or "VolViz", "ColorSpace": "RGB", "RGBPoints": colors, "Points": opacities}
    ]


def to_vp(function: TransferFunction) -> str:
    """A volume property of 3D Slicer: linear interpolation, shaded, no gradient opacity."""
    opacities: list[float] = []
    colors: list[float] = []
    for p in function.points:
        opacities += [p.value, p.opacity * function.opacity]
        colors += [p.value, *p.color]

    def row(numbers: Sequence[float]) -> str:
        return " ".join([str(len(numbers)), *(f"{n:.9g}" for n in numbers)])

    return "\n".join(["1", "1", "0.9", "0.1", "0.2", "10", row(opacities), "4 0 1 255 1", row(colors), ""])


# ------------------------------------------------------------------ from the files of other programs


def _preset(function: TransferFunction, name: str) -> Preset:
    return Preset(id=name, label=name, description="", transfer_function=function)


def _json(content: bytes, name: str) -> Preset:
    try:
        data = json.loads(content.decode("utf-8-sig"))
    except ValueError:
        raise LoadError("it is not JSON.") from None
    if isinstance(data, list) and data:
        # ParaView exports a list of presets; the first one with colours counts
        maps = [d for d in data if isinstance(d, dict)]
        data = next((d for d in maps if "RGBPoints" in d or "IndexedColors" in d), data[0])
    if not isinstance(data, dict):
        raise LoadError("it holds no transfer function.")
    if "IndexedColors" in data and "RGBPoints" not in data:
        return _preset(_indexed(data, str(data.get("Name") or name)), str(data.get("Name") or name))
    if "RGBPoints" in data or "Points" in data:
        function = _paraview(data, str(data.get("Name") or name))
        return _preset(function, function.name)
    if "points" in data and "transfer_function" not in data:
        function = TransferFunction.from_dict(data)
        return _preset(function, function.name or name)
    return Preset.from_dict(data, "preset")


def _paraview(data: Mapping[str, Any], name: str) -> TransferFunction:
    rgb = np.asarray(data.get("RGBPoints") or (), dtype=np.float64).reshape(-1, 4)
    alpha = np.asarray(data.get("Points") or (), dtype=np.float64).reshape(-1, 4)
    for what in (rgb, alpha):
        if not np.isfinite(what).all():
            raise LoadError("it holds numbers that are not finite.")
    rgb, alpha = (rows[np.argsort(rows[:, 0], kind="stable")] for rows in (rgb, alpha))
    colors = _colors(rgb, str(data.get("ColorSpace", "RGB")))
    opacities = _opacities(alpha)
    if not len(rgb):
        colors = (ChannelPoint(float(alpha[0, 0]), (1.0, 1.0, 1.0)),)
    elif not len(alpha):
        # a colour map without opacities: rising, as volume rendering needs some
        opacities = (ChannelPoint(colors[0].value, (0.0,)), ChannelPoint(colors[-1].value, (1.0,)))
    elif alpha[0, 0] >= 0.0 and alpha[-1, 0] <= 1.0 and not 0.0 <= rgb[0, 0] < rgb[-1, 0] <= 1.0:
        # opacities of newer files are fractions of the range of the colours
        low, span = rgb[0, 0], rgb[-1, 0] - rgb[0, 0]
        opacities = tuple(ChannelPoint(float(low + s.value * span), s.level) for s in opacities)
    values = [s.value for s in (*colors, *opacities)]
    # A map over 0..1 or -1..1 is a ramp to be spread over any data.
    relative = min(values) in (0.0, -1.0) and max(values) == 1.0
    like = TransferFunction((ControlPoint(0.0, (0.0, 0.0, 0.0), 0.0),), name=name)
    function = merged(colors, opacities, like)
    if not relative:
        return function
    low, span = min(values), max(values) - min(values)
    return TransferFunction.from_points(
        [((p.value - low) / span, p.rgba) for p in function.points], domain="relative", name=name
    )


def _indexed(data: Mapping[str, Any], name: str) -> TransferFunction:
    """A map of categories: its colours as equal flat pieces over the range of the data, opacity rising."""
    rgb = np.clip(np.asarray(data["IndexedColors"], dtype=np.float64).reshape(-1, 3), 0.0, 1.0)
    if not len(rgb) or not np.isfinite(rgb).all():
        raise LoadError("its list of colours is empty or holds numbers that are not finite.")
    edges = np.linspace(0.0, 1.0, len(rgb) + 1).tolist()
    pieces = zip(edges[:-1], edges[1:], rgb.tolist(), strict=True)
    points = [(v, (*color, v)) for low, high, color in pieces for v in (low, high)]
    return TransferFunction.from_points(points, domain="relative", name=name)


def _colors(rgb: npt.NDArray[np.float64], space: str) -> Channel:
    """Stops whose straight lines in RGB follow the lines of another colour space."""
    points: list[ChannelPoint] = []
    stepped = space.upper() == "STEP"
    for a, b in pairwise(rgb):
        if stepped:
            # between two points VTK shows the colour of the second one
            first, second = (tuple(np.clip(row[1:], 0.0, 1.0).tolist()) for row in (a, b))
            points += [ChannelPoint(float(a[0]), first), ChannelPoint(float(a[0]), second)]
            continue
        parts = 1 if space.upper() == "RGB" or a[0] == b[0] else 64
        for k in range(parts):
            t = k / parts
            color = between(tuple(a[1:].tolist()), tuple(b[1:].tolist()), t, space)
            points.append(ChannelPoint(float(a[0] + t * (b[0] - a[0])), color))
    if len(rgb):
        points.append(ChannelPoint(float(rgb[-1, 0]), tuple(np.clip(rgb[-1, 1:], 0.0, 1.0).tolist())))
    return straightened(tuple(points), 1 / 512) if points else ()


def _opacities(rows: npt.NDArray[np.float64]) -> Channel:
    """Stops of a VTK piecewise function: value, opacity, midpoint, sharpness a row.

    Midpoint moves where half way is reached; sharpness 1 is a step there. In between, VTK's curve is replaced
    by straight lines through the midpoint whose slope grows with the sharpness.
    """
    points: list[ChannelPoint] = []
    for i, (value, opacity, middle, sharp) in enumerate(rows.tolist()):
        points.append(ChannelPoint(value, (min(max(opacity, 0.0), 1.0),)))
        if i + 1 == len(rows) or rows[i + 1, 0] == value:
            continue
        following, next_opacity = float(rows[i + 1, 0]), float(np.clip(rows[i + 1, 1], 0.0, 1.0))
        if math.isclose(middle, 0.5) and sharp == 0.0:
            continue
        center = value + min(max(middle, 1e-5), 1 - 1e-5) * (following - value)
        if sharp < 0.01:
            points.append(ChannelPoint(center, ((points[-1].level[0] + next_opacity) / 2,)))
        else:
            reach = (1.0 - min(sharp, 1.0)) / 2
            first, here = value + (center - value) * (1 - reach * 2), points[-1].level
            points += [
                ChannelPoint(first, here),
                ChannelPoint(following - (following - center) * (1 - reach * 2), (next_opacity,)),
            ]
    return tuple(sorted(points, key=lambda s: s.value))


def _vp(content: bytes, name: str) -> Preset:
    # Each line may carry a comment after "=>", as Slicer's manual shows them.
    lines = [line.split("=>")[0].split() for line in content.decode("utf-8", "replace").splitlines()]
    rows = [[float(word) for word in line] for line in lines if line]
    tables = [row for row in rows if len(row) > 1]
    if len(rows) < 9 or len(tables) < 3 or any(row[0] != len(row) - 1 for row in tables[:3]):
        raise LoadError("it is no volume property of 3D Slicer.")
    alpha = np.array(tables[0][1:]).reshape(-1, 2)
    rgb = np.array(tables[2][1:]).reshape(-1, 4)
    opacities = tuple(ChannelPoint(v, (min(max(a, 0.0), 1.0),)) for v, a in alpha.tolist())
    colors = tuple(ChannelPoint(v, tuple(np.clip(c, 0.0, 1.0).tolist())) for v, *c in rgb.tolist())
    like = TransferFunction((ControlPoint(0.0, (0.0, 0.0, 0.0), 0.0),), name=name)
    function = merged(colors, opacities, like)
    is_hu = function.points[0].value <= -900.0
    return Preset(name, name, "", function, modality="CT" if is_hu else "any", unit="HU" if is_hu else "")


def _dat(content: bytes, name: str) -> Preset:
    if len(content) != 4 * DAT_ENTRIES:
        raise LoadError(f"a raw table has {4 * DAT_ENTRIES} bytes, this file has {len(content)}.")
    table = np.frombuffer(content, np.uint8).reshape(DAT_ENTRIES, 4)
    return _preset(simplified(TransferFunction.from_table(table, name=name)), name)
