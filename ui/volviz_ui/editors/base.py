"""What every editor of a setting is: a widget with a value, a signal, beginning and end of a gesture."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget

from volviz.model.parameters import Parameter


class Editor(QWidget):
    """Shows and changes one value.

    `value_changed` is emitted when the *user* has changed it, never by `set_value`. Between `gesture_started`
    and `gesture_finished` a slider or the like is being dragged.
    """

    value_changed = Signal(object)
    gesture_started = Signal()
    gesture_finished = Signal()

    wide = False
    """Whether the label stands above the editor instead of beside it."""

    def __init__(self, parameter: Parameter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.parameter = parameter
        self.setToolTip(tooltip_of(parameter))
        self.setAccessibleName(parameter.label)

    def set_value(self, value: Any) -> None:
        """Show a value."""
        raise NotImplementedError


def tooltip_of(parameter: Parameter) -> str:
    """The words for a setting: what it does, its unit, how a script names it."""
    text = parameter.tooltip
    if parameter.minimum is not None and parameter.maximum is not None:
        text += f" ({parameter.minimum:g} to {parameter.maximum:g})"
    if parameter.unit and parameter.unit != "data":
        text += f" [{parameter.unit}]"
    return f"<p>{text}</p><p><code>{parameter.name}</code></p>"
