"""Frame times of two views, taken in turn, a piece at every turn of the event loop."""

from __future__ import annotations

from PySide6.QtCore import QObject, QTimer, Signal

from volviz.compare.timing import FrameTimes
from volviz_ui.views.view_controller import ViewController

ROUNDS = 5
BUDGET_SECONDS = 0.1
"""Of a turn: longer than elsewhere, since every piece costs a little that a whole frame does not."""


class FrameTiming(QObject):
    """Draws the full images of two views several times over and adds up what their pieces and VTK's frame take.

    The sum stands for one frame at full quality: the image, VTK's own part, and the wait for OpenGL. An image in
    several pieces takes somewhat longer than a clock outside would say of it in one.
    Where OpenGL runs on hardware, its own clock is read beside ours.
    The image that is shown stays; a drag or a change of the scene ends the measurement.
    """

    progressed = Signal(float)
    finished = Signal(object)
    """Two `FrameTimes`, or None when it was broken off."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._controllers: tuple[ViewController, ViewController] | None = None
        self._seconds: tuple[list[float], list[float]] = ([], [])
        self._gpu_seconds: tuple[list[float], list[float]] = ([], [])
        self._order: list[int] = []
        self._begun = False
        self._total = 1
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(0)
        self._timer.timeout.connect(self._turn)

    @property
    def is_running(self) -> bool:
        """Whether times are being taken."""
        return self._controllers is not None

    def start(self, first: ViewController, second: ViewController, rounds: int = ROUNDS) -> None:
        """Measure `rounds` full images of each side, the order of the sides turned round every time."""
        self.cancel()
        self._controllers = (first, second)
        self._seconds = ([], [])
        self._gpu_seconds = ([], [])
        self._order = [side for turn in range(rounds) for side in ((0, 1) if turn % 2 == 0 else (1, 0))]
        self._total = len(self._order)
        self._begun = False
        for controller in self._controllers:
            controller.scheduler.pause()
            if controller.handle is not None:
                controller.handle.on_gpu_clock = not controller.handle.gpu.limits.software
        self._timer.start()

    def cancel(self) -> None:
        """Break off."""
        if self._controllers is not None:
            self._end()
            self.finished.emit(None)

    def _end(self) -> None:
        self._timer.stop()
        controllers, self._controllers = self._controllers, None
        for controller in controllers or ():
            if controller.handle is not None:
                controller.handle.on_gpu_clock = False
            controller.scheduler.resume()
            controller.show_image()

    def _turn(self) -> None:
        if self._controllers is None:
            return
        controller = self._controllers[self._order[0]]
        handle = controller.handle
        if handle is None or handle.error is not None or controller.is_interacting:
            self.cancel()
            return
        if not self._begun:
            # the same values again: the image at hand no longer counts as theirs
            handle.invalidate()
            self._begun = True
        done = handle.refine(budget=BUDGET_SECONDS)
        if done and handle.status.complete:
            side = self._order.pop(0)
            self._seconds[side].append(handle.status.seconds + controller.frame_seconds())
            if handle.status.gpu_seconds is not None:
                self._gpu_seconds[side].append(handle.status.gpu_seconds)
            self._begun = False
            self.progressed.emit(1 - len(self._order) / self._total)
        if self._order:
            self._timer.start()
            return
        times = tuple(
            FrameTimes(controller.handle.technique.id, tuple(seconds), gpu_seconds=tuple(gpu_seconds))
            for controller, seconds, gpu_seconds in zip(
                self._controllers, self._seconds, self._gpu_seconds, strict=True
            )
        )
        self._end()
        self.finished.emit(times)
