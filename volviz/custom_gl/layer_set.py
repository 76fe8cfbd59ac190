"""Which layers of a spec are drawn, and in which order."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, ClassVar, Literal
from weakref import WeakKeyDictionary

import numpy as np

from volviz.custom_gl.technique import TechniqueInfo, drawn_function
from volviz.errors import InputError
from volviz.model.label_palette import LabelLook, ShownLabels
from volviz.model.layers import ImageLayer, LabelLayer, LayerMode, volume_of
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.references import VolumeKey
from volviz.volume_data.source import VolumeSource
from volviz.volume_data.volume import Volume

#: Layers that one picture may join.
MAX_LAYERS = 16

_auto_functions: WeakKeyDictionary[Volume, TransferFunction] = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class ResolvedLayer:
    """A layer with every choice made.

    Attributes
    ----------
    volume : Volume
        Its values, where they are shown.
    transfer_function, drawn_function : TransferFunction
        As in `volviz.custom_gl.resolve.ResolvedSpec`.
    mode : {"add", "mask", "modulate"}
        How it joins the others.
    """

    volume: Volume
    transfer_function: TransferFunction
    drawn_function: TransferFunction
    mode: LayerMode

    def keeping(self, before: Sequence[ResolvedLayer]) -> ResolvedLayer:
        """The same, with the function of an earlier layer of this volume that is drawn alike."""
        for other in before:
            if other.volume is self.volume and other.drawn_function == self.drawn_function:
                return replace(self, drawn_function=other.drawn_function)
        return self

    @property
    def place_in_order(self) -> tuple[Any, ...]:
        """Sorts layers by what they are, so that pictures do not depend on the order in which they are given."""
        volume = self.volume
        return (
            self.mode, volume.index_to_world.tobytes(), volume.dimensions, volume.array.dtype.str, volume.range,
            volume.name, id(volume), _written(self.drawn_function),
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class ResolvedLabels:
    """A layer of labels with every choice made.

    Attributes
    ----------
    volume : Volume
        Its labels, where they are shown.
    shown : ShownLabels
        How.
    mode : {"add", "mask"}
        Its surfaces are seen, or the others are seen within its labels only.
    """

    volume: Volume
    shown: ShownLabels
    mode: Literal["add", "mask"]

    #: What framing and picking take for it: all labels but 0.
    FUNCTION: ClassVar[TransferFunction] = TransferFunction.from_points(
        [(0.0, (0.8, 0.8, 0.8, 0.0)), (1.0, (0.8, 0.8, 0.8, 1.0))]
    )

    @property
    def place_in_order(self) -> tuple[Any, ...]:
        """As in `ResolvedLayer`."""
        volume = self.volume
        return (
            self.mode,
            volume.index_to_world.tobytes(),
            volume.dimensions,
            volume.name,
            id(volume),
            repr(self.shown),
        )


def seen_from(function: TransferFunction, value_range: tuple[float, float]) -> float:
    """The lowest value at which a function reaches half of its largest opacity, in data units: where matter begins.

    Parameters
    ----------
    function : TransferFunction
        In data units; of regions over value and gradient the curve counts.
    value_range : tuple of 2 floats
        Within which it is looked for.

    Returns
    -------
    float
        Infinity where nothing is visible.
    """
    low, high = function.table_range(value_range)
    table = function.bake((low, high), 4096)[:, 3].astype(np.float64)
    half = 0.5 * float(table.max())
    if half == 0.0:
        return math.inf
    i = int(np.argmax(table >= half))
    part = float(i) if i == 0 else i - 1 + (half - table[i - 1]) / (table[i] - table[i - 1])
    return float(low + (high - low) * part / (len(table) - 1))


@lru_cache(maxsize=64)
def _written(function: TransferFunction) -> str:
    return repr(function)


def visible_layers(
    layers: Sequence[ImageLayer | LabelLayer], info: TechniqueInfo, mode: str
) -> tuple[tuple[ImageLayer, ...], tuple[LabelLayer, ...]]:
    """The image layers of a spec that are seen, and its layers of labels that are, in a mode of a ray caster.

    Raises
    ------
    InputError
        None is visible, or the technique cannot draw what is.
    """
    seen = [layer for layer in layers if layer.visible]
    if not layers:
        raise InputError("there is no volume to show: give a volviz.Volume.")
    if not seen:
        raise InputError("all layers are hidden; make one visible.")
    images = tuple(layer for layer in seen if isinstance(layer, ImageLayer))
    labels = tuple(layer for layer in seen if isinstance(layer, LabelLayer))
    if labels and not info.draws_layers:
        raise InputError(f"{info.label} draws no labels; hide the layers of labels, or draw by raycast.")
    if mode != "composite" and any(layer.mode == "add" for layer in labels):
        labels = tuple(layer for layer in labels if layer.mode != "add")
        if not images:
            raise InputError(
                f'labels are surfaces, which the mode "{mode}" has no place for; choose "composite".'
            )
    if all(layer.mode != "add" for layer in images) and all(layer.mode != "add" for layer in labels):
        raise InputError(
            f'a layer of the mode "{seen[0].mode}" acts on others and shows nothing itself; add one of the mode '
            '"add".'
        )
    if len(seen) > MAX_LAYERS:
        raise InputError(f"at most {MAX_LAYERS} layers are drawn together, got {len(seen)}; hide some.")
    if len(seen) > 1 and not info.draws_layers:
        raise InputError(
            f"{info.label} draws one layer and {len(seen)} are visible; hide the others, or draw them all by raycast."
        )
    return images, labels


def resolved_labels(layer: LabelLayer, volumes: Mapping[VolumeKey, Volume]) -> ResolvedLabels:
    """A layer of labels with its choices made; colours that it does not name are those of its file."""
    read = volume_of(layer, volumes)
    colors = layer.colors
    if isinstance(layer.volume, VolumeSource):
        known = {label.number: label.color for label in layer.volume.labels if label.color is not None}
        colors = tuple(sorted((known | dict(colors)).items()))
    look = LabelLook(colors, layer.hidden, layer.opacity, layer.opacities)
    placed = read if layer.transform is None else read.moved(layer.transform)
    return ResolvedLabels(placed, ShownLabels(look, layer.smooth), layer.mode)


def resolved_layer(
    layer: ImageLayer, volumes: Mapping[VolumeKey, Volume], info: TechniqueInfo, settings: Any
) -> ResolvedLayer:
    """A layer with its choices made for a technique."""
    read = volume_of(layer, volumes)
    low, high = read.range
    if not np.isfinite(high - low):
        raise InputError(
            f"{read.name}: its values reach from {low:.3g} to {high:.3g}, farther than 64-bit numbers count; "
            "divide them by 10 first."
        )
    function = layer_function(layer, read).resolved(read.range)
    placed = read if layer.transform is None else read.moved(layer.transform)
    return ResolvedLayer(placed, function, drawn_function(info, settings, function), layer.mode)


def layer_function(layer: ImageLayer, volume: Volume) -> TransferFunction:
    """The transfer function of a layer: its own, one from its colour and window, or one made from the data.

    A colour (white where there is only a window) fades in over the window (the range of the data where there is only
    a colour).
    """
    function = layer.transfer_function
    if function is None and (layer.color is not None or layer.window is not None):
        color = layer.color or (1.0, 1.0, 1.0)
        low, high = layer.window or volume.data_range
        function = TransferFunction.from_points([(low, (*color, 0.0)), (high, (*color, 1.0))])
    if function is None:
        function = _auto_functions.get(volume)
        if function is None:
            function = _auto_functions[volume] = TransferFunction.auto(volume)
    return function if layer.opacity == 1.0 else function.with_opacity(function.opacity * layer.opacity)
