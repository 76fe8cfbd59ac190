"""A scene together with its volumes: what views and panels show."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from volviz.custom_gl.scene_techniques import render_spec
from volviz.model.render_spec import RenderSpec
from volviz.model.scene import Scene
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.references import VolumeKey
from volviz.volume_data.volume import Volume


@dataclass(frozen=True)
class LoadedScene:
    """A scene whose volumes are in memory.

    Attributes
    ----------
    scene : Scene
        What is shown.
    volumes : mapping from VolumeKey to Volume
        What its layers show, as far as they are drawn: that of `scene.layer`.
    """

    scene: Scene = field(default_factory=Scene)
    volumes: Mapping[VolumeKey, Volume] = field(default_factory=dict)

    @property
    def volume(self) -> Volume | None:
        """The volume of the first image layer; None for a scene that shows nothing."""
        layer = self.scene.layer
        return None if layer is None else self.volumes[layer.key]

    @property
    def transfer_function(self) -> TransferFunction | None:
        """The transfer function of the first image layer."""
        layer = self.scene.layer
        return None if layer is None else layer.transfer_function

    def spec(self, view: int) -> RenderSpec:
        """What a view draws of the scene: the first image layer, as if it were alone; see `words_on_layers`."""
        first = self.scene.layer
        layers = () if first is None else (replace(first, visible=True, mode="add", transform=None),)
        # distances of surfaces are measured by whoever compares, and given to the handle as colours
        return replace(render_spec(self.scene, view), layers=layers, surface_colors=None)


def words_on_layers(scene: Scene) -> str:
    """A sentence on what of the layers is kept, but not drawn yet; empty when all is drawn."""
    first = scene.layer
    parts = []
    if len(scene.layers) > 1:
        others = len(scene.layers) - 1
        parts.append("1 further layer" if others == 1 else f"{others} further layers")
    if first is not None:
        parts += [
            words
            for words, is_so in (
                ("the transform of the first image", first.transform is not None),
                (f"its mode {first.mode}", first.mode != "add"),
                ("that it is hidden", not first.visible),
            )
            if is_so
        ]
    return f"Kept, but not drawn yet: {', '.join(parts)}." if parts else ""


def volume_of(shown: LoadedScene) -> Volume | None:
    """The volume that is shown; for `binding.show_value`."""
    return shown.volume
