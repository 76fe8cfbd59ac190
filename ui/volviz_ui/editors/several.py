"""Editors of several values of one kind: numbers with a slider each, colours side by side."""

from __future__ import annotations

from functools import partial
from itertools import pairwise
from typing import Any

from PySide6.QtGui import QColor
from PySide6.QtWidgets import QHBoxLayout, QPushButton, QVBoxLayout, QWidget

from volviz.model.parameters import Parameter
from volviz_ui.editors.base import Editor, tooltip_of
from volviz_ui.editors.number import Scale, SliderField, slider_range
from volviz_ui.editors.simple import ColorButton, chosen_color
from volviz_ui.style.icons import set_icon
from volviz_ui.widgets.small import small_button

MOST = 4


class FloatsEditor(Editor):
    """A few numbers, each with slider and field; one can be added, all but one removed."""

    wide = True

    def __init__(self, parameter: Parameter, parent: QWidget | None = None) -> None:
        super().__init__(parameter, parent)
        self._values: tuple[float, ...] = ()
        self.rows: list[SliderField] = []
        self._lines: list[QWidget] = []
        self.add = QPushButton(self.tr("Add"), self)
        self.add.setToolTip(self.tr("One more value"))
        set_icon(self.add, "plus")
        self.add.clicked.connect(self._on_add)
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.setSpacing(4)
        self._column.addWidget(self.add)
        self.setFocusProxy(self.add)

    def set_value(self, value: Any) -> None:
        """Show numbers; rows are made anew only when there are more or fewer."""
        self._values = tuple(float(v) for v in value)
        if len(self.rows) != len(self._values):
            self._make_rows()
        for row, number in zip(self.rows, self._values, strict=True):
            row.set_value(number)
        self.add.setVisible(len(self._values) < MOST)

    def _make_rows(self) -> None:
        for line in self._lines:
            self._column.removeWidget(line)
            line.hide()
            line.deleteLater()
        self._lines, self.rows = [], []
        low, high = slider_range(self.parameter)
        limit = 1e12
        minimum = -limit if self.parameter.minimum is None else self.parameter.minimum
        maximum = limit if self.parameter.maximum is None else self.parameter.maximum
        for index in range(len(self._values)):
            line = QWidget(self)
            row = SliderField(
                Scale(low, high, logarithmic=self.parameter.logarithmic),
                minimum=minimum,
                maximum=maximum,
                unit=self.parameter.unit,
                parent=line,
            )
            for part in (row.slider, row.field):
                part.setToolTip(tooltip_of(self.parameter))
                part.setAccessibleName(f"{self.parameter.label} {index + 1}")
            row.value_changed.connect(partial(self._on_value, index))
            row.gesture_started.connect(self.gesture_started)
            row.gesture_finished.connect(self.gesture_finished)
            remove = small_button("x", self.tr("Remove this value"), line)
            remove.setVisible(len(self._values) > 1)
            remove.clicked.connect(partial(self._on_remove, index))
            layout = QHBoxLayout(line)
            layout.setContentsMargins(0, 0, 0, 0)
            layout.setSpacing(4)
            layout.addWidget(row, 1)
            layout.addWidget(remove)
            self._column.insertWidget(index, line)
            self._lines.append(line)
            self.rows.append(row)

    def _on_value(self, index: int, value: float) -> None:
        values = list(self._values)
        values[index] = value
        self._values = tuple(values)
        self.value_changed.emit(self._values)

    def _on_add(self) -> None:
        low, high = slider_range(self.parameter)
        # in the middle of the widest gap, so that the new one is seen
        marks = sorted({low, high, *(v for v in self._values if low <= v <= high)})
        gaps = [(b - a, (a + b) / 2) for a, b in pairwise(marks)]
        self.set_value((*self._values, max(gaps)[1] if gaps else low))
        self.value_changed.emit(self._values)

    def _on_remove(self, index: int) -> None:
        self.set_value(self._values[:index] + self._values[index + 1 :])
        self.value_changed.emit(self._values)


class ColorsEditor(Editor):
    """A few colours side by side; a click changes one."""

    wide = True

    def __init__(self, parameter: Parameter, parent: QWidget | None = None) -> None:
        super().__init__(parameter, parent)
        self._values: tuple[tuple[float, ...], ...] = ()
        self.buttons: list[ColorButton] = []
        self._line = QHBoxLayout(self)
        self._line.setContentsMargins(0, 0, 0, 0)
        self._line.setSpacing(4)
        self._line.addStretch(1)

    def set_value(self, value: Any) -> None:
        """Show colours."""
        self._values = tuple(tuple(color) for color in value)
        while len(self.buttons) > len(self._values):
            button = self.buttons.pop()
            self._line.removeWidget(button)
            button.hide()
            button.deleteLater()
        while len(self.buttons) < len(self._values):
            button = ColorButton(self, with_name=False)
            number = len(self.buttons)
            button.setToolTip(tooltip_of(self.parameter))
            button.setAccessibleName(f"{self.parameter.label} {number + 1}")
            button.clicked.connect(partial(self._choose, number))
            self._line.insertWidget(number, button)
            self.buttons.append(button)
        for button, color in zip(self.buttons, self._values, strict=True):
            button.set_color(QColor.fromRgbF(*color))

    def _choose(self, index: int) -> None:
        color = chosen_color(self, self.buttons[index].color, self.parameter.label)
        if color is not None:
            values = list(self._values)
            values[index] = (color.redF(), color.greenF(), color.blueF())
            self.set_value(values)
            self.value_changed.emit(self._values)
