"""Images without a window: `volviz.render` for one, `volviz.Renderer` for many from one OpenGL context."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import nullcontext
from dataclasses import replace
from typing import Any, Literal, Self

import numpy as np
import numpy.typing as npt

from volviz.annotations.figure import surround
from volviz.annotations.picture import shapes_around
from volviz.annotations.shapes import Shape
from volviz.annotations.subject import subject_of
from volviz.custom_gl.arguments import spec_of
from volviz.custom_gl.offscreen import (
    MAX_SIZE,
    apply_camera,
    background_color,
    checked_dtype,
    checked_size,
    finished,
    look_at_tile,
    tiles_of,
)
from volviz.custom_gl.resolve import Volumes, resolve
from volviz.custom_gl.vtk import VolumeHandle, add_spec
from volviz.custom_gl.vtk.vtk_imports import pyvista
from volviz.custom_gl.vtk.window_gpu import WindowGpu, acquire, give_back
from volviz.errors import Cancelled, RenderError
from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.layers import ImageLayer, LabelLayer
from volviz.model.light import Light
from volviz.model.looks.look import Look
from volviz.model.picture import PictureContents
from volviz.model.render_spec import RenderSpec, View
from volviz.model.surface_values import SurfaceColors
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.brick_cache.cache import BrickStatus
from volviz.volume_data.source import VolumeSource
from volviz.volume_data.volume import Volume

Drawable = Volume | VolumeSource | ImageLayer | LabelLayer | Sequence[ImageLayer | LabelLayer]
Pixels = npt.NDArray[np.float32]
DType = Literal["uint8", "float32"]
#: Left, top, width and height of a part of an image, in pixels.
Region = tuple[int, int, int, int]
Part = tuple[Region, Pixels]

#: Images that are drawn a little at a time are cut into tiles of `TILE` pixels an edge where an edge is longer than
#: `UNCUT`: a tile is held as 32-bit floats with depth, which 16384 x 16384 pixels would need 5 GB for.
UNCUT, TILE = 2048, 1024
#: Seconds of drawing between two looks at `cancel`.
TURN_SECONDS = 0.03


def render(
    volume: Drawable,
    technique: str | None = None,
    *,
    transfer_function: TransferFunction | None = None,
    size: tuple[int, int] = (800, 600),
    camera: Camera | Sequence[Any] | None = None,
    background: Sequence[float] | str | None = None,
    dtype: DType = "uint8",
    settings: Any = None,
    light: Light | None = None,
    clipping: Clipping | None = None,
    classic: bool = False,
    show: PictureContents | str | Iterable[str] = (),
    title: str = "",
    look: Look | str | None = None,
    **values: Any,
) -> npt.NDArray[Any]:
    """An image of a volume, drawn off-screen at full quality; many of them come faster from a `Renderer`.

    Parameters
    ----------
    size : tuple of 2 ints, default: (800, 600)
        Width and height in pixels, 1..16384.
    volume, technique, transfer_function, camera, background, dtype, settings, light, clipping, classic, look
        As for `Renderer.render`.
    show, title, **values
        As for `Renderer.render`.

    Returns
    -------
    ndarray of shape (H, W, 4)
        Red, green, blue, alpha (straight, not premultiplied); row 0 at the top.

    Raises
    ------
    VolvizError
        Unusable arguments, or no usable OpenGL.
    """
    with Renderer(size) as renderer:
        return renderer.render(
            volume, technique, transfer_function=transfer_function, camera=camera, background=background,
            dtype=dtype, settings=settings, light=light, clipping=clipping, classic=classic, look=look, show=show,
            title=title, **values,
        )  # fmt: skip


class Renderer:
    """Draws images off-screen, many from one OpenGL context; a context manager.

    What stays the same from one image to the next is kept: textures, shader programs, meshes. The context is made
    with the first image, and belongs to the thread that draws it.

    Parameters
    ----------
    size : tuple of 2 ints, default: (800, 600)
        Width and height of the images in pixels, 1..16384.
    largest_tile : int, optional
        Largest edge in pixels of what is drawn in one piece; the default is the limit of the driver. Larger images
        are drawn tile by tile.

    Raises
    ------
    InputError
        An impossible size.
    """

    def __init__(self, size: tuple[int, int] = (800, 600), *, largest_tile: int | None = None) -> None:
        self._size = checked_size(size)
        self._largest_tile = largest_tile
        self._plotter: Any = None
        self._handle: VolumeHandle | None = None
        self._gpu: WindowGpu | None = None
        self._closed = False

    # ------------------------------------------------------------------ images

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the images in pixels."""
        return self._size

    def resize(self, size: tuple[int, int]) -> None:
        """Draw images of another size from now on.

        Raises
        ------
        InputError
            An impossible size.
        """
        self._check_open()
        self._size = checked_size(size)

    def render(
        self,
        volume: Drawable,
        technique: str | None = None,
        *,
        transfer_function: TransferFunction | None = None,
        camera: Camera | Sequence[Any] | None = None,
        background: Sequence[float] | str | None = None,
        dtype: DType = "uint8",
        settings: Any = None,
        light: Light | None = None,
        clipping: Clipping | None = None,
        classic: bool = False,
        surface_colors: SurfaceColors | None = None,
        show: PictureContents | str | Iterable[str] = (),
        title: str = "",
        look: Look | str | None = None,
        progress: Callable[[float], None] | None = None,
        cancel: Callable[[], bool] | None = None,
        **values: Any,
    ) -> npt.NDArray[Any]:
        """An image of a volume at full quality.

        Parameters
        ----------
        volume : Volume, VolumeSource, ImageLayer or sequence of layers
            What to show. Several visible layers are drawn in one ray integral, by techniques that can.
        technique : str, optional
            Id of a technique (`volviz.techniques`); the default is that of the look, without one "raycast".
        transfer_function : TransferFunction, optional
            Of a volume; the default is made from its histogram.
        camera : Camera or triple, optional
            A `volviz.Camera`, or position, focal point and view up as PyVista writes them (view angle 30
            degrees); the default frames what is visible, with a look a stack of few slices from their faces.
        background : colour, optional
            Three floats 0..1 or a colour name makes the image opaque; None gives straight alpha.
        dtype : {"uint8", "float32"}
            Values 0..255, or 0..1 without rounding.
        settings, light, clipping, classic, look, **values
            As for `volviz.add_volume`.
        surface_colors : SurfaceColors, optional
            Values that the surface is coloured by, for techniques that draw triangles.
        show : PictureContents, str or iterable of str
            What stands around the volume, by name: "box", "axes", "marker" (directions of the world), "bar" (colours of
            the values), "scale", "letters" (at the edges of a slice), "legend" (of labels and layers).
        title : str
            A line above the picture.
        progress, cancel
            As for `draw`.

        Returns
        -------
        ndarray of shape (H, W, 4)
            Red, green, blue, alpha (straight, not premultiplied); row 0 at the top.

        Raises
        ------
        VolvizError
            Unusable arguments, or no usable OpenGL.
        """
        spec = spec_of(
            volume, technique, transfer_function=transfer_function, settings=settings, light=light,
            clipping=clipping, classic=classic, surface_colors=surface_colors, look=look, **values,
        )  # fmt: skip
        if camera is not None:
            camera = Camera.coerce(camera)
        elif look is not None:
            camera = resolve(spec).framing_camera(self._size, stacks_from_faces=True)
        view = View(camera, self._size, background_color(background))
        contents = PictureContents.of(show, title)
        return self.draw(spec, view, dtype=dtype, contents=contents, progress=progress, cancel=cancel)

    def draw(
        self,
        spec: RenderSpec,
        view: View,
        volumes: Volumes | None = None,
        *,
        dtype: DType = "uint8",
        contents: PictureContents | None = None,
        progress: Callable[[float], None] | None = None,
        cancel: Callable[[], bool] | None = None,
    ) -> npt.NDArray[Any]:
        """An image of what a spec says, from a view of any size.

        Parameters
        ----------
        spec : RenderSpec
            What to show.
        view : View
            From where; its size counts, not that of the renderer.
        volumes : mapping of VolumeKey to Volume, optional
            What has been read of the references in the layers.
        dtype : {"uint8", "float32"}
            Values 0..255, or 0..1 without rounding.
        contents : PictureContents, optional
            What stands around the volume.
        progress : callable, optional
            Called with the finished part, 0..1.
        cancel : callable, optional
            Asked now and then; when it returns True, drawing ends with `Cancelled`.

        Returns
        -------
        ndarray of shape (H, W, 4)
            As from `render`.

        Raises
        ------
        VolvizError
            Unusable values, no usable OpenGL, or `Cancelled`.
        """
        checked_dtype(dtype)
        edge = self._limit()
        in_turns = progress is not None or cancel is not None
        if in_turns and max(view.size) > UNCUT:
            edge = min(edge, TILE)
        width, height = view.size
        shapes = self.shapes(spec, view, contents or PictureContents(), volumes)
        image = np.empty((height, width, 4), dtype)
        parts = self._parts(spec, view, volumes, edge, TURN_SECONDS if in_turns else None)
        fraction, part = 0.0, None
        while fraction < 1.0:
            if cancel is not None and cancel():
                raise Cancelled("the picture was cancelled.")
            fraction, part = next(parts)
            if part is not None:
                (x, y, w, h), pixels = part
                if shapes:
                    pixels = surround(pixels, shapes, (x, y))
                image[y : y + h, x : x + w] = finished(pixels, view.background, dtype)
            if progress is not None:
                progress(fraction)
            if self._handle is not None and self._handle.is_waiting:
                self._handle.wait(TURN_SECONDS)
        return image

    def shapes(
        self, spec: RenderSpec, view: View, contents: PictureContents, volumes: Volumes | None = None
    ) -> tuple[Shape, ...]:
        """What stands around the volume in an image, as shapes in its pixels.

        Parameters
        ----------
        spec, view, volumes
            As for `draw`.
        contents : PictureContents
            What is wanted.
        """
        if contents.is_empty:
            return ()
        camera = self._framed(spec, view, volumes).camera
        assert camera is not None
        subject = subject_of(resolve(spec, volumes), volumes)
        return shapes_around(contents, subject, camera, view.size, background=view.background)

    def turns(
        self, spec: RenderSpec, view: View, volumes: Volumes | None = None, *, seconds: float = TURN_SECONDS
    ) -> Iterator[tuple[float, Part | None]]:
        """Draw an image a little at a time, for windows that must stay alive meanwhile.

        Whoever stops iterating gives the image up.

        Parameters
        ----------
        spec, view, volumes
            As for `draw`.
        seconds : float
            About how long a turn may take.

        Yields
        ------
        fraction : float
            Part of the image that is drawn, 0..1.
        part : tuple or None
            A tile that is ready, and its pixels: shape (height, width, 4), float32, premultiplied, row 0 at the top.

        Raises
        ------
        VolvizError
            As from `draw`, when the first turn is taken.
        """
        return self._parts(spec, view, volumes, TILE if max(view.size) > UNCUT else UNCUT, seconds)

    def timed(
        self,
        spec: RenderSpec,
        view: View,
        volumes: Volumes | None = None,
        *,
        on_gpu_clock: bool | None = None,
    ) -> tuple[float, float | None]:
        """Draw one complete frame and wait until it is finished, without reading it.

        Parameters
        ----------
        spec, view, volumes
            As for `draw`; the view must fit the driver's limit.
        on_gpu_clock : bool, optional
            Ask OpenGL's own clock, too; the default is to do so where it means anything, on graphics cards.

        Returns
        -------
        seconds : float
            Wall time: VTK's part, ours and the wait for OpenGL.
        gpu_seconds : float or None
            Time by OpenGL's own clock (`GL_TIME_ELAPSED`).
        """
        view = self._framed(spec, view, volumes)
        window = self._window_of(view.size)
        asks = on_gpu_clock if on_gpu_clock is not None else not self.is_software
        window.MakeCurrent()
        query = self._window_gpu().gpu.gl.query(time=True) if asks else None
        begin = time.perf_counter()
        with query or nullcontext():
            self._frame(spec, view, volumes)
            window.WaitForCompletion()
        seconds = time.perf_counter() - begin
        return seconds, None if query is None else float(query.elapsed) * 1e-9

    # ------------------------------------------------------------------ what is said

    @property
    def notice(self) -> str:
        """What the last image shows differently from what was asked for; empty when nothing."""
        return "" if self._handle is None else self._handle.notice

    @property
    def bricks(self) -> BrickStatus | None:
        """Of a volume that the last image shows brick by brick: which levels and bricks of it; None for others."""
        return None if self._handle is None else self._handle.status.bricks

    @property
    def is_software(self) -> bool:
        """Whether OpenGL is computed on the processor."""
        return self._window_gpu().gpu.limits.software

    @property
    def opengl(self) -> str:
        """What OpenGL calls itself, with its version."""
        limits = self._window_gpu().gpu.limits
        return f"{limits.renderer}, OpenGL {limits.version}"

    # ------------------------------------------------------------------ the end

    def close(self) -> None:
        """Release everything; a second call does nothing."""
        self._closed = True
        handle, self._handle = self._handle, None
        if handle is not None:
            handle.remove()
        gpu, self._gpu = self._gpu, None
        if gpu is not None:
            gpu.window.MakeCurrent()
            give_back(gpu, context_alive=True)
        plotter, self._plotter = self._plotter, None
        if plotter is not None:
            plotter.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # ------------------------------------------------------------------ inside

    def _check_open(self) -> None:
        if self._closed:
            raise RenderError("the renderer is closed and draws nothing any more; make a new one.")

    def _framed(self, spec: RenderSpec, view: View, volumes: Volumes | None) -> View:
        """The view with a camera, where it leaves that open."""
        self._check_open()
        checked_size(view.size)
        if view.camera is None:
            view = replace(view, camera=resolve(spec, volumes).framing_camera(view.size))
        return view

    def _limit(self) -> int:
        """Largest edge of a tile in pixels."""
        if self._largest_tile is not None:
            return self._largest_tile
        return min(MAX_SIZE, self._window_gpu().gpu.limits.max_texture)

    def _window_of(self, size: tuple[int, int]) -> Any:
        """The window, opened if need be, of a size in pixels."""
        if self._plotter is None:
            self._plotter = pyvista.Plotter(
                off_screen=True, window_size=list(size), notebook=False, theme=pyvista.themes.Theme()
            )
            self._plotter.render_window.SetMultiSamples(0)
            self._plotter.show(auto_close=False, interactive=False)
        window = self._plotter.render_window
        if tuple(window.GetSize()) != size:
            window.SetSize(*size)
        return window

    def _window_gpu(self) -> WindowGpu:
        self._check_open()
        if self._gpu is None:
            window = self._window_of(self._size)
            window.MakeCurrent()
            self._gpu = acquire(window)
        return self._gpu

    def _parts(
        self, spec: RenderSpec, view: View, volumes: Volumes | None, edge: int, seconds: float | None
    ) -> Iterator[tuple[float, Part | None]]:
        """The image tile by tile, at once or in turns of so many seconds; as from `turns`."""
        view = self._framed(spec, view, volumes)
        width, height = (min(edge, n) for n in view.size)
        tiles = tiles_of(view.size, (width, height))
        for done, tile in enumerate(tiles):
            self._window_of((width, height))
            handle = self._frame(spec, view, volumes, tile, in_turns=seconds is not None)
            while seconds is not None and (not handle.refine(budget=seconds) or handle.is_missing_bricks):
                handle.raise_error()
                within = handle.status.progress
                # a tile begins with a coarse image, which is reported as complete (1) although the tile is not
                yield (done + (within if within < 1.0 else 0.0)) / len(tiles), None
            handle.raise_error()
            yield (done + 1) / len(tiles), (tile, handle.read_image()[: tile[3], : tile[2]])

    def _frame(
        self,
        spec: RenderSpec,
        view: View,
        volumes: Volumes | None,
        tile: Region | None = None,
        *,
        in_turns: bool = False,
    ) -> VolumeHandle:
        """Draw a frame into the window: complete, or only begun where the rest is to follow in turns."""
        plotter, handle = self._plotter, self._handle
        scheduler = _Turns() if in_turns else None
        if handle is None:
            handle = self._handle = add_spec(plotter, spec, volumes, pacer=scheduler)
        else:
            handle.scheduler = scheduler
            handle.show(spec, volumes)
        # an image that is asked for has all bricks
        handle.shows_unfinished = False
        assert view.camera is not None
        apply_camera(plotter.camera, view.camera)
        if view.clipping_range is None:
            plotter.reset_camera_clipping_range()
        else:
            plotter.camera.SetClippingRange(*view.clipping_range)
        look_at_tile(plotter.camera, view.size, tile, plotter.render_window.GetSize())
        plotter.render()
        handle.raise_error()
        return handle


class _Turns:
    """The frame scheduler of images that are asked for turn by turn anyway."""

    def request(self, handle: object) -> None:
        """`Renderer` comes back by itself."""

    def wake(self, handle: object) -> None:
        """The same holds when work in the background has ended."""
