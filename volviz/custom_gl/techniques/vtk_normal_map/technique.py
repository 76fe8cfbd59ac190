"""A rectangle with a colour texture and a normal texture, lit by VTK."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.technique import Frame
from volviz.custom_gl.techniques.vtk_normal_map.plane_maps import PlaneMaps, PlaneRequest, plane_maps
from volviz.custom_gl.vtk_props import vtk_imports as vtk
from volviz.custom_gl.vtk_props.errors import ErrorWords
from volviz.model.cut_plane import default_cut_plane
from volviz.tasks import LatestResult

#: Most texels along a side while something moves.
MOVING_TEXELS = 192


class VtkNormalMap:
    """`vtkProperty::SetNormalTexture` on a plane, with tangents of `vtkPolyDataTangents`."""

    by_tiles = False
    writes_depth = True
    within_tiles = True
    ambient_from_light = True
    seconds_per_pixel = 1e-6

    def __init__(self) -> None:
        self._maps: LatestResult[PlaneRequest, PlaneMaps] = LatestResult("plane", cancels=False)
        self._shown: PlaneMaps | None = None
        self._volume: Any = None
        self.mapper = vtk.vtkPolyDataMapper()
        self.mapper.ScalarVisibilityOff()
        self.actor = vtk.vtkActor()
        self.actor.SetMapper(self.mapper)
        # places that are cut out are discarded, not blended
        self.actor.ForceOpaqueOn()
        self.actor.GetProperty().SetInterpolationToPhong()
        self._colors, self._normals = vtk.vtkTexture(), vtk.vtkTexture()
        for texture in (self._colors, self._normals):
            texture.InterpolateOn()
            texture.RepeatOff()
            texture.EdgeClampOn()
            texture.SetColorModeToDirectScalars()
        self.actor.SetTexture(self._colors)
        self.actor.GetProperty().SetNormalTexture(self._normals)
        self.errors = ErrorWords(self.mapper, self.actor)

    @property
    def props(self) -> tuple[Any, ...]:
        """The plane."""
        return (self.actor,)

    def prepare(self, frame: Frame) -> bool:
        """Sample the plane in the background; True when there are maps to show."""
        request = _request(frame)
        maps = self._maps.get(frame.tasks, request, lambda _progress, _cancel: plane_maps(request))
        if maps is None:
            if not frame.interactive or self._shown is None or self._volume is not frame.volume:
                return False
        elif maps is not self._shown:
            self._shown, self._volume = maps, frame.volume
            self._show(maps)
        look = self.actor.GetProperty()
        look.SetAmbient(frame.settings.ambient)
        look.SetDiffuse(frame.settings.diffuse)
        look.SetSpecular(0.0)
        return True

    def _show(self, maps: PlaneMaps) -> None:
        self._colors.SetInputData(_image(maps.colors))
        self._normals.SetInputData(_image(maps.normals))
        points, cells = vtk.vtkPoints(), vtk.vtkCellArray()
        points.SetData(vtk.numpy_to_vtk(maps.corners.astype(np.float32), deep=True))
        for triangle in ((0, 1, 2), (0, 2, 3)):
            cells.InsertNextCell(3, triangle)
        plane = vtk.vtkPolyData()
        plane.SetPoints(points)
        plane.SetPolys(cells)
        normals = vtk.numpy_to_vtk(np.tile(maps.normal.astype(np.float32), (4, 1)), deep=True)
        normals.SetName("Normals")
        plane.GetPointData().SetNormals(normals)
        places = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32)
        coordinates = vtk.numpy_to_vtk(places, deep=True)
        coordinates.SetName("Texture coordinates")
        plane.GetPointData().SetTCoords(coordinates)
        tangents = vtk.vtkPolyDataTangents()
        tangents.SetInputData(plane)
        tangents.Update()
        self.mapper.SetInputData(tangents.GetOutput())

    def check(self) -> None:
        """Raise what VTK complained about while it drew."""
        self.errors.raise_any(self.mapper.GetClassName())

    def release(self, window: Any) -> None:
        """Release what lies on the GPU; the context is current."""
        self._maps.clear()
        self.actor.ReleaseGraphicsResources(window)
        self._colors.ReleaseGraphicsResources(window)
        self._normals.ReleaseGraphicsResources(window)
        self.mapper.RemoveAllInputs()
        self._shown = None


def _request(frame: Frame) -> PlaneRequest:
    settings, corners = frame.settings, frame.box_corners
    origin, normal = default_cut_plane(corners)
    origin = settings.plane_origin or origin
    normal = settings.plane_normal or normal
    away = np.dot(frame.camera.direction, normal) > 0
    if not frame.camera.parallel:
        away = np.dot(frame.camera.eye - np.asarray(origin), normal) < 0
    texels = min(settings.texels, MOVING_TEXELS) if frame.interactive else settings.texels
    return PlaneRequest(
        frame.volume,
        frame.transfer_function,
        # the light does not change what is sampled
        replace(settings, ambient=0.0, diffuse=0.0),
        tuple(origin),
        tuple(-n for n in normal) if away else tuple(normal),
        frame.crop,
        frame.planes,
        tuple(tuple(corner) for corner in corners.tolist()),
        texels,
    )


def _image(pixels: npt.NDArray[np.uint8]) -> Any:
    """An image as VTK's image; row 0 is the lowest."""
    height, width, channels = pixels.shape
    image = vtk.vtkImageData()
    image.SetDimensions(width, height, 1)
    image.GetPointData().SetScalars(vtk.numpy_to_vtk(pixels.reshape(-1, channels), deep=True))
    return image
