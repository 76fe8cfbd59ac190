"""What a volume's handle shows, as one immutable value, and how it changes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.settings import SharedSettings
from volviz.custom_gl.technique import TechniqueInfo, drawn_function, surface_settings
from volviz.errors import InputError
from volviz.kernels.slices import crop_corners
from volviz.model.clipping import Clipping, Crop
from volviz.model.light import Light, default_position
from volviz.model.parameters import make_settings, parameters_of
from volviz.model.surface_values import SurfaceColors
from volviz.model.transfer_function import TransferFunction
from volviz.model.volume import Volume

#: What each value of the scene must be an instance of, and how to come by one.
_KINDS: dict[str, tuple[type[Any], str]] = {
    "volume": (Volume, "wrap an array in one, or load a file"),
    "transfer_function": (TransferFunction, "its preset(...) and from_points(...) make one"),
    "light": (Light, "or give light_position, light_color and headlight by themselves"),
    "clipping": (Clipping, "or give crop and clip_planes by themselves"),
}


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


def check_settings(info: TechniqueInfo, settings: Any) -> None:
    """Refuse settings of another technique.

    Raises
    ------
    InputError
        They are not an instance of the technique's class.
    """
    if not isinstance(settings, info.settings):
        raise InputError(f"{info.id} takes {info.settings.__name__}, got {type(settings).__name__}.")


@dataclass(frozen=True, eq=False)
class Shown:
    """Everything that decides the picture, but for camera and size.

    Attributes
    ----------
    given_function : TransferFunction
        As the user gave it, perhaps relative to the range of the data.
    transfer_function : TransferFunction
        The same in data units.
    drawn_function : TransferFunction
        The same without regions that the technique does not draw. Uploads are keyed by its identity: an equal one
        stays the same object.
    surface_colors : SurfaceColors or None
        Values of the surface that are seen instead of its own colours. They end with the surface: with another
        volume, technique or setting of the extraction.
    """

    volume: Volume
    info: TechniqueInfo
    settings: Any
    light: Light
    clipping: Clipping
    given_function: TransferFunction
    transfer_function: TransferFunction
    drawn_function: TransferFunction
    surface_colors: SurfaceColors | None = None

    @property
    def light_position(self) -> tuple[float, float, float]:
        """World position of the placed light (also while the headlight is on)."""
        return self.light.position or default_position(self.volume.bounds)

    @property
    def crop(self) -> Crop:
        """The crop box within the volume, in continuous voxel indices (i0, i1, j0, j1, k0, k1)."""
        return self.clipping.crop_within(self.volume.dimensions)

    @property
    def box_corners(self) -> npt.NDArray[np.float64]:
        """World corners of the cropped box, shape (8, 3); bit 0 of the row is x, bit 1 y, bit 2 z."""
        return crop_corners(self.volume.index_to_world, self.crop, self.volume.dimensions)

    @property
    def notice(self) -> str:
        """A sentence on what of the settings cannot be drawn together; empty when nothing."""
        if self.drawn_function.by_gradient is None or not getattr(self.settings, "preintegrated", False):
            return ""
        return "Regions over value and gradient are drawn without pre-integration."

    @classmethod
    def first(
        cls,
        volume: Volume,
        info: TechniqueInfo,
        settings: Any,
        light: Light,
        clipping: Clipping,
        function: TransferFunction,
    ) -> Shown:
        """What is shown to begin with."""
        resolved = function.resolved(volume.range)
        drawn = drawn_function(info, settings, resolved)
        return cls(volume, info, settings, light, clipping, function, resolved, drawn)

    def changed(
        self,
        *,
        volume: Volume | None,
        info: TechniqueInfo | None,
        transfer_function: TransferFunction | None,
        settings: Any,
        light: Light | None,
        clipping: Clipping | None,
        values: Mapping[str, Any],
    ) -> Shown:
        """The same with other values; None leaves one as it is.

        Raises
        ------
        VolvizError
            A value does not fit.
        """
        check_kinds(volume=volume, transfer_function=transfer_function, light=light, clipping=clipping)
        new_info = info or self.info
        if values and settings is not None:
            raise InputError(f"give either settings or single values ({', '.join(values)}), not both.")
        if settings is not None:
            check_settings(new_info, settings)
        new_light, new_clipping = light or self.light, clipping or self.clipping
        own: Mapping[str, Any] = {}
        if values:
            new_light, new_clipping, own = split_values(values, new_light, new_clipping)
        if settings is None:
            settings = self._settings_with(new_info, own)
        new_volume = volume or self.volume
        new_clipping.crop_within(new_volume.dimensions)
        given = transfer_function or self.given_function
        resolved = given.resolved(new_volume.range)
        drawn = drawn_function(new_info, settings, resolved)
        changed = replace(
            self,
            volume=new_volume,
            info=new_info,
            settings=settings,
            light=new_light,
            clipping=new_clipping,
            given_function=given,
            transfer_function=resolved,
            drawn_function=self.drawn_function if drawn == self.drawn_function else drawn,
        )
        return changed if changed.is_same_surface(self) else replace(changed, surface_colors=None)

    def is_same_surface(self, other: Shown) -> bool:
        """Whether a mesh technique extracts the same mesh."""
        return (
            self.volume is other.volume
            and self.info.id == other.info.id
            and surface_settings(self.settings) == surface_settings(other.settings)
        )

    def _settings_with(self, info: TechniqueInfo, own: Mapping[str, Any]) -> Any:
        if info.id != self.info.id:
            return make_settings(info.settings, own, owner=info.id)
        if not own:
            return self.settings
        merged = {p.name: getattr(self.settings, p.name) for p in info.parameters} | dict(own)
        return make_settings(info.settings, merged, owner=info.id)


def split_values(
    values: Mapping[str, Any], light: Light, clipping: Clipping
) -> tuple[Light, Clipping, dict[str, Any]]:
    """Keywords as light, clipping and the rest, which belongs to the technique.

    A light position without a word on the headlight switches the headlight off: it was meant to be seen.
    """
    shared = {p.name: p for p in parameters_of(SharedSettings)}
    own = {name: value for name, value in values.items() if name not in shared}
    given = {name: shared[name].checked(value) for name, value in values.items() if name in shared}
    changes: dict[str, Any] = {}
    if "light_position" in given:
        changes["position"] = given["light_position"]
    if given.get("light_position") is not None:
        changes["headlight"] = False
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
