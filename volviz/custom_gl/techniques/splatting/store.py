"""Splats as one packed array, selected and ordered in the background."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.splat_selection import splats_of
from volviz.custom_gl.techniques.splatting.order import Eye, back_to_front, shuffled
from volviz.tasks import LatestResult, Tasks
from volviz.volume_data.volume import Volume

#: Floats per splat: voxel index (3), normal (3), fraction of the data range (1).
FLOATS = 7

Packed = npt.NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class SplatRequest:
    """What is to be drawn.

    Attributes
    ----------
    volume : Volume
        The data.
    isovalue : float
        In data units.
    per_axis : int or None
        Lattice; None for every voxel.
    cull : bool
        Leave hidden voxels out.
    eye : tuple of 4 floats or None
        Order from back to front for this (homogeneous) place of the eye; None for a random order.
    """

    volume: Volume
    isovalue: float
    per_axis: int | None
    cull: bool
    eye: Eye | None

    @property
    def selection(self) -> Any:
        """Equal for equal selections."""
        return self.volume, self.isovalue, self.per_axis, self.cull

    @property
    def key(self) -> Any:
        """Equal for equal splats in equal order."""
        return self.selection, self.eye

    def may_follow(self, other: SplatRequest) -> bool:
        """Whether a moving image may go on with the other splats until these are ready."""
        return self.volume is other.volume and (self.eye is None) == (other.eye is None)


@dataclass(frozen=True, eq=False)
class Ready:
    """Finished splats.

    Attributes
    ----------
    request : SplatRequest
        What was asked for.
    packed : ndarray of shape (N, 7), float32
        In drawing order.
    """

    request: SplatRequest
    packed: Packed


class SplatStore:
    """Keeps the last splats and makes new ones in the background.

    Parameters
    ----------
    key : str
        Of its tasks.
    """

    def __init__(self, key: str) -> None:
        self._ready: LatestResult[Any, Ready] = LatestResult(key, cancels=False)
        # of the thread that makes the splats: another order needs no other selection
        self._selected: tuple[Any, Packed] | None = None

    def get(self, tasks: Tasks, request: SplatRequest, *, may_follow: bool) -> Ready | None:
        """The splats, or None while they are being made.

        Parameters
        ----------
        tasks : Tasks
            Where they are made.
        request : SplatRequest
            What is to be drawn.
        may_follow : bool
            Give the last splats as long as these are not ready, where that is possible (`SplatRequest.may_follow`).
        """
        ready = self._ready.get(tasks, request.key, lambda _progress, _cancel: self._made(request))
        last = self._ready.last
        if ready is None and may_follow and last is not None and request.may_follow(last.request):
            return last
        return ready

    def _made(self, request: SplatRequest) -> Ready:
        selected = self._selected
        if selected is None or selected[0] != request.selection:
            selected = self._selected = (request.selection, pack(request))
        packed = selected[1]
        if request.eye is None:
            order = shuffled(len(packed))
        else:
            order = back_to_front(packed[:, :3], request.eye, request.volume.index_to_world)
        return Ready(request, packed[order])

    def clear(self) -> None:
        """Forget everything."""
        self._ready.clear()
        self._selected = None


def pack(request: SplatRequest) -> Packed:
    """Select splats: rows of voxel index, unit normal in the world and fraction of the bulk's range."""
    volume = request.volume
    low, high = volume.bulk_range
    splats = splats_of(volume, request.isovalue, request.per_axis, cull=request.cull)
    packed = np.empty((len(splats.values), FLOATS), np.float32)
    packed[:, :3] = splats.positions
    packed[:, 3:6] = splats.normals
    packed[:, 6] = (splats.values - low) / (high - low if high > low else 1.0)
    return packed
