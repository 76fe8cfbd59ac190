"""A volume in a renderer: takes values, draws them when VTK draws, keeps the finished picture."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.gpu.clock import GpuClock
from volviz.custom_gl.gpu.context import Gpu
from volviz.custom_gl.gpu.resources import VolumeResources, texel_limits
from volviz.custom_gl.gpu.scalars import is_prepared
from volviz.custom_gl.gpu.targets import Target
from volviz.custom_gl.host.accumulation import Accumulation, jittered_camera, sample_phase
from volviz.custom_gl.host.frame_uniforms import box_tiles, level_of_detail, shared_uniforms
from volviz.custom_gl.host.hook import HOOK_ACTORS, Hook
from volviz.custom_gl.host.kept_targets import KeptTargets
from volviz.custom_gl.host.mesh_filters import filter_triangles
from volviz.custom_gl.host.mesh_reading import read_triangles
from volviz.custom_gl.host.no_textures import NO_TEXTURES, NoTextures
from volviz.custom_gl.host.pacing import FULL, CostModel, FrameStatus, Level, Pacer, Quality, StatusListener
from volviz.custom_gl.host.picture import Picture, area_of, composite
from volviz.custom_gl.host.renderer_view import RendererView
from volviz.custom_gl.host.scene_depth import SceneDepth, opaque_revision
from volviz.custom_gl.host.scene_handles import SceneHandles
from volviz.custom_gl.host.shown import Shown
from volviz.custom_gl.host.technique_runner import TechniqueRunner
from volviz.custom_gl.host.window_gpu import WindowGpu, acquire, give_back
from volviz.custom_gl.picking import Picked, Sight, first_visible
from volviz.custom_gl.registry import technique as technique_info
from volviz.custom_gl.technique import Frame, TechniqueInfo
from volviz.errors import RenderError
from volviz.kernels.slices import crop_corners
from volviz.kernels.surface_pick import pixel_ray
from volviz.model.clipping import Clipping
from volviz.model.light import Light, default_position
from volviz.model.transfer_function import TransferFunction
from volviz.model.volume import Volume

#: Size of the tiles in which techniques draw pixel by pixel: several bins of a software rasteriser, so that
#: all of its threads have work, and short enough to be interrupted.
TILE = (256, 64)
#: The same where a large one is expected to take longer than this many seconds.
SMALL_TILE = (128, 64)
CHUNK_SECONDS = 0.012
#: Seconds of upload within a frame, so that a gesture that begins too early does not stay blind.
UPLOAD_SECONDS = 0.03
#: Pictures that are not interrupted are drawn in one piece.
AT_ONCE_TILE = (16384, 16384)
#: A full picture that is expected to take less than this is drawn at once instead of refined.
AT_ONCE_SECONDS = 0.045


@dataclass
class _Refinement:
    """A full picture in the making."""

    key: Any
    frame: Frame
    chunks: int
    done: int = 0
    seconds: float = 0.0
    clock: GpuClock | None = None


class VolumeHandle:
    """A volume shown in a renderer by one of the techniques; made by `volviz.add_volume`.

    Attributes
    ----------
    error : Exception or None
        What went wrong in the last drawing; the last good picture is kept.
    status : FrameStatus
        What the viewport shows now.
    on_status : list of callables
        Called with the new status, on the thread that draws.
    quality : {"fast", "balanced", "full"}
        How far resolution may drop while something moves.
    accumulates : bool
        Whether, with a pacer and at rest, further pictures follow the full one and their mean is shown
        (`volviz.custom_gl.host.accumulation`).
    share : float
        Part of the time of an interactive frame that this volume may take, 0..1; less than 1 where several
        viewports are drawn together.
    on_gpu_clock : bool
        Whether full pictures are timed by OpenGL's own clock, too (`FrameStatus.gpu_seconds`).
    handles : SceneHandles or None
        What can be dragged in the picture, while it is shown (`show_handles`).
    """

    accumulates: bool = True
    on_gpu_clock: bool = False

    def __init__(
        self,
        plotter: Any,
        volume: Volume,
        info: TechniqueInfo,
        transfer_function: TransferFunction,
        settings: Any,
        light: Light,
        clipping: Clipping,
        pacer: Pacer | None,
        renderer: Any = None,
    ) -> None:
        self.plotter = plotter
        self.renderer = renderer if renderer is not None else plotter.renderer
        self.window = plotter.render_window
        self.view = RendererView(self.renderer, self.window)
        self.error: Exception | None = None
        self.status = FrameStatus()
        self.on_status: list[StatusListener] = []
        self.quality: Quality = "balanced"
        self.share = 1.0
        self.pacer = pacer
        self._shown = Shown.first(volume, info, settings, light, clipping, transfer_function)
        self._revision = 0
        self._runner = TechniqueRunner(self.window, self.renderer.GetActiveCamera)
        self._resources: VolumeResources | None = None
        self._picture: Picture | None = None
        self._refinement: _Refinement | None = None
        self._accumulation = Accumulation(id(self))
        self._interacting = 0
        self._cost = CostModel()
        self._depth = SceneDepth()
        self._targets = KeptTargets(id(self))
        self._removed = False
        self.handles: SceneHandles | None = None
        self._hook = Hook(self.renderer, self._on_hook)
        self._gpu: WindowGpu = acquire(self.window)
        _HANDLES.append(self)
        self._place()

    # ------------------------------------------------------------------ values

    @property
    def volume(self) -> Volume:
        """The data shown."""
        return self._shown.volume

    @property
    def technique(self) -> TechniqueInfo:
        """The technique that draws."""
        return self._shown.info

    @property
    def settings(self) -> Any:
        """Settings of the technique."""
        return self._shown.settings

    @property
    def actor(self) -> Any:
        """The invisible `vtkActor` that stands for the volume in the renderer; its bounds are the box."""
        return self._hook.actor

    @property
    def light(self) -> Light:
        """The light."""
        return self._shown.light

    @property
    def clipping(self) -> Clipping:
        """Crop box and clip planes."""
        return self._shown.clipping

    @property
    def box_corners(self) -> npt.NDArray[np.float64]:
        """World corners of the cropped box, shape (8, 3); bit 0 of the row is x, bit 1 y, bit 2 z."""
        return crop_corners(
            self._shown.volume.index_to_world,
            self._shown.clipping.crop_within(self._shown.volume.dimensions),
            self._shown.volume.dimensions,
        )

    @property
    def notice(self) -> str:
        """A sentence on what the picture shows differently from what was asked for; empty when nothing."""
        words = [str(self._runner.says("notice", ""))]
        if self._shown.drawn_function.by_gradient is not None and getattr(
            self._shown.settings, "preintegrated", False
        ):
            words.append("Regions over value and gradient are drawn without pre-integration.")
        if self._resources is not None:
            factor = self._resources.full_factor
            if max(factor) > 1:
                blocks = " x ".join(str(n) for n in factor)
                words.append(
                    f"This volume is larger than the graphics memory or its largest texture allows: blocks of {blocks} "
                    "voxels (x, y, z) are drawn as one; crop the file or raise VOLVIZ_TEXTURE_MB to see all of it."
                )
        return " ".join(word for word in words if word)

    @property
    def mesh(self) -> Any:
        """The `ReadyMesh` that the full picture shows; None for techniques without triangles, or before there is one.

        See `volviz.custom_gl.mesh_drawing.world_triangles` for its place in the world.
        """
        return self._runner.says("mesh", None)

    @property
    def waiting(self) -> float:
        """How far the technique's worker is with what the next picture needs, 0..1."""
        return float(self._runner.says("progress", 0.0))

    @property
    def gpu(self) -> Gpu:
        """Programs, textures and targets of the window; made with the first drawing."""
        return self._gpu.gpu

    @property
    def transfer_function(self) -> TransferFunction:
        """The transfer function, in data units."""
        return self._shown.transfer_function

    @property
    def drawn_function(self) -> TransferFunction:
        """The transfer function without regions that the technique does not draw."""
        return self._shown.drawn_function

    def update(
        self,
        *,
        volume: Volume | None = None,
        technique: str | None = None,
        transfer_function: TransferFunction | None = None,
        settings: Any = None,
        light: Light | None = None,
        clipping: Clipping | None = None,
        quality: Quality | None = None,
        **values: Any,
    ) -> None:
        """Change what is shown; the next `render` of the plotter draws it.

        Parameters
        ----------
        settings : object, optional
            Instance of the technique's settings class.
        **values
            Single settings by name, light and clipping included, as in `volviz.render`.

        Raises
        ------
        VolvizError
            A value does not fit; nothing is changed then.
        """
        before = self._shown
        self._shown = now = before.changed(
            volume=volume,
            info=None if technique is None else technique_info(technique),
            transfer_function=transfer_function,
            settings=settings,
            light=light,
            clipping=clipping,
            values=values,
        )
        if now.info.id != before.info.id or now.volume is not before.volume:
            self._cost.forget()
        if now.info.id != before.info.id:
            self._runner.retire()
        if quality is not None:
            self.quality = quality
        self._revision += 1
        self.error = None
        self._place()

    def _place(self) -> None:
        self._hook.set_corners(self.box_corners)

    @property
    def light_position(self) -> tuple[float, float, float]:
        """World position of the placed light (also while the headlight is on)."""
        return self._shown.light.position or default_position(self._shown.volume.bounds)

    # ------------------------------------------------------------------ by hand

    def pick(self, x: float, y: float) -> Picked | None:
        """What is seen at a pixel, found on the processor; meshes of VTK in front of it are not looked at.

        Parameters
        ----------
        x, y : float
            Column and row in the renderer's viewport, row 0 at the top; whole numbers mean the centre of a pixel.

        Returns
        -------
        Picked or None
            World position, voxel, value and (for surfaces) isovalue; None where nothing of the volume is seen.
        """
        camera, (width, height, _, _) = self.view.camera(), self.view.rectangle()
        sight = Sight(
            self._shown.volume,
            self._shown.transfer_function,
            self._shown.settings,
            pixel_ray(camera.view, camera.projection, (width, height), (x, y)),
            self._shown.clipping.crop_within(self._shown.volume.dimensions),
            self._shown.clipping.planes,
        )
        return (self._shown.info.pick or first_visible)(sight)

    def show_handles(self, on: bool = True, *, listens: bool = True) -> None:
        """Show what can be dragged: the light and the cut plane, where the technique has them.

        Parameters
        ----------
        on : bool, default: True
            Show or hide.
        listens : bool, default: True
            Whether VTK's interactor drags them with the left button; False for windows that call
            `SceneHandles.grab`, `drag` and `release` themselves.
        """
        if self.handles is not None and not on:
            self.handles.remove()
            self.handles = None
        elif self.handles is None and on and not self._removed:
            self.handles = SceneHandles(self, listens=listens)

    # ------------------------------------------------------------------ gestures

    def begin_interaction(self) -> None:
        """A gesture begins: pictures are drawn at a resolution that keeps up with it."""
        self._interacting += 1
        self._refinement = None
        self._accumulation.interrupt()

    def end_interaction(self) -> None:
        """The gesture is over: the full picture follows."""
        self._interacting = max(self._interacting - 1, 0)
        if self._interacting == 0 and self.pacer is not None:
            picture = self._picture
            if not self.status.complete or (picture is not None and self._more_pictures(picture.key)):
                self.pacer.request(self)

    def refine(self, budget: float = 0.03) -> bool:
        """Draw further chunks of the full picture for about `budget` seconds.

        Returns
        -------
        bool
            True when the full picture, or a mean of several, is ready (render the plotter once to see it), or
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
        if not self._is_prepared():
            # let the thread that prepares the volume have the interpreter
            time.sleep(min(budget, 0.004))
            return False
        if not self._has_resources():
            # making the texture takes as long as a turn may
            self._ready_resources()
            return False
        if not self._upload(self._ready_resources(), budget):
            return False
        key = self._key()
        if self._picture is not None and self._picture.key == key and self._picture.level == FULL:
            return self._refine_further(key, self._picture.target, budget)
        if self._refinement is None or self._refinement.key != key:
            frame = self._frame(FULL, self._tile())
            chunks = self._runner.plan(self._shown.info, frame)
            if not chunks:
                self._report_waiting()
                return False
            # not before: while the technique waits, this target may still hold the picture that is shown
            frame.target.clear()
            clock = GpuClock(frame.gpu) if self.on_gpu_clock else None
            self._refinement = _Refinement(key, frame, chunks, clock=clock)
        work = self._refinement
        while work.done < work.chunks:
            chunk_begin = time.perf_counter()
            with work.clock or nullcontext():
                self._runner.draw(self._shown.info, work.frame, work.done)
            self._gpu.gpu.gl.finish()
            work.done += 1
            now = time.perf_counter()
            work.seconds += now - chunk_begin
            # the next one will take about as long
            if 2 * now - chunk_begin - begin > budget:
                break
        if work.done < work.chunks:
            shown = self._picture.level.fraction if self._picture else 0.0
            self._report(FrameStatus(shown, work.seconds, False, work.done / work.chunks))
            return False
        self._picture = self._finished(key, work.frame, FULL)
        self._cost.observe(FULL, work.seconds)
        self._refinement = None
        gpu_seconds = None if work.clock is None else work.clock.seconds
        self._report(FrameStatus(1.0, work.seconds, True, 1.0, gpu_seconds=gpu_seconds))
        return True

    def _tile(self) -> tuple[int, int]:
        """Size of the tiles of a full picture: smaller ones where large ones would hold up the event loop."""
        expected = self._cost.full_seconds
        if expected is None:
            return TILE
        width, height, _, _ = self.view.rectangle()
        tiles = -(-width // TILE[0]) * -(-height // TILE[1])
        return TILE if expected <= CHUNK_SECONDS * tiles else SMALL_TILE

    def _refine_further(self, key: Any, first: Target, budget: float) -> bool:
        """Draw pictures that follow the full one; only the window that has shown that one asks for them."""
        if self.pacer is None:
            return True
        before = self._accumulation.count
        shown = self._accumulation.refine(self, self._gpu.gpu, key, first, budget)
        if self._accumulation.count != before and self._accumulation.average(key) is not None:
            self._report(replace(self.status, samples=self._accumulation.count))
        return shown

    def _more_pictures(self, key: Any) -> bool:
        """Whether pictures are to follow the full one of that key, which is shown."""
        if not self.accumulates or not self._runner.says("accumulates", True):
            return False
        return self._accumulation.ask(key, self._cost.full_seconds or 0.0)

    @property
    def is_accumulating(self) -> bool:
        """Whether the full picture is shown and others are being drawn to be averaged with it."""
        picture = self._picture
        return picture is not None and picture.level == FULL and self._accumulation.goes_on(picture.key)

    def jittered_frame(self, sequence: int) -> Frame:
        """The frame of a picture that follows the full one, a little beside it, into a target of its own."""
        return self._frame(FULL, self._tile(), sequence)

    def plan_chunks(self, frame: Frame) -> int:
        """Into how many chunks the technique divides a frame."""
        return self._runner.plan(self._shown.info, frame)

    def draw_chunk(self, frame: Frame, chunk: int) -> None:
        """Let the technique draw one of them."""
        self._runner.draw(self._shown.info, frame, chunk)

    def _upload(self, resources: VolumeResources | NoTextures, budget: float) -> bool:
        """Upload scalars for about `budget` seconds; True when all are there."""
        begin = time.perf_counter()
        while not resources.complete:
            resources.upload(1)
            self._gpu.gpu.gl.finish()
            if time.perf_counter() - begin > budget:
                break
        return resources.complete

    # ------------------------------------------------------------------ drawing

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
        """Make sure that there is a picture of the present state, at the resolution that time allows."""
        if self.pacer is not None and not self._is_prepared():
            self._picture = None
            self.pacer.request(self)
            return
        resources = self._ready_resources()
        if self.pacer is None:
            resources.upload()
        elif not resources.complete and not self._upload(resources, UPLOAD_SECONDS):
            self._picture = None
            self.pacer.request(self)
            return
        key = self._key()
        if self._picture is not None and self._picture.key == key:
            waits = self._picture.level != FULL or self._more_pictures(key)
            if waits and self.pacer is not None and not self._interacting:
                self.pacer.request(self)
            return
        if self.pacer is None:
            self._draw_at(FULL, key)
            return
        self._refinement = None
        level = self._cost.level(self.quality, self.share)
        expected = self._cost.full_seconds
        if not self._interacting and expected is not None and expected <= AT_ONCE_SECONDS * self.share:
            level = FULL
        self._draw_at(level, key)
        if not self._interacting and (level != FULL or (self.status.complete and self._more_pictures(key))):
            self.pacer.request(self)

    def _draw_at(self, level: Level, key: Any) -> None:
        if self.pacer is not None:
            # what VTK has submitted before is not part of our cost
            self._gpu.gpu.gl.finish()
        begin = time.perf_counter()
        drawn = self._worthwhile(level)
        frame = self._frame(drawn, tile=AT_ONCE_TILE)
        chunks = self._runner.plan(self._shown.info, frame)
        while not chunks and self.pacer is None:
            chunks = self._runner.plan(self._shown.info, frame)
        if not chunks and self.pacer is not None:
            self._report_waiting()
            self.pacer.request(self)
            return
        frame.target.clear()
        for chunk in range(chunks):
            self._runner.draw(self._shown.info, frame, chunk)
        if self.pacer is not None:
            # without waiting, only the submission of the work would be timed
            self._gpu.gpu.gl.finish()
        seconds = time.perf_counter() - begin
        self._cost.observe(level, seconds)
        self._picture = self._finished(key, frame, drawn)
        self._report(FrameStatus(drawn.fraction, seconds, drawn == FULL, 1.0))

    def _finished(self, key: Any, frame: Frame, level: Level) -> Picture:
        area = area_of(frame, within_tiles=self._runner.says("within_tiles", False))
        return Picture(key, frame.target, level, area)

    def _worthwhile(self, level: Level) -> Level:
        """The level without a loss of resolution that would make nothing cheaper."""
        least = float(getattr(self._runner.ready(self._shown.info), "least_resolution", 0.0))
        return replace(level, fraction=max(level.fraction, least))

    def _report_waiting(self) -> None:
        """The technique waits for a worker: the last picture stays."""
        shown = self._picture.level.fraction if self._picture else 0.0
        self._report(FrameStatus(shown, 0.0, False, 0.0, waiting=self.waiting))

    def _show(self, framebuffer: Any) -> None:
        # a technique that waits for a worker may have asked for a target of another size: the old one is gone
        if self._picture is None or self._picture.target.released:
            return
        width, height, x, y = self.view.rectangle()
        composite(
            self._gpu.gpu,
            self._picture.target,
            framebuffer,
            (x, y, width, height),
            self._depth.texture,
            self.view.depth_map(),
            writes_depth=self._runner.says("writes_depth", False),
            area=self._picture.area,
            average=self._accumulation.average(self._picture.key) if self._picture.level == FULL else None,
        )

    def _has_resources(self) -> bool:
        if not self._shown.info.uses_textures:
            return True
        return self._resources is not None and self._resources.volume is self._shown.volume

    def _is_prepared(self) -> bool:
        """Whether textures of the volume can be made without computing them here first."""
        return self._has_resources() or is_prepared(
            self._shown.volume, *texel_limits(self._gpu.gpu, self._shown.volume)
        )

    def _ready_resources(self) -> VolumeResources | NoTextures:
        needed = self._shown.info.uses_textures
        if self._resources is not None and (self._resources.volume is not self._shown.volume or not needed):
            self._gpu.drop(self._resources)
            self._resources = None
        if not needed:
            return NO_TEXTURES
        if self._resources is None:
            self._resources = self._gpu.resources(self._shown.volume)
        return self._resources

    # ------------------------------------------------------------------ the frame

    def _key(self) -> Any:
        camera = self.view.camera()
        return (
            self._revision,
            self.view.rectangle()[:2],
            camera.view.tobytes(),
            camera.projection.tobytes(),
            self._depth.key,
        )

    def _capture_depth(self, gpu: Gpu) -> None:
        """Copy the depth of what is already drawn and opaque unless the copy at hand still shows it."""
        revision = opaque_revision(self.renderer, HOOK_ACTORS) + self._surfaces_before()
        self._depth.update(gpu, self.window, revision, self.view.rectangle(), self.view.camera())

    @property
    def surface_shown(self) -> Any:
        """What changes with the depth that the picture now shown writes; None when it writes none."""
        if self._picture is None or not self._runner.says("writes_depth", False):
            return None
        return id(self), self._picture.key, self._picture.level

    def _surfaces_before(self) -> tuple[Any, ...]:
        """What changes with the surfaces of other volumes that are drawn before this one."""
        before = []
        own = self._hook.actor
        by_actor = {id(handle.actor): handle for handle in handles_of(self.renderer)}
        for prop in self.renderer.GetViewProps():
            if prop is own:
                break
            handle = by_actor.get(id(prop))
            if handle is not None and handle.surface_shown is not None:
                before.append(handle.surface_shown)
        return tuple(before)

    def _frame(self, level: Level, tile: tuple[int, int] = TILE, sequence: int = 0) -> Frame:
        width, height, _, _ = self.view.rectangle()
        size = (max(round(width * level.fraction), 1), max(round(height * level.fraction), 1))
        purpose = "full" if level == FULL else "interactive"
        shown = self._picture.target if self._picture is not None else None
        gpu = self._gpu.gpu
        frame = Frame(
            gpu=gpu,
            target=self._accumulation.target(gpu, size)
            if sequence
            else self._targets.get(gpu, purpose, size, shown),
            size=size,
            window_size=(width, height),
            volume=self._shown.volume,
            resources=cast(VolumeResources, self._ready_resources()),
            transfer_function=self._shown.drawn_function,
            settings=self._shown.settings,
            camera=jittered_camera(self.view.camera(), size, sequence),
            light_position=np.array(self.light_position),
            light_color=self._shown.light.color,
            headlight=self._shown.light.headlight,
            crop=self._shown.clipping.crop_within(self._shown.volume.dimensions),
            planes=self._shown.clipping.planes,
            scene_depth=self._depth.texture,
            step_scale=level.step_scale,
            level=0,
            sequence=sequence,
            interactive=level != FULL,
            tiles=(),
            uniforms={},
            filter_triangles=filter_triangles,
            read_triangles=read_triangles,
        )
        frame.level = level_of_detail(frame)
        frame.resources.select(frame.level)
        frame.tiles = box_tiles(frame.box_corners, frame.camera.view_projection, size, tile)
        if self._shown.info.uses_textures:
            frame.uniforms = shared_uniforms(frame)
            frame.uniforms["u_first_sample"] = sample_phase(frame.uniforms["u_first_sample"], sequence)
        return frame

    # ------------------------------------------------------------------ status and end

    def _fail(self, error: Exception) -> None:
        """Keep the error for whoever asked for the picture: VTK would print and swallow it."""
        self.error = error
        self._refinement = None
        self._report(FrameStatus(self.status.resolution, 0.0, True, 1.0))

    def _report(self, status: FrameStatus) -> None:
        self.status = replace(status, notice=self.notice)
        for listener in list(self.on_status):
            listener(self.status)

    def read_picture(self, *, averaged: bool = False) -> Any:
        """The finished full picture without VTK's: shape (H, W, 4), float32, premultiplied, row 0 at the top.

        Parameters
        ----------
        averaged : bool, default: False
            The mean with the pictures that have followed it at rest, if any have (`FrameStatus.samples`).

        Raises
        ------
        RenderError
            There is no full picture of the present state.
        """
        if self._picture is None or self._picture.level != FULL:
            raise RenderError(
                "there is no full picture to read: render the plotter first, and let no other pass (ambient "
                "occlusion, shadows, SSAA) take the place of the volume's."
            )
        self.window.MakeCurrent()
        with self._gpu.foreign():
            average = self._accumulation.average(self._picture.key) if averaged else None
            target, count = average or (self._picture.target, 1)
            width, height = target.size
            data = target.color.read()
        picture = np.frombuffer(data, np.float32).reshape(height, width, 4)[::-1].copy()
        return picture if count == 1 else picture / np.float32(count)

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

    def raise_error(self) -> None:
        """Raise what went wrong in the last drawing, if anything did."""
        if self.error is not None:
            raise self.error

    def remove(self) -> None:
        """Take the volume out of the renderer and release its GPU objects; a second call does nothing."""
        if self._removed:
            return
        self.show_handles(False)
        self._removed = True
        _HANDLES.remove(self)
        last = not any(other.renderer is self.renderer for other in _HANDLES)
        alive = self._gpu.started and bool(
            self.window.GetInitialized() if hasattr(self.window, "GetInitialized") else 1
        )
        if alive and self.plotter.render_window is not None:
            self.window.MakeCurrent()
            self._release()
        self._hook.remove(last=last)
        give_back(self._gpu, context_alive=alive)
        self.on_status.clear()
        self._picture = self._refinement = None

    def _release(self) -> None:
        self._runner.release()
        if self._resources is not None:
            self._gpu.drop(self._resources)
            self._resources = None
        self._accumulation.release(self._gpu.gpu)
        self._targets.release(self._gpu.gpu)
        self._depth.release(self.window)


_HANDLES: list[VolumeHandle] = []


def handles_of(renderer: Any) -> Sequence[VolumeHandle]:
    """Volumes that are shown in a renderer."""
    return [handle for handle in _HANDLES if handle.renderer is renderer]
