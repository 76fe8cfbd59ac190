"""Voxels above an isovalue by VTK's point mapper."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.gpu.scalars import BRICK, bricks_of
from volviz.custom_gl.technique import Frame
from volviz.custom_gl.techniques.vtk_point_gaussian.cloud import Cloud
from volviz.custom_gl.vtk_props.background import Background
from volviz.custom_gl.vtk_props.clipping import set_planes, shown_part
from volviz.kernels.splats import Splats, select_splats
from volviz.model.auto_isovalue import auto_isovalue
from volviz.model.volume import Volume

#: Clip planes that the mapper takes.
MAX_PLANES = 6
#: Seconds that a picture waits for its splats before the window gets its turn.
PATIENCE = 0.015

#: Splats that are drawn while something moves, on software OpenGL and on a graphics card.
MOVING_SPLATS, MOVING_SPLATS_HARDWARE = 40_000, 1_000_000


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
        self.writes_depth = True
        # one for all splats and one for some of them, so that neither is uploaded again after a gesture
        self._clouds = {False: Cloud(), True: Cloud()}
        self._now = self._clouds[False]

    @property
    def props(self) -> tuple[Any, ...]:
        """The splats."""
        return (self._now.actor,)

    @property
    def mapper(self) -> Any:
        """VTK's mapper of the splats that are shown."""
        return self._now.mapper

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
        moving = frame.interactive and len(splats.values) > limit
        if moving:
            splats = self._selection(splats, limit)
            # fewer splats on the same surface: each is larger
            enlarged = (len(self._splats.values) / limit) ** 0.5
        steps = lattice_steps(volume, settings.splats_per_axis)
        cloud = self._now = self._clouds[moving]
        cloud.show(splats, volume)
        cloud.paint(frame.transfer_function, disc=disc)
        cloud.shape(enlarged * settings.splat_size * float((steps * volume.spacing).max()), disc=disc)
        set_planes(cloud.mapper, shown_part(frame)[:MAX_PLANES])
        self.writes_depth = disc
        return True

    def _selection(self, splats: Splats, count: int) -> Splats:
        """Some of the splats, the same ones every time."""
        if self._few is None or self._few[0] is not splats:
            chosen = np.sort(np.random.default_rng(0).permutation(len(splats.values))[:count])
            few = Splats(splats.positions[chosen], splats.normals[chosen], splats.values[chosen])
            self._few = (splats, few)
        return self._few[1]

    def check(self) -> None:
        """Raise what VTK complained about while it drew."""
        self._now.errors.raise_any(self.mapper.GetClassName())

    def release(self, window: Any) -> None:
        """Release what lies on the GPU; the context is current."""
        self._background.close()
        for cloud in self._clouds.values():
            cloud.release(window)
        self._splats = self._few = None


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
