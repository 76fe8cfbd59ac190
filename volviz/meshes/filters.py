"""Smoothing and decimation of triangles by VTK, off the GUI thread, with progress and cancel."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz import environment
from volviz.errors import Cancelled

environment.prepare()

from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy  # noqa: E402
from vtkmodules.vtkCommonCore import vtkPoints  # noqa: E402
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData  # noqa: E402
from vtkmodules.vtkFiltersCore import (  # noqa: E402
    vtkPolyDataNormals,
    vtkQuadricDecimation,
    vtkWindowedSincPolyDataFilter,
)

Array = npt.NDArray[Any]

#: Pass band of the smoothing (Taubin 1996): lower is smoother; 0.1 keeps the shape and takes the steps away.
PASS_BAND = 0.1
#: Triangles that decimation leaves at least: the fewest that enclose anything.
FEWEST = 4


def filter_triangles(
    vertices: Array,
    faces: Array,
    *,
    smoothing: int = 0,
    decimation: float = 0.0,
    progress: Callable[[float], object] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> tuple[Array, Array, npt.NDArray[np.float32]]:
    """Smooth, then decimate a mesh, and compute its normals from the triangles that come out.

    Parameters
    ----------
    vertices : ndarray of shape (V, 3), float32 or float64
        Positions (x, y, z) in units in which lengths can be compared: in the world, not in voxels.
    faces : ndarray of shape (F, 3), integers
        Vertex numbers.
    smoothing : int, default: 0
        Iterations of windowed-sinc smoothing (Taubin, Zhang and Golub 1996), which does not shrink the surface.
    decimation : float, default: 0.0
        Share of the triangles to remove by quadric error (Garland and Heckbert 1997), 0 to 0.99; some are left of
        any mesh.
    progress : callable, optional
        Called with the finished fraction, 0..1, on the thread that works.
    cancel : callable, optional
        Asked whenever VTK reports its progress; when it returns True the work ends with `Cancelled`.

    Returns
    -------
    vertices : ndarray of shape (V', 3), of the same type
    faces : ndarray of shape (F', 3), int64
    normals : ndarray of shape (V', 3), float32
        Unit vectors by the right-hand rule, weighted over the triangles of a vertex as VTK does.

    Raises
    ------
    Cancelled
        `cancel` returned True.
    """
    if not len(faces):
        return vertices, faces, np.zeros(vertices.shape, np.float32)
    steps: list[tuple[Any, float]] = []
    if smoothing:
        sinc = vtkWindowedSincPolyDataFilter()
        sinc.SetNumberOfIterations(int(smoothing))
        sinc.SetPassBand(PASS_BAND)
        sinc.BoundarySmoothingOff()
        sinc.FeatureEdgeSmoothingOff()
        sinc.NonManifoldSmoothingOff()
        steps.append((sinc, 1.0))
    removable = min(decimation, 1.0 - FEWEST / len(faces))
    if removable > 0:
        quadric = vtkQuadricDecimation()
        quadric.SetTargetReduction(float(removable))
        steps.append((quadric, 8.0))
    shading = vtkPolyDataNormals()
    # VTK would otherwise split or turn what already is consistent
    shading.SplittingOff()
    shading.ConsistencyOff()
    shading.AutoOrientNormalsOff()
    shading.ComputeCellNormalsOff()
    shading.ComputePointNormalsOn()
    steps.append((shading, 0.5))
    # VTK sums weighted positions in single precision: far from the origin the mesh would drift
    middle = (vertices.min(axis=0).astype(np.float64) + vertices.max(axis=0)) / 2
    mesh = _mesh((vertices - middle).astype(np.float32), faces)
    whole, done = sum(share for _, share in steps), 0.0
    for step, share in steps:
        changed = _run(step, mesh, done / whole, share / whole, progress, cancel)
        # of a mesh that is all border VTK may leave nothing
        mesh = changed if changed.GetNumberOfCells() else mesh
        done += share
    return (
        (vtk_to_numpy(mesh.GetPoints().GetData()) + middle).astype(vertices.dtype),
        np.asarray(vtk_to_numpy(mesh.GetPolys().GetConnectivityArray())).reshape(-1, 3),
        np.asarray(vtk_to_numpy(mesh.GetPointData().GetNormals()), np.float32),
    )


def _mesh(vertices: Array, faces: Array) -> vtkPolyData:
    """The arrays as VTK's mesh, not copied."""
    points = vtkPoints()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(vertices)))
    cells = vtkCellArray()
    cells.SetData(3, numpy_to_vtk(np.ascontiguousarray(faces).reshape(-1)))
    mesh = vtkPolyData()
    mesh.SetPoints(points)
    mesh.SetPolys(cells)
    return mesh


def _run(
    step: Any,
    mesh: vtkPolyData,
    begin: float,
    share: float,
    progress: Callable[[float], object] | None,
    cancel: Callable[[], bool] | None,
) -> vtkPolyData:
    """Run one filter of VTK, which reports its progress and is asked to stop through its own events."""
    errors: list[Exception] = []

    def report(_filter: Any, _event: str) -> None:
        try:
            if progress is not None:
                progress(begin + share * step.GetProgress())
            if cancel is not None and cancel():
                step.SetAbortExecute(True)
        except Exception as error:  # noqa: BLE001 - VTK would print and swallow it
            errors.append(error)
            step.SetAbortExecute(True)

    if cancel is not None and cancel():
        raise Cancelled("The work on the mesh was cancelled.")
    observer = step.AddObserver("ProgressEvent", report)
    try:
        step.SetInputData(mesh)
        step.Update()
    finally:
        step.RemoveObserver(observer)
    if errors:
        raise errors[0]
    if cancel is not None and cancel():
        raise Cancelled("The work on the mesh was cancelled.")
    result: vtkPolyData = step.GetOutput()
    return result
