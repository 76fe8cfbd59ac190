"""The present picture as a Python script (`Copy as Python`)."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from volviz.custom_gl.registry import technique
from volviz.custom_gl.scene_techniques import current_settings, current_technique, distance_coloring
from volviz.custom_gl.technique import TechniqueInfo
from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.light import Light
from volviz.model.parameters import setting_values
from volviz.model.scene import Scene
from volviz.model.surface_values import DistanceColoring
from volviz.model.transfer_function_2d import Region, TransferFunction2D


def script_of(scene: Scene, size: tuple[int, int]) -> str:
    """Python that draws what the scene shows.

    Parameters
    ----------
    scene : Scene
        With at least one layer.
    size : tuple of 2 ints
        Width and height of the picture.
    """
    layer = scene.layer
    if layer is None:
        return "import volviz\n"
    hints = "".join(f", {key}={value!r}" for key, value in layer.volume.hints)
    points = layer.transfer_function.points
    regions = _regions(layer.transfer_function.by_gradient)
    coloring = distance_coloring(scene)
    lines = ["import volviz"]
    if regions:
        lines = ["from dataclasses import replace", "", *lines]
        lines += ["from volviz.model.transfer_function_2d import Region, TransferFunction2D"]
    if coloring is not None:
        lines += ["from volviz.model.surface_values import DistanceColoring"]
    lines += ["", f"volume = volviz.load({layer.volume.source!r}{hints})"]
    lines += ["transfer_function = volviz.TransferFunction.from_points(", "    ["]
    lines += [f"        ({_number(p.value)}, {_tuple(p.rgba)})," for p in points]
    domain = layer.transfer_function.domain
    lines += ["    ]," + ("" if domain == "data" else f" domain={domain!r},")]
    lines += [")"]
    if layer.transfer_function.opacity != 1.0:
        opacity = _number(layer.transfer_function.opacity)
        lines[-1] += f".with_opacity({opacity})"
    lines += regions + _coloring(coloring)
    info = current_technique(scene)
    lines += ["picture = volviz.render(", "    volume,", f"    {info.id!r},"]
    lines += ["    transfer_function=transfer_function,", f"    size={size},"]
    if scene.view.camera is not None:
        lines += [f"    camera={_camera(scene.view.camera)},"]
    lines += _light(scene.light, info) + _clipping(scene.clipping)
    lines += [f"    {setting}," for setting in _settings(info, current_settings(scene))]
    if coloring is not None:
        lines += ["    surface_colors=surface_colors,"]
    lines += [")", ""]
    return "\n".join(lines)


def _settings(info: TechniqueInfo, settings: Any) -> list[str]:
    """Settings that are not at their defaults, as keywords."""
    defaults = setting_values(info.settings())
    return [
        f"{name}={_value(value)}"
        for name, value in setting_values(settings).items()
        if value != defaults[name]
    ]


def _coloring(coloring: DistanceColoring | None) -> list[str]:
    """The distance to another surface that this one is coloured by; it is measured anew."""
    if coloring is None:
        return []
    info = technique(coloring.technique)
    settings = ", ".join(_settings(info, coloring.settings))
    lines = [f"other = volviz.techniques()[{info.id!r}].settings({settings})"]
    options = "" if coloring.signed else ", signed=False"
    options += "" if coloring.limit is None else f", limit={_number(coloring.limit)}"
    return [*lines, f"surface_colors = DistanceColoring({info.id!r}, other{options})"]


def _regions(by_gradient: TransferFunction2D | None) -> list[str]:
    """Regions over value and gradient, where they are what is drawn."""
    if by_gradient is None or not by_gradient.enabled:
        return []
    lines = ["regions = TransferFunction2D(", "    ("]
    for region in by_gradient.regions:
        values = ", ".join(_value(getattr(region, field.name)) for field in fields(Region))
        lines += [f"        Region({values}),"]
    lines += ["    )", ")", "transfer_function = replace(transfer_function, by_gradient=regions)"]
    return lines


def _camera(camera: Camera) -> str:
    parts = []
    for field in fields(Camera):
        value = getattr(camera, field.name)
        if field.name in ("position", "focal_point") or value != field.default:
            parts.append(f"{field.name}={_value(value)}")
    return f"volviz.Camera({', '.join(parts)})"


def _light(light: Light, info: TechniqueInfo) -> list[str]:
    lines = []
    if light.headlight and "light" in info.handles:
        # such techniques would begin with a placed light
        lines.append("    headlight=True,")
    if not light.headlight:
        lines.append("    headlight=False,")
        if light.position is not None:
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
    """Seven digits: more than a picture shows, few enough to read."""
    if isinstance(value, int):
        return str(value)
    text = f"{value:.7g}"
    return text if any(c in text for c in ".en") else text + ".0"
