"""Progressive rendering: the full image chunk by chunk, then further ones at rest, and their mean.

Every further image looks through other points of its pixels and samples its rays at other places: edges become
smooth, and the wood grain that equally placed samples leave on steep data disappears.
"""

from __future__ import annotations

import math
import time
from contextlib import nullcontext
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from volviz.custom_gl.gpu.clock import GpuClock
from volviz.custom_gl.gpu.context import Gpu
from volviz.custom_gl.gpu.targets import Target
from volviz.custom_gl.resolve import ResolvedSpec
from volviz.custom_gl.technique import Frame, FrameCamera
from volviz.custom_gl.vtk.compositing import add_image
from volviz.custom_gl.vtk.technique_runner import TechniqueRunner

#: Where the further images look through their pixels, in pixels from the middle: each row and column of a lattice of
#: eight is taken once, and after every two, four and eight images the mean lies (nearly) in the middle.
SUBPIXEL_JITTER = tuple(
    (x / 16.0, y / 16.0) for x, y in ((1, -3), (-1, 3), (5, 1), (-5, -1), (-3, -7), (3, 7), (7, 5), (-7, -5))
)
#: Where they sample, in steps from the middle of a segment: with the first image nine places, equally far apart.
PHASES = tuple(k / 9.0 for k in (4, -4, 2, -2, 3, -3, 1, -1))

#: Full images that take longer than this all together are not worth the wait; fewer than two show nothing.
SECONDS = 3.0
LEAST = 2
#: The mean is shown after so many further images.
SHOWN_AFTER = (2, 4, 8)


class ProgressiveRendering:
    """Draws the chunks of one frame.

    Parameters
    ----------
    key : object
        What the image shows, as in `Image`.
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


class JitteredFrames(Protocol):
    """What the accumulation needs of a `ViewRenderer`."""

    def jittered_frame(self, sequence: int) -> Frame:
        """The frame of a further image, into a target of its own."""

    def plan_chunks(self, frame: Frame) -> int:
        """Into how many chunks its drawing is divided."""

    def draw_chunk(self, frame: Frame, chunk: int) -> None:
        """Draw one of them."""


class Accumulation:
    """The sum of the full image and those that followed it.

    Attributes
    ----------
    key : object
        What the images show, as in `Image`; None = nothing is summed up.
    count : int
        Images in the sum, the first one included.
    """

    def __init__(self, owner: int) -> None:
        self._names = {part: f"{part} of {owner}" for part in ("sum", "jittered")}
        self.key: Any = None
        self.count = 0
        self._asked: Any = None
        self._count_to_add = 0
        self._sum: Target | None = None
        self._frame: Frame | None = None
        self._chunks = 0
        self._done = 0

    def ask(self, key: Any, full_seconds: float) -> bool:
        """The full image of `key` is shown and nothing moves: whether further ones are to be drawn.

        Parameters
        ----------
        key : object
            Of the image.
        full_seconds : float
            Time that one full image takes.
        """
        if key != self._asked:
            count = min(math.floor(SECONDS / max(full_seconds, 1e-6)), len(SUBPIXEL_JITTER))
            self._asked = key
            self._count_to_add = max((n for n in SHOWN_AFTER if n <= count), default=0)
            if self._count_to_add < LEAST:
                self._count_to_add = 0
        return not self._is_finished(key)

    def goes_on(self, key: Any) -> bool:
        """Whether further images of the full one of `key` are still being drawn."""
        return key == self._asked and not self._is_finished(key)

    def _is_finished(self, key: Any) -> bool:
        if key != self._asked:
            return True
        return self._count_to_add == 0 or (self.key == key and self.count > self._count_to_add)

    def average(self, key: Any) -> tuple[Target, int] | None:
        """The sum and the number of images in it, where that is to be shown instead of the first image."""
        if self.key != key or self._sum is None or self._sum.released or self.count - 1 < SHOWN_AFTER[0]:
            return None
        return self._sum, self.count

    def refine(self, host: JitteredFrames, gpu: Gpu, key: Any, first: Target, budget: float) -> bool:
        """Draw for about `budget` seconds; True when there is a new mean to be shown or nothing to do."""
        begin = time.perf_counter()
        if self._is_finished(key):
            return True
        if self.key != key or self._sum is None or self._sum.released:
            self._begin(gpu, key, first)
        if self._frame is None:
            self._frame = host.jittered_frame(self.count)
            self._chunks, self._done = host.plan_chunks(self._frame), 0
            if not self._chunks:
                # the technique has something else to do first: the images so far must suffice
                self._count_to_add, self._frame = self.count - 1, None
                return True
            self._frame.target.clear()
        while self._done < self._chunks:
            host.draw_chunk(self._frame, self._done)
            gpu.gl.finish()
            self._done += 1
            if time.perf_counter() - begin > budget:
                break
        if self._done < self._chunks:
            return False
        self._add(gpu, self._frame.target)
        self._frame = None
        self.count += 1
        if self.count > self._count_to_add:
            gpu.targets.drop(self._names["jittered"])
        return self.count - 1 in SHOWN_AFTER

    def interrupt(self) -> None:
        """A gesture begins: the image in the making is given up, the sum stays."""
        self._frame = None

    def target(self, gpu: Gpu, size: tuple[int, int]) -> Target:
        """What further images are drawn into."""
        return gpu.targets.get(self._names["jittered"], size)

    def release(self, gpu: Gpu) -> None:
        """Release the targets; the context must be current."""
        for name in self._names.values():
            gpu.targets.drop(name)
        self.key = self._asked = self._sum = self._frame = None

    def _begin(self, gpu: Gpu, key: Any, first: Target) -> None:
        self._sum = gpu.targets.get(self._names["sum"], first.size, depth=False)
        self._sum.clear()
        self.key, self.count, self._frame = key, 0, None
        self._add(gpu, first)
        self.count = 1

    def _add(self, gpu: Gpu, image: Target) -> None:
        assert self._sum is not None
        add_image(gpu, image, self._sum)


def jittered_camera(camera: FrameCamera, size: tuple[int, int], sequence: int) -> FrameCamera:
    """The camera of the image of that number, looking through other points of its pixels; 0 leaves it."""
    if sequence == 0:
        return camera
    x, y = SUBPIXEL_JITTER[(sequence - 1) % len(SUBPIXEL_JITTER)]
    shift = np.eye(4)
    shift[0, 3], shift[1, 3] = 2.0 * x / size[0], 2.0 * y / size[1]
    return replace(camera, projection=shift @ camera.projection)


def sample_phase(first_sample: float, sequence: int) -> float:
    """Where in a segment the image of that number samples: only midpoint samples are moved."""
    if sequence == 0 or first_sample != 0.5:
        return first_sample
    return 0.5 + PHASES[(sequence - 1) % len(PHASES)]
