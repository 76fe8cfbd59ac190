"""Which settings the sides of a comparison get, and what they do differently all the same, in words.

Settings of the same name mean the same almost everywhere, so matching copies values. What a technique cannot follow it
declares in its folder (`volviz.custom_gl.matching`): VTK's ray caster samples the far ends of whole steps, whatever
ours does. So ours follows where it can, and a sentence says what stays different where it cannot.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from volviz.custom_gl.matching import Side
from volviz.custom_gl.registry import are_counterparts
from volviz.custom_gl.registry import technique as technique_info
from volviz.errors import SettingError
from volviz.model.light import Light
from volviz.model.parameters import make_settings, setting_values, value_text

if TYPE_CHECKING:
    from volviz.compare.results import SideResult
    from volviz.custom_gl.technique import TechniqueInfo


@dataclass(frozen=True)
class MatchedSide:
    """A side with its final settings.

    Attributes
    ----------
    name : str
        The technique's id, with a number where it takes part more than once.
    technique : str
        Its id.
    settings : object
        Instance of its settings class.
    own_values : mapping
        The settings that were given for it, without what matching added.
    differences : mapping of str to tuple of str
        For other sides by name: what cannot be matched, a sentence each.
    """

    name: str
    technique: str
    settings: Any
    own_values: Mapping[str, Any]
    differences: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


def match_sides(
    sides: Sequence[tuple[str, Mapping[str, Any]]], *, matched: bool = True, light: Light | None = None
) -> list[MatchedSide]:
    """Final settings of all sides.

    Parameters
    ----------
    sides : sequence of (technique id, settings by name)
    matched : bool, default: True
        Bring sides that stand for one another to the same settings; off, each keeps its defaults. VTK's take those of
        the first of ours; where VTK's can do a thing in one way only, ours follow. What was given for a side stays.
    light : Light, optional
        The light of the scene, for the words; without it, it sits at the eye.

    Raises
    ------
    VolvizError
        An unknown technique, or settings that do not fit it.
    """
    names = side_names([technique for technique, _ in sides])
    infos = [technique_info(technique) for technique, _ in sides]
    made: list[MatchedSide] = []
    for name, info, (_, values) in zip(names, infos, sides, strict=True):
        added = _added(info, values, sides, infos) if matched else {}
        settings = make_settings(info.settings, added | dict(values), owner=info.id)
        made.append(MatchedSide(name, info.id, settings, dict(values)))
    return [replace(side, differences=_words(side, made, light)) for side in made]


def _added(
    info: TechniqueInfo,
    values: Mapping[str, Any],
    sides: Sequence[tuple[str, Mapping[str, Any]]],
    infos: Sequence[TechniqueInfo],
) -> dict[str, Any]:
    """What one side takes over from the others: VTK's the settings of ours, ours what VTK can in one way only."""
    added: dict[str, Any] = {}
    for other, (_, given) in zip(infos, sides, strict=True):
        if other.id in info.counterpart_of:
            followed = _with_what_is_fixed(other.id, given, infos)
            settings, _ = match(other.id, make_settings(other.settings, followed, owner=other.id), info.id)
            added = setting_values(settings)
            break
    added = _with_what_is_fixed(info.id, added, infos)
    return {name: value for name, value in added.items() if name not in values}


def _with_what_is_fixed(
    technique: str, values: Mapping[str, Any], infos: Sequence[TechniqueInfo]
) -> dict[str, Any]:
    """What was given for a technique, over what other sides can do in one way only."""
    followed: dict[str, Any] = {}
    for other in infos:
        if are_counterparts(other.id, technique):
            followed = follow(technique, followed, other.id)
    return followed | dict(values)


def _words(
    side: MatchedSide, sides: Sequence[MatchedSide], light: Light | None
) -> dict[str, tuple[str, ...]]:
    return {
        other.name: tuple(
            differences(side.technique, side.settings, other.technique, other.settings, light=light)
        )
        for other in sides
        if other is not side
    }


def match(technique: str, settings: Any, other: str, *, light: Light | None = None) -> tuple[Any, list[str]]:
    """Settings of another technique that stand for those of the first, and what differs all the same.

    Parameters
    ----------
    technique : str
        Id of the technique that is set, ours or VTK's.
    settings : object
        Its settings.
    other : str
        Id of the technique that shall follow.
    light : Light, optional
        The light of the scene; without it, it sits at the eye.

    Returns
    -------
    settings : object
        Instance of the settings class of `other`.
    differences : list of str
        A sentence each.

    Raises
    ------
    InputError
        There is no such technique.
    """
    source, info = technique_info(technique), technique_info(other)
    values: dict[str, Any] = {}
    known = {p.name: p for p in info.parameters}
    wanted = setting_values(settings)
    wanted |= source.matching.fixed
    if wanted.get("shading") is False:
        wanted |= info.matching.unlit
    if source.matching.unlit:
        wanted["shading"] = any(wanted[name] != value for name, value in source.matching.unlit.items())
    for one, another in ((source, info), (info, source)):
        for name in one.matching.other_meaning.get(another.id, ()):
            wanted.pop(name, None)
    for name, value in wanted.items():
        if name in known:
            try:
                values[name] = known[name].checked(value)
            except SettingError:
                continue
    followed = make_settings(info.settings, values, owner=other)
    return followed, differences(technique, settings, other, followed, light=light)


def follow(technique: str, values: Mapping[str, Any], other: str) -> dict[str, Any]:
    """Values by name, with those replaced that another technique can have in one way only."""
    known = {p.name for p in technique_info(technique).parameters}
    fixed = technique_info(other).matching.fixed
    return dict(values) | {name: value for name, value in fixed.items() if name in known}


def differences(
    first: str, first_settings: Any, second: str, second_settings: Any, *, light: Light | None = None
) -> list[str]:
    """What two techniques with these settings do differently beside plain unequal settings, a sentence each.

    Parameters
    ----------
    first, second : str
        Ids of the techniques, in any order.
    first_settings, second_settings : object
        Their settings.
    light : Light, optional
        The light of the scene; without it, it sits at the eye.
    """
    infos = technique_info(first), technique_info(second)
    if first == second or not are_counterparts(first, second):
        return []
    sides = [
        _side(info, settings, light or Light())
        for info, settings in zip(infos, (first_settings, second_settings), strict=True)
    ]
    sentences = []
    for info, (it, other) in zip(infos, (sides, sides[::-1]), strict=True):
        values = setting_values(other.settings)
        words = values | {"it": it.id, "other": other.id, "its_mode": it.get("mode")}
        sentences += [rule.words.format(**words) for rule in info.matching.rules if rule.when(it, other)]
    return sentences


def _side(info: TechniqueInfo, settings: Any, light: Light) -> Side:
    ours = info.kind == "image"
    extraction = {"method": info.extraction} if ours and info.extraction else {}
    return Side(info.id, ours, settings, {**extraction, **info.matching.fixed}, light)


def side_names(techniques: Sequence[str]) -> list[str]:
    """A name for each side: the id, and "raycast 2" for the second one of a kind."""
    names: list[str] = []
    for i, technique in enumerate(techniques):
        before = techniques[:i].count(technique)
        names.append(f"{technique} {before + 1}" if before else technique)
    return names


def settings_differences(first: SideResult, second: SideResult) -> list[str]:
    """Settings of the same name that have different values on both sides, a sentence each."""
    return [
        f"{name} is {value_text(first.settings[name], 6)} in {first.name}, "
        f"{value_text(second.settings[name], 6)} in {second.name}."
        for name in first.settings
        if name in second.settings and first.settings[name] != second.settings[name]
    ]
