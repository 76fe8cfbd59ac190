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

from volviz.annotations.figure import is_vector, surround, write_picture
from volviz.annotations.margins import title
from volviz.annotations.picture import shapes_around
from volviz.annotations.shapes import Shape, moved
from volviz.annotations.style import Style
from volviz.annotations.subject import Subject
from volviz.custom_gl.offscreen import finished
from volviz.model.picture import PictureContents
from volviz.model.render_spec import View
from volviz.model.surface_values import SurfaceColors
from volviz.renderer import Renderer
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.session.workers import Task, Workers
from volviz_ui.views.annotations import GROUND, background_image
from volviz_ui.views.picture_parts import CAPTION, Part, PictureRequest

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
    parts : sequence of Part
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
        parts: Sequence[Part],
        subjects: Sequence[Subject | None],
        colors: Sequence[SurfaceColors | None],
        workers: Workers,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self.path = path if Path(path).suffix else path + ".png"
        self._shown, self._request, self._parts = shown, request, parts
        self._is_vector = is_vector(Path(self.path))
        self._opaque = not request.transparent or self.path.lower().endswith(OPAQUE_SUFFIXES)
        self._workers, self._colors = workers, colors
        self._around = [self._shapes(part, subject) for part, subject in zip(parts, subjects, strict=True)]
        self._renderer: Renderer | None = None
        self._turns: Iterator[Any] = iter(())
        self._pixels: npt.NDArray[np.uint8] | None = None
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

    # ------------------------------------------------------------------ what stands around

    def _shapes(self, part: Part, subject: Subject | None) -> tuple[Shape, ...]:
        """What stands around the volume of a part, in its own pixels."""
        if subject is None:
            return ()
        camera = self._shown.scene.view_at(part.view).camera
        assert camera is not None
        size = (part.place.width(), part.place.height())
        contents = self._request.contents
        if len(self._parts) > 1:
            # one title stands above all of them
            contents = replace(contents, title="")
            if part.seen[1] - part.seen[0] < part.place.width():
                # both sides of a wipe would write over one another
                contents = PictureContents(box=contents.box)
        return shapes_around(contents, subject, camera, size, background=self._ground, scale=part.scale)

    @property
    def _ground(self) -> tuple[float, float, float] | None:
        """What lies behind, as far as the colour of letters asks for it."""
        return self._shown.scene.background or GROUND if self._opaque else None

    def _captions(self) -> list[Shape]:
        """Lines above the parts, and the title of all, in pixels of the picture."""
        if len(self._parts) == 1:
            return []
        scale = self._parts[0].scale
        style = Style(scale, self._ground)
        shapes: list[Shape] = []
        for part in self._parts:
            left, right = part.seen
            place = ((left + right) / 2, part.place.top() - 0.5 * CAPTION * scale)
            shapes.append(style.text(part.caption, place, across="middle", bold=True))
        if self._request.contents.title:
            shapes += title(self._request.contents.title, self._request.size, style)
        return shapes

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
        width, height = self._request.size
        self._pixels = np.zeros((height, width, 4), np.uint8)
        if self._opaque and not self._is_vector:
            behind = background_image(self._shown.scene.background, (1, height))
            self._pixels[..., :3], self._pixels[..., 3] = np.rint(behind * 255.0), 255
        self._renderer = Renderer((self._parts[0].place.width(), self._parts[0].place.height()))
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
            View(self._shown.scene.view_at(part.view).camera, (part.place.width(), part.place.height())),
            self._shown.volumes,
            seconds=TURN_SECONDS,
        )

    def _take(self, region: tuple[int, int, int, int], pixels: npt.NDArray[np.float32]) -> None:
        """Have a tile of the present part put where it belongs, with what stands around it."""
        assert self._pixels is not None
        part, shapes = self._parts[self._number], self._around[self._number]
        target, x, y = self._pixels, region[0], region[1]
        top = part.place.top() + y
        first = max(part.seen[0] - part.place.left() - x, 0)
        last = min(part.seen[1] - part.place.left() - x, pixels.shape[1])
        if first >= last:
            return
        left = part.place.left() + x + first
        is_opaque, around = self._opaque and not self._is_vector, () if self._is_vector else shapes
        column = background_image(self._shown.scene.background, (1, self._request.size[1]))

        def compose(_task: Task) -> None:
            shown = (surround(pixels, around, (x, y)) if around else pixels)[:, first:last]
            if is_opaque:
                behind = column[top : top + len(shown)]
                shown = np.concatenate(
                    [shown[..., :3] + (1.0 - shown[..., 3:]) * behind, np.ones_like(shown[..., 3:])], axis=2
                )
            target[top : top + len(shown), left : left + last - first] = finished(shown, None, "uint8")

        self._start(compose, self._forget)

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
        assert self._pixels is not None
        pixels, path, dpi = self._pixels, Path(self.path), self._request.dpi
        captions, opaque = self._captions(), self._opaque
        shapes: list[Shape] = []
        background: Any = None
        if self._is_vector:
            for part, around in zip(self._parts, self._around, strict=True):
                shapes += [moved(shape, part.place.left(), part.place.top()) for shape in around]
            shapes += captions
            background = self._background() if opaque else None

        def write(_task: Task) -> None:
            shown = pixels
            if captions and not shapes:
                whole = pixels.astype(np.float32) / np.float32(255.0)
                whole[..., :3] *= whole[..., 3:]
                shown = finished(surround(whole, captions), None, "uint8")
            if opaque and not is_vector(path):
                shown = shown[..., :3]
            write_picture(path, shown, shapes, background, dpi)

        self._start(write, self._on_written)

    def _background(self) -> Any:
        """A colour, or the gradient as a column of pixels."""
        color = self._shown.scene.background
        if color is not None:
            return color
        return np.rint(background_image(None, (1, self._request.size[1])) * 255.0).astype(np.uint8)

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
        self._pixels = None
        self._tasks = []
        self.is_over = True
        self.ended.emit()
