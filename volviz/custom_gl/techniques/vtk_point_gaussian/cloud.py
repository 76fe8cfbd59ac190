"""Splats as points of VTK's mapper."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.splat_selection import SIGMA_PER_DIAMETER
from volviz.custom_gl.vtk_props import vtk_imports as vtk
from volviz.custom_gl.vtk_props.errors import ErrorWords
from volviz.kernels.splats import Splats
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.volume import Volume

#: A disc: nothing outside the radius, everything inside. VTK's own footprint is a Gaussian, the radius its deviation.
_DISC = "//VTK::Color::Impl\nif (dot(offsetVCVSOutput.xy, offsetVCVSOutput.xy) > 1.0) { discard; }\n"


class Cloud:
    """An actor, and the splats that it shows."""

    def __init__(self) -> None:
        self._points: Splats | None = None
        self._colored: tuple[TransferFunction, bool] | None = None
        self._disc: bool | None = None
        self.mapper = vtk.vtkPointGaussianMapper()
        self.mapper.EmissiveOff()
        self.mapper.SetColorModeToDirectScalars()
        self.actor = vtk.vtkActor()
        self.actor.SetMapper(self.mapper)
        self.errors = ErrorWords(self.mapper, self.actor)

    def show(self, splats: Splats, volume: Volume) -> None:
        """Show these splats; nothing happens when they are shown already."""
        if self._points is splats:
            return
        self._points, self._colored = splats, None
        to_world = volume.index_to_world
        world = splats.positions.astype(np.float64) @ to_world[:3, :3].T + to_world[:3, 3]
        points = vtk.vtkPoints()
        points.SetData(vtk.numpy_to_vtk(world.astype(np.float32), deep=True))
        data = vtk.vtkPolyData()
        data.SetPoints(points)
        self.mapper.SetInputData(data)

    def paint(self, function: TransferFunction, *, disc: bool) -> None:
        """Colours of a transfer function in data units, and its opacities unless they are discs."""
        if self._points is None or (
            self._colored is not None and self._colored[0] is function and self._colored[1] == disc
        ):
            return
        self._colored = (function, disc)
        rgba = function.evaluate(self._points.values)
        if disc:
            rgba[:, 3] = 1.0
        data = self.mapper.GetInput()
        data.GetPointData().SetScalars(vtk.numpy_to_vtk(_bytes(rgba), deep=True))
        data.Modified()

    def shape(self, diameter: float, *, disc: bool) -> None:
        """Discs or Gaussians of this diameter in world units."""
        # VTK's radius is a disc's radius or a Gaussian's standard deviation
        self.mapper.SetScaleFactor(diameter * (0.5 if disc else SIGMA_PER_DIAMETER))
        if disc == self._disc:
            return
        self._disc = disc
        self.mapper.SetSplatShaderCode(_DISC if disc else None)
        # the triangle around a splat, in radii
        self.mapper.SetBoundScale(1.0 if disc else 3.0)
        self.actor.SetForceOpaque(disc)
        self.actor.SetForceTranslucent(not disc)

    def release(self, window: Any) -> None:
        """Release what lies on the GPU; the context is current."""
        self.actor.ReleaseGraphicsResources(window)
        self.mapper.RemoveAllInputs()
        self._points = self._colored = None


def _bytes(rgba: npt.NDArray[np.float64]) -> npt.NDArray[np.uint8]:
    return np.rint(np.clip(rgba, 0.0, 1.0) * 255.0).astype(np.uint8)
