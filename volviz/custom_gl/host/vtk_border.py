"""The one place where VTK and PyVista are imported for drawing, after their environment is prepared."""

from __future__ import annotations

from volviz import environment

environment.prepare()

import pyvista  # noqa: E402
from vtkmodules.vtkCommonMath import vtkMatrix4x4  # noqa: E402
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper  # noqa: E402
from vtkmodules.vtkRenderingOpenGL2 import (  # noqa: E402
    vtkOpenGLFramebufferObject,
    vtkRenderStepsPass,
    vtkTranslucentPass,
)

__all__ = [
    "pyvista",
    "vtkActor",
    "vtkMatrix4x4",
    "vtkOpenGLFramebufferObject",
    "vtkPolyDataMapper",
    "vtkRenderStepsPass",
    "vtkTranslucentPass",
]
