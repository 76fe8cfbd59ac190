"""Marching cubes and marching tetrahedra, with tables generated from the geometry of the cell.

The names below are imported when they are first used: extraction needs numba, the rest of this package does not.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from volviz.kernels.marching.components import face_components, keep_components
    from volviz.kernels.marching.extract import marching_cubes, warm_up

__all__ = ["marching_cubes", "face_components", "keep_components", "warm_up"]

_PLACES = {
    "marching_cubes": "extract",
    "warm_up": "extract",
    "face_components": "components",
    "keep_components": "components",
}


def __getattr__(name: str) -> Any:
    place = _PLACES.get(name)
    if place is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{place}"), name)
    globals()[name] = value
    return value
