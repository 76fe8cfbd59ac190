"""Edits of the layers of a scene, from scene to scene."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Any

from volviz.model.layers import Color, ImageLayer, Layer
from volviz.model.scene import Scene
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.references import VolumeRef


def with_layer_at(scene: Scene, number: int, **changes: Any) -> Scene:
    """The scene with one layer changed."""
    layers = tuple(
        replace(layer, **changes) if n == number else layer for n, layer in enumerate(scene.layers)
    )
    return replace(scene, layers=layers)


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
