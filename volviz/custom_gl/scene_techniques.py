"""The scene together with the registry: which technique draws a view, with which settings, and how both are changed."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from volviz.custom_gl.registry import technique as technique_info
from volviz.custom_gl.registry import techniques
from volviz.custom_gl.settings import common_settings
from volviz.custom_gl.technique import TechniqueInfo
from volviz.model.cursor import tilted
from volviz.model.layers import ImageLayer, Layer
from volviz.model.light import FROM_UPPER_LEFT, Light
from volviz.model.looks.look import Look
from volviz.model.manipulators import as_vector
from volviz.model.movie import Surroundings
from volviz.model.parameters import Parameter, make_settings, setting_values
from volviz.model.render_spec import RenderSpec
from volviz.model.scene import Layout, Scene, SceneView
from volviz.model.slice_plane import NAMED_PLANES
from volviz.model.store import Store
from volviz.model.surface_values import DistanceColoring
from volviz.model.transfer.first_look import grey_window
from volviz.model.view_edits import with_comparison, with_views
from volviz.volume_data.vectors import Vector
from volviz.volume_data.volume import Volume


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


def has_light(scene: Scene, view: int | None = None) -> bool:
    """Whether a light shapes the picture of a view: by shading, or by shadows."""
    lit = common_settings(current_settings(scene, view)).shading
    return lit or "light" in current_technique(scene, view).manipulators


def settings_at_cursor(scene: Scene, view: int | None = None) -> Any:
    """Settings with which a view is drawn: what follows the cursor is where that is."""
    info, settings = current_technique(scene, view), current_settings(scene, view)
    if scene.tilt is not None and info.turned is not None and scene.view_at(view).own_camera:
        settings = info.turned(settings, partial(tilted, scene.tilt))
    name = info.cursor_setting
    if not name or scene.cursor is None or getattr(settings, name) is not None:
        return settings
    return replace(settings, **{name: scene.cursor})


def slice_technique() -> TechniqueInfo:
    """The technique that shows planes to be faced."""
    return next(info for info in techniques().values() if info.facing is not None)


def faced(scene: Scene, view: int) -> tuple[Vector, Vector] | None:
    """Direction towards the viewer, and up, of a view that looks at one plane by a camera of its own; else None."""
    info = current_technique(scene, view)
    if info.facing is None or not scene.view_at(view).own_camera:
        return None
    settings = current_settings(scene, view)
    facing = info.facing(settings)
    if scene.tilt is None or info.turned is None or facing is None:
        return facing
    turned = info.facing(info.turned(settings, partial(tilted, scene.tilt)))
    assert turned is not None
    # what is up stays up, as far as it can: the slice across which one turns must not turn itself
    normal, up = turned[0], np.asarray(facing[1])
    up = up - (up @ np.asarray(normal)) * np.asarray(normal)
    length = float(np.linalg.norm(up))
    return (normal, as_vector(up / length)) if length > 1e-3 else turned


def with_slices(scene: Scene, layout: Layout) -> Scene:
    """The active view beside an axial, a coronal and a sagittal slice, which have cameras of their own.

    Slices that are there stay as they are.
    """
    first = next((view for view in (scene.view, *scene.views) if not view.own_camera), SceneView())
    info = slice_technique()
    there = [view for view in scene.views if view.own_camera]
    slices = there if len(there) == len(NAMED_PLANES) else [
        SceneView(own_camera=True).with_settings(info.id, info.settings(plane=plane)) for plane in NAMED_PLANES
    ]  # fmt: skip
    views = (first, *(replace(view, technique=info.id) for view in slices))
    return replace(with_comparison(scene, mode="side_by_side"), views=views, active=0, layout=layout)


def with_various_views(scene: Scene, count: int) -> Scene:
    """The scene with so many views; where there are more than two, each new one has a technique that no other has.

    They come in the order of the list, after that of the active view.
    """
    there = len(scene.views)
    changed = with_views(scene, count)
    if count <= 2:
        return changed
    order = [info.id for info in drawing_techniques() if info.facing is None]
    used = [view.technique for view in changed.views[: max(there, 1)]]
    start = order.index(used[-1]) + 1 if used[-1] in order else 0
    free = [ident for ident in (*order[start:], *order[:start]) if ident not in used]
    for number, ident in zip(range(there, count), free, strict=False):
        changed = changed.with_view(number, technique=ident)
    return changed


def with_window_moved(scene: Scene, volume: Volume, view: int, wider: float, higher: float) -> Scene:
    """The scene whose slices have the grey window of one of them, made wider and moved.

    Parameters
    ----------
    scene : Scene
    volume : Volume
        Whose values are shown.
    view : int
        Number of the view whose window is changed.
    wider : float
        How much wider, 1 is twice as wide.
    higher : float
        How much higher, in widths.
    """
    info = slice_technique()
    settings = scene.view_at(view).settings_for(info.id, info.settings)
    low, high = grey_window(volume, settings.window_level, settings.window_width)
    width = high - low
    changes = {"window_width": width * 2.0**wider, "window_level": (low + high) / 2 + higher * width}
    for number, each in enumerate(scene.views):
        if each.technique == info.id:
            changed = replace(each.settings_for(info.id, info.settings), **changes)
            scene = scene.with_view(number, settings=each.with_settings(info.id, changed).settings)
    return scene


def without_slices(scene: Scene) -> Scene:
    """The scene without the views that have cameras of their own; one view stays in any case."""
    kept = tuple(view for view in scene.views if not view.own_camera)
    views = kept or (replace(scene.view, own_camera=False, camera=None),)
    return replace(scene, views=views, active=0, layout="grid")


def with_look(scene: Scene, look: Look) -> Scene:
    """The scene whose volume is shown in another way: its function, and the technique of a view with its settings.

    Views that are compared, and slices, keep their techniques.
    """
    scene = scene.with_layer(transfer_function=look.transfer_function)
    volumes = _volume_views(scene)
    return with_technique(scene, look.technique, look.settings, volumes[0]) if len(volumes) == 1 else scene


def can_take_looks(scene: Scene) -> bool:
    """Whether one view shows one volume, which looks are made for."""
    seen = [layer for layer in scene.layers if layer.visible]
    return seen == [scene.layer] and len(_volume_views(scene)) == 1


def _volume_views(scene: Scene) -> list[int]:
    """Numbers of the views that are no slices with cameras of their own."""
    return [number for number, view in enumerate(scene.views) if not view.own_camera]


def with_technique(
    scene: Scene, technique: str, values: Mapping[str, Any] | None, view: int | None = None
) -> Scene:
    """The scene one of whose views is drawn by a technique with these settings.

    What is lit gets a light from the upper left, as long as nobody has touched the light: from the eye itself
    shapes look flat.

    Parameters
    ----------
    scene : Scene
    technique : str
        Id of the technique.
    values : mapping or None
        Its settings by name; None leaves those that it has.
    view : int, optional
        Number of the view, the active one unless another is named.

    Raises
    ------
    VolvizError
        There is no such technique or setting.
    """
    info = technique_info(technique)
    drawn = replace(scene.view_at(view), technique=info.id)
    if values is not None:
        drawn = drawn.with_settings(info.id, make_settings(info.settings, dict(values), owner=info.id))
    return _lit_from_above(scene.with_view(view, technique=drawn.technique, settings=drawn.settings), view)


def with_lighting(scene: Scene, values: Mapping[str, Any]) -> Scene:
    """The scene with other settings of the technique of the active view, where that can be lit; else as it is.

    Parameters
    ----------
    scene : Scene
    values : mapping
        Settings by name; the technique leaves out those that it does not have.

    Raises
    ------
    VolvizError
        A value is outside of its limits.
    """
    info, settings = current_technique(scene), current_settings(scene)
    present = setting_values(settings)
    # where the light can be dragged, matter is lit by more than its gradient
    if "shading" not in present or "light" in info.manipulators:
        return scene
    known = {name: value for name, value in values.items() if name in present}
    changed = scene.view.with_settings(info.id, make_settings(info.settings, present | known, owner=info.id))
    return _lit_from_above(scene.with_view(settings=changed.settings))


def _lit_from_above(scene: Scene, view: int | None = None) -> Scene:
    """The scene with its light at the upper left, where a view is lit and nobody has touched the light."""
    settings = current_settings(scene, view)
    # a technique whose settings have no switch for it is always lit where it has an ambient light
    lit = getattr(settings, "shading", hasattr(settings, "ambient"))
    return replace(scene, light=FROM_UPPER_LEFT) if lit and scene.light == Light() else scene


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
    store: Store,
    parameter: Parameter,
    value: Any,
    *,
    view: int | None = None,
    gesture: Hashable | None = None,
) -> None:
    """Give a setting of the technique that draws a view, the active one unless another is named, another value.

    Raises
    ------
    SettingError
        The value is outside of the limits of the parameter.
    """

    def change(scene: Scene) -> Scene:
        info = current_technique(scene, view)
        settings = replace(current_settings(scene, view), **{parameter.name: parameter.checked(value)})
        changed = scene.view_at(view).with_settings(info.id, settings)
        return scene.with_view(view, settings=changed.settings)

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
        settings_at_cursor(scene, view),
        scene.light,
        scene.clipping,
        distance_coloring(scene, view),
    )


def drawn_spec(scene: Scene, view: int | None = None) -> RenderSpec:
    """The same with the layers that are drawn: those that are visible, or the active one alone."""
    return replace(render_spec(scene, view), layers=drawn_layers(scene, view))


def drawn_layers(scene: Scene, view: int | None = None) -> tuple[Layer, ...]:
    """The layers that a view draws: those that are visible, or the active one by a technique that draws one."""
    active = scene.layer
    if active is None:
        return ()
    visible = tuple(layer for layer in scene.layers if layer.visible)
    if draws_one(scene, view):
        visible = tuple(replace(layer, mode="add") for layer in visible if layer is active)
    if any(isinstance(layer, ImageLayer) and layer.mode == "add" for layer in visible):
        return visible
    # an empty picture is one of the active layer without opacity, so that labels and masks have their place
    return (replace(active, visible=True, mode="add", opacity=0.0), *visible)


def draws_one(scene: Scene, view: int | None = None) -> bool:
    """Whether the technique of a view draws one layer at a time."""
    return not current_technique(scene, view).draws_layers


def surroundings(volumes: Iterable[Volume], times: int = 1) -> Surroundings:
    """What the moves of a movie have to know of the volumes that a scene shows, and how many time points there are."""
    bounds = np.array([volume.bounds for volume in volumes])
    low, high = bounds[:, ::2].min(axis=0).tolist(), bounds[:, 1::2].max(axis=0).tolist()
    around = (low[0], high[0], low[1], high[1], low[2], high[2])
    return Surroundings(lambda name: technique_info(name).settings, around, times)


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
