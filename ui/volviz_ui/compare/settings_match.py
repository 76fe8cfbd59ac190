"""The same settings on both sides, as far as both have them, and what stays different, in words."""

from __future__ import annotations

from typing import Any

from volviz.compare.matching import in_words
from volviz.errors import SettingError
from volviz.model.parameters import Parameter, make_settings
from volviz.model.scene import Scene
from volviz_ui.panels.technique_box import current_settings, current_technique


def match_second(scene: Scene, first: int, second: int) -> Scene:
    """The scene with the settings of one view given to another wherever both have them.

    A value that the other technique does not take is left as it is there.
    """
    ours, theirs = current_technique(scene, first), current_technique(scene, second)
    given, settings = current_settings(scene, first), current_settings(scene, second)
    values: dict[str, Any] = {p.name: getattr(settings, p.name) for p in theirs.parameters}
    names = {p.name for p in ours.parameters}
    for parameter in theirs.parameters:
        if parameter.name in names:
            try:
                values[parameter.name] = parameter.checked(getattr(given, parameter.name))
            except SettingError:
                continue
    matched = make_settings(theirs.settings, values, owner=theirs.id)
    view = scene.views[second].with_settings(theirs.id, matched)
    return scene.with_view(second, settings=view.settings)


def setting_differences(scene: Scene, first: int, second: int) -> list[str]:
    """What two views are told to do differently, a sentence each.

    Settings of both with different values first, then those that only one has and that are not at their default.
    """
    infos = [current_technique(scene, view) for view in (first, second)]
    settings = [current_settings(scene, view) for view in (first, second)]
    parameters = [{p.name: p for p in info.parameters} for info in infos]
    sentences = []
    for name, parameter in parameters[0].items():
        if name in parameters[1]:
            a, b = (getattr(values, name) for values in settings)
            if a != b:
                sentences.append(f"{parameter.label}: {_value(parameter, a)} and {_value(parameter, b)}.")
    for side in (0, 1):
        for name, parameter in parameters[side].items():
            value = getattr(settings[side], name)
            if name not in parameters[1 - side] and value != parameter.default:
                words = f"{parameter.label} of {infos[side].label}: {_value(parameter, value)}"
                sentences.append(f"{words}; the other has no such setting.")
    return sentences


def _value(parameter: Parameter, value: Any) -> str:
    labels = dict(parameter.choices or ())
    if value in labels:
        return str(labels[value])
    if isinstance(value, bool):
        return "on" if value else "off"
    return f"{in_words(value)} {parameter.unit or ''}".strip()
