"""VTK for the techniques that show its own mappers, imported after its environment is prepared."""

from __future__ import annotations

from volviz import environment

environment.prepare()

from vtkmodules.util.numpy_support import get_vtk_array_type, numpy_to_vtk, vtk_to_numpy  # noqa: E402
from vtkmodules.vtkCommonCore import vtkLookupTable, vtkObject, vtkPoints  # noqa: E402
from vtkmodules.vtkCommonDataModel import (  # noqa: E402
    vtkCellArray,
    vtkImageData,
    vtkPiecewiseFunction,
    vtkPlane,
    vtkPolyData,
)
from vtkmodules.vtkCommonMath import vtkMatrix4x4  # noqa: E402
from vtkmodules.vtkFiltersCore import (  # noqa: E402
    vtkClipPolyData,
    vtkFlyingEdges3D,
    vtkMarchingCubes,
    vtkPolyDataTangents,
)
from vtkmodules.vtkRenderingCore import (  # noqa: E402
    vtkActor,
    vtkColorTransferFunction,
    vtkPointGaussianMapper,
    vtkPolyDataMapper,
    vtkTexture,
    vtkVolume,
    vtkVolumeProperty,
)
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper, vtkVolumeMapper  # noqa: E402
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper  # noqa: E402

__all__ = [
    "get_vtk_array_type",
    "numpy_to_vtk",
    "vtkActor",
    "vtkCellArray",
    "vtkClipPolyData",
    "vtkColorTransferFunction",
    "vtkFixedPointVolumeRayCastMapper",
    "vtkFlyingEdges3D",
    "vtkImageData",
    "vtkLookupTable",
    "vtkMarchingCubes",
    "vtkMatrix4x4",
    "vtkObject",
    "vtkOpenGLGPUVolumeRayCastMapper",
    "vtkPiecewiseFunction",
    "vtkPlane",
    "vtkPointGaussianMapper",
    "vtkPoints",
    "vtkPolyData",
    "vtkPolyDataMapper",
    "vtkPolyDataTangents",
    "vtkTexture",
    "vtkVolume",
    "vtkVolumeMapper",
    "vtkVolumeProperty",
    "vtk_to_numpy",
]
