"""How our drawing gets its turn in VTK's frame: a render pass and an invisible actor.

VTK's Python classes cannot be subclassed as render passes. Instead the renderer gets a `vtkRenderStepsPass`
whose translucent step is a plain `vtkTranslucentPass` (the default one, order-independent transparency,
draws into a framebuffer of its own with rewritten shaders), and a *hook actor*: the corners of the volume's box,
fully transparent. Its mapper fires ``StartEvent`` after the opaque geometry and before the overlay.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.vtk import vtk_imports as vtk
from volviz.custom_gl.vtk.draw_order import sort_translucent
from volviz.errors import RenderError

# passes that we installed, by renderer address: PyVista's effects replace them, which must be noticed
_PASSES: dict[str, Any] = {}

#: ``id`` of the actors that stand for volumes: they are no annotations.
HOOK_ACTORS: set[int] = set()

_UNIT_CUBE = np.array([[c & 1, c >> 1 & 1, c >> 2 & 1] for c in range(8)], float) - 0.5


class _PlacedActor(vtk.vtkActor):  # type: ignore[misc]
    """Stands where its user matrix puts it: volumes follow `Plotter.set_scale` by themselves."""

    def SetScale(self, *_scale: Any) -> None:  # noqa: N802
        """Leave the actor as it is; PyVista would stretch it about its middle."""


class Hook:
    """Calls back once per drawing of the renderer's translucent step.

    Parameters
    ----------
    renderer : vtkRenderer
        Where to draw.
    callback : callable
        Called without arguments, with the window's context current.
    """

    def __init__(self, renderer: Any, callback: Callable[[], None]) -> None:
        self.renderer = renderer
        # first of all, since it may refuse
        self.install()
        self.actor = _PlacedActor()
        self._mapper = vtk.vtkPolyDataMapper()
        # bare points: faces that nobody sees would still be shaded, pixel by pixel, all over the view
        self._mapper.SetInputData(vtk.pyvista.PolyData(_UNIT_CUBE))
        self.actor.SetMapper(self._mapper)
        self.actor.ForceTranslucentOn()
        self.actor.GetProperty().SetOpacity(0.0)
        self.actor.PickableOff()
        self._observer = self._mapper.AddObserver("StartEvent", lambda *_: callback())
        self._render_observer = renderer.AddObserver("StartEvent", lambda *_: self._before_rendering())
        renderer.AddActor(self.actor)
        HOOK_ACTORS.add(id(self.actor))

    def set_corners(self, corners: npt.NDArray[np.float64]) -> None:
        """Place the actor's box, so that bounds, camera reset and clipping range come out right.

        Parameters
        ----------
        corners : ndarray of shape (8, 3)
            World corners; bit 0 of the row number is x, bit 1 y, bit 2 z.
        """
        matrix = vtk.vtkMatrix4x4()
        axes = [corners[1] - corners[0], corners[2] - corners[0], corners[4] - corners[0]]
        center = corners.mean(axis=0)
        for row in range(3):
            for column in range(3):
                matrix.SetElement(row, column, float(axes[column][row]))
            matrix.SetElement(row, 3, float(center[row]))
        self.actor.SetUserMatrix(matrix)

    def install(self) -> None:
        """Put our pass into the renderer unless it is there.

        Raises
        ------
        RenderError
            Another pass has taken its place (ambient occlusion, shadows, eye-dome lighting, SSAA).
        """
        address = self.renderer.GetAddressAsString("vtkRenderer")
        ours, present = _PASSES.get(address), self.renderer.GetPass()
        if ours is not None and present is ours:
            return
        if present is not None and ours is None:
            raise RenderError(
                f"the renderer already has a render pass ({present.GetClassName()}), which leaves no room for "
                "volumes; switch ambient occlusion, shadows, eye-dome lighting and SSAA off first."
            )
        steps = vtk.vtkRenderStepsPass()
        steps.SetTranslucentPass(vtk.vtkTranslucentPass())
        self.renderer.SetPass(steps)
        _PASSES[address] = steps

    def _before_rendering(self) -> None:
        self.install()
        sort_translucent(self.renderer, HOOK_ACTORS)

    def remove(self, *, last: bool) -> None:
        """Take the actor away and, with the last volume of the renderer, the pass."""
        HOOK_ACTORS.discard(id(self.actor))
        self._mapper.RemoveObserver(self._observer)
        self.renderer.RemoveObserver(self._render_observer)
        self.renderer.RemoveActor(self.actor)
        if last:
            ours = _PASSES.pop(self.renderer.GetAddressAsString("vtkRenderer"), None)
            if ours is not None and self.renderer.GetPass() is ours:
                self.renderer.SetPass(None)
