"""The one place where VTK and PyVista are imported for drawing, after their environment is prepared."""

from __future__ import annotations

from volviz import environment

environment.prepare()

import pyvista  # noqa: E402
from vtkmodules.vtkCommonCore import vtkPoints  # noqa: E402
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData  # noqa: E402
from vtkmodules.vtkCommonMath import vtkMatrix4x4  # noqa: E402
from vtkmodules.vtkRenderingCore import (  # noqa: E402
    vtkActor,
    vtkActor2D,
    vtkLight,
    vtkPolyDataMapper,
    vtkPolyDataMapper2D,
    vtkRenderer,
)
from vtkmodules.vtkRenderingOpenGL2 import (  # noqa: E402
    vtkOpenGLFramebufferObject,
    vtkRenderStepsPass,
    vtkTranslucentPass,
)

__all__ = [
    "pyvista",
    "vtkActor",
    "vtkActor2D",
    "vtkCellArray",
    "vtkLight",
    "vtkMatrix4x4",
    "vtkOpenGLFramebufferObject",
    "vtkPoints",
    "vtkPolyData",
    "vtkPolyDataMapper",
    "vtkPolyDataMapper2D",
    "vtkRenderStepsPass",
    "vtkRenderer",
    "vtkTranslucentPass",
]
