"""Drawing an image for a file while the window goes on: a turn now and then, the file on a worker."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QObject, QTimer, Signal

from volviz.errors import LoadError
from volviz.model.render_spec import View
from volviz.model.surface_values import SurfaceColors
from volviz.renderer import Renderer
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.session.workers import Task, Workers
from volviz_ui.views.annotations import background_image

OPAQUE_SUFFIXES = (".jpg", ".jpeg")
TURN_SECONDS = 0.03
REST_MS = 2
"""Between two turns, so that the window has its own."""


class ImageExport(QObject):
    """One image on its way into a file.

    Parameters
    ----------
    shown : LoadedScene
        What to draw; later changes of the window's scene do not matter.
    path : str
        The file; its suffix says the format.
    size : tuple of 2 ints
        Width and height in pixels.
    transparent : bool
        Leave the background out, where the format can.
    workers : Workers
        Where the file is written.
    surface_colors : SurfaceColors, optional
        What the surface of the active view is coloured by.
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
        size: tuple[int, int],
        *,
        transparent: bool,
        workers: Workers,
        surface_colors: SurfaceColors | None = None,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self.path = path if Path(path).suffix else path + ".png"
        self._shown, self._size = shown, size
        self._opaque = not transparent or self.path.lower().endswith(OPAQUE_SUFFIXES)
        self._workers = workers
        self._surface_colors = surface_colors
        self._renderer: Renderer | None = None
        self._turns: Iterator[Any] = iter(())
        self._pixels: npt.NDArray[np.uint8] | None = None
        self._task: Task | None = None
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
            if self._task is not None:
                self._task.cancel()
            self._end()

    def _turn(self) -> None:
        try:
            if self._renderer is None:
                self._begin()
                return
            fraction, part = next(self._turns)
            if part is not None:
                self._take(*part)
            self.progressed.emit(fraction)
            if fraction == 1.0:
                self._write()
        except Exception as error:  # noqa: BLE001 - whatever drawing raises is told, the window goes on
            self._fail(error)

    def _begin(self) -> None:
        scene = self._shown.scene
        width, height = self._size
        self._pixels = np.zeros((height, width, 3 if self._opaque else 4), np.uint8)
        self._renderer = Renderer(self._size)
        self._turns = self._renderer.turns(
            replace(self._shown.spec(scene.active_index), surface_colors=self._surface_colors),
            View(scene.view.camera, self._size),
            self._shown.volumes,
            seconds=TURN_SECONDS,
        )

    def _take(self, region: tuple[int, int, int, int], part: npt.NDArray[np.float32]) -> None:
        """Put a part of the image over the background and where it belongs."""
        assert self._pixels is not None
        x, y, width, height = region
        alpha = part[..., 3:]
        if self._opaque:
            behind = background_image(self._shown.scene.background, (width, self._size[1]))[y : y + height]
            colors = part[..., :3] + (1.0 - alpha) * behind
        else:
            colors = np.divide(part[..., :3], alpha, out=np.zeros_like(part[..., :3]), where=alpha > 1e-6)
            colors = np.concatenate([colors, alpha], axis=-1)
        self._pixels[y : y + height, x : x + width] = np.rint(np.clip(colors, 0.0, 1.0) * 255.0)

    def _write(self) -> None:
        self._release()
        assert self._pixels is not None
        pixels, path = self._pixels, self.path

        def write(task: Task) -> None:
            write_image(pixels, Path(path), task)

        self._task = self._workers.start(write, label=path)
        self._task.succeeded.connect(self._on_written)
        self._task.failed.connect(self._fail)

    def _on_written(self, _result: Any) -> None:
        self.saved.emit(self.path)
        self._end()

    def _fail(self, error: object) -> None:
        self.failed.emit(error)
        self._end()

    def _release(self) -> None:
        self._timer.stop()
        self._turns = iter(())
        renderer, self._renderer = self._renderer, None
        if renderer is not None:
            renderer.close()

    def _end(self) -> None:
        self._release()
        self._pixels = self._task = None
        self.is_over = True
        self.ended.emit()


def write_image(pixels: npt.NDArray[np.uint8], path: Path, task: Task) -> None:
    """Write a file beside the wanted one first: what was there stays until the new one is whole. On a worker."""
    from PIL import Image

    part = path.with_name(f"{path.stem}.part{path.suffix}")
    try:
        Image.fromarray(pixels).save(part)
        task.report(1.0)
        part.replace(path)
    except OSError as error:
        why = error.strerror or str(error)
        raise LoadError(f"{path} cannot be written: {why}; choose another folder.") from error
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)
