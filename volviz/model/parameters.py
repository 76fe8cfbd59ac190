"""Settings that describe themselves: kind, range, unit, label and the cost of a change.

A technique's settings are a frozen dataclass whose fields are made by `parameter`. From that one description
follow the panel in the window, ``--set name=value`` on the command line, the keywords of `volviz.render`, the
entry in a session file and what the renderer must do again when the value changes.
"""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from numbers import Real
from typing import Any, Literal, TypeVar, cast

from volviz.errors import InputError, SettingError

Kind = Literal[
    "float", "int", "bool", "choice", "color", "vector", "crop", "planes", "floats", "colors", "path"
]

S = TypeVar("S")


class Cost(IntEnum):
    """What a change of a setting makes necessary, cheapest first."""

    VALUE = 0  #: a uniform is set
    TEXTURE = 1  #: a table or texture is uploaded
    PROGRAM = 2  #: another shader program is used, compiled once
    DATA = 3  #: something is extracted from the volume on a worker


@dataclass(frozen=True)
class Parameter:
    """Description of one setting.

    Attributes
    ----------
    name : str
        Keyword of `volviz.render`, field of the settings class.
    kind : str
        One of "float", "int", "bool", "choice", "color" (3 floats 0..1), "vector" (3 floats), "crop" (6
        floats), "planes", "floats" (tuple of floats), "colors" (tuple of colours), "path".
    default : object
        Value when nothing is said; None only when `optional`.
    label, tooltip, unit, group : str
        Words for people. `unit` stands behind the number.
    minimum, maximum : float or None
        Inclusive limits of the accepted values.
    soft_minimum, soft_maximum : float or None
        Range of the slider; values beyond it can be typed.
    logarithmic : bool
        The slider moves by factors.
    choices : tuple of (value, label)
        For the kind "choice".
    optional : bool
        None is allowed and means "chosen for you", described by `none_label`.
    cost : Cost
        What a change makes necessary.
    enabled_by : tuple of (name, values) or None
        The setting acts only while the setting of that name has one of these values.
    """

    name: str
    kind: Kind
    default: Any
    label: str
    tooltip: str
    unit: str = ""
    group: str = ""
    minimum: float | None = None
    maximum: float | None = None
    soft_minimum: float | None = None
    soft_maximum: float | None = None
    logarithmic: bool = False
    choices: tuple[tuple[str, str], ...] = ()
    optional: bool = False
    none_label: str = "automatic"
    cost: Cost = Cost.VALUE
    enabled_by: tuple[str, tuple[Any, ...]] | None = None

    def checked(self, value: Any) -> Any:
        """`value` in the form this setting stores.

        Raises
        ------
        SettingError
            It is of another kind or outside the limits.
        """
        if value is None:
            if self.optional:
                return None
            raise SettingError(f"{self.name} needs a value: {self._expected()}.")
        try:
            if isinstance(value, (str, bytes)) and self.kind not in ("choice", "path"):
                # its characters would pass for numbers, "50" for (5, 0); text is for `parse`
                raise TypeError
            return getattr(self, f"_check_{self.kind}")(value)
        except (TypeError, ValueError, OverflowError) as error:
            if isinstance(error, InputError):
                raise
            raise SettingError(f"{self.name} must be {self._expected()}, got {value!r}.") from None

    def parse(self, text: str) -> Any:
        """The value written as `text` after ``--set name=``: numbers, ``true``, ``none``, lists."""
        text = text.strip()
        if self.optional and text.lower() in ("none", "auto", "automatic", ""):
            return None
        if self.kind in ("choice", "path"):
            return self.checked(text)
        if self.kind == "color" and re.fullmatch("#[0-9a-fA-F]{6}", text):
            return self.checked([int(text[i : i + 2], 16) / 255 for i in (1, 3, 5)])
        if self.kind == "bool":
            words = {"true": True, "yes": True, "on": True, "1": True}
            words |= {"false": False, "no": False, "off": False, "0": False}
            if text.lower() in words:
                return words[text.lower()]
            raise SettingError(f"{self.name} must be true or false, got {text!r}.")
        try:
            if self.kind in ("float", "int"):
                return self.checked(float(text) if self.kind == "float" else int(text))
            numbers = [[float(n) for n in part.split(",")] for part in text.strip("()[]").split(";")]
        except ValueError as error:
            if isinstance(error, SettingError):
                raise
            raise SettingError(f"{self.name} must be {self._expected()}, got {text!r}.") from None
        if self.kind == "planes":
            return self.checked([(row[:3], row[3:]) for row in numbers])
        if self.kind == "colors":
            return self.checked(numbers)
        return self.checked(numbers[0])

    def words(self, value: Any) -> str:
        """A value for people: the label of a choice, on or off, numbers of six digits with their unit."""
        labels = dict(self.choices)
        if value in labels:
            return labels[value]
        if isinstance(value, bool):
            return "on" if value else "off"
        return f"{value_text(value, 6)} {self.unit}".strip()

    # ------------------------------------------------------------------ one check per kind

    def _limited(self, value: float) -> float:
        if not math.isfinite(value):
            raise ValueError
        if (self.minimum is not None and value < self.minimum) or (
            self.maximum is not None and value > self.maximum
        ):
            raise SettingError(f"{self.name} must be {self._expected()}, got {value:g}.")
        return value

    def _check_float(self, value: Any) -> float:
        if isinstance(value, (str, bytes, bool)):
            raise TypeError
        return float(self._limited(float(value)))

    def _check_int(self, value: Any) -> int:
        if isinstance(value, (str, bytes, bool)) or int(value) != value:
            raise TypeError
        return int(self._limited(int(value)))

    def _check_bool(self, value: Any) -> bool:
        if value not in (True, False, 0, 1):
            raise TypeError
        return bool(value)

    def _check_choice(self, value: Any) -> str:
        if value not in [key for key, _ in self.choices]:
            raise ValueError
        return str(value)

    def _check_color(self, value: Any) -> tuple[float, ...]:
        r, g, b = (float(c) for c in value)
        if not all(0.0 <= c <= 1.0 for c in (r, g, b)):
            raise ValueError
        return r, g, b

    def _check_vector(self, value: Any) -> tuple[float, ...]:
        x, y, z = (float(c) for c in value)
        if not all(map(math.isfinite, (x, y, z))):
            raise ValueError
        return x, y, z

    def _check_crop(self, value: Any) -> Any:
        from volviz.model.clipping import checked_crop

        return checked_crop(value)

    def _check_planes(self, value: Any) -> Any:
        from volviz.model.clipping import checked_planes

        return checked_planes(value)

    def _check_floats(self, value: Any) -> tuple[float, ...]:
        numbers = (value,) if isinstance(value, Real) else tuple(value)
        return tuple(float(self._limited(float(v))) for v in numbers)

    def _check_colors(self, value: Any) -> tuple[tuple[float, ...], ...]:
        return tuple(self._check_color(v) for v in value)

    def _check_path(self, value: Any) -> str:
        return str(value)

    def _expected(self) -> str:
        if self.kind == "choice":
            return "one of " + ", ".join(key for key, _ in self.choices)
        words = {
            "float": "a number",
            "int": "a whole number",
            "bool": "true or false",
            "color": "three numbers between 0 and 1 (red, green, blue)",
            "vector": "three numbers (x, y, z)",
            "crop": "six numbers (i0, i1, j0, j1, k0, k1)",
            "planes": "pairs of origin and normal",
            "floats": "one or more numbers",
            "colors": "colours of three numbers each",
            "path": "the path of a file",
        }[self.kind]
        if self.minimum is not None and self.maximum is not None:
            words += f" from {self.minimum:g} to {self.maximum:g}"
        elif self.minimum is not None:
            words += f" of at least {self.minimum:g}"
        return words + (" (or none)" if self.optional else "")


def parameter(
    default: Any,
    label: str,
    tooltip: str,
    *,
    kind: Kind | None = None,
    **description: Any,
) -> Any:
    """A dataclass field that carries the description of a setting (see `Parameter` for the keywords)."""
    if kind is None:
        kind = "choice" if "choices" in description else _kind_of(default)
    description |= {"kind": kind, "default": default, "label": label, "tooltip": tooltip}
    return dataclasses.field(default=default, metadata={"parameter": description})


def _kind_of(default: Any) -> Kind:
    if isinstance(default, bool):
        return "bool"
    if isinstance(default, int):
        return "int"
    if isinstance(default, float):
        return "float"
    raise TypeError(f"the kind of a setting with the default {default!r} must be named")


@cache
def _described(settings: Hashable) -> tuple[Parameter, ...]:
    return tuple(
        Parameter(name=field.name, **field.metadata["parameter"])
        for field in dataclasses.fields(settings)  # type: ignore[arg-type]
        if "parameter" in field.metadata
    )


def parameters_of(settings: type[Any]) -> tuple[Parameter, ...]:
    """The described settings of a settings class, in the order of its fields."""
    return _described(cast(Hashable, settings))


def value_text(value: Any, digits: int | None = None) -> str:
    """The value of a setting as `Parameter.parse` reads it; floats with so many digits, or with all that they have."""
    if value is None:
        return "automatic"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and digits is not None:
        return f"{value:.{digits}g}"
    if not isinstance(value, tuple | list):
        return str(value)
    if not value:
        return "none"
    separator = "; " if isinstance(value[0], tuple | list) else ","
    return separator.join(value_text(_flat(item), digits) for item in value)


def _flat(value: Any) -> Any:
    """A plane, origin and normal, as six numbers; everything else as it is."""
    if isinstance(value, tuple | list) and value and isinstance(value[0], tuple | list):
        return [number for part in value for number in part]
    return value


def setting_values(settings: Any) -> dict[str, Any]:
    """The values of an instance of a settings class by name, in the order of its fields."""
    return {p.name: getattr(settings, p.name) for p in parameters_of(type(settings))}


def make_settings(settings: type[S], values: Mapping[str, Any], *, owner: str) -> S:
    """An instance of a settings class from keywords, each checked.

    Parameters
    ----------
    settings : type
        A frozen dataclass of `parameter` fields.
    values : mapping
        Setting names and values.
    owner : str
        Who has these settings, for the error message ("raycast").

    Raises
    ------
    SettingError
        An unknown name (near ones are suggested) or an unusable value.
    """
    known = {p.name: p for p in parameters_of(settings)}
    checked: dict[str, Any] = {}
    for name, value in values.items():
        if name not in known:
            raise SettingError(unknown_setting(owner, name, list(known)))
        checked[name] = known[name].checked(value)
    return settings(**checked)


def unknown_setting(owner: str, name: str, known: Sequence[str]) -> str:
    """The sentence for a setting that does not exist, with the nearest existing names."""
    from difflib import get_close_matches

    near = get_close_matches(name, known, n=3)
    hint = f"did you mean {' or '.join(near)}?" if near else "it has " + ", ".join(sorted(known)) + "."
    return f"{owner} has no setting called {name!r}; {hint}"
