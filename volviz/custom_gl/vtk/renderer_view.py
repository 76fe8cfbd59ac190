"""What a renderer of VTK looks at: its rectangle in the window, its camera, its depth range."""

from __future__ import annotations

from typing import Any

import numpy as np

from volviz.custom_gl.technique import FrameCamera


class RendererView:
    """Reads a renderer in the terms of our frames.

    Parameters
    ----------
    renderer : vtkRenderer
        The renderer.
    window : vtkRenderWindow
        Its window.
    """

    def __init__(self, renderer: Any, window: Any) -> None:
        self._renderer = renderer
        self._window = window

    def rectangle(self) -> tuple[int, int, int, int]:
        """Width, height and origin x, y of the renderer in the framebuffer, in pixels, tiled or not."""
        # GetTiledSizeAndOrigin cannot be called from Python: the same arithmetic here
        viewport, tile = self._renderer.GetViewport(), self._window.GetTileViewport()
        size = self._window.GetSize()
        low = [int((max(viewport[i], tile[i]) - tile[i]) * size[i] + 0.5) for i in (0, 1)]
        high = [int((min(viewport[i + 2], tile[i + 2]) - tile[i]) * size[i] + 0.5) for i in (0, 1)]
        return max(high[0] - low[0], 1), max(high[1] - low[1], 1), low[0], low[1]

    def camera(self) -> FrameCamera:
        """The active camera with VTK's own matrices."""
        camera = self._renderer.GetActiveCamera()
        view = np.array(
            [camera.GetModelViewTransformMatrix().GetElement(i, j) for i in range(4) for j in range(4)]
        )
        matrix = camera.GetProjectionTransformMatrix(self._renderer.GetTiledAspectRatio(), -1, 1)
        projection = np.array([matrix.GetElement(i, j) for i in range(4) for j in range(4)])
        return FrameCamera(
            view.reshape(4, 4),
            projection.reshape(4, 4),
            np.array(camera.GetPosition()),
            np.array(camera.GetDirectionOfProjection()),
            bool(camera.GetParallelProjection()),
        )

    def depth_map(self) -> tuple[float, float]:
        """(a, b) with eye depth = a / (b - window depth), (0, 0) for parallel projection."""
        camera = self._renderer.GetActiveCamera()
        if camera.GetParallelProjection():
            return 0.0, 0.0
        near, far = camera.GetClippingRange()
        return near * far / (far - near), far / (far - near)
