"""The life of a technique object in a window: made when first needed, called in a clean state, released in time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from volviz.custom_gl.technique import Frame, ImageTechnique, TechniqueInfo
from volviz.custom_gl.vtk.prop_renderer import PropRenderer
from volviz.tasks import Done, Tasks


class TechniqueRunner:
    """Runs one technique after the other.

    Attributes
    ----------
    technique : ImageTechnique or None
        The present one; None before the first drawing and after `retire`.
    tasks : Tasks
        Its work in the background (`Frame.tasks`).

    Parameters
    ----------
    window : vtkRenderWindow
        Where it draws.
    camera : callable
        Gives the `vtkCamera` of the plotter's renderer.
    on_task : callable
        Called with each task of the technique that has ended, on its thread.
    """

    def __init__(self, window: Any, camera: Callable[[], Any], on_task: Done) -> None:
        self.technique: ImageTechnique | None = None
        self.tasks = Tasks(on_task)
        self._on_task = on_task
        self._retired: list[ImageTechnique] = []
        self._window = window
        self._camera = camera

    def reported(self, name: str, default: Any) -> Any:
        """An optional attribute of the technique (`volviz.custom_gl.technique.ImageTechnique`)."""
        return getattr(self.technique, name, default)

    def retire(self) -> None:
        """Another technique follows; the context need not be current, `ready` releases what this one holds."""
        if self.technique is not None:
            self._retired.append(self.technique)
            self.technique = None
            self.tasks.close()
            self.tasks = Tasks(self._on_task)

    def ready(self, info: TechniqueInfo) -> ImageTechnique:
        """The technique of that description, made if need be; the context is current."""
        self._release_retired()
        if self.technique is None:
            made = info.create()
            if info.kind == "prop":
                made = PropRenderer(made, self._window, self._camera)
            self.technique = made
        return self.technique

    def plan(self, info: TechniqueInfo, frame: Frame) -> int:
        """Into how many chunks the technique divides a frame; 0 = it waits for a task."""
        clean(frame)
        return self.ready(info).plan(frame)

    def draw(self, info: TechniqueInfo, frame: Frame, chunk: int) -> None:
        """Let the technique draw one of them."""
        clean(frame)
        self.ready(info).draw(frame, chunk)
        frame.gpu.gl.scissor = None

    def release(self) -> None:
        """Release all GPU objects; the context is current."""
        self.retire()
        self.tasks.close()
        self._release_retired()

    def _release_retired(self) -> None:
        for technique in self._retired:
            technique.release()
        self._retired.clear()


def clean(frame: Frame) -> None:
    """Default state, the frame's target bound: what every call of a technique may rely on."""
    frame.resources.select(frame.level)
    gl = frame.gpu.gl
    gl.enable_only(gl.NOTHING)
    frame.target.fbo.use()
    frame.target.fbo.depth_mask = True
    gl.viewport = (0, 0, *frame.size)
    gl.scissor = None
