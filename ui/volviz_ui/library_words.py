"""Words of the library in the language of the window: names of techniques, settings, presets, looks and samples.

The library knows no Qt and speaks English; what it says for people is looked up here, in the context `CONTEXT`.
"""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QCoreApplication

from volviz.model.parameters import Parameter

#: Of the translator, under which all words of the library stand.
CONTEXT = "Library"


def translated(words: str) -> str:
    """Words of the library in the language of the window."""
    return QCoreApplication.translate(CONTEXT, words) if words else words


def translated_parameter(parameter: Parameter) -> Parameter:
    """A setting with its words in the language of the window."""
    return replace(
        parameter,
        label=translated(parameter.label),
        tooltip=translated(parameter.tooltip),
        group=translated(parameter.group),
        none_label=translated(parameter.none_label),
        choices=tuple((value, translated(words)) for value, words in parameter.choices),
    )
