"""Voxels above an isovalue by VTK's point mapper."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.gpu.scalars import BRICK, bricks_of
from volviz.custom_gl.technique import Frame
from volviz.custom_gl.vtk_props import border as vtk
from volviz.custom_gl.vtk_props.background import Background
from volviz.custom_gl.vtk_props.clipping import set_planes, shown_part
from volviz.custom_gl.vtk_props.errors import ErrorWords
from volviz.kernels.splats import Splats, select_splats
from volviz.model.auto_isovalue import auto_isovalue
from volviz.model.transfer_function import TransferFunction
from volviz.model.volume import Volume

#: Clip planes that the mapper takes.
MAX_PLANES = 6
#: Seconds that a picture waits for its splats before the window gets its turn.
PATIENCE = 0.015

#: Splats that are drawn while something moves, on software OpenGL and on a graphics card.
MOVING_SPLATS, MOVING_SPLATS_HARDWARE = 40_000, 1_000_000

#: Standard deviation of a Gaussian in diameters, as in our splatting.
SIGMA_PER_DIAMETER = 0.45

#: A disc: nothing outside the radius, everything inside. VTK's own footprint is a Gaussian, the radius its deviation.
_DISC = "//VTK::Color::Impl\nif (dot(offsetVCVSOutput.xy, offsetVCVSOutput.xy) > 1.0) { discard; }\n"


class _Wish(NamedTuple):
    """Which voxels; equal wishes give equal splats."""

    volume: Volume
    isovalue: float
    per_axis: int | None
    cull: bool


class VtkPointGaussian:
    """`vtkPointGaussianMapper` on the voxels that our splatting takes."""

    by_tiles = False
    within_tiles = False
    ambient_from_light = True
    seconds_per_pixel = 1e-6

    def __init__(self) -> None:
        self._background: Background[_Wish, Splats] = Background()
        self._wish: _Wish | None = None
        self._splats: Splats | None = None
        self._few: tuple[Splats, Splats] | None = None
        self._painted: Any = None
        self._points: Any = None
        self._disc: bool | None = None
        self.writes_depth = True
        self.mapper = vtk.vtkPointGaussianMapper()
        self.mapper.EmissiveOff()
        self.mapper.SetColorModeToDirectScalars()
        self.actor = vtk.vtkActor()
        self.actor.SetMapper(self.mapper)
        self.errors = ErrorWords(self.mapper, self.actor)

    @property
    def props(self) -> tuple[Any, ...]:
        """The splats."""
        return (self.actor,)

    def prepare(self, frame: Frame) -> bool:
        """Select the voxels on a thread; True when there are some to show."""
        settings, volume = frame.settings, frame.volume
        disc = settings.footprint == "disc"
        isovalue = settings.isovalue if settings.isovalue is not None else auto_isovalue(volume)
        wish = _Wish(volume, float(isovalue), settings.splats_per_axis, disc)
        splats = self._background.get(wish, lambda: _select(wish), PATIENCE)
        if splats is None:
            if not frame.interactive or self._wish is None or self._wish[::3] != wish[::3]:
                return False
        else:
            self._wish, self._splats = wish, splats
        assert self._splats is not None
        splats, enlarged = self._splats, 1.0
        limit = MOVING_SPLATS if frame.gpu.limits.software else MOVING_SPLATS_HARDWARE
        if frame.interactive and len(splats.values) > limit:
            splats = self._selection(splats, limit)
            # fewer splats on the same surface: each is larger
            enlarged = (len(self._splats.values) / limit) ** 0.5
        self._show_points(splats, volume)
        self._paint(splats, frame.transfer_function, disc=disc)
        self._shape(settings, volume, enlarged, disc=disc)
        set_planes(self.mapper, shown_part(frame)[:MAX_PLANES])
        return True

    def _selection(self, splats: Splats, count: int) -> Splats:
        """Some of the splats, the same ones every time."""
        if self._few is None or self._few[0] is not splats:
            chosen = np.sort(np.random.default_rng(0).permutation(len(splats.values))[:count])
            self._few = (splats, Splats(*(np.ascontiguousarray(part[chosen]) for part in splats)))
        return self._few[1]

    def _show_points(self, splats: Splats, volume: Volume) -> None:
        if self._points is splats:
            return
        self._points = splats
        self._painted = None
        to_world = volume.index_to_world
        world = splats.positions.astype(np.float64) @ to_world[:3, :3].T + to_world[:3, 3]
        points = vtk.vtkPoints()
        points.SetData(vtk.numpy_to_vtk(world.astype(np.float32), deep=True))
        data = vtk.vtkPolyData()
        data.SetPoints(points)
        self.mapper.SetInputData(data)

    def _paint(self, splats: Splats, function: TransferFunction, *, disc: bool) -> None:
        if self._painted == (id(function), disc):
            return
        self._painted = (id(function), disc)
        self._function = function
        rgba = function.evaluate(splats.values)
        if disc:
            rgba[:, 3] = 1.0
        data = self.mapper.GetInput()
        data.GetPointData().SetScalars(vtk.numpy_to_vtk(_bytes(rgba), deep=True))
        data.Modified()

    def _shape(self, settings: Any, volume: Volume, enlarged: float, *, disc: bool) -> None:
        steps = lattice_steps(volume, settings.splats_per_axis)
        diameter = enlarged * settings.splat_size * float((steps * volume.spacing).max())
        # VTK's radius is a disc's radius or a Gaussian's standard deviation
        self.mapper.SetScaleFactor(diameter * (0.5 if disc else SIGMA_PER_DIAMETER))
        if disc == self._disc:
            return
        self._disc = disc
        self.mapper.SetSplatShaderCode(_DISC if disc else None)
        # the triangle around a splat, in radii
        self.mapper.SetBoundScale(1.0 if disc else 3.0)
        self.writes_depth = disc
        if disc:
            self.actor.ForceOpaqueOn()
            self.actor.ForceTranslucentOff()
        else:
            self.actor.ForceOpaqueOff()
            self.actor.ForceTranslucentOn()

    def check(self) -> None:
        """Raise what VTK complained about while it drew."""
        self.errors.raise_any(self.mapper.GetClassName())

    def release(self, window: Any) -> None:
        """Release what lies on the GPU; the context is current."""
        self._background.close()
        self.actor.ReleaseGraphicsResources(window)
        self.mapper.RemoveAllInputs()
        self._splats = self._few = self._points = self._painted = None


def lattice_steps(volume: Volume, per_axis: int | None) -> npt.NDArray[np.float64]:
    """Distance of neighbouring splats along x, y, z in voxels."""
    if per_axis is None:
        return np.ones(3)
    return np.asarray(np.maximum(np.array(volume.dimensions) / per_axis, 1.0))


def _select(wish: _Wish) -> Splats:
    volume = wish.volume
    bricks = bricks_of(volume)
    return select_splats(
        volume.array,
        wish.isovalue,
        spacing=volume.spacing,
        direction=volume.direction,
        splats_per_axis=wish.per_axis,
        cull_interior=wish.cull,
        bricks=(bricks.low, bricks.high),
        brick=BRICK,
        lowest=volume.range[0],
    )


def _bytes(rgba: npt.NDArray[np.float64]) -> npt.NDArray[np.uint8]:
    return np.rint(np.clip(rgba, 0.0, 1.0) * 255.0).astype(np.uint8)
