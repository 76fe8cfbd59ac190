"""The present image as a Python script (`Copy as Python`)."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from volviz.custom_gl.registry import technique
from volviz.custom_gl.scene_techniques import current_technique, distance_coloring, settings_at_cursor
from volviz.custom_gl.technique import TechniqueInfo
from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.layers import ImageLayer, Layer
from volviz.model.light import Light
from volviz.model.parameters import setting_values
from volviz.model.scene import Scene
from volviz.model.surface_values import DistanceColoring
from volviz.model.transfer.function import TransferFunction
from volviz.model.transfer.function_2d import Region


def script_of(scene: Scene, size: tuple[int, int]) -> str:
    """Python that draws what the scene shows.

    Parameters
    ----------
    scene : Scene
        With at least one layer.
    size : tuple of 2 ints
        Width and height of the image.
    """
    layer = scene.layer
    if layer is None:
        return "\n".join(["import volviz", *_others(list(scene.layers), drawn=False), ""])
    others = [other for other in scene.layers if other is not layer]
    functions = [each.transfer_function for each in scene.layers if isinstance(each, ImageLayer)]
    coloring = distance_coloring(scene)
    lines = ["import volviz"]
    if any(function is not None and _has_regions(function) for function in functions):
        lines = ["from dataclasses import replace", "", *lines]
        lines += ["from volviz.model.transfer.function_2d import Region, TransferFunction2D"]
    if coloring is not None:
        lines += [
            "from volviz.compare.distance_colors import colors_of",
            "from volviz.custom_gl.arguments import spec_of",
            "from volviz.model.surface_values import DistanceColoring",
        ]
    chosen = "" if layer.channel is None else f", channel={layer.channel}"
    chosen += f", time={layer.time}" if layer.time else ""
    lines += ["", f"volume = volviz.load({_source(layer)}{chosen})"]
    if layer.transfer_function is not None:
        lines += _function("transfer_function", layer.transfer_function)
    info = current_technique(scene)
    together = bool(others) and info.draws_layers
    lines += _others(others, drawn=together) + _coloring(scene, coloring)
    shown = ["    volume,"]
    values = _layer_values(layer, but=("channel", "time", *(() if together else ("name", "visible"))))
    as_layer = together or bool(values)
    if as_layer:
        function = "" if layer.transfer_function is None else ", transfer_function"
        lines += [f"layer = volviz.ImageLayer(volume{function}{values})"]
        names = ["layer", *(f"layer_{number}" for number in range(2, len(others) + 2))]
        shown = [f"    [{', '.join(names)}]," if together else "    layer,"]
    lines += ["picture = volviz.render(", *shown, f"    {info.id!r},"]
    if layer.transfer_function is not None and not as_layer:
        lines += ["    transfer_function=transfer_function,"]
    lines += [f"    size={size},"]
    if scene.background is not None:
        lines += [f"    background={_tuple(scene.background)},"]
    if scene.view.camera is not None:
        lines += [f"    camera={_camera(scene.view.camera)},"]
    lines += _light(scene.light, info) + _clipping(scene.clipping)
    lines += [f"    {setting}," for setting in _settings(info, settings_at_cursor(scene))]
    if coloring is not None:
        lines += ["    surface_colors=surface_colors,"]
    lines += [")", "", "from PIL import Image", "", 'Image.fromarray(picture).save("picture.png")', ""]
    return "\n".join(lines)


def _settings(info: TechniqueInfo, settings: Any) -> list[str]:
    """Settings that are not at their defaults, as keywords."""
    defaults = setting_values(info.settings())
    return [
        f"{name}={_value(value)}"
        for name, value in setting_values(settings).items()
        if value != defaults[name]
    ]


def _coloring(scene: Scene, coloring: DistanceColoring | None) -> list[str]:
    """The distance to another surface that this one is coloured by; it is measured anew."""
    if coloring is None:
        return []
    info = technique(coloring.technique)
    settings = ", ".join(_settings(info, coloring.settings))
    lines = [f"other = volviz.techniques()[{info.id!r}].settings({settings})"]
    shown = current_technique(scene)
    own = ", ".join(["volume", repr(shown.id), *_settings(shown, settings_at_cursor(scene))])
    options = "" if coloring.signed else ", signed=False"
    options += "" if coloring.limit is None else f", limit={_number(coloring.limit)}"
    return [
        *lines,
        f"wish = DistanceColoring({info.id!r}, other{options})",
        f"surface_colors = colors_of(spec_of({own}, surface_colors=wish))",
    ]


def _source(layer: Layer) -> str:
    """What to open, and how to read it."""
    ref = layer.key.ref
    return repr(ref.source) + "".join(f", {key}={value!r}" for key, value in ref.hints)


def _others(layers: list[Layer], *, drawn: bool) -> list[str]:
    """Further layers; those that a technique for one leaves out are told as well, so that none gets lost."""
    lines = []
    for number, layer in enumerate(layers, start=2):
        parts = f"volviz.open({_source(layer)})"
        if isinstance(layer, ImageLayer) and layer.transfer_function is not None:
            lines += _function(f"transfer_function_{number}", layer.transfer_function)
            parts += f", transfer_function_{number}"
        kind = type(layer).__name__
        if not drawn:
            lines += ["# one layer is drawn: this one is not in the picture"]
        lines += [f"layer_{number} = volviz.{kind}({parts}{_layer_values(layer)})"]
    return lines


def _layer_values(layer: Layer, but: tuple[str, ...] = ()) -> str:
    """Values of a layer that are not at their defaults, as keywords."""
    plain = type(layer)(layer.volume)
    names = [f.name for f in fields(layer) if f.name not in ("volume", "transfer_function", *but)]
    values = {name: getattr(layer, name) for name in names}
    return "".join(
        f", {name}={_value(value)}" for name, value in values.items() if value != getattr(plain, name)
    )


def _function(name: str, function: TransferFunction) -> list[str]:
    """A transfer function under a name, with its regions over value and gradient where they are drawn."""
    lines = [f"{name} = volviz.TransferFunction.from_points(", "    ["]
    lines += [f"        ({_number(p.value)}, {_tuple(p.rgba)})," for p in function.points]
    lines += ["    ]," + ("" if function.domain == "data" else f" domain={function.domain!r},")]
    lines += [")" if function.opacity == 1.0 else f").with_opacity({_number(function.opacity)})"]
    if not _has_regions(function):
        return lines
    lines += ["regions = TransferFunction2D(", "    ("]
    for region in function.by_gradient.regions:
        values = ", ".join(_value(getattr(region, field.name)) for field in fields(Region))
        lines += [f"        Region({values}),"]
    return [*lines, "    )", ")", f"{name} = replace({name}, by_gradient=regions)"]


def _has_regions(function: TransferFunction) -> bool:
    return function.by_gradient is not None and function.by_gradient.enabled


def _camera(camera: Camera) -> str:
    parts = []
    for field in fields(Camera):
        value = getattr(camera, field.name)
        if field.name in ("position", "focal_point") or value != field.default:
            parts.append(f"{field.name}={_value(value)}")
    return f"volviz.Camera({', '.join(parts)})"


def _light(light: Light, info: TechniqueInfo) -> list[str]:
    lines = []
    if light.headlight and "light" in info.manipulators:
        # such techniques would begin with a placed light
        lines.append("    headlight=True,")
    if not light.headlight:
        lines.append("    headlight=False,")
        if light.beside_eye:
            lines.append("    light_beside_eye=True,")
        elif light.position is not None:
            lines.append(f"    light_position={_tuple(light.position)},")
    if light.color != Light().color:
        lines.append(f"    light_color={_tuple(light.color)},")
    return lines


def _clipping(clipping: Clipping) -> list[str]:
    lines = []
    if clipping.crop is not None:
        lines.append(f"    crop={_tuple(clipping.crop)},")
    if clipping.planes:
        planes = ", ".join(f"({_tuple(origin)}, {_tuple(normal)})" for origin, normal in clipping.planes)
        lines.append(f"    clip_planes=[{planes}],")
    return lines


def _value(value: Any) -> str:
    if isinstance(value, bool) or value is None or isinstance(value, str):
        return repr(value)
    if isinstance(value, tuple):
        return "(" + ", ".join(_value(part) for part in value) + ("," if len(value) == 1 else "") + ")"
    return _number(value)


def _tuple(values: tuple[float, ...]) -> str:
    return "(" + ", ".join(_number(v) for v in values) + ")"


def _number(value: float) -> str:
    """Seven digits: more than an image shows, few enough to read."""
    if isinstance(value, int):
        return str(value)
    text = f"{value:.7g}"
    return text if any(c in text for c in ".en") else text + ".0"
