"""One side of a comparison: a technique in an off-screen window of its own, drawn at full quality."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, Self

import numpy.typing as npt

from volviz.custom_gl.host import add_volume
from volviz.custom_gl.host.vtk_border import pyvista
from volviz.custom_gl.host.window_gpu import WindowGpu, acquire, give_back
from volviz.custom_gl.registry import technique as technique_info
from volviz.custom_gl.technique import TechniqueInfo
from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.light import Light
from volviz.model.transfer_function import TransferFunction
from volviz.model.volume import Volume
from volviz.offscreen import apply_camera, finished


@dataclass(frozen=True)
class View:
    """What all sides of a comparison have in common.

    Attributes
    ----------
    volume : Volume
    transfer_function : TransferFunction
    camera : Camera
    size : tuple of 2 ints
        Width and height in pixels.
    light : Light
    clipping : Clipping
    background : tuple of 3 floats
        Pictures are compared over this colour, 0..1.
    """

    volume: Volume
    transfer_function: TransferFunction
    camera: Camera
    size: tuple[int, int] = (800, 600)
    light: Light = field(default_factory=Light)
    clipping: Clipping = field(default_factory=Clipping)
    background: tuple[float, float, float] = (0.0, 0.0, 0.0)


class Stage:
    """A technique in an off-screen window of its own; a context manager.

    Parameters
    ----------
    view : View
        What is shown.
    technique : str
        Id of the technique.
    settings : object or mapping, optional
        Instance of its settings class, or single settings by name; the default are its own defaults.

    Attributes
    ----------
    first_seconds : float
        Wall time of the first picture in the open window: uploads, shaders, extraction of meshes.

    Raises
    ------
    VolvizError
        Unknown technique or setting, or drawing failed.
    """

    def __init__(self, view: View, technique: str, settings: Any = None) -> None:
        self.view = view
        self._gpu: WindowGpu | None = None
        self.handle: Any = None
        plotter: Any = pyvista.Plotter(
            off_screen=True, window_size=list(view.size), notebook=False, theme=pyvista.themes.Theme()
        )
        self._plotter: Any = plotter
        try:
            self.window: Any = plotter.render_window
            self.window.SetMultiSamples(0)
            plotter.set_background(view.background)
            # the window itself and its OpenGL context are not what is compared
            plotter.show(auto_close=False, interactive=False)
            values = dict(settings) if isinstance(settings, Mapping) else {}
            begin = time.perf_counter()
            self.handle = add_volume(
                plotter, view.volume, technique, transfer_function=view.transfer_function,
                settings=None if isinstance(settings, Mapping) else settings,
                light=view.light, clipping=view.clipping, **values,
            )  # fmt: skip
            self._draw(view.camera)
            self.first_seconds = time.perf_counter() - begin
        except BaseException:
            self.close()
            raise

    @property
    def technique(self) -> TechniqueInfo:
        """The technique that draws."""
        return technique_info(self.handle.technique.id)

    @property
    def settings(self) -> Any:
        """Its settings."""
        return self.handle.settings

    @property
    def notice(self) -> str:
        """What the picture shows differently from what was asked for; empty when nothing."""
        return str(getattr(self.handle, "notice", ""))

    @property
    def is_software(self) -> bool:
        """Whether OpenGL is computed on the processor, where its clock for the GPU means nothing."""
        return self._window_gpu().gpu.limits.software

    @property
    def renderer(self) -> str:
        """What OpenGL calls itself, with its version."""
        limits = self._window_gpu().gpu.limits
        return f"{limits.renderer}, OpenGL {limits.version}"

    def draw(self, camera: Camera) -> float:
        """Draw one complete frame and wait until it is finished.

        Returns
        -------
        float
            Wall time in seconds: VTK's part, ours and the wait for OpenGL.
        """
        self.window.MakeCurrent()
        begin = time.perf_counter()
        self._draw(camera)
        return time.perf_counter() - begin

    def draw_on_gpu_clock(self, camera: Camera) -> tuple[float, float]:
        """Draw one complete frame; wall time and OpenGL's own time for it (`GL_TIME_ELAPSED`), in seconds."""
        gpu = self._window_gpu().gpu
        self.window.MakeCurrent()
        query = gpu.gl.query(time=True)
        begin = time.perf_counter()
        with query:
            self._draw(camera)
        return time.perf_counter() - begin, float(query.elapsed) * 1e-9

    def update(self, **changes: Any) -> None:
        """Change settings by name, or `settings` as a whole; the next frame shows them."""
        self.handle.update(**changes)

    def picture(self, dtype: Literal["uint8", "float32"] = "uint8") -> npt.NDArray[Any]:
        """The picture of the view's camera over its background, shape (H, W, 3), row 0 at the top."""
        self.draw(self.view.camera)
        return finished(self.handle.read_picture(), self.view.background, dtype)[..., :3]

    def close(self) -> None:
        """Give the window and everything in it back; a second call does nothing."""
        if self._plotter is None:
            return
        if self.handle is not None:
            self.handle.remove()
        if self._gpu is not None:
            self.window.MakeCurrent()
            give_back(self._gpu, context_alive=True)
        self._plotter.close()
        self.handle = self.window = self._plotter = self._gpu = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _draw(self, camera: Camera) -> None:
        apply_camera(self._plotter.camera, camera)
        self._plotter.reset_camera_clipping_range()
        self._plotter.render()
        self.window.WaitForCompletion()
        self.handle.raise_error()

    def _window_gpu(self) -> WindowGpu:
        if self._gpu is None:
            self.window.MakeCurrent()
            self._gpu = acquire(self.window)
        return self._gpu


def nudged(camera: Camera, frame: int) -> Camera:
    """The camera of a frame while times are taken: turned by little, never the same twice running.

    Half a degree to the right, to the left, a degree to the right and so on, so that all frames together look
    from where the picture does.
    """
    return camera.turned(0.5 * (1 + frame // 2) * (1 if frame % 2 else -1))


def with_size(view: View, size: tuple[int, int]) -> View:
    """The view in a window of another size."""
    return replace(view, size=size)
