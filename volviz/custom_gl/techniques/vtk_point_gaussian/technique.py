"""Voxels above an isovalue by VTK's point mapper."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from volviz.custom_gl.splat_selection import lattice_steps, splats_of
from volviz.custom_gl.technique import Frame
from volviz.custom_gl.techniques.vtk_point_gaussian.cloud import Cloud
from volviz.custom_gl.vtk_props.clipping import Plane, clip_planes_of, set_planes
from volviz.kernels.splats import Splats
from volviz.tasks import LatestResult
from volviz.volume_data.volume import Volume

#: Clip planes that the mapper takes; what more would cut away is not handed to it.
MAX_PLANES = 6
#: Splats that are drawn while something moves, on software OpenGL and on a graphics card.
MOVING_SPLATS, MOVING_SPLATS_HARDWARE = 40_000, 1_000_000


class _CloudRequest(NamedTuple):
    """Which voxels; equal requests give equal splats."""

    volume: Volume
    isovalue: float
    per_axis: int | None
    cull: bool
    cuts: tuple[Plane, ...]

    def may_follow(self, other: _CloudRequest) -> bool:
        """Whether a moving image may go on with the other splats until these are ready."""
        return self.volume is other.volume and self.cull == other.cull


class VtkPointGaussian:
    """`vtkPointGaussianMapper` on the voxels that our splatting takes."""

    by_tiles = False
    within_tiles = False
    ambient_from_light = True
    seconds_per_pixel = 1e-6

    def __init__(self) -> None:
        self._selected: LatestResult[_CloudRequest, Splats] = LatestResult("splats", cancels=False)
        self._request: _CloudRequest | None = None
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
        """Select the voxels in the background; True when there are some to show."""
        settings, volume = frame.settings, frame.volume
        disc = settings.footprint == "disc"
        planes = clip_planes_of(frame)
        # a cut lays bare what would be hidden
        cull = disc and not planes
        request = _CloudRequest(
            volume, frame.isovalues[0], settings.splats_per_axis, cull, tuple(planes[MAX_PLANES:])
        )
        splats = self._selected.get(frame.tasks, request, lambda _progress, _cancel: _selected(request))
        if splats is None:
            if not frame.interactive or self._request is None or not request.may_follow(self._request):
                return False
        else:
            self._request, self._splats = request, splats
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
        set_planes(cloud.mapper, planes[:MAX_PLANES])
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
        self._selected.clear()
        for cloud in self._clouds.values():
            cloud.release(window)
        self._splats = self._few = None


def _selected(request: _CloudRequest) -> Splats:
    """The splats of a request, without those whose centres its cuts take away."""
    volume = request.volume
    splats = splats_of(volume, request.isovalue, request.per_axis, cull=request.cull)
    if not request.cuts:
        return splats
    matrix = volume.index_to_world
    world = splats.positions @ matrix[:3, :3].T + matrix[:3, 3]
    kept = np.all([(world - origin) @ normal >= 0.0 for origin, normal in request.cuts], axis=0)
    return Splats(splats.positions[kept], splats.normals[kept], splats.values[kept])
