"""VTK for the techniques that show its own mappers, imported after its environment is prepared."""

from __future__ import annotations

from volviz import environment

environment.prepare()

from vtkmodules.util.numpy_support import get_vtk_array_type, numpy_to_vtk  # noqa: E402
from vtkmodules.vtkCommonCore import vtkObject  # noqa: E402
from vtkmodules.vtkCommonDataModel import (  # noqa: E402
    vtkImageData,
    vtkPiecewiseFunction,
    vtkPlane,
)
from vtkmodules.vtkCommonMath import vtkMatrix4x4  # noqa: E402
from vtkmodules.vtkRenderingCore import (  # noqa: E402
    vtkColorTransferFunction,
    vtkVolume,
    vtkVolumeProperty,
)
from vtkmodules.vtkRenderingVolume import vtkVolumeMapper  # noqa: E402
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper  # noqa: E402

__all__ = [
    "get_vtk_array_type",
    "numpy_to_vtk",
    "vtkColorTransferFunction",
    "vtkImageData",
    "vtkMatrix4x4",
    "vtkObject",
    "vtkOpenGLGPUVolumeRayCastMapper",
    "vtkPiecewiseFunction",
    "vtkPlane",
    "vtkVolume",
    "vtkVolumeMapper",
    "vtkVolumeProperty",
]
