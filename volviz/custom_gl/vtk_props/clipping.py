"""Crop box and clip planes for VTK's mappers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.custom_gl.vtk_props import vtk_imports as vtk

if TYPE_CHECKING:
    from volviz.custom_gl.technique import Frame

Vector = tuple[float, float, float]
Plane = tuple[Vector, Vector]


def crop_planes(frame: Frame) -> list[Plane]:
    """The faces of the crop box that cut something away, as (origin, inward normal) in world space."""
    to_world, to_index = frame.volume.index_to_world, frame.volume.world_to_index
    planes = []
    for axis, size in enumerate(frame.volume.dimensions):
        # of a sheared lattice the normals are not the axes
        normal = to_index[axis, :3] / np.linalg.norm(to_index[axis, :3])
        for side, limit in ((0, 0.0), (1, size - 1.0)):
            value = frame.crop[2 * axis + side]
            if value == limit:
                continue
            index = np.zeros(4)
            index[axis], index[3] = value, 1.0
            planes.append((_vector(to_world @ index), _vector(-normal if side else normal)))
    return planes


def clip_planes_of(frame: Frame) -> list[Plane]:
    """Crop box and clip planes together, as planes in world space."""
    return crop_planes(frame) + list(frame.planes)


def set_planes(mapper: Any, planes: list[Plane]) -> None:
    """Clip what a mapper draws by planes in world space, and by no others."""
    mapper.RemoveAllClippingPlanes()
    for origin, normal in planes:
        plane = vtk.vtkPlane()
        plane.SetOrigin(*origin)
        plane.SetNormal(*normal)
        mapper.AddClippingPlane(plane)


def image_box(frame: Frame, *, mirrored: bool) -> tuple[float, float, float, float, float, float]:
    """The crop box in the coordinates of a `PlacedImage`, in world units (x0, x1, y0, y1, z0, z1)."""
    crop = np.array(frame.crop).reshape(3, 2)
    if mirrored:
        crop[0] = frame.volume.dimensions[0] - 1 - crop[0, ::-1]
    x0, x1, y0, y1, z0, z1 = (crop * np.array(frame.volume.spacing)[:, None]).ravel()
    return float(x0), float(x1), float(y0), float(y1), float(z0), float(z1)


def _vector(values: Any) -> Vector:
    x, y, z = (float(v) for v in values[:3])
    return x, y, z
