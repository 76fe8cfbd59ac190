"""A full picture in the making: chunk by chunk, in the turns of an event loop."""

from __future__ import annotations

import time
from contextlib import nullcontext
from typing import Any

from volviz.custom_gl.gpu.clock import GpuClock
from volviz.custom_gl.host.technique_runner import TechniqueRunner
from volviz.custom_gl.resolve import ResolvedSpec
from volviz.custom_gl.technique import Frame


class Refinement:
    """Draws the chunks of one frame.

    Parameters
    ----------
    key : object
        What the picture shows, as in `Picture`.
    frame : Frame
        Its target is cleared here.
    chunks : int
        Into how many the technique has divided it.
    on_gpu_clock : bool
        Time it by OpenGL's own clock, too.

    Attributes
    ----------
    seconds : float
        Time that the chunks so far have taken.
    """

    def __init__(self, key: Any, frame: Frame, chunks: int, *, on_gpu_clock: bool) -> None:
        self.key, self.frame = key, frame
        self.seconds = 0.0
        self._chunks, self._done = chunks, 0
        self._clock = GpuClock(frame.gpu) if on_gpu_clock else None
        frame.target.clear()

    @property
    def progress(self) -> float:
        """Part of the chunks that are drawn, 0..1."""
        return self._done / self._chunks

    @property
    def is_finished(self) -> bool:
        """Whether all are drawn."""
        return self._done == self._chunks

    @property
    def gpu_seconds(self) -> float | None:
        """Time by OpenGL's own clock, where that was asked for."""
        return None if self._clock is None else self._clock.seconds

    def go_on(self, runner: TechniqueRunner, shown: ResolvedSpec, end: float) -> None:
        """Draw at least one chunk, and others as long as they are likely to be ready at `end` (`time.perf_counter`)."""
        while not self.is_finished:
            begin = time.perf_counter()
            with self._clock or nullcontext():
                runner.draw(shown.info, self.frame, self._done)
            self.frame.gpu.gl.finish()
            self._done += 1
            now = time.perf_counter()
            self.seconds += now - begin
            # the next one will take about as long
            if 2 * now - begin > end:
                break
