"""What a `RenderSpec` means: every choice made, nothing left open, before anything is drawn."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.framing import default_camera, layers_camera
from volviz.custom_gl.lattices import crop_planes, is_same_lattice, joint_crop
from volviz.custom_gl.layer_set import (
    ResolvedLabels,
    ResolvedLayer,
    resolved_labels,
    resolved_layer,
    seen_from,
    visible_layers,
)
from volviz.custom_gl.registry import technique as technique_info
from volviz.custom_gl.settings import CommonSettings, common_settings
from volviz.custom_gl.technique import TechniqueInfo, surface_settings
from volviz.errors import InputError
from volviz.kernels.slices import crop_corners
from volviz.model.camera import Camera
from volviz.model.clipping import Clipping, Crop, Plane
from volviz.model.layers import LabelLayer
from volviz.model.light import Light, default_position, position_beside_eye
from volviz.model.render_spec import RenderSpec
from volviz.model.surface_values import SurfaceColors
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.boxes import between_levels
from volviz.volume_data.finer_levels import levels_behind
from volviz.volume_data.large_volume import at_finest
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
    layers : tuple of ResolvedLayer
        The image layers that are drawn, in an order that does not depend on the one in which they were given.
    labels : tuple of ResolvedLabels
        The layers of labels that are drawn, likewise.
    volume : Volume
        The data of the first layer that is seen, which the crop box, panels and pickers mean.
    info : TechniqueInfo
        The technique.
    settings : object
        Instance of its settings class.
    common : CommonSettings
        The same as the parts that all techniques share read it.
    bounds : tuple of 6 floats
        World bounds of what the light shines on.
    light_position : tuple of 3 floats
        World position of the placed light (also while the headlight is on); `light_seen_from` knows the one beside
        the eye.
    crop : tuple of 6 floats
        Box that is shown, in continuous voxel indices (i0, i1, j0, j1, k0, k1), within the volume.
    transfer_function : TransferFunction
        Of the same layer, in data units.
    drawn_function : TransferFunction
        The same without regions that the technique does not draw. Uploads are keyed by its identity: an equal one
        stays the same object (`keeping`).
    surface_colors : SurfaceColors or None
        Values of the surface that are seen instead of its own colours.
    """

    spec: RenderSpec
    layers: tuple[ResolvedLayer, ...]
    labels: tuple[ResolvedLabels, ...]
    volume: Volume
    info: TechniqueInfo
    settings: Any
    common: CommonSettings
    bounds: tuple[float, float, float, float, float, float]
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

    def light_seen_from(self, world_to_eye: npt.NDArray[np.float64]) -> Vector:
        """World position of the light, where it is no headlight, for a view matrix, shape (4, 4)."""
        if self.light.beside_eye:
            return position_beside_eye(self.bounds, world_to_eye)
        return self.light_position

    @cached_property
    def isovalues(self) -> tuple[float, ...]:
        """Values of the isosurfaces that the technique shows, in data units; empty where it shows none.

        Of several layers they are those of the first one that is seen.
        """
        if self.is_joint and self.info.isovalue_setting:
            return next((self.isovalues_of(layer) for layer in self.layers if self.leads(layer)), ())
        return self.info.isovalues(self.settings, self.volume)

    def leads(self, layer: ResolvedLayer | ResolvedLabels) -> bool:
        """Whether a layer is the first one that is seen, which settings of isosurfaces and the crop box mean."""
        return (
            isinstance(layer, ResolvedLayer)
            and layer.mode == "add"
            and layer.volume is self.volume
            and layer.transfer_function is self.transfer_function
        )

    def isovalues_of(self, layer: ResolvedLayer | ResolvedLabels) -> tuple[float, ...]:
        """Values of the isosurfaces of one of several layers, in data units.

        Those that are set belong to the first one; the others show where their functions begin to be seen.
        """
        if not self.info.isovalue_setting or not isinstance(layer, ResolvedLayer):
            return ()
        if self.leads(layer) and getattr(self.settings, self.info.isovalue_setting) is not None:
            return self.info.isovalues(self.settings, layer.volume)
        return (seen_from(layer.transfer_function, layer.volume.range),)

    @property
    def unit_distance(self) -> float:
        """Length of ray to which the opacities of the transfer function refer, in world units."""
        return self.unit_distance_of(self.volume)

    def unit_distance_of(self, volume: Volume) -> float:
        """The same for the function of another layer."""
        chosen = self.common.opacity_unit_distance
        if chosen is None:
            # of the finest level, or the picture would depend on how much memory there is
            finer = levels_behind(volume)
            return volume.mean_spacing if finer is None else sum(finer.levels[0].spacing) / 3.0
        return float(chosen)

    @property
    def volumes(self) -> tuple[Volume, ...]:
        """The data of all layers that are drawn; rays are given in texture coordinates of the first one."""
        return tuple(layer.volume for layer in self.all_layers)

    @cached_property
    def drawn_volume(self) -> Volume:
        """On whose lattice rays are given: of the first volume, or of its finest level where that is read in bricks."""
        first = self.volumes[0]
        return at_finest(first) if self.info.draws_bricks and not self.is_joint else first

    @property
    def all_layers(self) -> tuple[ResolvedLayer | ResolvedLabels, ...]:
        """Image layers, then those of labels."""
        return (*self.layers, *self.labels)

    @property
    def is_joint(self) -> bool:
        """Whether several layers, or labels, are drawn in one integral."""
        return len(self.layers) > 1 or bool(self.labels)

    @property
    def seen(self) -> list[tuple[Volume, TransferFunction]]:
        """Data of each layer that is seen, and the function that shows it."""
        images = [(layer.volume, layer.drawn_function) for layer in self.layers if layer.mode == "add"]
        return images + [(layer.volume, layer.FUNCTION) for layer in self.labels if layer.mode == "add"]

    def framing_camera(
        self,
        size: tuple[int, int],
        azimuth: float = 0.0,
        elevation: float = 0.0,
        *,
        stacks_from_faces: bool = False,
    ) -> Camera:
        """The camera that frames all that is seen, or faces the plane that the technique shows.

        Parameters
        ----------
        size : tuple of 2 ints
            Width and height of the image in pixels.
        azimuth, elevation : float
            Further turn in degrees.
        stacks_from_faces : bool
            Look at a stack of few slices from their faces, as looks are seen.
        """
        facing = None if self.info.facing is None else self.info.facing(self.settings)
        if facing is not None:
            return default_camera(self.volume, size, azimuth, elevation, facing=facing)
        return layers_camera(self.seen, size, azimuth, elevation, stacks_from_faces=stacks_from_faces)

    @cached_property
    def is_one_lattice(self) -> bool:
        """Whether the voxels of all layers lie in the same places."""
        return all(is_same_lattice(self.volume, volume) for volume in self.volumes)

    @cached_property
    def drawn_crop(self) -> Crop:
        """Box around what is shown, in continuous voxel indices of `drawn_volume`."""
        finest, finer = self.drawn_volume, levels_behind(self.volumes[0])
        if finer is not None and finest is not self.volumes[0]:
            if self.clipping.crop is None:
                return Clipping().crop_within(finest.dimensions)
            extent = between_levels(self.crop, finer.levels[finer.held_level], finer.levels[0])
            return Clipping(extent).crop_within(finest.dimensions)
        return self.crop if self.is_one_lattice else joint_crop(self.volumes)

    @cached_property
    def drawn_planes(self) -> tuple[Plane, ...]:
        """Clip planes, with the faces of the crop box where layers lie on several lattices."""
        if self.is_one_lattice or self.clipping.crop is None:
            return self.clipping.planes
        return self.clipping.planes + crop_planes(self.volume, self.crop)

    @cached_property
    def box_corners(self) -> npt.NDArray[np.float64]:
        """World corners of the box around what is shown, shape (8, 3); bit 0 of the row is x, bit 1 y, bit 2 z."""
        first = self.drawn_volume
        return crop_corners(first.index_to_world, self.drawn_crop, first.dimensions)

    @property
    def notice(self) -> str:
        """A sentence on what of the settings cannot be drawn together; empty when nothing."""
        hidden = any(
            isinstance(layer, LabelLayer) and layer.visible and layer.mode == "add"
            for layer in self.spec.layers
        )
        if hidden and self.common.mode != "composite":
            return "Labels are surfaces and are seen by compositing only."
        if not self.common.preintegrated:
            return ""
        if self.is_joint:
            return "Several layers are drawn without pre-integration."
        if self.drawn_function.by_gradient is None:
            return ""
        return "Regions over value and gradient are drawn without pre-integration."

    def lies_like(self, other: ResolvedSpec) -> bool:
        """Whether the volumes of another one lie in the same places and are of the same types: other time points."""
        if len(self.layers) != len(other.layers) or len(self.labels) != len(other.labels):
            return False
        return all(
            is_same_lattice(one, two) and one.array.dtype == two.array.dtype
            for one, two in zip(self.volumes, other.volumes, strict=True)
        )

    def is_same_surface(self, other: ResolvedSpec) -> bool:
        """Whether a mesh technique extracts the same mesh."""
        return (
            self.volume is other.volume
            and self.info.id == other.info.id
            and surface_settings(self.settings) == surface_settings(other.settings)
        )

    def keeping(self, before: ResolvedSpec) -> ResolvedSpec:
        """The same, with the functions of an earlier one where they are drawn alike: those need not be uploaded."""
        layers = tuple(layer.keeping(before.layers) for layer in self.layers)
        if all(kept is layer for kept, layer in zip(layers, self.layers, strict=True)):
            return self
        drawn = next(
            (
                kept.drawn_function
                for kept, layer in zip(layers, self.layers, strict=True)
                if layer.drawn_function is self.drawn_function
            ),
            self.drawn_function,
        )
        return replace(self, layers=layers, drawn_function=drawn)


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
    info = technique_info(spec.technique)
    settings = settings_of(spec)
    common = common_settings(settings)
    seen, seen_labels = visible_layers(spec.layers, info, common.mode)
    for layer in seen:
        check_kinds(transfer_function=layer.transfer_function)
    check_kinds(light=spec.light, clipping=spec.clipping)
    layers = [resolved_layer(layer, volumes or {}, info, settings) for layer in seen]
    labels = [resolved_labels(layer, volumes or {}) for layer in seen_labels]
    first = next((layer for layer in layers if layer.mode == "add"), None)
    drawn: list[ResolvedLayer | ResolvedLabels] = [*layers, *labels]
    volume = next(layer.volume for layer in drawn if layer.mode == "add")
    corners = np.concatenate([layer.volume.corners for layer in drawn])
    (x0, y0, z0), (x1, y1, z1) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return ResolvedSpec(
        spec=spec,
        layers=tuple(sorted(layers, key=lambda layer: layer.place_in_order)),
        # one alone need not be written out for its place: it may have a hundred thousand labels
        labels=tuple(sorted(labels, key=lambda layer: layer.place_in_order) if len(labels) > 1 else labels),
        volume=volume,
        info=info,
        settings=settings,
        common=common,
        bounds=(x0, x1, y0, y1, z0, z1),
        light_position=spec.light.position or default_position((x0, x1, y0, y1, z0, z1)),
        crop=spec.clipping.crop_within(volume.dimensions),
        transfer_function=ResolvedLabels.FUNCTION if first is None else first.transfer_function,
        drawn_function=ResolvedLabels.FUNCTION if first is None else first.drawn_function,
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
