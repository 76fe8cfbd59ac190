"""Settings that may be left to the program: a check box "automatic" before the editor proper."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QSignalBlocker
from PySide6.QtWidgets import QCheckBox, QVBoxLayout, QWidget

from volviz.model.parameters import Parameter
from volviz_ui.editors.base import Editor, tooltip_of


class OptionalEditor(Editor):
    """Leaves the value to the program (None) or sets it by another editor.

    Parameters
    ----------
    parameter : Parameter
        An optional setting.
    inner : Editor
        Edits the value when it is not automatic.
    fallback : object
        What the editor shows at first; a change there switches "automatic" off.
    """

    wide = True

    def __init__(
        self, parameter: Parameter, inner: Editor, fallback: Any, parent: QWidget | None = None
    ) -> None:
        super().__init__(parameter, parent)
        self.inner = inner
        self._last = fallback
        label = parameter.none_label[:1].upper() + parameter.none_label[1:]
        self.check = QCheckBox(label, self)
        self.check.setToolTip(tooltip_of(parameter))
        self.check.setAccessibleName(f"{parameter.label}: {label}")
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addWidget(self.check)
        layout.addWidget(inner)
        self.setFocusProxy(self.check)
        self.check.toggled.connect(self._on_toggled)
        inner.value_changed.connect(self._on_inner)
        inner.gesture_started.connect(self.gesture_started)
        inner.gesture_finished.connect(self.gesture_finished)

    def set_fallback(self, value: Any) -> None:
        """What "automatic" stands for at present, shown while it is on."""
        if self.check.isChecked():
            self._last = value
            self.inner.set_value(value)

    def set_value(self, value: Any) -> None:
        """Show a value, or None for automatic."""
        if value is not None:
            self._last = value
        with QSignalBlocker(self.check):
            self.check.setChecked(value is None)
        self.inner.set_value(self._last)

    def _on_toggled(self, automatic: bool) -> None:
        self.value_changed.emit(None if automatic else self._last)

    def _on_inner(self, value: Any) -> None:
        # whoever moves the slider wants this value, and not the automatic one
        self._last = value
        with QSignalBlocker(self.check):
            self.check.setChecked(False)
        self.value_changed.emit(value)
