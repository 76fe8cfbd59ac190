"""`add_volume`: a volume in a plotter, until the plotter closes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from volviz.custom_gl.arguments import spec_of
from volviz.custom_gl.resolve import Volumes
from volviz.custom_gl.vtk.frame_scheduling import FrameScheduler
from volviz.custom_gl.vtk.handle import VolumeHandle, handles_of
from volviz.custom_gl.vtk.plotter_scale import Scale, listen_to_scale
from volviz.custom_gl.vtk.vtk_imports import pyvista
from volviz.errors import InputError
from volviz.model.clipping import Clipping
from volviz.model.layers import ImageLayer, LabelLayer
from volviz.model.light import Light
from volviz.model.looks.look import Look
from volviz.model.render_spec import RenderSpec
from volviz.model.surface_values import SurfaceColors
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.source import VolumeSource
from volviz.volume_data.volume import Volume


def add_volume(
    plotter: Any,
    volume: Volume | VolumeSource | ImageLayer | LabelLayer | Sequence[ImageLayer | LabelLayer],
    technique: str | None = None,
    *,
    transfer_function: TransferFunction | None = None,
    settings: Any = None,
    light: Light | None = None,
    clipping: Clipping | None = None,
    classic: bool = False,
    surface_colors: SurfaceColors | None = None,
    look: Look | str | None = None,
    pacer: FrameScheduler | None = None,
    **values: Any,
) -> VolumeHandle:
    """Show a volume in a PyVista plotter, beside meshes, scalar bars and whatever else it holds.

    Parameters
    ----------
    plotter : pyvista.Plotter or pyvistaqt.QtInteractor
        Where to show it; the volume goes into its active renderer.
    volume : Volume, VolumeSource, ImageLayer or sequence of layers
        What to show. Several visible layers are drawn in one ray integral, by techniques that can.
    technique : str, optional
        Id of a technique (`volviz.techniques`); the default is that of the look, without one "raycast".
    transfer_function : TransferFunction, optional
        Of a volume; the default is made from its histogram.
    settings : object, optional
        Instance of the technique's settings class, instead of single settings.
    light, clipping : Light, Clipping, optional
        Shared values; single ones can be given by name. Without a word on the light it sits at the eye or,
        for techniques whose light can be dragged, at its default place beside the volume.
    classic : bool, default: False
        Start from the values of the well-known teaching programs.
    pacer : FrameScheduler, optional
        For windows with an event loop: full images come piece by piece. Without one every render is
        complete.
    surface_colors : SurfaceColors, optional
        Values that the surface is coloured by, for techniques that draw triangles.
    look : Look or str, optional
        One of `volviz.looks`, or its id, "best" for the first of them: brings technique, settings, function and a
        light from the upper left. What is given beside it counts more.
    **values
        Single settings by name, `headlight`, `light_position`, `light_color`, `crop` and `clip_planes`
        included.

    Returns
    -------
    VolumeHandle
        ``update(...)`` changes what is shown, ``remove()`` takes it away; ``read_image()`` gives the finished image,
        shape (H, W, 4), float32, premultiplied, row 0 at the top.

    Raises
    ------
    VolvizError
        Unknown technique or setting, unusable value.
    """
    spec = spec_of(
        volume, technique, transfer_function=transfer_function, settings=settings, light=light,
        clipping=clipping, classic=classic, surface_colors=surface_colors, look=look, **values,
    )  # fmt: skip
    return add_spec(plotter, spec, pacer=pacer)


def add_spec(
    plotter: Any, spec: RenderSpec, volumes: Volumes | None = None, *, pacer: FrameScheduler | None = None
) -> VolumeHandle:
    """Show what a spec says in a plotter; see `add_volume` and `volviz.custom_gl.resolve.resolve`."""
    if plotter.render_window is None:
        raise InputError("the plotter is closed and shows nothing any more; make a new one.")
    handle = VolumeHandle(plotter, spec, volumes, pacer)
    release_on_close(plotter)
    renderer = plotter.renderer

    def stretch(scale: Scale) -> None:
        for shown in handles_of(renderer):
            shown.stretch(scale)

    listen_to_scale(renderer, stretch)
    return handle


def release_on_close(plotter: Any) -> None:
    """Let `Plotter.close` take the volumes away first, while the OpenGL context still lives.

    A window of Qt is closed by its own rules: the desktop program removes its volumes itself.
    """
    if not isinstance(plotter, pyvista.Plotter) or "close" in vars(plotter):
        return
    close = plotter.close
    renderers = list(plotter.renderers)

    def close_with_volumes(*args: Any, **keywords: Any) -> Any:
        for renderer in renderers:
            for handle in list(handles_of(renderer)):
                handle.remove()
        vars(plotter).pop("close", None)
        return close(*args, **keywords)

    vars(plotter)["close"] = close_with_volumes
