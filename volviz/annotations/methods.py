"""How a picture was made, in a sentence for the methods section of a paper."""

from __future__ import annotations

from typing import Any

from volviz.custom_gl.resolve import ResolvedSpec
from volviz.model.camera import Camera
from volviz.model.parameters import Parameter, setting_values
from volviz.model.ticks import value_text

#: Settings that decide a picture so much that they are told also when nobody has changed them.
TOLD = frozenset(
    {"mode", "step", "slice_count", "isovalue", "isovalues", "interpolation", "shading", "gradient", "plane"}
)
#: Kinds of settings that a sentence has no words for.
_UNSPOKEN = frozenset({"color", "colors", "vector", "crop", "planes", "path"})


def methods_sentence(shown: ResolvedSpec, camera: Camera, size: tuple[int, int]) -> str:
    """What a reader needs to draw the picture again.

    Parameters
    ----------
    shown : ResolvedSpec
        What is drawn.
    camera : Camera
    size : tuple of 2 ints
        Width and height of the picture in pixels.
    """
    from volviz import __version__

    volume = shown.volume
    unit = str(volume.metadata.get("length_unit", "mm"))
    dimensions = " × ".join(str(n) for n in volume.dimensions)
    spacing = " × ".join(f"{s:.4g}" for s in volume.spacing)
    projection = (
        "parallel projection"
        if camera.parallel
        else f"perspective projection, angle of view {camera.view_angle:.3g}°"
    )
    parts = [
        f"{shown.info.label.lower() if shown.info.label[1:2].islower() else shown.info.label}{_settings(shown)}",
        _function(shown),
        _light(shown),
        _cuts(shown),
        projection,
        f"{size[0]} × {size[1]} pixels",
    ]
    count = f" and {len(shown.volumes) - 1} more" if len(shown.volumes) > 1 else ""
    return (
        f"Rendered with VolViz {__version__} from a volume of {dimensions} voxels of {spacing} {unit}".rstrip()
        + f"{count}: {'; '.join(part for part in parts if part)}."
    )


def _settings(shown: ResolvedSpec) -> str:
    """Settings that matter here: those told in any case, and those that differ from what they usually are."""
    values, usual = setting_values(shown.settings), setting_values(shown.info.settings())
    words = [
        _words(
            parameter, _isovalues(shown) if parameter.name.startswith("isovalue") else values[parameter.name]
        )
        for parameter in shown.info.parameters
        if _acts(parameter, values)
        and parameter.kind not in _UNSPOKEN
        and (parameter.name in TOLD or values[parameter.name] != usual[parameter.name])
        and (values[parameter.name] is not None or parameter.name.startswith("isovalue"))
    ]
    return f" ({', '.join(words)})" if words else ""


def _isovalues(shown: ResolvedSpec) -> Any:
    return shown.isovalues if len(shown.isovalues) != 1 else shown.isovalues[0]


def _acts(parameter: Parameter, values: dict[str, Any]) -> bool:
    if parameter.enabled_by is None:
        return True
    name, wanted = parameter.enabled_by
    return values.get(name) in wanted


def _words(parameter: Parameter, value: Any) -> str:
    return f"{parameter.label[0].lower()}{parameter.label[1:]} {_lower(parameter.words(value), parameter)}"


def _lower(words: str, parameter: Parameter) -> str:
    """Names of choices stand inside a sentence; abbreviations stay."""
    return words[0].lower() + words[1:] if parameter.choices and words[1:2].islower() else words


def _function(shown: ResolvedSpec) -> str:
    if shown.isovalues or getattr(shown.settings, "coloring", "") == "window" or not shown.layers:
        return ""
    function, (low, high) = shown.transfer_function, shown.volume.range
    points = sorted(point.value for point in function.points)
    unit = f" {shown.volume.unit}" if shown.volume.unit else ""
    ends = f"{value_text(points[0], high - low)} to {value_text(points[-1], high - low)}{unit}"
    return f"transfer function of {len(points)} points from {ends}"


def _light(shown: ResolvedSpec) -> str:
    if not shown.common.shading:
        return ""
    return "light from the eye" if shown.light.headlight else "one placed light"


def _cuts(shown: ResolvedSpec) -> str:
    parts = ["cropped"] if shown.clipping.crop is not None else []
    count = len(shown.clipping.planes)
    if count:
        parts.append(f"cut by {count} plane{'s' if count > 1 else ''}")
    return " and ".join(parts)
