"""Resolved depth of the opaque geometry that VTK has drawn, as a texture that shaders can read."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.gpu.context import Gpu
from volviz.custom_gl.technique import FrameCamera
from volviz.custom_gl.vtk import vtk_imports as vtk

_GL_DEPTH_BUFFER_BIT = 0x0100
_GL_NEAREST = 0x2600
_VTK_UNSIGNED_CHAR = 3


class SceneDepth:
    """Copies the depth of a part of VTK's (possibly multisampled) framebuffer.

    Attributes
    ----------
    key : object
        What the copy shows; None where there is nothing opaque.
    """

    def __init__(self) -> None:
        self._fbo: Any = None
        self._size = (0, 0)
        self._texture: Any = None
        self._pixels: tuple[Any, npt.NDArray[np.float32]] | None = None
        self.key: Any = None

    @property
    def texture(self) -> Any:
        """The copy, None where there is nothing opaque."""
        return self._texture if self.key else None

    def update(
        self,
        gpu: Gpu,
        window: Any,
        revision: tuple[Any, ...],
        rectangle: tuple[int, int, int, int],
        camera: FrameCamera,
    ) -> None:
        """Copy the depth of what is already drawn unless the copy at hand still shows it.

        Parameters
        ----------
        revision : tuple
            What changes with the opaque things; empty when there are none.
        rectangle : tuple of 4 ints
            Width, height, x, y of the part of the window.
        """
        if not revision:
            self.key = None
            return
        key = (revision, rectangle, camera.view.tobytes(), camera.projection.tobytes())
        if key != self.key:
            width, height, x, y = rectangle
            self._capture(gpu, window, (x, y), (width, height))
            self.key = key

    @property
    def is_read(self) -> bool:
        """Whether `at` can answer without OpenGL: the copy has been read, or there is nothing opaque."""
        return self.texture is None or (self._pixels is not None and self._pixels[0] == self.key)

    def at(self, column: int, row: int) -> float | None:
        """Window depth 0..1 at a pixel of what was last `read`, (0, 0) at the upper left; None for nothing opaque."""
        if self.texture is None or self._pixels is None:
            return None
        depths = self._pixels[1]
        if not (0 <= row < depths.shape[0] and 0 <= column < depths.shape[1]):
            return None
        depth = float(depths[depths.shape[0] - 1 - row, column])
        return depth if depth < 1.0 else None

    def _capture(self, gpu: Gpu, window: Any, origin: tuple[int, int], size: tuple[int, int]) -> None:
        width, height = size
        if self._fbo is None or self._size != size:
            self.release(window)
            self._fbo = vtk.vtkOpenGLFramebufferObject()
            self._fbo.SetContext(window)
            state = window.GetState()
            state.PushFramebufferBindings()
            # the depth formats of both sides must be equal, or the blit is an invalid operation
            self._fbo.PopulateFramebuffer(
                width, height, True, 1, _VTK_UNSIGNED_CHAR, True,
                window.GetRenderBufferTargetDepthSize(), 0, bool(window.GetStencilCapable()),
            )  # fmt: skip
            state.PopFramebufferBindings()
            self._size = size
            handle = self._fbo.GetDepthAttachmentAsTextureObject().GetHandle()
            self._texture = gpu.gl.external_texture(handle, size, 1, 0, "f4")
            self._texture.filter = (gpu.gl.NEAREST, gpu.gl.NEAREST)
        state = window.GetState()
        state.PushFramebufferBindings()
        window.GetRenderFramebuffer().Bind(0x8CA8)
        self._fbo.Bind(0x8CA9)
        x, y = origin
        vtk.vtkOpenGLFramebufferObject.Blit(
            (x, x + width, y, y + height), (0, width, 0, height), _GL_DEPTH_BUFFER_BIT, _GL_NEAREST
        )
        state.PopFramebufferBindings()

    def read(self, gpu: Gpu) -> None:
        """Fetch the copy for `at`: window depth 0..1, row 0 at the bottom."""
        width, height = self._size
        framebuffer = gpu.gl.detect_framebuffer(self._fbo.GetFBOIndex())
        data = framebuffer.read((0, 0, width, height), components=1, attachment=-1, alignment=1, dtype="f4")
        self._pixels = (self.key, np.frombuffer(data, np.float32).reshape(height, width))

    def release(self, window: Any) -> None:
        """Release the copy."""
        if self._fbo is not None:
            self._fbo.ReleaseGraphicsResources(window)
            self._fbo = None
            self._texture = None
            self._pixels = None
            self.key = None


def opaque_revision(renderer: Any, hooks: set[int]) -> tuple[Any, ...]:
    """What changes whenever the opaque geometry of a renderer may look different; empty when there is none.

    Parameters
    ----------
    renderer : vtkRenderer
        The renderer.
    hooks : set of int
        ``id`` of the actors that are not annotations.
    """
    revision = []
    for prop in renderer.GetViewProps():
        if id(prop) in hooks or not prop.GetVisibility() or not prop.HasOpaqueGeometry():
            continue
        if prop.IsA("vtkActor2D"):
            continue
        revision.append((prop.GetAddressAsString("vtkProp"), prop.GetRedrawMTime()))
    return tuple(revision)
