"""Discs, lines and arrow heads in pixels, drawn over the image by one actor."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.vtk import vtk_imports as vtk

Array = npt.NDArray[np.float64]
Color = tuple[float, float, float, float]

CORNERS = 28


class PixelShapes:
    """Collects filled shapes back to front and shows them as a two-dimensional actor.

    Shapes in the overlay take no part in depth, in bounds or in what counts as opaque scenery: the volume is not
    drawn again because a handle has moved.
    """

    def __init__(self) -> None:
        self._points: list[Array] = []
        self._colors: list[Color] = []
        self._data = vtk.vtkPolyData()
        mapper = vtk.vtkPolyDataMapper2D()
        mapper.SetInputData(self._data)
        self.actor = vtk.vtkActor2D()
        self.actor.SetMapper(mapper)
        self.actor.PickableOff()
        self.actor.VisibilityOff()

    def clear(self) -> None:
        """Begin anew."""
        self._points.clear()
        self._colors.clear()

    def polygon(self, corners: Array, color: Color) -> None:
        """A filled convex polygon; corners of shape (n, 2), in pixels from the lower left."""
        if np.all(np.isfinite(corners)):
            self._points.append(np.asarray(corners, np.float64))
            self._colors.append(color)

    def disc(self, center: Array, radius: float, color: Color) -> None:
        """A filled disc."""
        angles = np.linspace(0.0, 2 * np.pi, CORNERS, endpoint=False)
        self.polygon(center + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1), color)

    def line(self, a: Array, b: Array, width: float, color: Color) -> None:
        """A straight line with square ends."""
        along = b - a
        length = float(np.linalg.norm(along))
        if not length > 0:
            return
        across = np.array([-along[1], along[0]]) / length * width / 2
        self.polygon(np.array([a - across, b - across, b + across, a + across]), color)

    def show(self, *, visible: bool) -> None:
        """Hand the shapes to the actor."""
        visible = visible and bool(self._points)
        self.actor.SetVisibility(visible)
        if not visible:
            return
        flat = np.concatenate(self._points)
        points = vtk.vtkPoints()
        points.SetData(vtk.pyvista.convert_array(np.c_[flat, np.zeros(len(flat))]))
        sizes = [len(p) for p in self._points]
        starts = np.concatenate([[0], np.cumsum(sizes)])
        cells = vtk.vtkCellArray()
        cells.SetData(
            vtk.pyvista.convert_array(starts.astype(np.int64)),
            vtk.pyvista.convert_array(np.arange(len(flat), dtype=np.int64)),
        )
        colors = np.rint(np.array(self._colors) * 255).astype(np.uint8)
        self._data.Initialize()
        self._data.SetPoints(points)
        self._data.SetPolys(cells)
        self._data.GetCellData().SetScalars(vtk.pyvista.convert_array(colors))
