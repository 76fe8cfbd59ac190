"""The keywords of `volviz.render`, `volviz.add_volume` and `VolumeHandle.update` as a `RenderSpec`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from volviz.custom_gl.registry import technique as technique_info
from volviz.custom_gl.resolve import check_kinds, settings_of
from volviz.custom_gl.settings import SharedSettings
from volviz.custom_gl.technique import surface_settings
from volviz.errors import InputError
from volviz.model.clipping import Clipping
from volviz.model.layers import ImageLayer, LabelLayer, volume_of
from volviz.model.light import FROM_UPPER_LEFT, Light
from volviz.model.looks.choice import look_named
from volviz.model.looks.look import Look
from volviz.model.parameters import make_settings, parameters_of, setting_values
from volviz.model.render_spec import DEFAULT_TECHNIQUE, RenderSpec
from volviz.model.surface_values import DistanceColoring, SurfaceColors
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.source import VolumeSource
from volviz.volume_data.volume import Volume

Layers = tuple[ImageLayer | LabelLayer, ...]


def spec_of(
    shown: Volume | VolumeSource | ImageLayer | LabelLayer | Sequence[ImageLayer | LabelLayer],
    technique: str | None = None,
    *,
    transfer_function: TransferFunction | None = None,
    settings: Any = None,
    light: Light | None = None,
    clipping: Clipping | None = None,
    classic: bool = False,
    surface_colors: SurfaceColors | DistanceColoring | None = None,
    look: Look | str | None = None,
    **values: Any,
) -> RenderSpec:
    """What the keywords of `volviz.add_volume` ask for.

    Parameters
    ----------
    shown : Volume, ImageLayer, LabelLayer or sequence of layers
        What to show.
    technique, transfer_function, settings, light, clipping, classic, surface_colors, look, **values
        As in `volviz.add_volume`.

    Raises
    ------
    VolvizError
        Unknown technique or setting, unusable value.
    """
    check_kinds(transfer_function=transfer_function, light=light, clipping=clipping)
    if look is not None:
        if technique is not None or settings is not None or classic:
            raise InputError(
                "a look brings technique and settings; give either, or single settings beside it."
            )
        layers, look = _seen_with(look, layers_of(shown), transfer_function)
        technique, values = look.technique, dict(look.settings) | values
    else:
        layers = layers_of(shown, transfer_function)
    info = technique_info(technique or DEFAULT_TECHNIQUE)
    # under a light at the eye no shadow is seen, and shapes look flat
    first_light = Light(headlight="light" not in info.manipulators) if look is None else FROM_UPPER_LEFT
    new_light, new_clipping, own = split_values(values, light or first_light, clipping or Clipping())
    if settings is None:
        settings = make_settings(info.settings, (dict(info.classic) if classic else {}) | own, owner=info.id)
    else:
        _refuse_both(own)
    return RenderSpec(layers, info.id, settings, new_light, new_clipping, surface_colors)


def _seen_with(look: Look | str, layers: Layers, function: TransferFunction | None) -> tuple[Layers, Look]:
    """The one layer with the function of a look, unless another is given, and the look."""
    if len(layers) != 1 or not isinstance(layers[0], ImageLayer):
        raise InputError("a look is made for one volume; give layers their own transfer functions.")
    layer = layers[0]
    if isinstance(look, str):
        look = look_named(volume_of(layer), look)
    elif not isinstance(look, Look):
        raise InputError(f"look must be a name or one of volviz.looks, got {type(look).__name__}.")
    chosen = function or layer.transfer_function or look.transfer_function
    return (replace(layer, transfer_function=chosen, color=None, window=None),), look


def layers_of(shown: Any, transfer_function: TransferFunction | None = None) -> Layers:
    """Layers from a volume, with a function for it, or from one layer or several, which have their own.

    Raises
    ------
    InputError
        There is nothing to show, something else is given, or layers and a function.
    """
    if shown is None:
        raise InputError("there is no volume to show: give a volviz.Volume.")
    if isinstance(shown, ImageLayer | LabelLayer):
        shown = (shown,)
    elif not isinstance(shown, list | tuple):
        if not isinstance(shown, VolumeSource):
            check_kinds(volume=shown)
        return (ImageLayer(shown, transfer_function),)
    if not all(isinstance(layer, ImageLayer | LabelLayer) for layer in shown):
        raise InputError("layers are volviz.ImageLayer or volviz.LabelLayer; wrap each volume in one.")
    if transfer_function is not None:
        raise InputError("layers have transfer functions of their own; leave transfer_function out.")
    return tuple(shown)


def changed_spec(
    spec: RenderSpec,
    *,
    volume: Volume | None = None,
    technique: str | None = None,
    transfer_function: TransferFunction | None = None,
    settings: Any = None,
    light: Light | None = None,
    clipping: Clipping | None = None,
    **values: Any,
) -> RenderSpec:
    """A spec with other values, as in `VolumeHandle.update`; None leaves one as it is.

    Volume and function are those of the visible layer. Colours of a surface end with the surface: with another volume,
    technique or setting of the extraction.

    Raises
    ------
    VolvizError
        A value does not fit.
    """
    check_kinds(volume=volume, transfer_function=transfer_function, light=light, clipping=clipping)
    info = technique_info(technique or spec.technique)
    if settings is not None:
        _refuse_both(values)
    new_light, new_clipping, own = split_values(values, light or spec.light, clipping or spec.clipping)
    if settings is None and (own or info.id != spec.technique):
        present = setting_values(settings_of(spec)) if info.id == spec.technique else {}
        settings = make_settings(info.settings, present | own, owner=info.id)
    changes: dict[str, Any] = {}
    if volume is not None:
        changes["volume"] = volume
    if transfer_function is not None:
        changes["transfer_function"] = transfer_function
    layers = spec.layers
    if changes:
        layers = tuple(replace(layer, **changes) if layer.visible else layer for layer in layers)
    changed = RenderSpec(
        layers, info.id, spec.settings if settings is None else settings, new_light, new_clipping
    )
    return keeping_surface_colors(changed, spec)


def keeping_surface_colors(changed: RenderSpec, before: RenderSpec) -> RenderSpec:
    """A spec with the colours of the surface that an earlier one had, where it is the same surface."""
    if before.surface_colors is None or not _is_same_surface(changed, before):
        return changed
    return replace(changed, surface_colors=before.surface_colors)


def _is_same_surface(one: RenderSpec, other: RenderSpec) -> bool:
    """Whether a mesh technique extracts the same mesh."""
    return (
        one.technique == other.technique
        and [layer.volume for layer in one.layers] == [layer.volume for layer in other.layers]
        and surface_settings(settings_of(one)) == surface_settings(settings_of(other))
    )


def _refuse_both(values: Mapping[str, Any]) -> None:
    """Refuse single settings beside an instance of settings."""
    if values:
        raise InputError(f"give either settings or single values ({', '.join(values)}), not both.")


def split_values(
    values: Mapping[str, Any], light: Light, clipping: Clipping
) -> tuple[Light, Clipping, dict[str, Any]]:
    """Keywords as light, clipping and the rest, which belongs to the technique.

    A light position without a word on the headlight switches the headlight off: it was meant to be seen. So does a
    light beside the eye.
    """
    shared = {p.name: p for p in parameters_of(SharedSettings)}
    own = {name: value for name, value in values.items() if name not in shared}
    given = {name: shared[name].checked(value) for name, value in values.items() if name in shared}
    changes: dict[str, Any] = {}
    if "light_position" in given:
        changes["position"] = given["light_position"]
    if given.get("light_position") is not None:
        changes["headlight"] = False
        changes["beside_eye"] = False
    if given.get("light_beside_eye"):
        changes |= {"headlight": False, "beside_eye": True}
    if "headlight" in given:
        changes["headlight"] = given["headlight"]
    if "light_color" in given:
        changes["color"] = given["light_color"]
    cuts: dict[str, Any] = {}
    if "crop" in given:
        cuts["crop"] = given["crop"]
    if "clip_planes" in given:
        cuts["planes"] = given["clip_planes"]
    return replace(light, **changes), replace(clipping, **cuts), own
