"""The mesh that a side of a comparison shows, for the metrics of meshes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.compare.vtk_contours import vtk_contour
from volviz.custom_gl.registry import technique as technique_info
from volviz.kernels.marching.surface import clean_mesh
from volviz.meshes.extraction import extract_triangles
from volviz.model.auto_isovalue import auto_isovalue
from volviz.model.parameters import make_settings
from volviz.volume_data.volume import Volume

Mesh = tuple[npt.NDArray[Any], npt.NDArray[Any]]


def side_mesh(volume: Volume, technique: str, settings: Mapping[str, Any]) -> Mesh | None:
    """Vertices (V, 3) in the world and faces (F, 3) of what a mesh technique shows; None for other techniques.

    Vertices at one place are merged and triangles without area dropped, on all sides alike: they would spoil the
    Euler characteristic and the count of open edges.

    Parameters
    ----------
    volume : Volume
    technique : str
        Its id.
    settings : mapping
        Its settings by name.
    """
    mesh = drawn_mesh(volume, technique, settings)
    return None if mesh is None else cleaned(mesh)


def cleaned(mesh: Mesh) -> Mesh:
    """A mesh with one vertex at one place and without triangles that have no area."""
    vertices, faces, _ = clean_mesh(np.asarray(mesh[0]), np.asarray(mesh[1]), None)
    return vertices, faces


def drawn_mesh(
    volume: Volume,
    technique: str,
    settings: Mapping[str, Any],
    *,
    cancel: Callable[[], bool] | None = None,
) -> Mesh | None:
    """The mesh as a technique draws it, vertex by vertex; None for techniques that draw none.

    Parameters
    ----------
    volume, technique, settings
        As for `side_mesh`.
    cancel : callable, optional
        Asked now and then by our own extraction and filters; when it returns True they end with `Cancelled`.

    Returns
    -------
    tuple or None
        Vertices (V, 3) in the world and faces (F, 3).
    """
    info = technique_info(technique)
    if not info.extraction:
        return None
    isovalue = settings.get("isovalue")
    if isovalue is None:
        isovalue = auto_isovalue(volume)
    if info.kind == "prop":
        return vtk_contour(_as_drawn(volume, int(settings.get("stride", 1))), isovalue, info.extraction)
    made = make_settings(info.settings, settings, owner=info.id)
    vertices, faces, _ = extract_triangles(
        volume, isovalue, getattr(made, "method", info.extraction), normals=None, cancel=cancel,
        **made.extraction_options,
    )  # fmt: skip
    return vertices, faces


def _as_drawn(volume: Volume, stride: int) -> Volume:
    """What VTK's techniques hand to VTK: every n-th voxel, and the lowest value where there is no number."""
    array = volume.array[::stride, ::stride, ::stride]
    finite = np.isfinite(array)
    if stride == 1 and finite.all():
        return volume
    array = np.where(finite, array, np.asarray(volume.range[0], array.dtype))
    x, y, z = (stride * s for s in volume.spacing)
    return Volume(array, spacing=(x, y, z), origin=volume.origin, direction=volume.direction)
