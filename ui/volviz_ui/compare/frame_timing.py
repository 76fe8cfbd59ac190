"""Frame times of two views, taken in turn, a piece at every turn of the event loop."""

from __future__ import annotations

from PySide6.QtCore import QObject, QTimer, Signal

from volviz.compare.timing import FrameTimes
from volviz_ui.views.display import Display

ROUNDS = 5
BUDGET_SECONDS = 0.1
"""Of a turn: longer than elsewhere, since every piece costs a little that a whole frame does not."""


class FrameTiming(QObject):
    """Draws the full pictures of two views several times over and adds up what their pieces and VTK's frame take.

    The sum stands for one frame at full quality: the picture, VTK's own part, and the wait for OpenGL. A picture in
    several pieces takes somewhat longer than a clock outside would say of it in one.
    Where OpenGL runs on hardware, its own clock is read beside ours.
    The picture that is shown stays; a drag or a change of the scene ends the measurement.
    """

    progressed = Signal(float)
    finished = Signal(object)
    """Two `FrameTimes`, or None when it was broken off."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._displays: tuple[Display, Display] | None = None
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
        return self._displays is not None

    def start(self, first: Display, second: Display, rounds: int = ROUNDS) -> None:
        """Measure `rounds` full pictures of each side, the order of the sides turned round every time."""
        self.cancel()
        self._displays = (first, second)
        self._seconds = ([], [])
        self._gpu_seconds = ([], [])
        self._order = [side for turn in range(rounds) for side in ((0, 1) if turn % 2 == 0 else (1, 0))]
        self._total = len(self._order)
        self._begun = False
        for display in self._displays:
            display.pacer.pause()
            if display.handle is not None:
                display.handle.on_gpu_clock = not display.handle.gpu.limits.software
        self._timer.start()

    def cancel(self) -> None:
        """Break off."""
        if self._displays is not None:
            self._end()
            self.finished.emit(None)

    def _end(self) -> None:
        self._timer.stop()
        displays, self._displays = self._displays, None
        for display in displays or ():
            if display.handle is not None:
                display.handle.on_gpu_clock = False
            display.pacer.resume()
            display.show_picture()

    def _turn(self) -> None:
        if self._displays is None:
            return
        display = self._displays[self._order[0]]
        handle = display.handle
        if handle is None or handle.error is not None or display.is_interacting:
            self.cancel()
            return
        if not self._begun:
            # the same values again: the picture at hand no longer counts as theirs
            handle.invalidate()
            self._begun = True
        done = handle.refine(budget=BUDGET_SECONDS)
        if done and handle.status.complete:
            side = self._order.pop(0)
            self._seconds[side].append(handle.status.seconds + display.frame_seconds())
            if handle.status.gpu_seconds is not None:
                self._gpu_seconds[side].append(handle.status.gpu_seconds)
            self._begun = False
            self.progressed.emit(1 - len(self._order) / self._total)
        if self._order:
            self._timer.start()
            return
        times = tuple(
            FrameTimes(display.handle.technique.id, tuple(seconds), gpu_seconds=tuple(gpu_seconds))
            for display, seconds, gpu_seconds in zip(
                self._displays, self._seconds, self._gpu_seconds, strict=True
            )
        )
        self._end()
        self.finished.emit(times)
