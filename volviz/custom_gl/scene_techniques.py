"""The scene together with the registry: which technique draws a view, with which settings, and how both are changed."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import replace
from typing import Any

from volviz.custom_gl.registry import techniques
from volviz.custom_gl.technique import TechniqueInfo
from volviz.model.light import Light
from volviz.model.parameters import Parameter
from volviz.model.render_spec import RenderSpec
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.model.surface_values import DistanceColoring


def drawing_techniques() -> list[TechniqueInfo]:
    """Our own techniques, in the order of the list; VTK's are there for comparison."""
    return [info for info in techniques().values() if not info.counterpart_of]


def counterparts() -> list[TechniqueInfo]:
    """The techniques that are meant to be looked at beside ours: VTK's own mappers, the reference."""
    return [info for info in techniques().values() if info.counterpart_of]


def current_technique(scene: Scene, view: int | None = None) -> TechniqueInfo:
    """The technique that draws a view, the active one unless another is named."""
    known = techniques()
    return known.get(scene.view_at(view).technique) or next(iter(known.values()))


def current_settings(scene: Scene, view: int | None = None) -> Any:
    """Settings of the technique that draws a view, the active one unless another is named."""
    info = current_technique(scene, view)
    return scene.view_at(view).settings_for(info.id, info.settings)


def choose_technique(store: Store, technique: str, *, view: int | None = None) -> None:
    """Draw a view, the active one unless another is named, with another technique; a step of the history.

    A technique about light starts with a placed one, as long as nobody has touched the light: from the eye
    itself no shadow can be seen.
    """
    info = techniques()[technique]

    def chosen(scene: Scene) -> Scene:
        changed = scene.with_view(view, technique=technique)
        if "light" in info.manipulators and scene.light == Light():
            changed = replace(changed, light=Light(headlight=False))
        return changed

    store.update(chosen, label=info.label)


def change_setting(
    store: Store, parameter: Parameter, value: Any, *, gesture: Hashable | None = None
) -> None:
    """Give a setting of the current technique another value.

    Raises
    ------
    SettingError
        The value is outside of the limits of the parameter.
    """

    def change(scene: Scene) -> Scene:
        info = current_technique(scene)
        settings = replace(current_settings(scene), **{parameter.name: parameter.checked(value)})
        return scene.with_view(settings=scene.view.with_settings(info.id, settings).settings)

    store.update(change, label=parameter.label, gesture=gesture)


def reset_settings(store: Store, label: str) -> None:
    """Give all settings of the current technique their defaults."""

    def change(scene: Scene) -> Scene:
        info = current_technique(scene)
        return scene.with_view(settings=scene.view.with_settings(info.id, info.settings()).settings)

    store.update(change, label=label)


def render_spec(scene: Scene, view: int | None = None) -> RenderSpec:
    """What a view of the scene shows, the active one unless another is named."""
    return RenderSpec(
        scene.layers,
        current_technique(scene, view).id,
        current_settings(scene, view),
        scene.light,
        scene.clipping,
        distance_coloring(scene, view),
    )


def distance_coloring(scene: Scene, view: int | None = None) -> DistanceColoring | None:
    """The distance that the surface of a view is to be coloured by; None where the scene asks for none.

    That takes a compared pair of views whose techniques both draw triangles.
    """
    pair, comparison = scene.pair, scene.comparison
    index = scene.active_index if view is None else view
    if pair is None or index not in pair or comparison.distances == "off":
        return None
    other = pair[1 - pair.index(index)]
    if not all(current_technique(scene, each).colors_surface for each in pair):
        return None
    return DistanceColoring(
        current_technique(scene, other).id,
        current_settings(scene, other),
        comparison.distances == "signed",
        comparison.distance_limit,
    )
