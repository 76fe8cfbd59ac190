"""Draws one volume when VTK draws and piece by piece at rest, and keeps the finished image."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from volviz.custom_gl.gpu.context import Gpu
from volviz.custom_gl.gpu.targets import Target
from volviz.custom_gl.resolve import ResolvedSpec
from volviz.custom_gl.technique import Frame
from volviz.custom_gl.vtk.compositing import ImageKey, PooledTargets, RenderedImage, area_of, composite
from volviz.custom_gl.vtk.frame_scheduling import (
    FULL,
    LEVELS,
    CostModel,
    FrameScheduler,
    FrameStatus,
    Quality,
    QualityLevel,
    StatusListener,
)
from volviz.custom_gl.vtk.frames import brick_view, frame_size, make_frame
from volviz.custom_gl.vtk.hook import HOOK_ACTORS, Hook
from volviz.custom_gl.vtk.progressive import Accumulation, ProgressiveRendering
from volviz.custom_gl.vtk.renderer_view import RendererView
from volviz.custom_gl.vtk.scene_depth import SceneDepth, opaque_revision
from volviz.custom_gl.vtk.technique_runner import TechniqueRunner
from volviz.custom_gl.vtk.window_gpu import VolumeTextures, WindowGpu, acquire, give_back
from volviz.errors import RenderError
from volviz.tasks import BackgroundTask
from volviz.volume_data.brick_cache.selection import BrickView
from volviz.volume_data.volume import Volume

#: A turn of an event loop may be held up so long by a full image.
TURN_SECONDS = 0.03
#: Size of the tiles in which techniques draw pixel by pixel: several bins of a software rasteriser, so that
#: all of its threads have work, and short enough to be interrupted.
TILE = (256, 64)
#: The same from the largest to the smallest: one is taken whose tiles are expected to take no longer than this
#: part of a turn. Every piece has an end at which threads wait for one another: larger ones cost less in all.
TILES = ((512, 128), (512, 64), TILE, (128, 64))
PART_OF_TURN = 0.6
#: Seconds of upload within a frame, so that a gesture that begins too early does not stay blind.
UPLOAD_SECONDS = 0.03
#: The same where a coarser level of the scalars is drawn meanwhile.
UPLOAD_SECONDS_BESIDE = 0.008
#: Images that are not interrupted are drawn in one piece.
AT_ONCE_TILE = (16384, 16384)
#: A full image that is expected to take less than this is drawn at once instead of refined.
AT_ONCE_SECONDS = 0.045


class ViewRenderer:
    """The images of one volume in a renderer: which are due, at what quality, and the one that is shown.

    Parameters
    ----------
    renderer : vtkRenderer
        Where they are shown.
    window : vtkRenderWindow
        Its window.
    shown : ResolvedSpec
        What they show to begin with.
    scheduler : FrameScheduler or None
        Of a window with an event loop; without one every image is complete.

    Attributes
    ----------
    error : Exception or None
        What went wrong in the last drawing; the last good image is kept.
    status : FrameStatus
        What the viewport shows now.
    on_status : list of callables
        Called with the new status, on the thread that draws.
    quality : {"fast", "balanced", "full"}
        How far resolution may drop while something moves.
    accumulates : bool
        Whether, with a frame scheduler and at rest, further images follow the full one and their mean is shown
        (`volviz.custom_gl.vtk.progressive`).
    share : float
        Part of the time of an interactive frame that this volume may take, 0..1; less than 1 where several
        viewports are drawn together.
    shows_unfinished : bool
        Whether full images are drawn at rest before all bricks that they need are there.
    on_gpu_clock : bool
        Whether full images are timed by OpenGL's own clock, too (`FrameStatus.gpu_seconds`).
    """

    accumulates: bool = True
    on_gpu_clock: bool = False
    shows_unfinished: bool = True

    def __init__(
        self, renderer: Any, window: Any, shown: ResolvedSpec, scheduler: FrameScheduler | None
    ) -> None:
        self.renderer = renderer
        self.window = window
        self.view = RendererView(renderer, window)
        self.error: Exception | None = None
        self.status = FrameStatus()
        self.on_status: list[StatusListener] = []
        self.quality: Quality = "balanced"
        self.share = 1.0
        self.scheduler = scheduler
        self._shown = shown
        self._revision = 0
        self._runner = TechniqueRunner(window, renderer.GetActiveCamera, self._on_task)
        self._image: RenderedImage | None = None
        self._refinement: ProgressiveRendering | None = None
        self._accumulation = Accumulation(id(self))
        self._interacting = 0
        self._waits = self._has_news = False
        #: What is shown lies where what was shown before did: another time point, until whose picture that one stays.
        self._follows = False
        self._cost = CostModel()
        self._depth = SceneDepth()
        self._targets = PooledTargets(id(self))
        self._removed = False
        # first of what the window must give back, since it may refuse
        self._hook = Hook(renderer, self._on_hook)
        self._gpu: WindowGpu = acquire(window)
        self._textures = VolumeTextures(self._gpu, self._on_task)
        self._hook.set_corners(shown.box_corners)
        _RENDERERS.append(self)

    @property
    def actor(self) -> Any:
        """The invisible `vtkActor` that stands for the volume in the renderer; its bounds are the box."""
        return self._hook.actor

    @property
    def gpu(self) -> Gpu:
        """Programs, textures and targets of the window; made with the first drawing."""
        return self._gpu.gpu

    @property
    def notice(self) -> str:
        """A sentence on what the image shows differently from what was asked for; empty when nothing."""
        words = (str(self._runner.reported("notice", "")), self._shown.notice, self._textures.notice)
        return " ".join(word for word in words if word)

    @property
    def shows_present(self) -> bool:
        """Whether the image at hand, of whatever quality, is one of the present values."""
        return self._image is not None and self._image.key.revision == self._revision

    def preparation(self) -> Callable[[Sequence[Volume], Sequence[Volume]], None]:
        """What computes, on any thread, all that images of other volumes need before their textures can be made.

        Returns
        -------
        callable(images, labels)
            For volumes that are going to be shown in the place of the present ones.
        """
        self.window.MakeCurrent()
        return self._textures.preparation(self._shown)

    @property
    def is_waiting(self) -> bool:
        """Whether nothing more can be drawn before a task in the background has ended; then the pacer is woken."""
        return self._waits

    @property
    def is_missing_bricks(self) -> bool:
        """Whether bricks that the view needs are still to come."""
        return self._textures.is_missing

    def wait(self, timeout: float | None = None) -> None:
        """Wait for what the next image needs: for scripts, never in a turn of an event loop.

        Parameters
        ----------
        timeout : float, optional
            Seconds after which to give up.
        """
        if self._textures.wait(timeout):
            self._runner.tasks.wait(timeout)

    def _on_task(self, task: BackgroundTask[Any]) -> None:
        """A task has ended, on whose thread this is called: there may be more to draw."""
        if not task.is_cancelled:
            self._waits, self._has_news = False, True
            if self.scheduler is not None:
                self.scheduler.wake(self)

    def _show_instead(self, shown: ResolvedSpec) -> None:
        """Draw this from now on."""
        before, self._shown = self._shown, shown
        if shown.volumes != before.volumes:
            self._follows = shown.lies_like(before)
        if shown.info.id != before.info.id or (shown.volumes != before.volumes and not self._follows):
            self._cost.forget()
        if shown.info.id != before.info.id:
            self._runner.retire()
        if before.surface_colors is not None and not shown.is_same_surface(before):
            # the last image would stay until there is a new mesh, with colours that no longer mean anything
            self._image = None
        self.invalidate()
        self._hook.set_corners(shown.box_corners)

    def invalidate(self) -> None:
        """Have the image drawn anew by the next frame, though nothing it shows has changed."""
        self._revision += 1
        self.error = None

    # ------------------------------------------------------------------ gestures

    def begin_interaction(self) -> None:
        """A gesture begins: images are drawn at a resolution that keeps up with it."""
        self._interacting += 1
        self._refinement = None
        self._accumulation.interrupt()

    def end_interaction(self) -> None:
        """The gesture is over: the full image follows."""
        self._interacting = max(self._interacting - 1, 0)
        if self._interacting == 0 and self.scheduler is not None:
            image = self._image
            if not self.status.complete or (image is not None and self._more_images(image.key)):
                self.scheduler.request(self)

    # ------------------------------------------------------------------ at rest

    def refine(self, budget: float = TURN_SECONDS) -> bool:
        """Draw further chunks of the full image for about `budget` seconds.

        Returns
        -------
        bool
            True when the full image, or a mean of several, is ready (render the plotter once to see it), or
            when there is nothing to do.
        """
        if self._removed or self._interacting or self.error is not None:
            return True
        self.window.MakeCurrent()
        try:
            with self._gpu.foreign():
                return self._refine(budget)
        except Exception as error:  # noqa: BLE001 - kept in `error`, VTK would swallow it
            self._fail(error)
            return True

    def _refine(self, budget: float) -> bool:
        begin = time.perf_counter()
        if not self._can_make_textures():
            return False
        if not self._textures.are_made(self._shown):
            # making the texture takes as long as a turn may
            self._textures.of(self._shown)
            return False
        if not self._textures.upload(self._shown, budget):
            return False
        if not self._bricks_are_settled(begin + budget):
            return False
        key = self._key()
        if self._image is not None and self._image.key == key and self._image.level == FULL:
            return self._refine_further(key, self._image.target, budget)
        if self._refinement is None or self._refinement.key != key:
            frame = self._frame(FULL, self._tile(budget))
            chunks = self._plan(frame)
            if not chunks:
                return False
            # not before: while the technique waits, the target may still hold the image that is shown
            self._refinement = ProgressiveRendering(key, frame, chunks, on_gpu_clock=self.on_gpu_clock)
        work = self._refinement
        work.go_on(self._runner, self._shown, begin + budget)
        if not work.is_finished:
            shown = self._image.level.fraction if self._image else 0.0
            self._report(FrameStatus(shown, work.seconds, False, work.progress))
            return False
        self._image = self._finished(key, work.frame, FULL)
        self._cost.observe(FULL, work.seconds)
        self._refinement = None
        self._report(FrameStatus(1.0, work.seconds, True, 1.0, gpu_seconds=work.gpu_seconds))
        return True

    def _bricks_are_settled(self, end: float) -> bool:
        """Whether the full image may be drawn or gone on with; otherwise bricks are still to come."""
        if self._refinement is not None and self._refinement.key == self._key():
            # what is half drawn is finished with the bricks that it began with
            return True
        if not self._textures.follow(self._brick_view(), max(end - time.perf_counter(), 0.0)):
            return False
        image = self._image
        shown = image is not None and image.key == self._key() and image.level == FULL
        if self._textures.is_missing and (shown or not self.shows_unfinished):
            self._waits = True
            self._report(replace(self.status, complete=False))
            return False
        if shown and not self.status.complete:
            # what was missing cannot be read: nothing better will come
            self._report(replace(self.status, complete=True))
        return True

    def _brick_view(self) -> BrickView | None:
        """From where bricks are seen; None where nothing is drawn brick by brick."""
        if self._textures.bricks is None:
            return None
        return brick_view(self._shown, self.view)

    def _tile(self, budget: float) -> tuple[int, int]:
        """Size of the tiles of a full image: smaller ones where large ones would hold up the event loop."""
        expected = self._cost.full_seconds
        if expected is None:
            return TILE
        width, height, _, _ = self.view.rectangle()
        for tile in TILES:
            tiles = -(-width // tile[0]) * -(-height // tile[1])
            if expected <= PART_OF_TURN * budget * tiles:
                return tile
        return TILES[-1]

    def _refine_further(self, key: ImageKey, first: Target, budget: float) -> bool:
        """Draw images that follow the full one; only the window that has shown that one asks for them."""
        if self.scheduler is None:
            return True
        before = self._accumulation.count
        shown = self._accumulation.refine(self, self._gpu.gpu, key, first, budget)
        if self._accumulation.count != before and self._accumulation.average(key) is not None:
            self._report(replace(self.status, samples=self._accumulation.count))
        return shown

    def _more_images(self, key: ImageKey) -> bool:
        """Whether images are to follow the full one of that key, which is shown."""
        if (
            self._textures.is_missing
            or not self.accumulates
            or not self._runner.reported("accumulates", True)
        ):
            return False
        return self._accumulation.ask(key, self._cost.full_seconds or 0.0)

    @property
    def is_accumulating(self) -> bool:
        """Whether the full image is shown and others are being drawn to be averaged with it."""
        image = self._image
        return image is not None and image.level == FULL and self._accumulation.goes_on(image.key)

    def jittered_frame(self, sequence: int) -> Frame:
        """The frame of an image that follows the full one, a little beside it, into a target of its own."""
        return self._frame(FULL, self._tile(TURN_SECONDS), sequence)

    def plan_chunks(self, frame: Frame) -> int:
        """Into how many chunks the technique divides a frame."""
        return self._runner.plan(self._shown.info, frame)

    def _plan(self, frame: Frame) -> int:
        """The same for the first image; 0 while it waits, which is reported."""
        # before the technique is asked: a task may end between its answer and ours
        self._waits = True
        chunks = self._runner.plan(self._shown.info, frame)
        if chunks:
            self._waits = False
        else:
            self._report_waiting(self._runner.tasks.progress)
        return chunks

    def _can_make_textures(self) -> bool:
        """Whether the scalars are prepared, or nobody must be kept waiting; otherwise that is reported."""
        self._waits = True
        if self.scheduler is None or self._textures.can_be_made(self._shown):
            self._waits = False
            return True
        self._report_waiting(None)
        return False

    def _can_draw(self) -> bool:
        """Upload for a moment; whether an image can be drawn then, of all scalars or of a coarser level of them."""
        textures = self._textures
        coarsely = self._follows and self.quality != "full" and textures.draw_coarsely(self._shown)
        if coarsely and self._interacting and self.gpu.limits.software:
            # there the full scalars take longer than the frame may
            return True
        if textures.upload(self._shown, UPLOAD_SECONDS_BESIDE if coarsely else UPLOAD_SECONDS) or coarsely:
            return True
        if self._interacting and self.scheduler is not None:
            # at rest the frame scheduler goes on by itself
            self.scheduler.wake(self)
        return False

    def draw_chunk(self, frame: Frame, chunk: int) -> None:
        """Let the technique draw one of them."""
        self._runner.draw(self._shown.info, frame, chunk)

    # ------------------------------------------------------------------ in VTK's frame

    def _on_hook(self) -> None:
        if self._removed:
            return
        try:
            with self._gpu.foreign() as gpu:
                framebuffer = gpu.gl.detect_framebuffer()
                self._capture_depth(gpu)
                try:
                    if self.error is None:
                        self._draw_what_is_due()
                except Exception as error:  # noqa: BLE001 - kept in `error`, VTK would swallow it
                    self._fail(error)
                self._show(framebuffer)
                # not released: that would delete VTK's own framebuffer (moderngl collects nothing by itself)
        except Exception as error:  # noqa: BLE001 - kept in `error`, VTK would swallow it
            self._fail(error)

    def _draw_what_is_due(self) -> None:
        """Make sure that there is an image of the present state, at the resolution that time allows."""
        has_news, self._has_news = self._has_news, False
        if self.scheduler is not None and not (self._can_make_textures() and self._can_draw()):
            if not self._follows:
                self._image = None
            self.scheduler.request(self)
            return
        if self.scheduler is None:
            self._textures.of(self._shown).upload()
            self._textures.follow(self._brick_view(), math.inf)
        elif self._refinement is None or self._refinement.key != self._key():
            self._textures.follow(None if self._interacting else self._brick_view(), UPLOAD_SECONDS)
        key = self._key()
        has_news = has_news and self._interacting > 0
        if self._image is not None and self._image.key == key and not has_news:
            waits = self._image.level != FULL or self.is_missing_bricks or self._more_images(key)
            if waits and self.scheduler is not None and not self._interacting:
                self.scheduler.request(self)
            return
        if self.scheduler is None:
            self._draw_at(FULL, key)
            return
        self._refinement = None
        level = self._cost.level(self.quality, self.share)
        expected = self._cost.full_seconds
        if not self._interacting and expected is not None and expected <= AT_ONCE_SECONDS * self.share:
            level = FULL
        if level == FULL and not self._textures.of(self._shown).complete:
            level = LEVELS[1]
        self._draw_at(level, key)
        waits = level != FULL or self.is_missing_bricks
        if not self._interacting and (waits or (self.status.complete and self._more_images(key))):
            self.scheduler.request(self)

    def _draw_at(self, level: QualityLevel, key: ImageKey) -> None:
        if self.scheduler is not None:
            # what VTK has submitted before is not part of our cost
            self._gpu.gpu.gl.finish()
        begin = time.perf_counter()
        drawn = self._worthwhile(level)
        frame = self._frame(drawn, tile=AT_ONCE_TILE)
        chunks = self._plan(frame)
        while not chunks:
            if self.scheduler is not None:
                self.scheduler.request(self)
                return
            self._runner.tasks.wait()
            chunks = self._plan(frame)
        frame.target.clear()
        gpu = self._gpu.gpu
        for chunk in range(chunks):
            self._runner.draw(self._shown.info, frame, chunk)
            if gpu.limits.software:
                # all at once, the triangles of a mesh would take twice as long
                gpu.gl.finish()
        if self.scheduler is not None:
            # without waiting, only the submission of the work would be timed
            self._gpu.gpu.gl.finish()
        seconds = time.perf_counter() - begin
        self._cost.observe(level, seconds)
        self._image = self._finished(key, frame, drawn)
        self._report(FrameStatus(drawn.fraction, seconds, drawn == FULL, 1.0))

    def _finished(self, key: ImageKey, frame: Frame, level: QualityLevel) -> RenderedImage:
        area = area_of(frame, within_tiles=self._runner.reported("within_tiles", False))
        return RenderedImage(key, frame.target, level, area)

    def _worthwhile(self, level: QualityLevel) -> QualityLevel:
        """The level without a loss of resolution that would make nothing cheaper."""
        least = float(getattr(self._runner.ready(self._shown.info), "least_resolution", 0.0))
        return replace(level, fraction=max(level.fraction, least))

    def _show(self, framebuffer: Any) -> None:
        # a technique that waits for a task may have asked for a target of another size: the old one is gone
        if self._image is None or self._image.target.released:
            return
        width, height, x, y = self.view.rectangle()
        composite(
            self._gpu.gpu,
            self._image.target,
            framebuffer,
            (x, y, width, height),
            self._depth.texture,
            self.view.depth_map(),
            writes_depth=self._runner.reported("writes_depth", False),
            area=self._image.area,
            average=self._accumulation.average(self._image.key) if self._image.level == FULL else None,
        )

    # ------------------------------------------------------------------ what an image depends on

    def _key(self) -> ImageKey:
        camera = self.view.camera()
        return ImageKey(
            self._revision,
            self.view.rectangle()[:2],
            camera.view.tobytes(),
            camera.projection.tobytes(),
            self._depth.key,
            self._textures.revision,
        )

    def _capture_depth(self, gpu: Gpu) -> None:
        """Copy the depth of what is already drawn and opaque unless the copy at hand still shows it."""
        revision = opaque_revision(self.renderer, HOOK_ACTORS) + self._surfaces_before()
        self._depth.update(gpu, self.window, revision, self.view.rectangle(), self.view.camera())

    @property
    def surface_shown(self) -> Any:
        """What changes with the depth that the image now shown writes; None when it writes none."""
        if self._image is None or not self._runner.reported("writes_depth", False):
            return None
        return id(self), self._image.key, self._image.level

    def _surfaces_before(self) -> tuple[Any, ...]:
        """What changes with the surfaces of other volumes that are drawn before this one."""
        before = []
        own = self._hook.actor
        by_actor = {id(other.actor): other for other in view_renderers_of(self.renderer)}
        for prop in self.renderer.GetViewProps():
            if prop is own:
                break
            other = by_actor.get(id(prop))
            if other is not None and other.surface_shown is not None:
                before.append(other.surface_shown)
        return tuple(before)

    def _frame(self, level: QualityLevel, tile: tuple[int, int], sequence: int = 0) -> Frame:
        size, gpu = frame_size(self.view, level), self._gpu.gpu
        if sequence:
            target = self._accumulation.target(gpu, size)
        else:
            purpose = "full" if level == FULL else "interactive"
            shown = self._image.target if self._image is not None else None
            target = self._targets.get(gpu, purpose, size, shown)
        return make_frame(
            self._shown,
            self.view,
            gpu,
            target,
            self._textures.of(self._shown),
            scene_depth=self._depth.texture,
            level=level,
            tile=tile,
            tasks=self._runner.tasks,
            sequence=sequence,
        )

    # ------------------------------------------------------------------ what is told

    def _report_waiting(self, waiting: float | None) -> None:
        """A task must end first: the last image stays."""
        shown = self._image.level.fraction if self._image else 0.0
        self._report(FrameStatus(shown, 0.0, False, 0.0, waiting=waiting))

    def _fail(self, error: Exception) -> None:
        """Keep the error for whoever asked for the image: VTK would print and swallow it."""
        self.error = error
        self._refinement = None
        self._report(FrameStatus(self.status.resolution, 0.0, True, 1.0))

    def _report(self, status: FrameStatus) -> None:
        bricks = None if self._textures.bricks is None else self._textures.bricks.status
        complete = status.complete and not self.is_missing_bricks
        self.status = replace(status, notice=self.notice, bricks=bricks, complete=complete)
        for listener in list(self.on_status):
            listener(self.status)

    def raise_error(self) -> None:
        """Raise what went wrong in the last drawing, if anything did."""
        if self.error is not None:
            raise self.error

    def present_image(self) -> Any:
        """The image that is shown now, at whatever resolution it was drawn: as `read_image`.

        Raises
        ------
        RenderError
            Nothing has been drawn yet.
        """
        if self._image is None or self._image.target.released:
            raise RenderError("there is no picture yet; wait until the plotter has been drawn.")
        self.window.MakeCurrent()
        with self._gpu.foreign():
            return self._pixels(self._image.target)

    @staticmethod
    def _pixels(target: Target) -> Any:
        width, height = target.size
        return np.frombuffer(target.color.read(), np.float32).reshape(height, width, 4)[::-1].copy()

    def read_image(self, *, averaged: bool = False) -> Any:
        """The finished full image without VTK's: shape (H, W, 4), float32, premultiplied, row 0 at the top.

        Parameters
        ----------
        averaged : bool, default: False
            The mean with the images that have followed it at rest, if any have (`FrameStatus.samples`).

        Raises
        ------
        RenderError
            There is no full image of the present values (the camera may have moved on), or no volume any more.
        """
        if self._removed:
            raise RenderError(
                "the volume was removed or its plotter closed; read pictures before, show(auto_close=False) keeps "
                "a plotter open."
            )
        image = self._image
        if image is None or image.level != FULL or image.key.revision != self._revision:
            raise RenderError(
                "there is no full picture to read: render the plotter first, and let no other pass (ambient "
                "occlusion, shadows, SSAA) take the place of the volume's."
            )
        self.window.MakeCurrent()
        with self._gpu.foreign():
            average = self._accumulation.average(image.key) if averaged else None
            target, count = average or (image.target, 1)
            pixels = self._pixels(target)
        return pixels if count == 1 else pixels / np.float32(count)

    def opaque_depth(self, column: int, row: int) -> float | None:
        """Window depth 0..1 of VTK's opaque geometry at a pixel, None where there is none.

        Parameters
        ----------
        column, row : int
            Pixel of the viewport, (0, 0) at the upper left.
        """
        if not self._depth.is_read:
            self.window.MakeCurrent()
            with self._gpu.foreign() as gpu:
                self._depth.read(gpu)
        return self._depth.at(column, row)

    # ------------------------------------------------------------------ the end

    def _take_away(self, *, window_lives: bool) -> None:
        """Leave the renderer, and release everything on the GPU where its context still lives."""
        self._removed = True
        _RENDERERS.remove(self)
        context_lives = window_lives and self._gpu.started and bool(self.window.GetInitialized())
        if context_lives:
            self.window.MakeCurrent()
            self._runner.release()
            self._textures.release()
            self._accumulation.release(self._gpu.gpu)
            self._targets.release(self._gpu.gpu)
            self._depth.release(self.window)
        self._runner.tasks.close()
        self._textures.close()
        self._hook.remove(last=not view_renderers_of(self.renderer))
        give_back(self._gpu, context_alive=context_lives)
        self.on_status.clear()
        self._image = self._refinement = None


_RENDERERS: list[ViewRenderer] = []


def view_renderers_of(renderer: Any) -> Sequence[ViewRenderer]:
    """What is shown in a renderer, in the order in which it came."""
    return [other for other in _RENDERERS if other.renderer is renderer]
