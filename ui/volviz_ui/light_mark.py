"""The mark that shows where the light is: a small disc in its colour, on top of the picture."""

from __future__ import annotations

import numpy as np
import pyvista as pv
from vtkmodules.vtkRenderingCore import vtkActor2D, vtkPolyDataMapper2D

from volviz.model.light import Light, default_position
from volviz.model.volume import Volume
from volviz_ui.viewport import Viewport

RADIUS = 7.0
CORNERS = 32


class LightMark:
    """A disc with a ring, at the place of the light while that is not at the eye.

    Drawn over everything: a sphere in the scene would take part in depth and in the bounds of what is shown.
    """

    def __init__(self, viewport: Viewport) -> None:
        self._viewport = viewport
        self._ring = _disc(RADIUS + 2.0)
        self._disc = _disc(RADIUS)
        for actor in (self._ring, self._disc):
            actor.GetPositionCoordinate().SetCoordinateSystemToWorld()
            actor.VisibilityOff()
            viewport.renderer.AddViewProp(actor)
        self._ring.GetProperty().SetColor(0.08, 0.09, 0.11)

    def show(self, light: Light, volume: Volume | None, *, movable: bool) -> None:
        """Show or hide the mark.

        Parameters
        ----------
        light : Light
            Where it is and which colour it has.
        volume : Volume or None
            Its bounds give the automatic place.
        movable : bool
            Whether the technique lets the light be dragged.
        """
        visible = movable and not light.headlight and volume is not None
        for actor in (self._ring, self._disc):
            actor.SetVisibility(visible)
        if visible and volume is not None:
            position = light.position if light.position is not None else default_position(volume.bounds)
            for actor in (self._ring, self._disc):
                actor.GetPositionCoordinate().SetValue(*position)
            self._disc.GetProperty().SetColor(*light.color)
        self._viewport.render()

    @property
    def is_visible(self) -> bool:
        """Whether the mark is shown."""
        return bool(self._disc.GetVisibility())


def _disc(radius: float) -> vtkActor2D:
    angles = np.linspace(0.0, 2 * np.pi, CORNERS, endpoint=False)
    points = np.stack([radius * np.cos(angles), radius * np.sin(angles), np.zeros(CORNERS)], axis=1)
    mesh = pv.PolyData(points, faces=np.array([CORNERS, *range(CORNERS)]))
    mapper = vtkPolyDataMapper2D()
    mapper.SetInputData(mesh)
    actor = vtkActor2D()
    actor.SetMapper(mapper)
    actor.PickableOff()
    return actor
