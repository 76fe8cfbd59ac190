"""Which settings the sides of a comparison get, and what they do differently all the same, in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from volviz.custom_gl.registry import technique as technique_info
from volviz.model.parameters import make_settings

if TYPE_CHECKING:
    from volviz.compare.results import SideResult
    from volviz.custom_gl.technique import TechniqueInfo

#: VTK's ray casters that take their samples at the far ends of whole steps.
ENDS_OF_STEPS = ("vtk_gpu",)


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


def match_sides(sides: Sequence[tuple[str, Mapping[str, Any]]], *, matched: bool = True) -> list[MatchedSide]:
    """Final settings of all sides.

    Parameters
    ----------
    sides : sequence of (technique id, settings by name)
    matched : bool, default: True
        Bring sides that stand for one another to the same settings; off, each keeps its defaults.

    Raises
    ------
    VolvizError
        An unknown technique, or settings that do not fit it.
    """
    names = side_names([technique for technique, _ in sides])
    infos = [technique_info(technique) for technique, _ in sides]
    made = []
    for name, info, (_, values) in zip(names, infos, sides, strict=True):
        added = _added(info, values, sides, infos) if matched else {}
        settings = make_settings(info.settings, added | dict(values), owner=info.id)
        made.append(MatchedSide(name, info.id, settings, dict(values)))
    return made


def _added(
    info: TechniqueInfo,
    values: Mapping[str, Any],
    sides: Sequence[tuple[str, Mapping[str, Any]]],
    infos: Sequence[TechniqueInfo],
) -> dict[str, Any]:
    """What one side takes over from the others: VTK's the settings of ours, ours VTK's place of the first sample."""
    known = {p.name for p in info.parameters}
    added: dict[str, Any] = {}
    for other, (_, given) in zip(infos, sides, strict=True):
        if other.id in info.counterpart_of:
            added = {name: value for name, value in given.items() if name in known and name not in values}
            break
    samples_at_ends = any(other.id in ENDS_OF_STEPS for other in infos)
    if samples_at_ends and "first_sample" in known and info.id not in ENDS_OF_STEPS:
        added["first_sample"] = 1.0
    return added


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
        f"{name} is {in_words(first.settings[name])} in {first.name}, {in_words(second.settings[name])} in "
        f"{second.name}."
        for name in first.settings
        if name in second.settings and first.settings[name] != second.settings[name]
    ]


def in_words(value: Any) -> str:
    """A setting's value as a person would write it after ``--set name=``."""
    if value is None:
        return "automatic"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, (tuple, list)):
        nested = any(isinstance(item, (tuple, list)) for item in value)
        return ("; " if nested else ",").join(in_words(item) for item in value) or "none"
    return str(value)
