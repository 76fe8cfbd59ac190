"""One `Gpu` per render window, shared by all volumes in it, and the guard around our drawing."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from volviz.custom_gl.gpu.context import Gpu
from volviz.custom_gl.gpu.resources import VolumeResources
from volviz.model.volume import Volume

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
        self._volumes: dict[int, tuple[VolumeResources, int]] = {}

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

    def resources(self, volume: Volume) -> VolumeResources:
        """Textures of a volume; every caller returns them by `drop` once."""
        held = self._volumes.get(id(volume))
        if held is None:
            held = (VolumeResources(self.gpu, volume), 0)
        self._volumes[id(volume)] = (held[0], held[1] + 1)
        return held[0]

    def drop(self, resources: VolumeResources) -> None:
        """Give textures back; those that nobody uses any more are released."""
        held, users = self._volumes[id(resources.volume)]
        if users > 1:
            self._volumes[id(resources.volume)] = (held, users - 1)
        else:
            del self._volumes[id(resources.volume)]
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
