"""What a technique says of itself where its settings are brought beside those of another one.

Settings of the same name mean the same almost everywhere, so `volviz.compare.matching` copies values. A technique
declares the exceptions in its folder (`TechniqueInfo.matching`): what it can do in one way only, and sentences on what
stays different.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from volviz.model.light import Light


@dataclass(frozen=True)
class Side:
    """A technique with its settings under the light of the scene, as rules see it.

    Attributes
    ----------
    id : str
        Of the technique.
    is_ours : bool
        Whether it draws with our shaders, not by VTK's mappers.
    settings : object
        Instance of its settings class.
    always : mapping of str to object
        What it always does, by the names of settings that it does not have.
    light : Light
        The light of the scene.
    """

    id: str
    is_ours: bool
    settings: Any
    always: Mapping[str, Any]
    light: Light

    @property
    def is_lit(self) -> bool:
        """Whether highlights and normals are seen."""
        return self.get("shading") is not False and self.get("specular") is not None

    def get(self, name: str) -> Any:
        """A setting, or what the technique always does; None where it has no such thing."""
        return getattr(self.settings, name, self.always.get(name))


@dataclass(frozen=True)
class Rule:
    """A sentence on the technique that declares it, for counterparts that ask for something else.

    Attributes
    ----------
    when : callable
        Gets the technique's own side and the other one; True where the sentence holds.
    words : str
        Format string with ``{it}`` and ``{other}`` for the ids, ``{its_mode}``, and the other's settings by name.
    """

    when: Callable[[Side, Side], bool]
    words: str


@dataclass(frozen=True)
class Matching:
    """How the settings of a technique meet those of its counterparts.

    Attributes
    ----------
    fixed : mapping of str to object
        What the technique always does, by the names of the counterparts' settings.
    unlit : mapping of str to object
        Settings under which a technique that always lights shows matter that is not lit by its gradient: its colour, as
        bright as its light. Empty for all others.
    other_meaning : mapping of str to frozenset of str
        For ids of counterparts: settings of one name that mean something else in both.
    rules : tuple of Rule
        What stays different.
    """

    fixed: Mapping[str, Any] = field(default_factory=dict)
    unlit: Mapping[str, Any] = field(default_factory=dict)
    other_meaning: Mapping[str, frozenset[str]] = field(default_factory=dict)
    rules: tuple[Rule, ...] = ()
