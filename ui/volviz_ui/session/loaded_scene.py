"""A scene together with its volumes: what views and panels show."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from volviz.custom_gl.scene_techniques import current_technique, drawn_spec, draws_one, render_spec
from volviz.model.layers import holding
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
        What its layers show.
    """

    scene: Scene = field(default_factory=Scene)
    volumes: Mapping[VolumeKey, Volume] = field(default_factory=dict)

    @property
    def volume(self) -> Volume | None:
        """The volume of `Scene.layer`; None for a scene that shows nothing."""
        layer = self.scene.layer
        return None if layer is None else self.volumes[layer.key]

    @property
    def transfer_function(self) -> TransferFunction | None:
        """The transfer function of `Scene.layer`."""
        layer = self.scene.layer
        return None if layer is None else layer.transfer_function

    def spec(self, view: int) -> RenderSpec:
        """What a view draws of the scene: its visible layers, or the active one by a technique that draws one."""
        # distances of surfaces are measured by whoever compares, and given to the handle as colours
        return replace(drawn_spec(self.scene, view), surface_colors=None)

    def whole_spec(self, view: int) -> RenderSpec:
        """The same with the volumes themselves in the layers, for other threads."""
        spec = drawn_spec(self.scene, view)
        return replace(spec, layers=tuple(holding(layer, self.volumes) for layer in spec.layers))

    def active_spec(self, view: int) -> RenderSpec:
        """The same of the active layer alone: what a ray inspector follows."""
        active = self.scene.layer
        if active is None:
            return self.whole_spec(view)
        layer = replace(holding(active, self.volumes), visible=True, mode="add")
        return replace(render_spec(self.scene, view), layers=(layer,))


def words_on_layers(scene: Scene) -> str:
    """A sentence on layers that the technique of the active view leaves out; empty when all visible ones are drawn."""
    others = sum(layer.visible for layer in scene.layers if layer is not scene.layer)
    if not others or not draws_one(scene):
        return ""
    count = "1 other layer waits" if others == 1 else f"{others} other layers wait"
    return f"{current_technique(scene).label} draws the active layer; {count}."


def volume_of(shown: LoadedScene) -> Volume | None:
    """The volume that is shown; for `binding.show_value`."""
    return shown.volume
