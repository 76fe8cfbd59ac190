"""Drawing a picture for a file while the window goes on: a turn now and then, the rest on workers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QObject, QTimer, Signal

from volviz.annotations.composition import Composition
from volviz.annotations.figure import is_vector
from volviz.annotations.subject import Subject
from volviz.embedded_session import carries, session_with
from volviz.model.picture import Picture, PicturePart
from volviz.model.render_spec import View
from volviz.model.surface_values import SurfaceColors
from volviz.renderer import Renderer
from volviz.scene_drawing import write_composition
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.session.workers import Task, Workers
from volviz_ui.views.picture_parts import PictureRequest

OPAQUE_SUFFIXES = (".jpg", ".jpeg")
TURN_SECONDS = 0.03
REST_MS = 2
"""Between two turns, so that the window has its own."""


class ImageExport(QObject):
    """One picture on its way into a file.

    Parameters
    ----------
    shown : LoadedScene
        What to draw; later changes of the window's scene do not matter.
    path : str
        The file; its suffix says the format.
    request : PictureRequest
        Size, background, what stands around the volume.
    parts : sequence of PicturePart
        The views that the picture is made of.
    subjects : sequence of Subject or None
        What annotations tell of, for each part.
    colors : sequence of SurfaceColors or None
        What the surface is coloured by, for each part.
    workers : Workers
        Where annotations are drawn and the file is written.
    """

    progressed = Signal(float)
    saved = Signal(str)
    failed = Signal(object)
    ended = Signal()
    """Saved, failed or cancelled."""

    def __init__(
        self,
        shown: LoadedScene,
        path: str,
        request: PictureRequest,
        parts: Sequence[PicturePart],
        subjects: Sequence[Subject | None],
        colors: Sequence[SurfaceColors | None],
        workers: Workers,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self.path = path if Path(path).suffix else path + ".png"
        self._shown, self._request, self._parts = shown, request, parts
        picture = Picture(
            request.size,
            tuple(parts),
            request.contents,
            request.transparent and not self.path.lower().endswith(OPAQUE_SUFFIXES),
            request.dpi,
        )
        self._composition = Composition(shown.scene, picture, subjects, is_vector=is_vector(Path(self.path)))
        self._workers, self._colors = workers, colors
        self._renderer: Renderer | None = None
        self._turns: Iterator[Any] = iter(())
        self._tasks: list[Task] = []
        self._number = -1
        self._is_drawn = False
        self.is_over = False
        self._timer = QTimer(self)
        self._timer.setInterval(REST_MS)
        self._timer.timeout.connect(self._turn)

    def start(self) -> None:
        """Begin; everything else is told by the signals."""
        self._timer.start()

    def cancel(self) -> None:
        """Give up what is not in the file yet."""
        if not self.is_over:
            for task in self._tasks:
                task.cancel()
            self._end()

    # ------------------------------------------------------------------ drawing

    def _turn(self) -> None:
        try:
            if self._is_drawn:
                # what is still being put together belongs into the file
                if not self._tasks:
                    self._write()
                return
            if self._number < 0:
                self._begin()
                return
            fraction, tile = next(self._turns)
            if tile is not None:
                self._take(*tile)
            self.progressed.emit((self._number + fraction) / len(self._parts))
            if fraction == 1.0:
                self._next_part()
        except Exception as error:  # noqa: BLE001 - whatever drawing raises is told, the window goes on
            self._fail(error)

    def _begin(self) -> None:
        self._renderer = Renderer(self._parts[0].size)
        self._next_part()

    def _next_part(self) -> None:
        """Begin with the next view; after the last one, what is left is the file."""
        self._number += 1
        self._is_drawn = self._number == len(self._parts)
        if self._is_drawn:
            self._release(keeps_time=True)
            return
        assert self._renderer is not None
        part = self._parts[self._number]
        self._turns = self._renderer.turns(
            replace(self._shown.spec(part.view), surface_colors=self._colors[self._number]),
            View(self._shown.scene.view_at(part.view).camera, part.size),
            self._shown.volumes,
            seconds=TURN_SECONDS,
        )

    def _take(self, region: tuple[int, int, int, int], pixels: npt.NDArray[np.float32]) -> None:
        """Have a tile of the present part put where it belongs, with what stands around it."""
        number, composition = self._number, self._composition
        self._start(lambda _task: composition.take(number, region, pixels), self._forget)

    def _start(self, work: Any, then: Any) -> None:
        task = self._workers.start(work, label=self.path)
        self._tasks.append(task)
        task.succeeded.connect(partial(then, task))
        task.failed.connect(self._fail)

    def _forget(self, task: Task, _result: Any) -> None:
        self._tasks.remove(task)

    # ------------------------------------------------------------------ the file

    def _write(self) -> None:
        self._release()
        composition, path, scene = self._composition, Path(self.path), self._shown.scene
        keeps = self._request.keep_session and carries(path)

        def write(_task: Task) -> None:
            session = session_with(scene, composition.picture, path) if keeps else None
            write_composition(composition, path, session)

        self._start(write, self._on_written)

    def _on_written(self, _task: Task, _result: Any) -> None:
        self.saved.emit(self.path)
        self._end()

    def _fail(self, error: object) -> None:
        if not self.is_over:
            for task in self._tasks:
                task.cancel()
            self.failed.emit(error)
            self._end()

    def _release(self, *, keeps_time: bool = False) -> None:
        if not keeps_time:
            self._timer.stop()
        self._turns = iter(())
        renderer, self._renderer = self._renderer, None
        if renderer is not None:
            renderer.close()

    def _end(self) -> None:
        self._release()
        self._tasks = []
        self.is_over = True
        self.ended.emit()
