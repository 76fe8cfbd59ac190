"""`add_volume`, and how keywords are shared out between technique, light and clipping."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from volviz.custom_gl.host.handle import VolumeHandle, handles_of
from volviz.custom_gl.host.pacing import Pacer
from volviz.custom_gl.host.shown import check_kinds, check_settings, split_values
from volviz.custom_gl.host.vtk_border import pyvista
from volviz.custom_gl.registry import technique as technique_info
from volviz.custom_gl.technique import TechniqueInfo
from volviz.errors import InputError
from volviz.model.clipping import Clipping
from volviz.model.light import Light
from volviz.model.parameters import make_settings
from volviz.model.scene import DEFAULT_TECHNIQUE
from volviz.model.transfer_function import TransferFunction
from volviz.model.volume import Volume


def technique_settings(info: TechniqueInfo, values: Mapping[str, Any], *, classic: bool = False) -> Any:
    """Settings of a technique from keywords, over its classic values when `classic`.

    Raises
    ------
    SettingError
        An unknown name or an unusable value.
    """
    base = dict(info.classic) if classic else {}
    return make_settings(info.settings, base | dict(values), owner=info.id)


def add_volume(
    plotter: Any,
    volume: Volume,
    technique: str = DEFAULT_TECHNIQUE,
    *,
    transfer_function: TransferFunction | None = None,
    settings: Any = None,
    light: Light | None = None,
    clipping: Clipping | None = None,
    classic: bool = False,
    pacer: Pacer | None = None,
    **values: Any,
) -> VolumeHandle:
    """Show a volume in a PyVista plotter, beside meshes, scalar bars and whatever else it holds.

    Parameters
    ----------
    plotter : pyvista.Plotter or pyvistaqt.QtInteractor
        Where to show it; the volume goes into its active renderer.
    volume : Volume
        What to show.
    technique : str, default: "raycast"
        Id of a technique (`volviz.techniques`).
    transfer_function : TransferFunction, optional
        The default is made from the volume's histogram.
    settings : object, optional
        Instance of the technique's settings class, instead of single settings.
    light, clipping : Light, Clipping, optional
        Shared values; single ones can be given by name. Without a word on the light it sits at the eye or,
        for techniques whose light can be dragged, at its default place beside the volume.
    classic : bool, default: False
        Start from the values of the well-known teaching programs.
    pacer : Pacer, optional
        For windows with an event loop: full pictures come piece by piece. Without one every render is
        complete.
    **values
        Single settings by name, `headlight`, `light_position`, `light_color`, `crop` and `clip_planes`
        included.

    Returns
    -------
    VolumeHandle
        ``update(...)`` changes what is shown, ``remove()`` takes it away.

    Raises
    ------
    VolvizError
        Unknown technique or setting, unusable value.
    """
    info = technique_info(technique)
    if plotter.render_window is None:
        raise InputError("the plotter is closed and shows nothing any more; make a new one.")
    if volume is None:
        raise InputError("there is no volume to show: give a volviz.Volume.")
    check_kinds(volume=volume, transfer_function=transfer_function, light=light, clipping=clipping)
    # techniques with a light to be dragged show little under a light at the eye, which sees no shadow
    first_light = Light(headlight="light" not in info.handles)
    new_light, new_clipping, own = split_values(values, light or first_light, clipping or Clipping())
    new_clipping.crop_within(volume.dimensions)
    if settings is None:
        settings = technique_settings(info, own, classic=classic)
    else:
        if own:
            raise InputError(f"give either settings or single values ({', '.join(own)}), not both.")
        check_settings(info, settings)
    if transfer_function is None:
        transfer_function = TransferFunction.auto(volume)
    release_on_close(plotter)
    return VolumeHandle(plotter, volume, info, transfer_function, settings, new_light, new_clipping, pacer)


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
