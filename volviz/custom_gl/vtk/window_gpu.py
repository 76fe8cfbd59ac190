"""One `Gpu` per render window, shared by all volumes in it, and the guard around our drawing."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Hashable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

from volviz.custom_gl.gpu.brick_resources import BrickResources
from volviz.custom_gl.gpu.context import Gpu
from volviz.custom_gl.gpu.layer_resources import LayerResources
from volviz.custom_gl.gpu.resources import VolumeResources, texel_limits
from volviz.custom_gl.resolve import ResolvedSpec
from volviz.tasks import Done, LatestResult, Tasks
from volviz.volume_data.label_indices import are_labels_known, label_indices_of
from volviz.volume_data.scalars import is_prepared, prepare, reduction
from volviz.volume_data.volume import Volume

if TYPE_CHECKING:
    from volviz.volume_data.brick_cache.selection import BrickView

#: Environment variable that leaves multisampling on with software OpenGL.
KEEP_MULTISAMPLING = "VOLVIZ_KEEP_MULTISAMPLING"


class WindowGpu:
    """Resources of a window's OpenGL context.

    Attributes
    ----------
    window : vtkRenderWindow
        The window.
    users : int
        Number of volumes that use it; the last one releases everything.
    """

    def __init__(self, window: Any) -> None:
        self.window = window
        self.users = 0
        self._gpu: Gpu | None = None
        self._volumes: dict[Hashable, tuple[VolumeResources | LayerResources, int]] = {}

    @property
    def gpu(self) -> Gpu:
        """Made when first asked for, with the window's context current."""
        if self._gpu is None:
            self._gpu = Gpu()
            self._switch_multisampling_off()
        return self._gpu

    def _switch_multisampling_off(self) -> None:
        """Software OpenGL pays for every sample of every pixel, a tenth of a volume's frame time and more."""
        if self._gpu is not None and self._gpu.limits.software and not os.environ.get(KEEP_MULTISAMPLING):
            self.window.SetMultiSamples(0)

    @property
    def started(self) -> bool:
        """Whether anything was put on the GPU."""
        return self._gpu is not None

    def resources(self, wanted: Wanted, on_brick: Done) -> VolumeResources | LayerResources:
        """Textures of a volume, or of layers that are drawn together; every caller returns them by `drop` once.

        Those of a volume that is drawn brick by brick belong to one caller, who is told of bricks by `on_brick`.
        """
        key = _key(wanted, on_brick)
        held = self._volumes.get(key)
        if held is None:
            images, labels, bricks = wanted
            one = len(images) == 1 and not labels
            if bricks:
                made: VolumeResources | LayerResources = BrickResources(self.gpu, images[0], on_brick)
            else:
                made = (
                    VolumeResources(self.gpu, images[0]) if one else LayerResources(self.gpu, images, labels)
                )
            held = (made, 0)
        self._volumes[key] = (held[0], held[1] + 1)
        return held[0]

    def drop(self, wanted: Wanted, on_brick: Done) -> None:
        """Give textures back; those that nobody uses any more are released."""
        key = _key(wanted, on_brick)
        held, users = self._volumes[key]
        if users > 1:
            self._volumes[key] = (held, users - 1)
        else:
            del self._volumes[key]
            held.release()

    @contextmanager
    def foreign(self) -> Iterator[Gpu]:
        """Our OpenGL calls between VTK's: VTK finds its state as it left it.

        The context must be current.
        """
        state = self.window.GetState()
        gpu = self.gpu
        state.Push()
        # an error that VTK or Qt left behind must not be taken for ours
        _ = gpu.gl.error
        try:
            gpu.gl.disable(gpu.gl.BLEND | gpu.gl.DEPTH_TEST | gpu.gl.CULL_FACE)
            yield gpu
        finally:
            gpu.gl.scissor = None
            self.window.GetShaderCache().ReleaseCurrentShader()
            state.Reset()
            state.Pop()

    def release(self) -> None:
        """Release everything; the context must be current."""
        for resources, _ in self._volumes.values():
            resources.release()
        self._volumes.clear()
        if self._gpu is not None:
            self._gpu.release()
            self._gpu = None


class Wanted(NamedTuple):
    """Whose textures are meant, and whether they hold bricks of several levels."""

    images: tuple[Volume, ...] = ()
    labels: tuple[Volume, ...] = ()
    bricks: bool = False


def _key(wanted: Wanted, on_brick: Done) -> Hashable:
    images, labels = (tuple(id(volume) for volume in volumes) for volumes in wanted[:2])
    # bricks are chosen for one view, by who looks at them
    return images, labels, on_brick if wanted.bricks else None


_WINDOWS: dict[str, WindowGpu] = {}


def acquire(window: Any) -> WindowGpu:
    """The resources of a window; return them by `give_back`."""
    address = window.GetAddressAsString("vtkRenderWindow")
    entry = _WINDOWS.get(address)
    if entry is None or entry.window is not window:
        entry = _WINDOWS[address] = WindowGpu(window)
    entry.users += 1
    return entry


def give_back(entry: WindowGpu, *, context_alive: bool) -> None:
    """One volume less uses the window; the last one releases everything on the GPU."""
    entry.users -= 1
    if entry.users > 0:
        return
    _WINDOWS.pop(entry.window.GetAddressAsString("vtkRenderWindow"), None)
    if context_alive:
        entry.release()


class NoTextures:
    """Always complete; every level is the full one."""

    complete = True
    finest = coarsest = 0
    voxel_scale = 1.0

    def upload(self, max_bytes: int | None = None) -> bool:
        """There is nothing to upload."""
        del max_bytes
        return True

    def select(self, level: int) -> None:
        """There is one level only."""


NO_TEXTURES = NoTextures()
Textures = VolumeResources | LayerResources | NoTextures


def _prepare(gpu: Gpu, images: Sequence[Volume], labels: Sequence[Volume], *, alone: bool) -> None:
    """Compute what textures of volumes are made of; needs no context."""
    for volume in images:
        prepare(volume, *texel_limits(gpu, volume, alone=alone))
    for volume in labels:
        label_indices_of(volume)


def _volumes_of(shown: ResolvedSpec) -> tuple[tuple[Volume, ...], tuple[Volume, ...]]:
    return tuple(layer.volume for layer in shown.layers), tuple(layer.volume for layer in shown.labels)


class VolumeTextures:
    """Holds the textures of what is shown: of one volume, or of several layers.

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
        self._on_task = on_task
        self._held: VolumeResources | LayerResources | None = None
        self._wanted = Wanted()

    def are_made(self, shown: ResolvedSpec) -> bool:
        """Whether there are textures for what is shown, or none are needed."""
        if not shown.info.uses_textures:
            return True
        return self._held is not None and self._wanted == self._wanted_for(shown)

    def _wanted_for(self, shown: ResolvedSpec) -> Wanted:
        """What is shown, and whether it must be drawn brick by brick: it does not fit into memory or one texture."""
        images, labels = _volumes_of(shown)
        if shown.is_joint or not shown.info.draws_bricks:
            return Wanted(images, labels)
        volume = shown.drawn_volume
        bricks = volume is not images[0]
        if not bricks:
            limits = texel_limits(self._window_gpu.gpu, volume, alone=True)
            bricks = reduction(volume.array.shape, *limits) != (1, 1, 1)
        return Wanted((volume,), labels, bricks)

    def can_be_made(self, shown: ResolvedSpec) -> bool:
        """Whether they can be made without computing texels here first; if not, a task begins to compute them."""
        if self.are_made(shown):
            return True
        images, labels, bricks = self._wanted_for(shown)
        if bricks:
            return True
        alone = len(images) == 1 and not labels
        gpu = self._window_gpu.gpu
        limits = tuple((volume, *texel_limits(gpu, volume, alone=alone)) for volume in images)
        if all(is_prepared(*each) for each in limits) and all(map(are_labels_known, labels)):
            # or it would keep the volume that was prepared before this one
            self._prepared.clear()
            return True

        def made(_progress: object, _cancel: object) -> bool:
            _prepare(gpu, images, labels, alone=alone)
            return True

        return self._prepared.get(self.tasks, (limits, labels), made) is not None

    def preparation(self, shown: ResolvedSpec) -> Callable[[Sequence[Volume], Sequence[Volume]], None]:
        """What computes the texels and bricks of volumes that are shown next, in the place of those that are now."""
        if not shown.info.uses_textures:
            return lambda _images, _labels: None
        return partial(_prepare, self._window_gpu.gpu, alone=not shown.is_joint)

    def draw_coarsely(self, shown: ResolvedSpec) -> bool:
        """Let images be drawn from a coarser level until all is uploaded; whether there is one that can be."""
        textures = self.of(shown)
        if not isinstance(textures, VolumeResources) or shown.common.interpolation == "nearest":
            return False
        return textures.coarsest > 0

    def of(self, shown: ResolvedSpec) -> Textures:
        """The textures of what is shown, made if need be; those of other volumes are given back."""
        needed = shown.info.uses_textures
        if self._held is not None and not (needed and self.are_made(shown)):
            self.release()
        if not needed:
            return NO_TEXTURES
        if self._held is None:
            self._wanted = self._wanted_for(shown)
            self._held = self._window_gpu.resources(self._wanted, self._on_task)
        return self._held

    # ------------------------------------------------------------------ bricks

    @property
    def bricks(self) -> BrickResources | None:
        """What is drawn brick by brick, None where nothing is."""
        return self._held if isinstance(self._held, BrickResources) else None

    @property
    def revision(self) -> int:
        """Grows when other bricks are to be seen."""
        return 0 if self.bricks is None else self.bricks.revision

    @property
    def is_missing(self) -> bool:
        """Whether bricks that the view needs are still to come."""
        return self.bricks is not None and self.bricks.is_missing

    def follow(self, view: BrickView | None, seconds: float) -> bool:
        """Take bricks that have been read, and ask for what a view needs; whether none waits to be taken.

        Parameters
        ----------
        view : BrickView or None
            None while something moves.
        seconds : float
            About how long it may take; infinite: until nothing is missing.
        """
        bricks = self.bricks
        if bricks is None:
            return True
        settled = bricks.look(view, seconds)
        while math.isinf(seconds) and bricks.is_missing:
            bricks.cache.wait()
            settled = bricks.look(view, seconds)
        return settled

    def wait(self, timeout: float | None) -> bool:
        """Wait for what is being prepared or read; whether nothing is any more."""
        ended = self.tasks.wait(timeout)
        if self.bricks is not None:
            self.bricks.cache.wait(timeout)
        return ended

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
        """A sentence where several voxels had to become one texel, or parts cannot be read; empty otherwise."""
        if self.bricks is not None:
            failure, status = self.bricks.cache.failure, self.bricks.status
            if failure:
                return f"Parts of the volume are seen coarser: {failure}"
            if status.limited:
                return (
                    f"Level {status.level} is shown, and finer ones do not fit into the budget of textures: crop the "
                    "volume or raise the budget to see them."
                )
            return ""
        if self._held is None or max(self._held.full_factor) == 1:
            return ""
        blocks = " x ".join(str(n) for n in self._held.full_factor)
        return (
            f"This volume is larger than the graphics memory or its largest texture allows: blocks of {blocks} "
            "voxels (x, y, z) are drawn as one; crop the file or raise the budget of textures to see all of it."
        )

    def close(self) -> None:
        """Stop preparing; the context need not live."""
        self.tasks.close()
        self._prepared.clear()

    def release(self) -> None:
        """Give them back; the context is current."""
        if self._held is not None:
            self._window_gpu.drop(self._wanted, self._on_task)
            self._held, self._wanted = None, Wanted()
