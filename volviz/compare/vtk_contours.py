"""Isosurfaces by VTK's own filters, to compare ours with."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
import numpy.typing as npt

from volviz import environment
from volviz.errors import InputError

environment.prepare()

from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy  # noqa: E402
from vtkmodules.vtkCommonCore import vtkSMPTools  # noqa: E402
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData  # noqa: E402
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkMarchingCubes  # noqa: E402

if TYPE_CHECKING:
    from volviz.volume_data.volume import Volume

Array = npt.NDArray[Any]

_FILTERS = {"vtkMarchingCubes": vtkMarchingCubes, "vtkFlyingEdges3D": vtkFlyingEdges3D}
#: VTK's filters that make isosurfaces of images.
VTK_METHODS = tuple(_FILTERS)


def vtk_image(volume: Volume) -> vtkImageData:
    """The volume as VTK's image, with spacing, origin and direction; shares its memory where VTK can."""
    image = vtkImageData()
    image.SetDimensions(*volume.dimensions)
    image.SetSpacing(*volume.spacing)
    image.SetOrigin(*volume.origin)
    image.SetDirectionMatrix(*volume.direction.ravel())
    scalars = numpy_to_vtk(volume.array.reshape(-1), deep=not volume.array.flags.writeable)
    image.GetPointData().SetScalars(scalars)
    return image


def run_vtk_contour(
    image: vtkImageData, isovalue: float, method: str = "vtkFlyingEdges3D", *, threaded: bool = False
) -> vtkPolyData:
    """Run one of VTK's filters, with normals and without gradients and scalars.

    Parameters
    ----------
    image : vtkImageData
        See `vtk_image`.
    isovalue : float
        In data units.
    method : {"vtkMarchingCubes", "vtkFlyingEdges3D"}
        Which filter.
    threaded : bool, default: False
        Let VTK use all processors (only Flying Edges does); off by default, as in VTK's own wheel.

    Raises
    ------
    InputError
        No such filter.
    """
    if method not in _FILTERS:
        raise InputError(f"method is {method!r}; choose one of {', '.join(map(repr, VTK_METHODS))}.")
    backend = vtkSMPTools.GetBackend()
    vtkSMPTools.SetBackend("STDThread" if threaded else "Sequential")
    try:
        contour = _FILTERS[method]()
        contour.SetInputData(image)
        contour.SetValue(0, float(isovalue))
        contour.ComputeNormalsOn()
        contour.ComputeGradientsOff()
        contour.ComputeScalarsOff()
        contour.Update()
        return contour.GetOutput()
    finally:
        vtkSMPTools.SetBackend(backend)


@overload
def vtk_contour(volume: Volume, isovalue: float, method: str = ...) -> tuple[Array, Array]: ...
@overload
def vtk_contour(
    volume: Volume, isovalue: float, method: str = ..., *, with_normals: Literal[True]
) -> tuple[Array, Array, Array]: ...


def vtk_contour(
    volume: Volume, isovalue: float, method: str = "vtkFlyingEdges3D", *, with_normals: bool = False
) -> tuple[Array, ...]:
    """Vertices and triangles of VTK's isosurface.

    Parameters
    ----------
    volume : Volume
        Scalars and where they lie.
    isovalue : float
        In data units.
    method : {"vtkMarchingCubes", "vtkFlyingEdges3D"}
        Which filter.
    with_normals : bool, default: False
        Give the normals as well.

    Returns
    -------
    vertices : ndarray of shape (V, 3), float32
        World positions (x, y, z).
    faces : ndarray of shape (F, 3), int64
        Vertex numbers.
    normals : ndarray of shape (V, 3), float32
        Only on request.
    """
    mesh = run_vtk_contour(vtk_image(volume), isovalue, method)
    vertices, faces = vtk_mesh_arrays(mesh)
    if not with_normals:
        return vertices, faces
    if not len(vertices):
        return vertices, faces, vertices.copy()
    return vertices, faces, np.array(vtk_to_numpy(mesh.GetPointData().GetNormals()))


def vtk_mesh_arrays(mesh: vtkPolyData) -> tuple[Array, Array]:
    """Copies of the vertices (V, 3) and the faces (F, 3) of a triangle mesh of VTK."""
    if not mesh.GetNumberOfCells():
        return np.empty((0, 3), np.float32), np.empty((0, 3), np.int64)
    vertices = np.array(vtk_to_numpy(mesh.GetPoints().GetData()))
    faces = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return vertices, faces.astype(np.int64)
