"""The settings of one technique as sections of editors, made from their descriptions alone."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable
from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QLabel, QToolButton, QVBoxLayout, QWidget

from volviz.custom_gl.technique import TechniqueInfo
from volviz.model.parameters import Parameter
from volviz.volume_data.volume import Volume
from volviz_ui.editors import Editor, editor_for
from volviz_ui.editors.base import tooltip_of
from volviz_ui.editors.optional import OptionalEditor
from volviz_ui.library_words import translated_parameter
from volviz_ui.panels.panel import Section
from volviz_ui.widgets.small import small_button

LABEL_WIDTH = 112


class SettingsForm(QWidget):
    """Editors for all settings of a technique.

    Parameters
    ----------
    info : TechniqueInfo
        Whose settings these are.
    is_open : callable
        Takes the name of a group, says whether it starts unfolded.
    volume : Volume or None
        Its range and unit stand in for those of settings that are measured in data units.

    It is made without rows; they come by `grow`.
    """

    setting_changed = Signal(str, object)
    gesture_started = Signal(str)
    gesture_finished = Signal(str)
    """Names of settings whose editors are taken hold of, and let go."""
    section_folded = Signal(str, bool)

    def __init__(
        self,
        info: TechniqueInfo,
        is_open: Callable[[str], bool],
        volume: Volume | None,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.info = info
        self.editors: dict[str, Editor] = {}
        self.sections: dict[str, Section] = {}
        self._rows: dict[str, tuple[QLabel, QToolButton]] = {}
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.setSpacing(4)
        self._parameters = parameters_for(info, volume)
        self._is_open = is_open
        self._groups: dict[str, str] = {}
        self.more = QToolButton(self)
        self.more.setCheckable(True)
        self.more.setAutoRaise(True)
        self.more.setToolTip(
            self.tr("Settings that act only together with others, or in another mode of this technique")
        )
        self.more.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.more.toggled.connect(self._show_rows)
        self.more.hide()
        self._column.addWidget(self.more)

    @property
    def is_whole(self) -> bool:
        """Whether all rows are there."""
        return len(self.editors) == len(self._parameters)

    def grow(self, seconds: float = math.inf) -> None:
        """Add rows that are missing, at least one, for about so long."""
        if self.is_whole:
            return
        begin = time.perf_counter()
        for parameter in self._parameters[len(self.editors) :]:
            self._add(parameter, self._is_open)
            if time.perf_counter() - begin > seconds:
                break
        debug_view = self.sections.get(self._debug_view())
        if debug_view is not None:
            self._column.removeWidget(debug_view)
            self._column.insertWidget(self._column.count() - 1, debug_view)

    def fits(self, volume: Volume | None) -> bool:
        """Whether a form for that volume would have the same ranges and units."""
        return parameters_for(self.info, volume) == self._parameters

    def fold(self, is_open: Callable[[str], bool]) -> None:
        """Fold and unfold the groups as another form has left them."""
        for group, section in self.sections.items():
            section.set_open(is_open(group))

    def show_settings(self, settings: Any) -> None:
        """Show all values, and which settings act at present."""
        for name, editor in self.editors.items():
            value = getattr(settings, name)
            editor.set_value(value)
            _words, reset = self._rows[name]
            is_default = value == editor.parameter.default
            reset.setVisible(not is_default)
            enabled = acts(editor.parameter, settings)
            editor.setEnabled(enabled)
            self._rows[name][0].setEnabled(enabled)
        self._show_rows()

    def _show_rows(self) -> None:
        """Hide settings that have no effect at present, unless they are asked for."""
        idle = {name for name, editor in self.editors.items() if not editor.isEnabled()}
        for name, editor in self.editors.items():
            words, reset = self._rows[name]
            shown = name not in idle or self.more.isChecked()
            for part in (words, editor):
                part.setVisible(shown)
            keeps_place = reset.sizePolicy()
            keeps_place.setRetainSizeWhenHidden(shown)
            reset.setSizePolicy(keeps_place)
            if not shown:
                reset.hide()
        for group, section in self.sections.items():
            names = {name for name, editor in self.editors.items() if self._groups[name] == group}
            section.setVisible(bool(names - idle) or self.more.isChecked())
        self.more.setVisible(bool(idle))
        count = self.tr("%1 more, without effect now").replace("%1", str(len(idle)))
        self.more.setText(self.tr("Hide what has no effect") if self.more.isChecked() else count)

    def show_automatic(self, values: dict[str, Any]) -> None:
        """Say what "automatic" stands for at present, by the name of the setting."""
        for name, value in values.items():
            editor = self.editors.get(name)
            if isinstance(editor, OptionalEditor):
                editor.set_fallback(value)

    def _debug_view(self) -> str:
        return self.tr("How it works")

    def _add(self, parameter: Parameter, is_open: Callable[[str], bool]) -> None:
        parameter = translated_parameter(parameter)
        group = self._debug_view() if parameter.name == "display" else parameter.group or self.tr("Settings")
        section = self.sections.get(group)
        if section is None:
            section = Section(group, open_=is_open(group), parent=self)
            section.rows.setColumnMinimumWidth(0, LABEL_WIDTH)
            section.folded.connect(self.section_folded)
            self.sections[group] = section
            self._column.insertWidget(self._column.count() - 1, section)
        editor = editor_for(parameter)
        name = parameter.name
        reset = small_button("arrow-counter-clockwise", self.tr("Back to the default"))
        keeps_place = reset.sizePolicy()
        keeps_place.setRetainSizeWhenHidden(True)
        reset.setSizePolicy(keeps_place)
        reset.clicked.connect(lambda: self.setting_changed.emit(name, parameter.default))
        editor.value_changed.connect(lambda value: self.setting_changed.emit(name, value))
        editor.gesture_started.connect(lambda: self.gesture_started.emit(name))
        editor.gesture_finished.connect(lambda: self.gesture_finished.emit(name))
        words = section.add_row(
            parameter.label, editor, tail=reset, wide=editor.wide, tooltip=tooltip_of(parameter)
        )
        self.editors[name], self._groups[name] = editor, group
        self._rows[name] = (words, reset)


def acts(parameter: Parameter, settings: Any) -> bool:
    """Whether a setting has an effect with the other settings as they are."""
    if parameter.enabled_by is None:
        return True
    name, values = parameter.enabled_by
    return getattr(settings, name, None) in values


def parameters_for(info: TechniqueInfo, volume: Volume | None) -> tuple[Parameter, ...]:
    """The settings of a technique with range and unit of a volume."""
    return tuple(in_data_units(parameter, volume) for parameter in info.parameters)


def in_data_units(parameter: Parameter, volume: Volume | None) -> Parameter:
    """A setting measured in data units gets the range and the unit of the volume."""
    of_data = parameter.unit == "data" or parameter.name in ("isovalue", "isovalues")
    if volume is None or parameter.kind not in ("float", "floats") or not of_data:
        return parameter
    low, high = volume.range
    return dataclasses.replace(
        parameter, unit=volume.unit, soft_minimum=low, soft_maximum=max(high, low + 1e-9)
    )
