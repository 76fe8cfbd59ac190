"""Splats as one packed array, selected and ordered on a thread of their own."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.splat_selection import splats_of
from volviz.custom_gl.techniques.splatting.order import Eye, back_to_front, shuffled
from volviz.model.volume import Volume

#: Floats per splat: voxel index (3), normal (3), fraction of the data range (1).
FLOATS = 7

Packed = npt.NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Wanted:
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

    def may_follow(self, other: Wanted) -> bool:
        """Whether a moving picture may go on with the other splats until these are ready."""
        return self.volume is other.volume and (self.eye is None) == (other.eye is None)


@dataclass(frozen=True, eq=False)
class Ready:
    """Finished splats.

    Attributes
    ----------
    wanted : Wanted
        What was asked for.
    packed : ndarray of shape (N, 7), float32
        In drawing order.
    """

    wanted: Wanted
    packed: Packed


class SplatStore:
    """Keeps the last splats and makes new ones in the background."""

    def __init__(self) -> None:
        self.ready: Ready | None = None
        self.error: Exception | None = None
        self._selected: tuple[Any, Packed] | None = None
        self._thread: threading.Thread | None = None

    def get(self, wanted: Wanted, *, wait: bool, patience: float | None = None) -> Ready | None:
        """The splats, or what there was before as long as they are not ready.

        Parameters
        ----------
        wanted : Wanted
            What is to be drawn.
        wait : bool
            Come back with these splats only. Without others that may be shown meanwhile they are waited for anyway.
        patience : float, optional
            Seconds to wait for them before None is given; the default is to wait for as long as it takes.
        """
        while self.ready is None or self.ready.wanted.key != wanted.key:
            if self._thread is None:
                self._begin(wanted)
            elif self._thread.is_alive() and not wait and self.ready is not None:
                if wanted.may_follow(self.ready.wanted):
                    break
                if not self._end(patience):
                    return None
            elif not self._end(patience):
                return None
        return self.ready

    def _begin(self, wanted: Wanted) -> None:
        self._thread = threading.Thread(target=self._work, args=(wanted,), name="volviz-splats", daemon=True)
        self._thread.start()

    def _end(self, patience: float | None = None) -> bool:
        """Wait for the thread; False when it needs longer."""
        if self._thread is not None:
            self._thread.join(patience)
            if self._thread.is_alive():
                return False
            self._thread = None
        if self.error is not None:
            error, self.error = self.error, None
            raise error
        return True

    def _work(self, wanted: Wanted) -> None:
        try:
            if self._selected is None or self._selected[0] != wanted.selection:
                self._selected = (wanted.selection, pack(wanted))
            packed = self._selected[1]
            if wanted.eye is None:
                order = shuffled(len(packed))
            else:
                order = back_to_front(packed[:, :3], wanted.eye, wanted.volume.index_to_world)
            self.ready = Ready(wanted, packed[order])
        except Exception as error:  # noqa: BLE001 - raised again where the splats are asked for
            self.error = error

    def close(self) -> None:
        """Wait for the thread and forget everything."""
        if self._thread is not None:
            self._thread.join()
            self._thread = None
        self.ready = self._selected = self.error = None


def pack(wanted: Wanted) -> Packed:
    """Select splats: rows of voxel index, unit normal in the world and fraction of the data range."""
    volume = wanted.volume
    low, high = volume.range
    splats = splats_of(volume, wanted.isovalue, wanted.per_axis, cull=wanted.cull)
    packed = np.empty((len(splats.values), FLOATS), np.float32)
    packed[:, :3] = splats.positions
    packed[:, 3:6] = splats.normals
    packed[:, 6] = (splats.values - low) / (high - low if high > low else 1.0)
    return packed
