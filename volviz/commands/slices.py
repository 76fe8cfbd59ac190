"""Options of ``volviz render`` that place a slice: ``--plane``, ``--at`` and ``--slab``."""

from __future__ import annotations

import argparse
import math
import re
from typing import TYPE_CHECKING, Any

from volviz.errors import InputError
from volviz.model.slice_plane import NAMED_PLANES, slice_plane

if TYPE_CHECKING:
    from volviz.custom_gl.technique import TechniqueInfo
    from volviz.volume_data.volume import Volume

#: Lengths in millimetres.
_UNITS = {"nm": 1e-6, "um": 1e-3, "µm": 1e-3, "μm": 1e-3, "mm": 1.0, "cm": 10.0, "m": 1000.0}
_SLABS = {"max": "maximum", "min": "minimum", "maximum": "maximum", "minimum": "minimum", "mean": "mean",
          "composite": "composite"}  # fmt: skip


def add_plane_options(parser: argparse.ArgumentParser) -> None:
    """``--plane``, ``--at`` and ``--slab``; any of them asks for a slice."""
    group = parser.add_argument_group("slices")
    group.add_argument(
        "--plane", metavar="NAME", help=f"{', '.join(NAMED_PLANES)}, or the normal of the plane as X,Y,Z"
    )
    group.add_argument(
        "--at",
        metavar="POSITION",
        help="where the plane lies along its normal, such as 40mm, or a point X,Y,Z",
    )
    group.add_argument(
        "--slab", metavar="LENGTH[:MODE]", help="thickness, and max, min, mean or composite: 10mm:max"
    )


def asks_for_slice(options: argparse.Namespace) -> bool:
    """Whether one of the options is there."""
    return any(value is not None for value in (options.plane, options.at, options.slab))


def slicing_technique(chosen: str | None) -> str:
    """Id of the technique that draws slices.

    Raises
    ------
    InputError
        Another one was asked for.
    """
    from volviz.custom_gl.scene_techniques import slice_technique

    found = slice_technique().id
    if chosen not in (None, found):
        raise InputError(f"--plane, --at and --slab go with -t {found}, not with -t {chosen}.")
    return found


def plane_values(options: argparse.Namespace, volume: Volume, info: TechniqueInfo) -> dict[str, Any]:
    """Settings of the technique from the options, for a volume.

    Raises
    ------
    InputError
        Texts that are no plane, position or slab.
    """
    values: dict[str, Any] = {}
    plane: Any = options.plane or "axial"
    if plane in NAMED_PLANES:
        values["plane"] = plane
    else:
        plane = _vector(plane)
        if plane is None:
            raise InputError(
                f"--plane takes {', '.join(NAMED_PLANES)} or a normal such as 0,-1,0.5, got {options.plane!r}."
            )
        values |= {"plane": "oblique", "normal": plane}
    if options.at is not None:
        at = _vector(options.at)
        facing = info.facing(info.settings(**values)) if info.facing is not None else None
        directions = plane if plane in NAMED_PLANES or facing is None else facing
        where = _length(options.at, "--at", volume) if at is None else at
        values["point"] = slice_plane(directions, where, volume.center).point
    if options.slab is not None:
        thickness, _, mode = options.slab.partition(":")
        values["slab"] = _length(thickness, "--slab", volume)
        if mode:
            if mode.lower() not in _SLABS:
                raise InputError(f"--slab takes max, min, mean or composite after the colon, got {mode!r}.")
            values["slab_mode"] = _SLABS[mode.lower()]
    return values


def _vector(text: str) -> tuple[float, float, float] | None:
    try:
        x, y, z = (float(part) for part in text.strip("()").split(","))
    except ValueError:
        return None
    return x, y, z


def _length(text: str, option: str, volume: Volume) -> float:
    """A length in world units, written with or without a unit."""
    found = re.fullmatch(r"\s*([-+0-9.eE]+?)\s*([a-zµμ]*)\s*", text)
    try:
        number = float(found[1]) if found else float("nan")
    except ValueError:
        found = None
    if found is None or not math.isfinite(number):
        raise InputError(f"{option} takes a length such as 40mm, got {text!r}.")
    unit = found[2]
    if not unit:
        return number
    if unit not in _UNITS:
        raise InputError(f"{option} knows the units {', '.join(_UNITS)}, got {unit!r}.")
    own = str(volume.metadata.get("length_unit", "")) or "mm"
    if own not in _UNITS:
        raise InputError(f"{volume.name} is measured in {own}; give {option} without a unit, in {own}.")
    return number * _UNITS[unit] / _UNITS[own]
