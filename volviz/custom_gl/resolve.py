"""What a `RenderSpec` means: every choice made, nothing left open, before anything is drawn."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.registry import technique as technique_info
from volviz.custom_gl.settings import CommonSettings, common_settings
from volviz.custom_gl.technique import TechniqueInfo, drawn_function, surface_settings
from volviz.errors import InputError
from volviz.kernels.slices import crop_corners
from volviz.model.clipping import Clipping, Crop
from volviz.model.layers import ImageLayer, LabelLayer, volume_of
from volviz.model.light import Light, default_position
from volviz.model.render_spec import RenderSpec
from volviz.model.surface_values import SurfaceColors
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.references import VolumeKey
from volviz.volume_data.volume import Volume

Vector = tuple[float, float, float]
Volumes = Mapping[VolumeKey, Volume]

#: What each value of a spec must be an instance of, and how to come by one.
_KINDS: dict[str, tuple[type[Any], str]] = {
    "volume": (Volume, "wrap an array in one, or load a file"),
    "transfer_function": (TransferFunction, "its preset(...) and from_points(...) make one"),
    "light": (Light, "or give light_position, light_color and headlight by themselves"),
    "clipping": (Clipping, "or give crop and clip_planes by themselves"),
}

_auto_functions: WeakKeyDictionary[Volume, TransferFunction] = WeakKeyDictionary()


def check_kinds(**values: Any) -> None:
    """Refuse values that are not what their names promise; None is left to the caller.

    Raises
    ------
    InputError
        One is something else.
    """
    for name, value in values.items():
        kind, advice = _KINDS[name]
        if value is not None and not isinstance(value, kind):
            raise InputError(
                f"{name} must be a volviz.{kind.__name__}, got {type(value).__name__}; {advice}."
            )


@dataclass(frozen=True, eq=False)
class ResolvedSpec:
    """A `RenderSpec` with every choice made: what renderers, techniques and pickers read.

    Attributes
    ----------
    spec : RenderSpec
        What was asked for.
    volume : Volume
        The data of the layer that is drawn.
    info : TechniqueInfo
        The technique.
    settings : object
        Instance of its settings class.
    common : CommonSettings
        The same as the parts that all techniques share read it.
    light_position : tuple of 3 floats
        World position of the placed light (also while the headlight is on).
    crop : tuple of 6 floats
        Box that is shown, in continuous voxel indices (i0, i1, j0, j1, k0, k1), within the volume.
    transfer_function : TransferFunction
        In data units.
    drawn_function : TransferFunction
        The same without regions that the technique does not draw. Uploads are keyed by its identity: an equal one
        stays the same object (`keeping`).
    surface_colors : SurfaceColors or None
        Values of the surface that are seen instead of its own colours.
    """

    spec: RenderSpec
    volume: Volume
    info: TechniqueInfo
    settings: Any
    common: CommonSettings
    light_position: Vector
    crop: Crop
    transfer_function: TransferFunction
    drawn_function: TransferFunction
    surface_colors: SurfaceColors | None = None

    @property
    def light(self) -> Light:
        """The light; `light_position` says where it stands."""
        return self.spec.light

    @property
    def clipping(self) -> Clipping:
        """Crop box and clip planes as they were asked for."""
        return self.spec.clipping

    @cached_property
    def isovalues(self) -> tuple[float, ...]:
        """Values of the isosurfaces that the technique shows, in data units; empty where it shows none."""
        return self.info.isovalues(self.settings, self.volume)

    @property
    def unit_distance(self) -> float:
        """Length of ray to which the opacities of the transfer function refer, in world units."""
        chosen = self.common.opacity_unit_distance
        return self.volume.mean_spacing if chosen is None else float(chosen)

    @cached_property
    def box_corners(self) -> npt.NDArray[np.float64]:
        """World corners of the cropped box, shape (8, 3); bit 0 of the row is x, bit 1 y, bit 2 z."""
        return crop_corners(self.volume.index_to_world, self.crop, self.volume.dimensions)

    @property
    def notice(self) -> str:
        """A sentence on what of the settings cannot be drawn together; empty when nothing."""
        if self.drawn_function.by_gradient is None or not self.common.preintegrated:
            return ""
        return "Regions over value and gradient are drawn without pre-integration."

    def is_same_surface(self, other: ResolvedSpec) -> bool:
        """Whether a mesh technique extracts the same mesh."""
        return (
            self.volume is other.volume
            and self.info.id == other.info.id
            and surface_settings(self.settings) == surface_settings(other.settings)
        )

    def keeping(self, before: ResolvedSpec) -> ResolvedSpec:
        """The same, with the function of an earlier one where that is drawn alike, so that it need not be uploaded."""
        if self.drawn_function is before.drawn_function or self.drawn_function != before.drawn_function:
            return self
        return replace(self, drawn_function=before.drawn_function)


def resolve(spec: RenderSpec, volumes: Volumes | None = None) -> ResolvedSpec:
    """Make every choice that a spec leaves open, and refuse what cannot be drawn.

    Parameters
    ----------
    spec : RenderSpec
        What is to be drawn.
    volumes : mapping of VolumeKey to Volume, optional
        What has been read of the references in its layers (`volviz.model.layers.volume_of`).

    Raises
    ------
    InputError
        A value of the wrong kind, a crop box that leaves nothing, or layers that no technique draws yet.
    """
    layer = drawn_layer(spec)
    volume = volume_of(layer, volumes or {})
    low, high = volume.range
    if not np.isfinite(high - low):
        raise InputError(
            f"{volume.name}: its values reach from {low:.3g} to {high:.3g}, farther than 64-bit numbers count; "
            "divide them by 10 first."
        )
    check_kinds(transfer_function=layer.transfer_function, light=spec.light, clipping=spec.clipping)
    info = technique_info(spec.technique)
    settings = settings_of(spec)
    function = layer_function(layer, volume).resolved(volume.range)
    return ResolvedSpec(
        spec=spec,
        volume=volume,
        info=info,
        settings=settings,
        common=common_settings(settings),
        light_position=spec.light.position or default_position(volume.bounds),
        crop=spec.clipping.crop_within(volume.dimensions),
        transfer_function=function,
        drawn_function=drawn_function(info, settings, function),
        surface_colors=checked_surface_colors(info, spec.surface_colors),
    )


def settings_of(spec: RenderSpec) -> Any:
    """The settings of a spec's technique, its defaults where the spec leaves them open.

    Raises
    ------
    InputError
        They are not an instance of the technique's class.
    """
    info = technique_info(spec.technique)
    settings = info.settings() if spec.settings is None else spec.settings
    if not isinstance(settings, info.settings):
        raise InputError(f"{info.id} takes {info.settings.__name__}, got {type(settings).__name__}.")
    return settings


def checked_surface_colors(info: TechniqueInfo, colors: Any) -> SurfaceColors | None:
    """Colours of a surface as they can be drawn, or none.

    Raises
    ------
    InputError
        The technique draws no triangles, or the colours are still to be computed.
    """
    if colors is None:
        return None
    if not info.colors_surface:
        raise InputError(
            f"{info.id} draws no mesh whose triangles could be coloured by values; choose a technique that does, "
            "such as marching_cubes."
        )
    if not isinstance(colors, SurfaceColors):
        raise InputError(
            f"surface_colors must be SurfaceColors, got {type(colors).__name__}; "
            "volviz.compare.distance_colors.colors_of measures distances."
        )
    return colors


# ---------------------------------------------------------------------------------------- layers


def drawn_layer(spec: RenderSpec) -> ImageLayer:
    """The one layer of a spec that is drawn.

    Raises
    ------
    InputError
        None is visible, or what is visible cannot be drawn yet.
    """
    seen = [layer for layer in spec.layers if layer.visible]
    if not spec.layers:
        raise InputError("there is no volume to show: give a volviz.Volume.")
    if not seen:
        raise InputError("all layers are hidden; make one visible.")
    if len(seen) > 1:
        raise InputError(
            f"only one visible layer can be drawn at a time, got {len(seen)}; set visible=False on the others."
        )
    layer = seen[0]
    if isinstance(layer, LabelLayer):
        raise InputError("label layers cannot be drawn yet; show the labels as an ImageLayer.")
    if layer.mode != "add":
        raise InputError(
            f'a layer of the mode "{layer.mode}" acts on another one, and only one layer can be drawn; use "add".'
        )
    if layer.transform is not None:
        raise InputError(
            "a transform of a layer cannot be drawn yet; give its volume another origin, spacing and direction."
        )
    return layer


def layer_function(layer: ImageLayer, volume: Volume) -> TransferFunction:
    """The transfer function of a layer: its own, one from its colour and window, or one made from the data.

    A colour (white where there is only a window) fades in over the window (the range of the data where there is only
    a colour).
    """
    function = layer.transfer_function
    if function is None and (layer.color is not None or layer.window is not None):
        color = layer.color or (1.0, 1.0, 1.0)
        low, high = layer.window or volume.range
        function = TransferFunction.from_points([(low, (*color, 0.0)), (high, (*color, 1.0))])
    if function is None:
        function = _auto_functions.get(volume)
        if function is None:
            function = _auto_functions[volume] = TransferFunction.auto(volume)
    return function if layer.opacity == 1.0 else function.with_opacity(function.opacity * layer.opacity)
