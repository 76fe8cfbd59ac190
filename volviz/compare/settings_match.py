"""The same settings on both sides, as far as both have them, and what stays different, in words."""

from __future__ import annotations

import re
from typing import Any

from volviz.compare.matching import differences, follow, in_words
from volviz.custom_gl.registry import are_counterparts
from volviz.custom_gl.scene_techniques import current_settings, current_technique
from volviz.errors import SettingError
from volviz.model.parameters import Parameter, make_settings
from volviz.model.scene import Scene


def match_second(scene: Scene, first: int, second: int) -> Scene:
    """The scene with the settings of one view given to another wherever both have them.

    A value that the other technique does not take is left as it is there. What one of the two can do in one way only
    (VTK's mappers), the other one follows.
    """
    ours, theirs = current_technique(scene, first), current_technique(scene, second)
    given = follow(ours.id, _values(scene, first), theirs.id)
    values = _values(scene, second)
    for parameter in theirs.parameters:
        if parameter.name in given:
            try:
                values[parameter.name] = parameter.checked(given[parameter.name])
            except SettingError:
                continue
    values = follow(theirs.id, values, ours.id)
    for view, info, wanted in ((first, ours, given), (second, theirs, values)):
        settings = make_settings(info.settings, wanted, owner=info.id)
        changed = scene.views[view].with_settings(info.id, settings)
        if settings != current_settings(scene, view):
            scene = scene.with_view(view, settings=changed.settings)
    return scene


def setting_differences(scene: Scene, first: int, second: int) -> list[str]:
    """What two views are told to do differently, a sentence each.

    Settings of both with different values first, then what the techniques cannot do alike, then settings that only
    one has and that are not at their default.
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
    told = differences(infos[0].id, settings[0], infos[1].id, settings[1], light=scene.light)
    for info in infos:
        told = [re.sub(rf"\b{info.id}\b", info.label, sentence) for sentence in told]
    sentences += told
    if infos[0].id != infos[1].id and are_counterparts(infos[0].id, infos[1].id):
        return sentences  # the rules for the pair have told what matters
    for side in (0, 1):
        for name, parameter in parameters[side].items():
            value = getattr(settings[side], name)
            if name not in parameters[1 - side] and value != parameter.default:
                words = f"{parameter.label} of {infos[side].label}: {_value(parameter, value)}"
                sentences.append(f"{words}; the other has no such setting.")
    return sentences


def _values(scene: Scene, view: int) -> dict[str, Any]:
    settings = current_settings(scene, view)
    return {p.name: getattr(settings, p.name) for p in current_technique(scene, view).parameters}


def _value(parameter: Parameter, value: Any) -> str:
    labels = dict(parameter.choices or ())
    if value in labels:
        return str(labels[value])
    if isinstance(value, bool):
        return "on" if value else "off"
    return f"{in_words(value)} {parameter.unit or ''}".strip()
