"""From a volume to the triangles of an isosurface: extraction, choice of parts, filters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.volume_data.volume import Volume

Array = npt.NDArray[Any]

#: In what units vertices are: of the world; of the world, from the middle of the volume; of voxel indices.
Coordinates = Literal["world", "centred", "index"]
#: Part of the work that the extraction is when filters follow: they take several times as long.
EXTRACTION_SHARE = 0.2


class Triangles(NamedTuple):
    """A mesh as plain arrays.

    Attributes
    ----------
    vertices : ndarray of shape (V, 3), float32
        Positions (x, y, z); float64 where the volume lies too far from the world's origin for 32 bits.
    faces : ndarray of shape (F, 3), integers
        Vertex numbers.
    normals : ndarray of shape (V, 3) or, flat, (F, 3), float32, or None
        Unit vectors (x, y, z) to lower values.
    """

    vertices: Array
    faces: Array
    normals: npt.NDArray[np.float32] | None


def extract_triangles(
    volume: Volume,
    isovalue: float,
    method: str = "lorensen",
    *,
    coordinates: Coordinates = "world",
    stride: int = 1,
    normals: Literal["gradient", "flat"] | None = "gradient",
    mask: npt.ArrayLike | None = None,
    bounds: Sequence[int] | None = None,
    clean: bool = False,
    largest_part: bool = False,
    min_triangles: int = 0,
    smoothing: int = 0,
    decimation: float = 0.0,
    progress: Callable[[float], object] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> Triangles:
    """Surface of a volume on which its scalars have a given value.

    Parameters
    ----------
    volume : Volume
        Scalars and where they lie; what is not finite counts as the lowest value.
    isovalue : float
        In the unit of the volume. Outside its range the mesh is empty.
    method : {"lorensen", "topological", "tetrahedra"}, default: "lorensen"
        See `volviz.marching_cubes`, also for `stride`, `normals`, `mask`, `bounds`, `clean`, `progress` and `cancel`.
    coordinates : {"world", "centred", "index"}, default: "world"
        World units; the same, relative to the middle of the volume; or continuous voxel indices (i, j, k), whose
        normals are covectors: directions of the gradient per voxel, and triangles turn as if no direction were
        left-handed.
    largest_part : bool, default: False
        Keep only the connected part with the most triangles.
    min_triangles : int, default: 0
        Keep only connected parts with at least this many triangles.
    smoothing, decimation : int, float
        See `volviz.meshes.filters.filter_triangles`. Normals are computed anew from the triangles.

    Raises
    ------
    InputError
        An argument is not one of the above.
    Cancelled
        `cancel` returned True.
    """
    # here, where something is extracted: it imports numba
    from volviz.kernels.marching import keep_components, marching_cubes

    is_filtered = bool(smoothing or decimation)
    share = EXTRACTION_SHARE if is_filtered else 1.0
    vertices, faces, shading = marching_cubes(
        volume.finite_array,
        isovalue,
        method=method,
        stride=stride,
        normals=normals,
        mask=mask,
        bounds=bounds,
        clean=clean,
        progress=_share(progress, 0.0, share),
        cancel=cancel,
        **_geometry(volume, coordinates),
    )
    if largest_part or min_triangles:
        vertices, faces, shading = keep_components(
            vertices, faces, shading, largest_only=largest_part, min_triangles=min_triangles
        )
    if is_filtered and len(faces):
        # here and not above: VTK's filters, which few meshes need
        from volviz.kernels.marching.surface import face_normals
        from volviz.meshes.filters import filter_triangles

        # lengths are those of the world; its origin would only cost digits
        to_world = volume.index_to_world[:3, :3]
        in_world = (vertices @ to_world.T).astype(np.float32) if coordinates == "index" else vertices
        moved, faces, smooth = filter_triangles(
            in_world,
            faces,
            smoothing=smoothing,
            decimation=decimation,
            progress=_share(progress, share, 1.0),
            cancel=cancel,
        )
        if normals == "flat":
            smooth = face_normals(moved, faces)
        vertices, shading = moved, None if normals is None else smooth
        if coordinates == "index":
            vertices = (moved @ np.linalg.inv(to_world).T).astype(np.float32)
            shading = None if shading is None else _covectors(shading, to_world)
    return Triangles(vertices, faces, shading)


def _geometry(volume: Volume, coordinates: Coordinates) -> dict[str, Any]:
    """Arguments of the extraction that decide in what units it gives vertices."""
    if coordinates == "index":
        return {}
    origin = volume.origin
    if coordinates == "centred":
        origin = tuple(np.subtract(volume.origin, np.asarray(volume.center)))
    return {"spacing": volume.spacing, "origin": origin, "direction": volume.direction}


def _covectors(normals: Array, to_world: Array) -> npt.NDArray[np.float32]:
    """Normals of the world as unit covectors of voxel indices."""
    # a mirrored lattice turns the triangles over, and with them their normals
    sign = np.sign(np.linalg.det(to_world))
    covectors = normals @ (sign * to_world)
    lengths = np.linalg.norm(covectors, axis=1, keepdims=True)
    return np.asarray(covectors / np.where(lengths > 0, lengths, 1.0), np.float32)


def _share(
    progress: Callable[[float], object] | None, begin: float, end: float
) -> Callable[[float], object] | None:
    """Progress of a part of the work as progress of all of it."""
    return None if progress is None else lambda part: progress(begin + (end - begin) * part)
