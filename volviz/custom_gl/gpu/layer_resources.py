"""Textures of several layers that are drawn in one ray integral.

Texture units are few (OpenGL 3.3 promises 16). So up to four layers of one lattice share a texture of scalars, all
curves are rows of one table, and the fields of empty space of all lattices lie one above the other in one texture.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.gpu.context import Gpu, segment_texels
from volviz.custom_gl.gpu.label_resources import LabelResources
from volviz.custom_gl.gpu.resources import (
    SLAB_BYTES,
    SampledFrame,
    VolumeResources,
    distance_codes,
    distance_texture,
    empty_scalars,
    texel_limits,
)
from volviz.custom_gl.lattices import is_same_lattice
from volviz.custom_gl.settings import CLASSIFYING_MODES
from volviz.custom_gl.shader_source import layer_name
from volviz.errors import RenderError
from volviz.kernels.bricks import brick_grid_shape, grow_occupancy
from volviz.model.label_palette import ShownLabels
from volviz.model.layers import LayerMode
from volviz.model.transfer.function import MAX_TABLE
from volviz.model.transfer.tables import baked, rows_of
from volviz.volume_data.scalars import BRICK, texture_data_of
from volviz.volume_data.volume import Volume

if TYPE_CHECKING:
    from volviz.custom_gl.gpu.programs import Program

#: Layers whose scalars share a texture.
PACK = 4
#: What opaque matter lets through, as in ``glsl/joint_matter.glsl``.
LEAST_TRANSPARENCY = 1e-30


class LayerFrame(SampledFrame, Protocol):
    """What of the frame of one layer is read here."""

    uniforms: dict[str, Any]
    isovalues: tuple[float, ...]
    mode: LayerMode
    labels: ShownLabels | None

    @property
    def world_to_texture(self) -> npt.NDArray[np.float64]:
        """4 x 4 matrix from the world to texture coordinates."""


class JointFrame(Protocol):
    """What of the frame of all layers is read here."""

    @property
    def layers(self) -> Sequence[LayerFrame]:
        """The layers."""

    @property
    def texture_to_world(self) -> npt.NDArray[np.float64]:
        """4 x 4 matrix to the world from the texture coordinates in which rays are given."""


@dataclass(frozen=True)
class Arrangement:
    """Where layers stand among textures and lattices.

    Attributes
    ----------
    lattices : tuple of ints
        For each layer the number of the first one on its lattice.
    packs : tuple of tuples of ints
        Numbers of the layers that share a texture of scalars, in the order of its components.
    """

    lattices: tuple[int, ...]
    packs: tuple[tuple[int, ...], ...]

    @property
    def leads(self) -> tuple[int, ...]:
        """Numbers of the layers that stand for a lattice."""
        return tuple(dict.fromkeys(self.lattices))

    def component(self, layer: int) -> tuple[int, int]:
        """The first layer of a layer's pack, and its component."""
        pack = next(pack for pack in self.packs if layer in pack)
        return pack[0], pack.index(layer)


def arranged(gpu: Gpu, images: Sequence[Volume], labels: Sequence[LabelResources]) -> Arrangement:
    """Layers of one lattice and of equal texels, four to a texture."""
    texels = [texture_data_of(volume, *texel_limits(gpu, volume, alone=False)) for volume in images]
    texels += [each.texels for each in labels]
    volumes = [*images, *(each.volume for each in labels)]

    def is_same(one: int, other: int) -> bool:
        mapped = zip(texels[one].index_to_texture, texels[other].index_to_texture, strict=True)
        same = all(np.array_equal(first, second) for first, second in mapped)
        return same and is_same_lattice(volumes[one], volumes[other])

    numbers = range(len(volumes))
    lattices = tuple(next(first for first in numbers if is_same(first, n)) for n in numbers)
    alike: dict[Any, list[int]] = {}
    for n in numbers[: len(images)]:
        alike.setdefault((lattices[n], texels[n].format, texels[n].data.shape), []).append(n)
    packs = [tuple(same[i : i + PACK]) for same in alike.values() for i in range(0, len(same), PACK)]
    return Arrangement(lattices, tuple(packs))


class PackedScalars:
    """Scalars of up to four volumes of one lattice as the components of one texture.

    Attributes
    ----------
    texture : moderngl.Texture3D
        One component for each volume, linear filter, clamped.
    """

    def __init__(self, gpu: Gpu, volumes: Sequence[Volume]) -> None:
        self._gpu = gpu
        self._data = [texture_data_of(volume, *texel_limits(gpu, volume, alone=False)) for volume in volumes]
        self.texture = empty_scalars(gpu, self._data[0], len(volumes), volumes[0].name)
        self._uploaded = 0

    @property
    def complete(self) -> bool:
        """Whether all scalars are on the GPU."""
        return self._uploaded >= len(self._data[0].data)

    def upload_slab(self) -> None:
        """Upload some further planes."""
        z, y, x = self._data[0].data.shape
        first = self._uploaded
        plane = sum(texels.data[0].nbytes for texels in self._data)
        count = min(max(SLAB_BYTES // plane, 1), z - first)
        slab = np.stack([texels.data[first : first + count] for texels in self._data], axis=-1)
        self.texture.write(slab, viewport=(0, 0, first, x, y, count), alignment=1)
        self._uploaded += count
        self._gpu.uploads += 1


class LayerResources:
    """Textures of several layers, in the order in which they are drawn.

    Parameters
    ----------
    gpu : Gpu
        Where they are.
    images, labels : sequences of Volume
        Data of the image layers and, counted on from those, of the layers of labels.

    Attributes
    ----------
    layers : tuple of VolumeResources or LabelResources
        What belongs to one of them: mapping of texels, tables of regions, palettes, bricks.
    arrangement : Arrangement
        Which textures they share.
    """

    coarsest = 0
    voxel_scale = 1.0

    def __init__(self, gpu: Gpu, images: Sequence[Volume], labels: Sequence[Volume]) -> None:
        self.gpu = gpu
        self._labels = [LabelResources(gpu, volume) for volume in labels]
        self.arrangement = arranged(gpu, images, self._labels)
        units = int(gpu.gl.info["GL_MAX_TEXTURE_IMAGE_UNITS"])
        if len(self.arrangement.packs) + 2 * len(labels) + 3 > units:
            raise RenderError(
                f"the graphics driver reads {units} textures at once, and {len(images) + len(labels)} layers with "
                "voxels in different places need more; hide some."
            )
        self._packs = [PackedScalars(gpu, [images[n] for n in pack]) for pack in self.arrangement.packs]
        pack_of = {n: p for pack, p in zip(self.arrangement.packs, self._packs, strict=True) for n in pack}
        self._images = [VolumeResources(gpu, volume, pack_of[n]) for n, volume in enumerate(images)]
        self.layers: tuple[VolumeResources | LabelResources, ...] = (*self._images, *self._labels)
        self._tables: tuple[Any, Any] | None = None
        self._distances: tuple[Any, Any] | None = None

    @property
    def full_factor(self) -> tuple[int, int, int]:
        """Voxels per texel along (x, y, z) of the layer that was reduced most."""
        return max((layer.full_factor for layer in self.layers), key=max)

    @property
    def complete(self) -> bool:
        """Whether all scalars and labels are on the GPU."""
        return all(pack.complete for pack in self._packs) and all(each.complete for each in self._labels)

    def upload(self, max_bytes: int | None = None) -> bool:
        """Upload one further slab of scalars or labels, or all for None; True when all are there."""
        parts: list[PackedScalars | LabelResources] = [*self._packs, *self._labels]
        for part in parts:
            while not part.complete:
                part.upload_slab()
                if max_bytes is not None:
                    return self.complete
        return True

    # ------------------------------------------------------------------ programs

    def hooks(self, frame: JointFrame) -> dict[str, str]:
        """Files for the hooks of ``glsl/layer_set.glsl`` that belong to single layers."""
        images = (layer for layer in frame.layers if layer.labels is None)
        found = {"fetch": "fetch/packed.glsl"}
        for number, layer in enumerate(images):
            regions = layer.transfer_function.by_gradient is not None
            found[layer_name("classify", number)] = (
                "classify/regions.glsl" if regions else "classify/curve.glsl"
            )
        return found

    def defines(self, frame: JointFrame) -> dict[str, object]:
        """What ``glsl/layer_set.glsl`` must know of the layers of a frame."""
        layers = frame.layers
        images = [layer for layer in layers if layer.labels is None]
        height = rows_of(max(_segments(layers), default=1))
        defines: dict[str, object] = {
            "LAYERS": len(images), "LABELS": len(layers) - len(images), "LATTICES": len(self.arrangement.leads),
            "TABLE_FOLDED": height > 1, "MASKED": any(layer.mode != "add" for layer in layers),
        }  # fmt: skip
        for n, layer in enumerate(layers):
            lead = self.arrangement.lattices[n]
            own: dict[str, object] = {
                "LATTICE": lead,
                "MODE": ("add", "mask", "modulate").index(layer.mode),
                "AT_LATTICE": layer_name("g_at", lead),
                "SHARE_OF_LATTICE": layer_name("g_share", lead),
                "ON_LATTICE": layer_name("on_lattice", lead),
                "IN_LATTICE": layer_name("in_lattice", lead),
                "CUT_TO_LATTICE": layer_name("cut_to_lattice", lead),
            }
            if layer.labels is None:
                pack, component = self.arrangement.component(n)
                own |= {
                    "DEPTHS": holds_depths(layer),
                    "PACK": layer_name("t_scalars", pack), "COMPONENT": component,
                    "TABLE": "t_layer_tables", "TABLE_ROW": (n + 0.5) / len(images),
                    "TABLE_BASE": float(n * height),
                }  # fmt: skip
            else:
                own["SMOOTH"] = layer.labels.smooth
            if lead == n:
                on_it = [other for m, other in enumerate(layers) if self.arrangement.lattices[m] == n]
                own["ADDS"] = any(other.mode == "add" for other in on_it)
                own["DISTANCES"] = "t_layer_distances"
                own["FIRST_BRICK"] = layer_name("u_first_brick", n)
            defines |= {layer_name(name, n): value for name, value in own.items()}
        return defines

    # ------------------------------------------------------------------ what all layers share

    def lattice_uniforms(self, frame: JointFrame) -> list[dict[str, Any]]:
        """For each layer of a frame the uniforms of ``glsl/lattice.glsl`` and of its places in shared textures."""
        width = self._table_width(frame.layers)
        across, first_planes = self._atlas()
        found: list[dict[str, Any]] = []
        for number, layer in enumerate(frame.layers):
            edges = {}
            if layer.labels is None and layer.transfer_function.by_gradient is None:
                edges = {
                    "u_table_segment": 1.0 / min(width, MAX_TABLE),
                    "u_table_row": 1.0 / (sum(one.labels is None for one in frame.layers) * rows_of(width)),
                }
            found.append(
                edges
                | {
                    "u_ray_to_lattice": layer.world_to_texture @ frame.texture_to_world,
                    "u_brick_edge": tuple(1.0 / n for n in across),
                    "u_first_brick": (0.5, 0.5, 0.5 + first_planes[self.arrangement.lattices[number]]),
                }
            )
        return found

    def _atlas(self) -> tuple[tuple[int, int, int], dict[int, int]]:
        """Size (x, y, z) of the texture of all fields of empty space, and the first plane of each lattice's."""
        shapes = [brick_grid_shape(self.layers[n].volume.array.shape, BRICK) for n in self.arrangement.leads]
        ends = list(accumulate(shape[0] for shape in shapes))
        across = max(shape[2] for shape in shapes), max(shape[1] for shape in shapes), ends[-1]
        return across, dict(zip(self.arrangement.leads, [0, *ends], strict=False))

    @staticmethod
    def _table_width(layers: Sequence[LayerFrame]) -> int:
        return max(_segments(layers), default=1)

    def bind(self, program: Program, frame: JointFrame) -> None:
        """Bind every texture that a program of several layers asks for."""
        for number, (layer, resources) in enumerate(zip(frame.layers, self.layers, strict=True)):
            if isinstance(resources, VolumeResources):
                resources.bind(program, layer, layer=number)
            elif layer.labels is not None:
                resources.bind(program, layer.labels.look, number)
        if "t_layer_tables" in program.units:
            program.use_texture("t_layer_tables", self._table(frame))
        if "t_layer_distances" in program.units:
            program.use_texture("t_layer_distances", self._distance(frame))

    def _table(self, frame: JointFrame) -> Any:
        images = [layer for layer in frame.layers if layer.labels is None]
        key = tuple((layer.transfer_function, holds_depths(layer)) for layer in images)
        if self._tables is None or self._tables[0] != key:
            width = self._table_width(images)
            height, width = rows_of(width), min(width, MAX_TABLE)
            rows = np.zeros((len(images), height * width, 4), np.int32)
            for row, layer in zip(rows, images, strict=True):
                if layer.transfer_function.by_gradient is None:
                    texels = baked(layer.transfer_function, layer.volume).texels
                    if holds_depths(layer):
                        texels = texels.copy()
                        passing = 1.0 - texels[..., 3].astype(np.float64)
                        texels[..., 3] = -np.log(np.maximum(passing, LEAST_TRANSPARENCY))
                    segments = segment_texels(texels)[0]
                    row[: len(segments)] = segments
            texture = self.gpu.segments_texture(rows.reshape(-1, width, 4))
            self._tables = self._instead(self._tables, key, texture)
        return self._tables[1]

    def visible_key(self, frame: JointFrame) -> tuple[Any, ...]:
        """What visible bricks depend on."""
        return tuple(
            (n, self._visible_key(n, layer)) for n, layer in enumerate(frame.layers) if layer.mode == "add"
        )

    def visible_bricks(self, frame: JointFrame, *, whole: bool = False) -> dict[int, npt.NDArray[np.bool_]]:
        """For each lattice, by the number of its first layer, the bricks in which anything may be seen.

        Parameters
        ----------
        frame : JointFrame
        whole : bool
            The inside of labels counts as well as their surfaces, since it is seen where it is cut.
        """
        found = {
            lead: np.zeros(brick_grid_shape(self.layers[lead].volume.array.shape, BRICK), bool)
            for lead in self.arrangement.leads
        }
        for n, layer in enumerate(frame.layers):
            if layer.mode == "add":
                found[self.arrangement.lattices[n]] |= self._visible(n, layer, whole=whole)
        return found

    def _distance(self, frame: JointFrame) -> Any:
        key = self.visible_key(frame)
        if self._distances is None or self._distances[0] != key:
            across, first_planes = self._atlas()
            codes = np.zeros(across[::-1], np.float32)
            for lead, occupied in self.visible_bricks(frame).items():
                z, y, x = occupied.shape
                first = first_planes[lead]
                codes[first : first + z, :y, :x] = distance_codes(
                    occupied, max(self.layers[lead].texels.factor)
                )
            self._distances = self._instead(self._distances, key, distance_texture(self.gpu, codes))
        return self._distances[1]

    def _visible_key(self, n: int, layer: LayerFrame) -> Any:
        """What `_visible` depends on."""
        resources = self.layers[n]
        if isinstance(resources, VolumeResources):
            return (layer.isovalues, layer.step_world) if layer.isovalues else resources.occupancy_key(layer)
        return layer.labels, layer.step_world

    def _visible(self, n: int, layer: LayerFrame, *, whole: bool) -> npt.NDArray[np.bool_]:
        """Bricks of a layer in which anything may be seen."""
        resources = self.layers[n]
        # how far from a brick a segment may begin or end that crosses something in it
        within = min(layer.volume.spacing) * BRICK
        if isinstance(resources, VolumeResources):
            if not layer.isovalues:
                return resources.occupied(layer)
            return grow_occupancy(resources.crossed(layer.isovalues), math.ceil(layer.step_world / within))
        assert layer.labels is not None
        found = resources.visible_bricks(layer.labels.look, whole=whole)
        # a border is looked for along whole segments, half a step to either side of a sample
        beyond = math.ceil(max(0.5 * layer.step_world / min(layer.volume.spacing) - 1.0, 0.0) / BRICK)
        return grow_occupancy(found, beyond) if beyond else found

    @staticmethod
    def _instead(held: tuple[Any, Any] | None, key: Any, texture: Any) -> tuple[Any, Any]:
        if held is not None:
            held[1].release()
        return key, texture

    def release(self) -> None:
        """Release all textures; the context must be current."""
        for layer in self.layers:
            layer.release()
        for pack in self._packs:
            pack.texture.release()
        for held in (self._tables, self._distances):
            if held is not None:
                held[1].release()
        self._tables = self._distances = None


def _segments(layers: Sequence[LayerFrame]) -> list[int]:
    """Number of segments of the table of each layer that has one over the value."""
    return [
        int(layer.uniforms["u_table_last"])
        for layer in layers
        if layer.labels is None and layer.transfer_function.by_gradient is None
    ]


def holds_depths(layer: LayerFrame) -> bool:
    """Whether the table of a layer holds optical depths: where opacities are not changed or asked for after it."""
    common = layer.common
    by_value = layer.labels is None and layer.transfer_function.by_gradient is None
    return (
        by_value and layer.mode == "add" and common.mode in CLASSIFYING_MODES and not common.gradient_opacity
    )
