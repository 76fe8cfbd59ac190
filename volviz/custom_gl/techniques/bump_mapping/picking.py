"""Which point of the cut plane, of the box's faces or of the mesh is seen along a ray."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.picking import Picked, Sight, on_isovalue
from volviz.custom_gl.techniques.bump_mapping.receivers import Polygon, polygons
from volviz.kernels.slices import crop_corners

Float64Array = npt.NDArray[np.float64]


def pick(sight: Sight) -> Picked | None:
    """The nearest point of the surface that is not cut out."""
    settings, volume = sight.settings, sight.volume
    if settings.surface == "mesh":
        # a mesh from a file is in the hands of the worker; its place in the data is not known here
        return None if settings.mesh_file else on_isovalue(sight)
    pieces = polygons(
        crop_corners(volume.index_to_world, sight.crop, volume.dimensions),
        volume.direction,
        surface=settings.surface,
        plane=(settings.plane_origin, settings.plane_normal),
        up=settings.plane_up,
        eye=sight.ray.start,
    )
    distances = sorted(t for t in (_distance(sight, piece) for piece in pieces) if t is not None)
    for t in distances:
        if _is_shown(sight, t):
            return sight.picked(t)
    return None


def _distance(sight: Sight, piece: Polygon) -> float | None:
    """Distance along the ray at which it goes through a convex polygon."""
    slope = float(piece.normal @ sight.ray.direction)
    if abs(slope) < 1e-12:
        return None
    t = float(piece.normal @ (piece.corners[0] - sight.ray.start)) / slope
    if not 0.0 <= t <= sight.ray.length:
        return None
    point = sight.point(t)
    along = np.roll(piece.corners, -1, axis=0) - piece.corners
    sides = np.cross(along, point - piece.corners) @ piece.normal
    return t if np.all(sides >= 0) or np.all(sides <= 0) else None


def _is_shown(sight: Sight, t: float) -> bool:
    """Whether clip planes and transfer function leave a point of the surface."""
    point = sight.point(t)
    if any(np.dot(normal, point - np.asarray(origin)) < 0 for origin, normal in sight.planes):
        return False
    if not sight.settings.cut_out and sight.settings.density_threshold <= 0:
        return True
    value = sight.values(t)
    low, high = sight.volume.bulk_range
    if value[0] < low + sight.settings.density_threshold * (high - low):
        return False
    return not sight.settings.cut_out or bool(sight.opacities(np.atleast_1d(t), value)[0] > 0)
