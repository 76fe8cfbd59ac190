"""The planes that settings ask for, and what of the volume is seen on them. No OpenGL."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.model.slice_plane import NAMED_PLANES, SlicePlane, slice_plane

if TYPE_CHECKING:
    from volviz.volume_data.vectors import Vector


def shown_planes(settings: Any, center: Vector) -> tuple[SlicePlane, ...]:
    """The planes of some `SliceSettings`.

    Raises
    ------
    InputError
        The normal of an oblique plane is zero.
    """
    names = tuple(NAMED_PLANES) if settings.plane == "orthogonal" else (settings.plane,)
    asked = [(settings.normal, upright(settings.normal)) if name == "oblique" else name for name in names]
    return tuple(slice_plane(plane, settings.point, center) for plane in asked)


def upright(normal: Vector) -> Vector:
    """What is up on a plane of that normal: the head, or the front of the patient where one looks along the body."""
    x, y, z = normal
    return (0.0, -1.0, 0.0) if abs(z) > 0.99 * float(np.linalg.norm((x, y, z))) else (0.0, 0.0, 1.0)


def turned(settings: Any, turn: Callable[[Vector], Vector]) -> Any:
    """The settings with an axial, coronal or sagittal plane turned; others lie where they were put."""
    if settings.plane not in NAMED_PLANES:
        return settings
    return replace(settings, plane="oblique", normal=turn(NAMED_PLANES[settings.plane][0]))


def facing(settings: Any) -> tuple[Vector, Vector] | None:
    """Direction towards the viewer and up of a single plane; None where several are seen."""
    if settings.plane == "orthogonal":
        return None
    (plane,) = shown_planes(settings, (0.0, 0.0, 0.0))
    return plane.normal, plane.up
