"""A volume in a renderer: takes values, draws them when VTK draws, keeps the finished picture."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.gpu.context import Gpu
from volviz.custom_gl.gpu.resources import VolumeResources, texel_limits
from volviz.custom_gl.gpu.scalars import is_prepared
from volviz.custom_gl.gpu.targets import Target
from volviz.custom_gl.host.accumulation import Accumulation, jittered_camera, sample_phase
from volviz.custom_gl.host.frame_uniforms import box_tiles, pixel_size, shared_uniforms
from volviz.custom_gl.host.hook import HOOK_ACTORS, Hook
from volviz.custom_gl.host.mesh_filters import filter_triangles
from volviz.custom_gl.host.mesh_reading import read_triangles
from volviz.custom_gl.host.no_textures import NO_TEXTURES, NoTextures
from volviz.custom_gl.host.pacing import FULL, CostModel, FrameStatus, Level, Pacer, Quality, StatusListener
from volviz.custom_gl.host.picture import composite
from volviz.custom_gl.host.prop_drawing import PropDrawing
from volviz.custom_gl.host.scene_depth import SceneDepth, opaque_revision
from volviz.custom_gl.host.scene_handles import SceneHandles
from volviz.custom_gl.host.window_gpu import WindowGpu, acquire, give_back
from volviz.custom_gl.picking import Picked, Sight, first_visible
from volviz.custom_gl.registry import technique as technique_info
from volviz.custom_gl.technique import Frame, FrameCamera, ImageTechnique, TechniqueInfo, drawn_function
from volviz.errors import InputError, RenderError
from volviz.kernels.slices import crop_corners
from volviz.kernels.surface_pick import pixel_ray
from volviz.model.clipping import Clipping
from volviz.model.light import Light, default_position
from volviz.model.parameters import make_settings
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
#: Targets of different sizes that are kept: full, and some levels of interaction.
TARGETS_KEPT = 3
#: Pictures that are not interrupted are drawn in one piece.
AT_ONCE_TILE = (16384, 16384)
#: A full picture that is expected to take less than this is drawn at once instead of refined.
AT_ONCE_SECONDS = 0.045


@dataclass(frozen=True)
class _Picture:
    """A finished picture and what it shows."""

    key: Any
    target: Target
    level: Level
    area: tuple[float, float, float, float]


@dataclass
class _Refinement:
    """A full picture in the making."""

    key: Any
    frame: Frame
    chunks: int
    done: int = 0
    seconds: float = 0.0


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
    handles : SceneHandles or None
        What can be dragged in the picture, while it is shown (`show_handles`).
    """

    accumulates: bool = True

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
        self.error: Exception | None = None
        self.status = FrameStatus()
        self.on_status: list[StatusListener] = []
        self.quality: Quality = "balanced"
        self.share = 1.0
        self.pacer = pacer
        self._volume = volume
        self._info = info
        self._given_function = transfer_function
        self._transfer_function = transfer_function.resolved(volume.range)
        self._drawn_function = drawn_function(info, settings, self._transfer_function)
        self._settings = settings
        self._light = light
        self._clipping = clipping
        self._revision = 0
        self._technique: ImageTechnique | None = None
        self._retired: list[ImageTechnique] = []
        self._resources: VolumeResources | None = None
        self._picture: _Picture | None = None
        self._refinement: _Refinement | None = None
        self._accumulation = Accumulation(id(self))
        self._interacting = 0
        self._cost = CostModel()
        self._depth = SceneDepth()
        self._targets: dict[Target, str] = {}
        self._depth_key: Any = None
        self._depth_read: tuple[Any, Any] | None = None
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
        return self._volume

    @property
    def technique(self) -> TechniqueInfo:
        """The technique that draws."""
        return self._info

    @property
    def settings(self) -> Any:
        """Settings of the technique."""
        return self._settings

    @property
    def actor(self) -> Any:
        """The invisible `vtkActor` that stands for the volume in the renderer; its bounds are the box."""
        return self._hook.actor

    @property
    def light(self) -> Light:
        """The light."""
        return self._light

    @property
    def clipping(self) -> Clipping:
        """Crop box and clip planes."""
        return self._clipping

    @property
    def box_corners(self) -> npt.NDArray[np.float64]:
        """World corners of the cropped box, shape (8, 3); bit 0 of the row is x, bit 1 y, bit 2 z."""
        return crop_corners(
            self._volume.index_to_world,
            self._clipping.crop_within(self._volume.dimensions),
            self._volume.dimensions,
        )

    @property
    def notice(self) -> str:
        """A sentence on what the picture shows differently from what was asked for; empty when nothing."""
        words = [str(getattr(self._technique, "notice", ""))]
        if self._drawn_function.by_gradient is not None and getattr(self._settings, "preintegrated", False):
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
        return getattr(self._technique, "mesh", None)

    @property
    def waiting(self) -> float:
        """How far the technique's worker is with what the next picture needs, 0..1."""
        return float(getattr(self._technique, "progress", 0.0))

    @property
    def gpu(self) -> Gpu:
        """Programs, textures and targets of the window; made with the first drawing."""
        return self._gpu.gpu

    @property
    def transfer_function(self) -> TransferFunction:
        """The transfer function, in data units."""
        return self._transfer_function

    @property
    def drawn_function(self) -> TransferFunction:
        """The transfer function without regions that the technique does not draw."""
        return self._drawn_function

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
        from volviz.custom_gl.host.adding import split_values

        info = self._info if technique is None else technique_info(technique)
        new_light, new_clipping = light or self._light, clipping or self._clipping
        if values and settings is not None:
            raise InputError(f"give either settings or single values ({', '.join(values)}), not both.")
        if settings is not None and not isinstance(settings, info.settings):
            raise InputError(f"{info.id} takes {info.settings.__name__}, got {type(settings).__name__}.")
        if values:
            new_light, new_clipping, own = split_values(values, new_light, new_clipping)
        else:
            own = {}
        if settings is None:
            if info.id == self._info.id:
                merged = {p.name: getattr(self._settings, p.name) for p in info.parameters} | own
                settings = make_settings(info.settings, merged, owner=info.id) if own else self._settings
            else:
                settings = make_settings(info.settings, own, owner=info.id)
        new_volume = volume or self._volume
        new_clipping.crop_within(new_volume.dimensions)

        if info.id != self._info.id or new_volume is not self._volume:
            self._cost.forget()
        if info.id != self._info.id:
            self._retire_technique()
            self._info = info
        if new_volume is not self._volume:
            self._volume = new_volume
        if transfer_function is not None:
            self._given_function = transfer_function
        self._transfer_function = self._given_function.resolved(new_volume.range)
        drawn = drawn_function(info, settings, self._transfer_function)
        if drawn != self._drawn_function:
            self._drawn_function = drawn
        self._settings, self._light, self._clipping = settings, new_light, new_clipping
        if quality is not None:
            self.quality = quality
        self._revision += 1
        self.error = None
        self._place()

    def _retire_technique(self) -> None:
        """The technique's GPU objects are released with the next drawing, when the context is current."""
        if self._technique is not None:
            self._retired.append(self._technique)
            self._technique = None

    def _place(self) -> None:
        self._hook.set_corners(self.box_corners)

    @property
    def light_position(self) -> tuple[float, float, float]:
        """World position of the placed light (also while the headlight is on)."""
        return self._light.position or default_position(self._volume.bounds)

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
        camera, (width, height, _, _) = self._camera(), self._viewport()
        sight = Sight(
            self._volume,
            self._transfer_function,
            self._settings,
            pixel_ray(camera.view, camera.projection, (width, height), (x, y)),
            self._clipping.crop_within(self._volume.dimensions),
            self._clipping.planes,
        )
        return (self._info.pick or first_visible)(sight)

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
            chunks = self._plan(frame)
            if not chunks:
                self._report_waiting()
                return False
            # not before: while the technique waits, this target may still hold the picture that is shown
            frame.target.clear()
            self._refinement = _Refinement(key, frame, chunks)
        work = self._refinement
        while work.done < work.chunks:
            chunk_begin = time.perf_counter()
            self._draw_chunk(work.frame, work.done)
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
        self._picture = _Picture(key, work.frame.target, FULL, self._area(work.frame))
        self._cost.observe(FULL, work.seconds)
        self._refinement = None
        self._report(FrameStatus(1.0, work.seconds, True, 1.0))
        return True

    def _tile(self) -> tuple[int, int]:
        """Size of the tiles of a full picture: smaller ones where large ones would hold up the event loop."""
        expected = self._cost.full_seconds
        if expected is None:
            return TILE
        width, height, _, _ = self._viewport()
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
        if not self.accumulates or not getattr(self._technique, "accumulates", True):
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
        return self._plan(frame)

    def draw_chunk(self, frame: Frame, chunk: int) -> None:
        """Let the technique draw one of them."""
        self._draw_chunk(frame, chunk)

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
        chunks = self._plan(frame)
        while not chunks and self.pacer is None:
            chunks = self._plan(frame)
        if not chunks and self.pacer is not None:
            self._report_waiting()
            self.pacer.request(self)
            return
        frame.target.clear()
        for chunk in range(chunks):
            self._draw_chunk(frame, chunk)
        if self.pacer is not None:
            # without waiting, only the submission of the work would be timed
            self._gpu.gpu.gl.finish()
        seconds = time.perf_counter() - begin
        self._cost.observe(level, seconds)
        self._picture = _Picture(key, frame.target, drawn, self._area(frame))
        self._report(FrameStatus(drawn.fraction, seconds, drawn == FULL, 1.0))

    def _worthwhile(self, level: Level) -> Level:
        """The level without a loss of resolution that would make nothing cheaper."""
        least = float(getattr(self._current_technique(), "least_resolution", 0.0))
        return replace(level, fraction=max(level.fraction, least))

    def _plan(self, frame: Frame) -> int:
        self._clean(frame)
        return self._current_technique().plan(frame)

    def _report_waiting(self) -> None:
        """The technique waits for a worker: the last picture stays."""
        shown = self._picture.level.fraction if self._picture else 0.0
        self._report(FrameStatus(shown, 0.0, False, 0.0, waiting=self.waiting))

    def _draw_chunk(self, frame: Frame, chunk: int) -> None:
        self._clean(frame)
        self._current_technique().draw(frame, chunk)
        frame.gpu.gl.scissor = None

    def _clean(self, frame: Frame) -> None:
        """Default state, the frame's target bound: what every call of a technique may rely on."""
        frame.resources.select(frame.level)
        gl = frame.gpu.gl
        gl.enable_only(gl.NOTHING)
        frame.target.fbo.use()
        frame.target.fbo.depth_mask = True
        gl.viewport = (0, 0, *frame.size)
        gl.scissor = None

    def _show(self, framebuffer: Any) -> None:
        # a technique that waits for a worker may have asked for a target of another size: the old one is gone
        if self._picture is None or self._picture.target.released:
            return
        width, height, x, y = self._viewport()
        composite(
            self._gpu.gpu,
            self._picture.target,
            framebuffer,
            (x, y, width, height),
            self._depth.texture if self._depth_key else None,
            self._depth_map(),
            writes_depth=getattr(self._technique, "writes_depth", False),
            area=self._picture.area,
            average=self._accumulation.average(self._picture.key) if self._picture.level == FULL else None,
        )

    def _area(self, frame: Frame) -> tuple[float, float, float, float]:
        """Part of the picture that may hold anything, as fractions: left, bottom, right, top."""
        if not getattr(self._technique, "within_tiles", False):
            return 0.0, 0.0, 1.0, 1.0
        if not frame.tiles:
            return 0.0, 0.0, 0.0, 0.0
        tiles = np.array(frame.tiles, float)
        low = tiles[:, :2].min(axis=0) / frame.size
        high = (tiles[:, :2] + tiles[:, 2:]).max(axis=0) / frame.size
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    def _current_technique(self) -> ImageTechnique:
        for technique in self._retired:
            technique.release()
        self._retired.clear()
        if self._technique is None:
            made = self._info.create()
            if self._info.kind == "prop":
                made = PropDrawing(made, self.window, self.renderer.GetActiveCamera)
            self._technique = made
        return self._technique

    def _has_resources(self) -> bool:
        if not self._info.uses_textures:
            return True
        return self._resources is not None and self._resources.volume is self._volume

    def _is_prepared(self) -> bool:
        """Whether textures of the volume can be made without computing them here first."""
        return self._has_resources() or is_prepared(self._volume, *texel_limits(self._gpu.gpu, self._volume))

    def _ready_resources(self) -> VolumeResources | NoTextures:
        needed = self._info.uses_textures
        if self._resources is not None and (self._resources.volume is not self._volume or not needed):
            self._gpu.drop(self._resources)
            self._resources = None
        if not needed:
            return NO_TEXTURES
        if self._resources is None:
            self._resources = self._gpu.resources(self._volume)
        return self._resources

    # ------------------------------------------------------------------ the frame

    def _viewport(self) -> tuple[int, int, int, int]:
        """Width, height and origin x, y of the renderer in the framebuffer, tiled or not."""
        # GetTiledSizeAndOrigin cannot be called from Python: the same arithmetic here
        viewport, tile = self.renderer.GetViewport(), self.window.GetTileViewport()
        size = self.window.GetSize()
        low = [int((max(viewport[i], tile[i]) - tile[i]) * size[i] + 0.5) for i in (0, 1)]
        high = [int((min(viewport[i + 2], tile[i + 2]) - tile[i]) * size[i] + 0.5) for i in (0, 1)]
        return max(high[0] - low[0], 1), max(high[1] - low[1], 1), low[0], low[1]

    def _camera(self) -> FrameCamera:
        camera = self.renderer.GetActiveCamera()
        view = np.array(
            [camera.GetModelViewTransformMatrix().GetElement(i, j) for i in range(4) for j in range(4)]
        )
        matrix = camera.GetProjectionTransformMatrix(self.renderer.GetTiledAspectRatio(), -1, 1)
        projection = np.array([matrix.GetElement(i, j) for i in range(4) for j in range(4)])
        return FrameCamera(
            view.reshape(4, 4),
            projection.reshape(4, 4),
            np.array(camera.GetPosition()),
            np.array(camera.GetDirectionOfProjection()),
            bool(camera.GetParallelProjection()),
        )

    def _key(self) -> Any:
        camera = self._camera()
        return (
            self._revision,
            self._viewport()[:2],
            camera.view.tobytes(),
            camera.projection.tobytes(),
            self._depth_key,
        )

    def _capture_depth(self, gpu: Any) -> None:
        """Copy the depth of what is already drawn and opaque unless the copy at hand still shows it."""
        revision = opaque_revision(self.renderer, HOOK_ACTORS) + self._surfaces_before()
        if not revision:
            self._depth_key = None
            return
        camera = self._camera()
        viewport = self._viewport()
        key = (revision, viewport, camera.view.tobytes(), camera.projection.tobytes())
        if key != self._depth_key:
            self._depth.capture(gpu, self.window, (viewport[2], viewport[3]), (viewport[0], viewport[1]))
            self._depth_key = key

    @property
    def surface_shown(self) -> Any:
        """What changes with the depth that the picture now shown writes; None when it writes none."""
        if self._picture is None or not getattr(self._technique, "writes_depth", False):
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

    def _depth_map(self) -> tuple[float, float]:
        """(a, b) with eye depth = a / (b - window depth), (0, 0) for parallel projection."""
        camera = self.renderer.GetActiveCamera()
        if camera.GetParallelProjection():
            return 0.0, 0.0
        near, far = camera.GetClippingRange()
        return near * far / (far - near), far / (far - near)

    def _frame(self, level: Level, tile: tuple[int, int] = TILE, sequence: int = 0) -> Frame:
        width, height, _, _ = self._viewport()
        size = (max(round(width * level.fraction), 1), max(round(height * level.fraction), 1))
        purpose = "full" if level == FULL else "interactive"
        gpu = self._gpu.gpu
        frame = Frame(
            gpu=gpu,
            target=self._accumulation.target(gpu, size) if sequence else self._target(purpose, size),
            size=size,
            window_size=(width, height),
            volume=self._volume,
            resources=cast(VolumeResources, self._ready_resources()),
            transfer_function=self._drawn_function,
            settings=self._settings,
            camera=jittered_camera(self._camera(), size, sequence),
            light_position=np.array(self.light_position),
            light_color=self._light.color,
            headlight=self._light.headlight,
            crop=self._clipping.crop_within(self._volume.dimensions),
            planes=self._clipping.planes,
            scene_depth=self._depth.texture if self._depth_key else None,
            step_scale=level.step_scale,
            level=0,
            sequence=sequence,
            interactive=level != FULL,
            tiles=(),
            uniforms={},
            filter_triangles=filter_triangles,
            read_triangles=read_triangles,
        )
        frame.level = self._level_of_detail(frame)
        frame.resources.select(frame.level)
        frame.tiles = box_tiles(frame.box_corners, frame.camera.view_projection, size, tile)
        if self._info.uses_textures:
            frame.uniforms = shared_uniforms(frame)
            frame.uniforms["u_first_sample"] = sample_phase(frame.uniforms["u_first_sample"], sequence)
        return frame

    def _target(self, purpose: str, size: tuple[int, int]) -> Target:
        """A target to draw into; the one that holds the picture now shown is left alone until the next is done."""
        name = f"{purpose} {size[0]} x {size[1]} of {id(self)}"
        target = self._gpu.gpu.targets.get(name, size)
        # the one used last stands last
        self._targets.pop(target, None)
        self._targets[target] = name
        shown = self._picture.target if self._picture is not None else None
        for old in list(self._targets)[:-TARGETS_KEPT]:
            if old is not shown:
                self._gpu.gpu.targets.drop(self._targets.pop(old))
        return target

    def _level_of_detail(self, frame: Frame) -> int:
        """Level of the scalars that fits the size of a pixel.

        Full pictures take the full data unless the technique's ``mipmaps`` is on. While something moves, software
        OpenGL reads the level that is about as fine as its few pixels: most of its time goes into fetching
        voxels that lie far apart.
        """
        moving = frame.interactive and frame.gpu.limits.software
        if not moving and not getattr(frame.settings, "mipmaps", False):
            return 0
        if getattr(frame.settings, "interpolation", "linear") == "nearest":
            # labels must not be averaged
            return 0
        voxels = pixel_size(frame) / frame.volume.mean_spacing
        level = math.floor(math.log2(max(voxels, 1e-9)) + (0.0 if moving else 0.5))
        return min(max(level, 0), frame.resources.coarsest)

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
        if not self._depth_key or self._depth.texture is None:
            return None
        if self._depth_read is None or self._depth_read[0] != self._depth_key:
            self.window.MakeCurrent()
            with self._gpu.foreign():
                self._depth_read = (self._depth_key, self._depth.read(self._gpu.gpu))
        depths = self._depth_read[1]
        if not (0 <= row < depths.shape[0] and 0 <= column < depths.shape[1]):
            return None
        depth = float(depths[depths.shape[0] - 1 - row, column])
        return depth if depth < 1.0 else None

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
        self._retire_technique()
        for technique in self._retired:
            technique.release()
        self._retired.clear()
        if self._resources is not None:
            self._gpu.drop(self._resources)
            self._resources = None
        self._accumulation.release(self._gpu.gpu)
        for name in self._targets.values():
            self._gpu.gpu.targets.drop(name)
        self._targets.clear()
        self._depth.release(self.window)


_HANDLES: list[VolumeHandle] = []


def handles_of(renderer: Any) -> Sequence[VolumeHandle]:
    """Volumes that are shown in a renderer."""
    return [handle for handle in _HANDLES if handle.renderer is renderer]
