"""Edits of the layers of a scene, from scene to scene."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from typing import Any

from volviz.model.layers import Color, ImageLayer, LabelLayer, Layer, changed_layers
from volviz.model.scene import Scene
from volviz.model.time_range import refitted
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.description import Label
from volviz.volume_data.references import VolumeRef


def with_layer_at(scene: Scene, number: int, **changes: Any) -> Scene:
    """The scene with one layer changed."""
    return replace(scene, layers=changed_layers(scene.layers, number, **changes))


def moved(scene: Scene, number: int, by: int) -> Scene:
    """The scene with a layer further down (1) or up (-1) in the list; the picture stays the same."""
    other = number + by
    if not 0 <= other < len(scene.layers):
        return scene
    layers = list(scene.layers)
    layers[number], layers[other] = layers[other], layers[number]
    active = {number: other, other: number}.get(scene.active_layer, scene.active_layer)
    return replace(scene, layers=tuple(layers), active_layer=active)


def duplicated(scene: Scene, number: int) -> Scene:
    """The scene with a layer a second time, after itself; the copy is the active one."""
    layers = (*scene.layers[: number + 1], *scene.layers[number:])
    return replace(scene, layers=layers, active_layer=number + 1)


def as_labels(scene: Scene, number: int, table: Iterable[Label] = ()) -> Scene:
    """The scene with an image layer as one of labels, with the names and colours that its file knows."""
    layer = scene.layers[number]
    if not isinstance(layer, ImageLayer) or not can_remove(scene, number):
        return scene
    labels = LabelLayer(
        layer.volume,
        {label.number: label.color for label in table if label.color is not None},
        {label.number: label.name for label in table if label.name},
        name=layer.name, channel=layer.channel, time=layer.time, transform=layer.transform, visible=layer.visible,
    )  # fmt: skip
    return replace(scene, layers=(*scene.layers[:number], labels, *scene.layers[number + 1 :]))


def contrast_of(layer: Layer) -> tuple[float, float] | None:
    """Values between which the function of an image layer rises, in data units; None where it has none of its own."""
    if not isinstance(layer, ImageLayer) or layer.transfer_function is None:
        return None
    points = layer.transfer_function.points
    return points[0].value, points[-1].value


def with_contrast(scene: Scene, number: int, window: tuple[float, float]) -> Scene:
    """The scene with the function of a layer stretched between two values."""
    layer, before = scene.layers[number], contrast_of(scene.layers[number])
    if before is None or not isinstance(layer, ImageLayer) or layer.transfer_function is None:
        return scene
    return with_layer_at(scene, number, transfer_function=refitted(layer.transfer_function, before, window))


def can_remove(scene: Scene, number: int) -> bool:
    """Whether an image is left without a layer: panels and cameras need one."""
    return any(isinstance(layer, ImageLayer) for n, layer in enumerate(scene.layers) if n != number)


def without_layer(scene: Scene, number: int) -> Scene:
    """The scene without one layer; the last image stays."""
    if not can_remove(scene, number):
        return scene
    layers = (*scene.layers[:number], *scene.layers[number + 1 :])
    return replace(scene, layers=layers, active_layer=scene.active_layer - (scene.active_layer > number))


def with_added(scene: Scene, layers: Sequence[Layer]) -> Scene:
    """The scene with further layers, the first of which is the active one."""
    return replace(scene, layers=(*scene.layers, *layers), active_layer=len(scene.layers))


def with_layers_instead(scene: Scene, ref: VolumeRef, layers: Sequence[Layer]) -> Scene:
    """The scene with other layers in the place of the image layers of a file."""
    kept = [each for each in scene.layers if not (isinstance(each, ImageLayer) and each.volume == ref)]
    return replace(scene, layers=(*layers, *kept), active_layer=0)


def at_time(scene: Scene, time: int, refs: Collection[VolumeRef]) -> Scene:
    """The scene with all layers of some files at another time point."""
    layers = tuple(replace(layer, time=time) if layer.volume in refs else layer for layer in scene.layers)
    return replace(scene, layers=layers)


def with_only(scene: Scene, number: int) -> Scene:
    """The scene with one layer visible, or with all where that one alone was."""
    alone = all(layer.visible == (n == number) for n, layer in enumerate(scene.layers))
    layers = tuple(replace(layer, visible=alone or n == number) for n, layer in enumerate(scene.layers))
    return replace(scene, layers=layers)


def recolored(function: TransferFunction, color: Color) -> TransferFunction:
    """A function with its opacities and one colour."""
    return replace(function, points=tuple(replace(point, color=color) for point in function.points))


def shown_color(layer: Layer) -> Color | None:
    """The colour that stands for an image layer, that of its most opaque values; None for labels."""
    if not isinstance(layer, ImageLayer):
        return None
    if layer.transfer_function is None:
        return layer.color or (1.0, 1.0, 1.0)
    return max(layer.transfer_function.points, key=lambda point: point.opacity).color
