"""Meshes for VTK: isosurfaces of a volume as ``pyvista.PolyData`` in world units."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from volviz import environment
from volviz.errors import InputError
from volviz.kernels.mesh_metrics import enclosed_volume, surface_area
from volviz.meshes.extraction import extract_triangles

environment.prepare()

import pyvista  # noqa: E402
from vtkmodules.util.numpy_support import numpy_to_vtk  # noqa: E402
from vtkmodules.vtkCommonCore import vtkPoints  # noqa: E402
from vtkmodules.vtkCommonDataModel import vtkCellArray  # noqa: E402

if TYPE_CHECKING:
    from volviz.volume_data.volume import Volume

Array = npt.NDArray[Any]

#: Share of the triangles that decimation may remove at most; beyond it nothing recognisable is left.
MOST_DECIMATION = 0.99


def extract_isosurface(
    volume: Volume,
    isovalue: float,
    method: str = "lorensen",
    *,
    stride: int = 1,
    normals: Literal["gradient", "flat"] | None = "gradient",
    mask: npt.ArrayLike | None = None,
    bounds: Sequence[int] | None = None,
    clean: bool = False,
    largest_part: bool = False,
    min_triangles: int = 0,
    smooth: int = 0,
    decimate: float = 0.0,
    progress: Callable[[float], object] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> pyvista.PolyData:
    """Surface of a volume on which its scalars have a given value, in world units.

    Parameters
    ----------
    volume : Volume
        Scalars and where they lie; what is not finite counts as the lowest value.
    isovalue : float
        In the unit of the volume. Outside its range the mesh is empty.
    method : {"lorensen", "topological", "tetrahedra"}, default: "lorensen"
        See `volviz.marching_cubes`, also for `stride`, `normals`, `mask`, `bounds`, `clean`, `progress`
        and `cancel`.
    largest_part : bool, default: False
        Keep only the connected part with the most triangles.
    min_triangles : int, default: 0
        Keep only connected parts with at least this many triangles.
    smooth : int, default: 0
        Iterations of windowed-sinc smoothing (Taubin 1996), which does not shrink the surface; 20 is usual.
    decimate : float, default: 0.0
        Share of the triangles to remove by quadric error (Garland and Heckbert 1997), 0 to 0.99.

    Returns
    -------
    pyvista.PolyData
        Triangles with outward orientation, normals as active point normals (cell normals when flat), and the
        isovalue as field data. ``points`` of shape (V, 3), float32 (float64 far from the origin), are world
        positions (x, y, z) in the volume's unit of length. Smoothing and decimation compute normals anew from the
        triangles.

    Raises
    ------
    InputError
        An argument is not one of the above.
    Cancelled
        `cancel` returned True.
    """
    if smooth < 0:
        raise InputError(f"smooth must be 0 or a number of iterations, got {smooth}.")
    if not 0.0 <= decimate <= MOST_DECIMATION:
        raise InputError(f"decimate must lie between 0 and {MOST_DECIMATION}, got {decimate}.")
    vertices, faces, shading = extract_triangles(
        volume,
        isovalue,
        method,
        stride=stride,
        normals=normals,
        mask=mask,
        bounds=bounds,
        clean=clean,
        largest_part=largest_part,
        min_triangles=min_triangles,
        smoothing=smooth,
        decimation=decimate,
        progress=progress,
        cancel=cancel,
    )
    mesh = polydata(vertices, faces, shading, flat=normals == "flat")
    mesh.field_data["isovalue"] = [float(isovalue)]
    return mesh


def polydata(
    vertices: Array, faces: Array, normals: Array | None = None, *, flat: bool = False
) -> pyvista.PolyData:
    """Wrap arrays as a mesh of VTK, without copying them.

    Parameters
    ----------
    vertices : ndarray of shape (V, 3), float32 or float64
        World positions (x, y, z).
    faces : ndarray of shape (F, 3), int32 or int64
        Vertex numbers of triangles.
    normals : ndarray of shape (V, 3), or (F, 3) with `flat`, optional
        Unit vectors (x, y, z).
    flat : bool, default: False
        The normals belong to the triangles.

    Returns
    -------
    pyvista.PolyData
        Shares its memory with the arrays: do not write to them afterwards.
    """
    points = vtkPoints()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(vertices)))
    cells = vtkCellArray()
    cells.SetData(3, numpy_to_vtk(np.ascontiguousarray(faces).reshape(-1)))
    mesh = pyvista.PolyData()
    mesh.SetPoints(points)
    mesh.SetPolys(cells)
    if normals is not None:
        vectors = numpy_to_vtk(np.ascontiguousarray(normals))
        vectors.SetName("Normals")
        (mesh.GetCellData() if flat else mesh.GetPointData()).SetNormals(vectors)
    return mesh


def mesh_area_volume(mesh: pyvista.PolyData) -> tuple[float, float]:
    """Area, and enclosed volume, of a triangle mesh.

    Parameters
    ----------
    mesh : pyvista.PolyData
        Triangles in world units.

    Returns
    -------
    area : float
        In squared world units.
    volume : float
        In cubic world units, positive for outward orientation; meaningful for closed meshes only.

    Raises
    ------
    InputError
        The mesh has other cells than triangles.
    """
    vertices, faces = triangle_arrays(mesh)
    return surface_area(vertices, faces), enclosed_volume(vertices, faces)


def triangle_arrays(mesh: pyvista.PolyData) -> tuple[Array, Array]:
    """Vertices (V, 3) and faces (F, 3) of a mesh, without copies where VTK allows it.

    Raises
    ------
    InputError
        The mesh has other cells than triangles.
    """
    if mesh.n_cells and not mesh.is_all_triangles:
        raise InputError("The mesh has cells that are not triangles; triangulate it first.")
    vertices = np.asarray(mesh.points)
    if not mesh.n_cells:
        return vertices, np.empty((0, 3), np.int64)
    return vertices, np.asarray(mesh.regular_faces)
