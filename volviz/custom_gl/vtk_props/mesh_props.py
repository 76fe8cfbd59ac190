"""Isosurfaces that VTK's filters extract and its polygon mapper draws."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from volviz.custom_gl.vtk_props import vtk_imports as vtk
from volviz.custom_gl.vtk_props.clipping import Plane, clip_planes_of, set_planes
from volviz.custom_gl.vtk_props.errors import ErrorWords
from volviz.custom_gl.vtk_props.images import PlacedImage
from volviz.custom_gl.vtk_props.scalar_coloring import ScalarColoring, set_material, show_colors
from volviz.tasks import LatestResult

if TYPE_CHECKING:
    from volviz.custom_gl.technique import Frame
    from volviz.model.surface_values import SurfaceColors
    from volviz.volume_data.volume import Volume

#: Clip planes that the polygon mapper takes; with more the mesh itself is cut.
MAX_PLANES = 6
#: Triangles that are drawn while something moves: about 30 ms on software OpenGL, and on a graphics card.
MOVING_TRIANGLES, MOVING_TRIANGLES_HARDWARE = 60_000, 1_500_000
#: By how much the stride of an LOD mesh may be larger than that of the mesh.
COARSER = (2, 4, 8)


class _MeshPropRequest(NamedTuple):
    """What is to be extracted; equal requests give equal meshes."""

    volume: Volume
    isovalue: float
    stride: int
    smooth: bool
    cuts: tuple[Plane, ...]


class _ExtractedMesh(NamedTuple):
    """A mesh in the coordinates of its image, and where that lies."""

    request: _MeshPropRequest
    placed: PlacedImage
    mesh: Any

    @property
    def triangles(self) -> int:
        """Number of triangles."""
        return int(self.mesh.GetNumberOfCells())


class _Drawn:
    """An actor, and the surface that it shows."""

    def __init__(self, coloring: str) -> None:
        self.surface: _ExtractedMesh | None = None
        self.mesh: Any = None
        self.colors: SurfaceColors | None = None
        self.coloring = ScalarColoring(coloring)
        self.actor = vtk.vtkActor()
        self.mapper = vtk.vtkPolyDataMapper()
        self.mapper.ScalarVisibilityOff()
        self.actor.SetMapper(self.mapper)
        self.errors = ErrorWords(self.mapper, self.actor)

    def show(self, surface: _ExtractedMesh, mesh: Any) -> None:
        """Show this surface by its mesh, or by a painted copy; nothing happens when it is shown already."""
        if surface is not self.surface or mesh is not self.mesh:
            self.surface, self.mesh = surface, mesh
            self.mapper.SetInputData(mesh)
            self.actor.SetUserMatrix(surface.placed.matrix)

    def color(self, colors: SurfaceColors | None) -> None:
        """Colour by the values of a painted copy, or not."""
        if colors is not None:
            set_material(self.actor.GetProperty())
        if colors is not self.colors:
            self.colors = colors
            if colors is None:
                self.mapper.ScalarVisibilityOff()
            else:
                show_colors(self.mapper, colors)

    def release(self, window: Any) -> None:
        """Release what lies on the GPU; the context is current."""
        self.actor.ReleaseGraphicsResources(window)
        self.mapper.RemoveAllInputs()
        self.coloring.clear()
        self.surface = self.mesh = None


class MeshProp:
    """A `vtkActor` with a mesh that a filter makes of the volume.

    Parameters
    ----------
    make_filter : type
        `vtkMarchingCubes`, `vtkFlyingEdges3D` or another contour filter for images.
    """

    by_tiles = False
    writes_depth = True
    within_tiles = True
    ambient_from_light = True
    seconds_per_pixel = 1e-6

    def __init__(self, make_filter: Any) -> None:
        self._make_filter = make_filter
        self._fine: LatestResult[_MeshPropRequest, _ExtractedMesh] = LatestResult("mesh", cancels=False)
        self._coarse: LatestResult[_MeshPropRequest, _ExtractedMesh] = LatestResult(
            "coarse mesh", cancels=False
        )
        self._full: _ExtractedMesh | None = None
        # one for the full mesh and one for LOD meshes, so that neither is uploaded again after a gesture
        self._drawn = {False: _Drawn("values"), True: _Drawn("coarse values")}
        self._now = self._drawn[False]

    @property
    def props(self) -> tuple[Any, ...]:
        """The surface."""
        return (self._now.actor,)

    @property
    def mapper(self) -> Any:
        """VTK's mapper of the mesh that is shown."""
        return self._now.mapper

    def prepare(self, frame: Frame) -> bool:
        """Extract the surface in the background; True when there is one to show."""
        settings, volume = frame.settings, frame.volume
        planes = clip_planes_of(frame)
        request = _MeshPropRequest(
            volume,
            frame.isovalues[0],
            settings.stride,
            settings.normals == "gradient",
            tuple(planes[MAX_PLANES:]),
        )
        surface = self._lod_mesh(frame, request) if frame.interactive else None
        is_lod_mesh = surface is not None
        if surface is None:
            surface = self._extracted(self._fine, frame, request)
            self._full = surface or self._full
        if surface is None:
            # while something moves, the surface of before is better than an image that stands still
            surface, is_lod_mesh = self._now.surface, self._now is self._drawn[True]
            if not frame.interactive or surface is None or surface.request.volume is not volume:
                return False
        mesh, colors = surface.mesh, frame.surface_colors
        drawn = self._drawn[is_lod_mesh]
        if colors is not None and surface.triangles:
            # the surface of before must not get the colours of this one
            if surface.request.isovalue != request.isovalue:
                return False
            coarse = is_lod_mesh or settings.wireframe or self._is_slow(frame, 3 * surface.triangles)
            drawn = self._drawn[is_lod_mesh or (frame.interactive and coarse)]
            mesh = drawn.coloring.get(
                frame.tasks, surface.mesh, surface.placed.to_world, colors.values, lod_mesh=coarse
            )
            if mesh is None:
                return False
        self._now = drawn
        drawn.show(surface, mesh)
        set_planes(drawn.mapper, planes[:MAX_PLANES])
        look = drawn.actor.GetProperty()
        look.SetColor(*settings.color)
        look.SetSpecularColor(1.0, 1.0, 1.0)
        look.SetAmbient(settings.ambient)
        look.SetDiffuse(settings.diffuse)
        look.SetSpecular(settings.specular)
        look.SetSpecularPower(settings.shininess)
        look.SetInterpolation(2 if request.smooth else 0)
        look.SetRepresentation(1 if settings.wireframe else 2)
        drawn.color(None if mesh is surface.mesh else colors)
        return True

    @staticmethod
    def _is_slow(frame: Frame, triangles: int) -> bool:
        """Whether a moving image cannot have so many triangles."""
        limit = MOVING_TRIANGLES if frame.gpu.limits.software else MOVING_TRIANGLES_HARDWARE
        return frame.interactive and triangles > limit

    def _lod_mesh(self, frame: Frame, request: _MeshPropRequest) -> _ExtractedMesh | None:
        """A coarser mesh where the full one has too many triangles to be moved; None where it has not."""
        limit = MOVING_TRIANGLES if frame.gpu.limits.software else MOVING_TRIANGLES_HARDWARE
        full = self._full
        if full is None or full.request.volume is not request.volume or full.triangles <= limit:
            return None
        # a surface: the number of triangles falls with the square of the stride
        fine = full.request.stride
        factors = [f for f in COARSER if full.triangles * (fine / (f * request.stride)) ** 2 <= limit]
        stride = request.stride * (factors[0] if factors else COARSER[-1])
        coarse = request._replace(stride=stride)
        made = self._extracted(self._coarse, frame, coarse)
        last = made if made is not None else self._coarse.last
        return last if last is not None and last.request.volume is request.volume else None

    def _extracted(
        self,
        surfaces: LatestResult[_MeshPropRequest, _ExtractedMesh],
        frame: Frame,
        request: _MeshPropRequest,
    ) -> _ExtractedMesh | None:
        """The surface of a request, or None while a task makes it."""
        make = self._make_filter
        return surfaces.get(frame.tasks, request, lambda _progress, _cancel: _extract(make, request))

    def check(self) -> None:
        """Raise what VTK complained about while it drew."""
        self._now.errors.raise_any(self.mapper.GetClassName())

    def release(self, window: Any) -> None:
        """Release what lies on the GPU; the context is current."""
        self._fine.clear()
        self._coarse.clear()
        self._full = None
        for drawn in self._drawn.values():
            drawn.release(window)


def _extract(make_filter: Any, request: _MeshPropRequest) -> _ExtractedMesh:
    """The surface by VTK's filter, which cannot be interrupted."""
    placed = PlacedImage(request.volume, request.stride)
    contour = make_filter()
    errors = ErrorWords(contour)
    contour.SetInputData(placed.image)
    contour.SetValue(0, placed.value(request.isovalue))
    contour.SetComputeNormals(request.smooth)
    contour.ComputeGradientsOff()
    contour.ComputeScalarsOff()
    contour.Update()
    errors.raise_any(contour.GetClassName())
    mesh = contour.GetOutput()
    to_image = np.linalg.inv(placed.to_world)
    for origin, normal in request.cuts:
        plane = vtk.vtkPlane()
        plane.SetOrigin(*(to_image @ (*origin, 1.0))[:3])
        plane.SetNormal(*(placed.to_world[:3, :3].T @ normal))
        clip = vtk.vtkClipPolyData()
        clip.SetInputData(mesh)
        clip.SetClipFunction(plane)
        clip.Update()
        mesh = clip.GetOutput()
    return _ExtractedMesh(request, placed, mesh)
