"""The cross that the ray inspector draws over the image, at the pixel that is inspected."""

from __future__ import annotations

import numpy as np
import pyvista as pv
from vtkmodules.vtkRenderingCore import vtkActor2D, vtkPolyDataMapper2D

from volviz_ui.views.viewport import Viewport

ARM, GAP = 12.0, 4.0
"""Length of an arm of the cross, and the free middle that leaves the pixel itself to see; pixels."""

BRIGHT, DARK = (1.0, 0.83, 0.25), (0.05, 0.06, 0.08)


class RayMark:
    """A cross with a dark rim, so that it stands out on any image."""

    def __init__(self, viewport: Viewport) -> None:
        self._viewport = viewport
        self._actors = [_cross(2.0, DARK), _cross(0.75, BRIGHT)]
        for actor in self._actors:
            actor.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
            actor.VisibilityOff()
            viewport.renderer.AddViewProp(actor)
        self.place: tuple[float, float] | None = None

    def show(self, place: tuple[float, float] | None) -> None:
        """Show the cross at fractions of the viewport's width and height from the lower left; None hides it."""
        if place == self.place:
            return
        self.place = place
        for actor in self._actors:
            actor.SetVisibility(place is not None)
            if place is not None:
                actor.GetPositionCoordinate().SetValue(*place, 0.0)
        self._viewport.render()


def _cross(half: float, color: tuple[float, float, float]) -> vtkActor2D:
    """Four bars of that half width around a free middle."""
    rim = half - 0.75
    points, faces = [], []
    for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1)):
        along, across = np.array([dx, dy, 0.0]), np.array([-dy, dx, 0.0])
        first = len(points)
        for a, b in ((GAP - rim, -half), (ARM + rim, -half), (ARM + rim, half), (GAP - rim, half)):
            points.append(a * along + b * across)
        faces += [4, first, first + 1, first + 2, first + 3]
    mapper = vtkPolyDataMapper2D()
    mapper.SetInputData(pv.PolyData(np.array(points), faces=np.array(faces)))
    actor = vtkActor2D()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*color)
    actor.PickableOff()
    return actor
