"""Isosurfaces by VTK's ray caster."""

from __future__ import annotations

from typing import Any

from volviz.custom_gl.technique import Frame
from volviz.custom_gl.vtk_props.images import PlacedImage
from volviz.custom_gl.vtk_props.volume_props import GpuVolumeProp


class VtkIsosurface(GpuVolumeProp):
    """`vtkGPUVolumeRayCastMapper` in its isosurface mode: colour and opacity are looked up at the isovalues."""

    always_lit = True
    only_mode = "isosurface"

    def __init__(self) -> None:
        super().__init__()
        self._surfaces: Any = None

    def classify(self, frame: Frame, placed: PlacedImage) -> None:
        """Isovalues, and steps of colour and opacity between them."""
        settings, volume = frame.settings, frame.volume
        isovalues = frame.isovalues
        surfaces = (volume, isovalues, settings.colors, settings.opacities)
        if surfaces == self._surfaces:
            return
        self._surfaces = surfaces
        isovalues = tuple(placed.value(value) for value in isovalues)
        contours = self.property.GetIsoSurfaceValues()
        contours.SetNumberOfContours(len(isovalues))
        colors, opacities = self.property.GetRGBTransferFunction(0), self.property.GetScalarOpacity(0)
        colors.RemoveAllPoints()
        opacities.RemoveAllPoints()
        low, high = placed.range
        last = len(settings.opacities) - 1
        for number, value in enumerate(isovalues):
            contours.SetValue(number, value)
            color = settings.colors[number % len(settings.colors)]
            # tables have an entry next to the isovalue, not on it: constant up to half-way to the next surface
            others = sorted(abs(other - value) for other in isovalues if other != value)
            reach = 0.45 * (others[0] if others else max(high - low, 1.0))
            for place in (value - reach, value + reach):
                colors.AddRGBPoint(place, *color)
                opacities.AddPoint(place, settings.opacities[min(number, last)])
