"""The same settings on both sides, as far as both have them, and what stays different, in words."""

from __future__ import annotations

import re

from volviz.compare.matching import differences, follow
from volviz.custom_gl.registry import are_counterparts
from volviz.custom_gl.scene_techniques import current_settings, current_technique
from volviz.errors import SettingError
from volviz.model.parameters import make_settings, setting_values
from volviz.model.scene import Scene


def match_second(scene: Scene, first: int, second: int, *, keeps_first: bool = False) -> Scene:
    """The scene with the settings of one view given to another wherever both have them.

    A value that the other technique does not take is left as it is there. What the second one can do in one way only
    (VTK's mappers), the first one follows, unless it is to be kept as it is.
    """
    ours, theirs = current_technique(scene, first), current_technique(scene, second)
    given = follow(ours.id, setting_values(current_settings(scene, first)), theirs.id)
    values = setting_values(current_settings(scene, second))
    for parameter in theirs.parameters:
        if parameter.name in given:
            try:
                values[parameter.name] = parameter.checked(given[parameter.name])
            except SettingError:
                continue
    values = follow(theirs.id, values, ours.id)
    sides = ((first, ours, given), (second, theirs, values))
    for view, info, wanted in sides[int(keeps_first) :]:
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
                sentences.append(f"{parameter.label}: {parameter.words(a)} and {parameter.words(b)}.")
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
                words = f"{parameter.label} of {infos[side].label}: {parameter.words(value)}"
                sentences.append(f"{words}; the other has no such setting.")
    return sentences
