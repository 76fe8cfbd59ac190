"""The textures of the volume that a handle shows: taken from the window, filled a piece at a time, given back."""

from __future__ import annotations

import time
from typing import Any

from volviz.custom_gl.gpu.resources import VolumeResources, texel_limits
from volviz.custom_gl.gpu.scalars import is_prepared, prepare
from volviz.custom_gl.host.window_gpu import WindowGpu
from volviz.custom_gl.resolve import ResolvedSpec
from volviz.tasks import Done, LatestResult, Tasks


class NoTextures:
    """Always complete; every level is the full one."""

    complete = True
    coarsest = 0

    def upload(self, max_bytes: int | None = None) -> bool:
        """There is nothing to upload."""
        del max_bytes
        return True

    def select(self, level: int) -> None:
        """There is one level only."""


NO_TEXTURES = NoTextures()


class ShownTextures:
    """Holds the textures of one volume at a time.

    Parameters
    ----------
    window_gpu : WindowGpu
        Where they are; all volumes of a window share it.
    on_task : callable
        Called when the scalars of a volume have been prepared, on another thread.

    Attributes
    ----------
    tasks : Tasks
        Where they are prepared.
    """

    def __init__(self, window_gpu: WindowGpu, on_task: Done) -> None:
        self._window_gpu = window_gpu
        self.tasks = Tasks(on_task)
        self._prepared: LatestResult[Any, bool] = LatestResult("scalars", cancels=False)
        self._held: VolumeResources | None = None

    def are_made(self, shown: ResolvedSpec) -> bool:
        """Whether there are textures for what is shown, or none are needed."""
        if not shown.info.uses_textures:
            return True
        return self._held is not None and self._held.volume is shown.volume

    def can_be_made(self, shown: ResolvedSpec) -> bool:
        """Whether they can be made without computing texels here first; if not, a task begins to compute them."""
        if self.are_made(shown):
            return True
        volume, limits = shown.volume, texel_limits(self._window_gpu.gpu, shown.volume)
        if is_prepared(volume, *limits):
            return True
        ready = self._prepared.get(
            self.tasks, (volume, limits), lambda _progress, _cancel: prepare(volume, *limits)
        )
        return ready is not None

    def of(self, shown: ResolvedSpec) -> VolumeResources | NoTextures:
        """The textures of what is shown, made if need be; those of another volume are given back."""
        needed = shown.info.uses_textures
        if self._held is not None and (self._held.volume is not shown.volume or not needed):
            self.release()
        if not needed:
            return NO_TEXTURES
        if self._held is None:
            self._held = self._window_gpu.resources(shown.volume)
        return self._held

    def upload(self, shown: ResolvedSpec, budget: float) -> bool:
        """Fill them for about `budget` seconds; True when they are full."""
        begin = time.perf_counter()
        textures = self.of(shown)
        while not textures.complete:
            textures.upload(1)
            self._window_gpu.gpu.gl.finish()
            if time.perf_counter() - begin > budget:
                break
        return textures.complete

    @property
    def notice(self) -> str:
        """A sentence where several voxels had to become one texel; empty otherwise."""
        if self._held is None or max(self._held.full_factor) == 1:
            return ""
        blocks = " x ".join(str(n) for n in self._held.full_factor)
        return (
            f"This volume is larger than the graphics memory or its largest texture allows: blocks of {blocks} "
            "voxels (x, y, z) are drawn as one; crop the file or raise VOLVIZ_TEXTURE_MB to see all of it."
        )

    def close(self) -> None:
        """Stop preparing; the context need not live."""
        self.tasks.close()
        self._prepared.clear()

    def release(self) -> None:
        """Give them back; the context is current."""
        if self._held is not None:
            self._window_gpu.drop(self._held)
            self._held = None
