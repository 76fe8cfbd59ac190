"""One editor for each kind of setting; `editor_for` chooses by the description of the setting."""

from __future__ import annotations

import dataclasses
from typing import Any

from PySide6.QtWidgets import QWidget

from volviz.model.parameters import Parameter
from volviz_ui.editors.base import Editor
from volviz_ui.editors.number import NumberEditor, slider_range
from volviz_ui.editors.optional import OptionalEditor
from volviz_ui.editors.several import ColorsEditor, FloatsEditor
from volviz_ui.editors.simple import (
    BoolEditor,
    ChoiceEditor,
    ColorEditor,
    PathEditor,
    TextEditor,
    VectorEditor,
)
from volviz_ui.library_words import translated_parameter

__all__ = ["Editor", "editor_for"]

_EDITORS: dict[str, type[Editor]] = {
    "float": NumberEditor,
    "int": NumberEditor,
    "bool": BoolEditor,
    "choice": ChoiceEditor,
    "color": ColorEditor,
    "vector": VectorEditor,
    "floats": FloatsEditor,
    "colors": ColorsEditor,
    "path": PathEditor,
}


def editor_for(parameter: Parameter, parent: QWidget | None = None) -> Editor:
    """The widget that edits a setting; kinds without a special one are written as text."""
    parameter = translated_parameter(parameter)
    kind = _EDITORS.get(parameter.kind, TextEditor)
    if not parameter.optional or kind in (TextEditor, PathEditor):
        return kind(parameter, parent)
    required = dataclasses.replace(parameter, optional=False)
    return OptionalEditor(parameter, kind(required), _fallback(parameter), parent)


def _fallback(parameter: Parameter) -> Any:
    """Where the editor of an optional setting begins."""
    if parameter.default is not None:
        return parameter.default
    if parameter.kind in ("float", "int"):
        low, high = slider_range(parameter)
        middle = (low * high) ** 0.5 if parameter.logarithmic and low > 0 else (low + high) / 2
        return round(middle) if parameter.kind == "int" else middle
    if parameter.kind == "floats":
        low, high = slider_range(parameter)
        return ((low + high) / 2,)
    return {
        "bool": False,
        "choice": parameter.choices[0][0] if parameter.choices else "",
        "color": (1.0, 1.0, 1.0),
        "vector": (0.0, 0.0, 0.0),
        "colors": ((1.0, 1.0, 1.0),),
    }[parameter.kind]
