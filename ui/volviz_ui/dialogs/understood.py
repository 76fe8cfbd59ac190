"""What was understood of a file, and where it is wrong: axes, spacing, units."""

from __future__ import annotations

from typing import Any

import numpy as np
from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QDoubleSpinBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QWidget,
)

from volviz.volume_data.orientation import LETTERS, direction_of, orientation_of
from volviz.volume_data.volume import Volume
from volviz_ui.editors.number import NumberField
from volviz_ui.editors.simple import QWIDGETSIZE_MAX, NoWheelComboBox
from volviz_ui.widgets.dialog_layout import lay_out
from volviz_ui.widgets.small import quiet_label

#: Hints of `volviz.open` that this dialog gives.
CORRECTED = ("spacing", "orientation", "length_unit", "unit")
_LENGTH_UNITS = ("mm", "µm", "nm", "m", "Å", "")
#: Directions nearer than this to those of a code are those, as a cosine.
_STRAIGHT = 1e-6


class UnderstoodDialog(QDialog):
    """Axes, spacing and units as they were understood, to be corrected; what the reader noted.

    Parameters
    ----------
    volume : Volume
    corrections : mapping
        Hints that correct the file already.
    remembers : bool
        Whether they are those that are remembered for the file.

    Attributes
    ----------
    corrected : signal (dict, bool)
        Hints that differ from what is shown now and those that stay, and whether they are to be remembered; an
        empty dict takes the file at its word again.
    """

    corrected = Signal(object, bool)

    def __init__(
        self, volume: Volume, corrections: dict[str, Any], *, remembers: bool, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("What was understood"))
        self._corrections = {name: value for name, value in corrections.items() if name in CORRECTED}
        self._code = orientation_of(volume.direction)
        self._is_straight = bool(
            np.abs(np.asarray(volume.direction) - direction_of(self._code)).max() < _STRAIGHT
        )
        self.axes = [self._axis(letter) for letter in self._code]
        self.spacing = [self._length(value) for value in volume.spacing]
        self.length_unit = NoWheelComboBox(self)
        self.length_unit.setEditable(True)
        self.length_unit.addItems(list(_LENGTH_UNITS))
        self.length_unit.setCurrentText(str(volume.metadata.get("length_unit", "")))
        self.length_unit.setToolTip(self.tr("Unit of spacing and size; the numbers stay as they are"))
        self.unit = QLineEdit(volume.unit, self)
        self.unit.setToolTip(self.tr("Unit of the values, HU say"))
        self._before = self._entered
        self.remember = QCheckBox(self.tr("Remember this for the file"), self)
        self.remember.setChecked(remembers or not self._corrections)
        self.remember.setToolTip(
            self.tr(
                "The window opens this file so from now on, until it changes; scripts and the command line do not"
            )
        )

        form = QFormLayout()
        form.setHorizontalSpacing(16)
        form.setVerticalSpacing(8)
        form.addRow(self.tr("File"), QLabel(_said(volume), self))
        for number, name in enumerate(
            (self.tr("Columns lead"), self.tr("Rows lead"), self.tr("Slices lead"))
        ):
            form.addRow(name, self.axes[number])
        if not self._is_straight:
            words = quiet_label(self.tr("The axes are oblique; these are the nearest directions. They stay as they are "
                                        "unless you choose others."))  # fmt: skip
            words.setWordWrap(True)
            form.addRow("", words)
        form.addRow(self.tr("Spacing x, y, z"), _row(self.spacing))
        form.addRow(self.tr("Unit of lengths"), self.length_unit)
        form.addRow(self.tr("Unit of values"), self.unit)
        self.check: QLabel = quiet_label()
        self.check.setWordWrap(True)
        notes = volume.metadata.get("notes", ())
        self.notes = quiet_label("\n".join(str(note) for note in notes))
        self.notes.setWordWrap(True)
        self.notes.setVisible(bool(notes))

        self.buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Apply | QDialogButtonBox.StandardButton.Close, self
        )
        self.as_the_file_says = self.buttons.addButton(
            self.tr("As the file says"), QDialogButtonBox.ButtonRole.ResetRole
        )
        self.as_the_file_says.setEnabled(bool(self._corrections))
        self.apply = self.buttons.button(QDialogButtonBox.StandardButton.Apply)
        self.apply.clicked.connect(self._on_apply)
        self.as_the_file_says.clicked.connect(self._on_reset)
        self.buttons.rejected.connect(self.reject)
        lay_out(self, form, self.notes, self.check, self.remember, self.buttons)
        self.setMinimumWidth(460)
        for box in (*self.axes, self.length_unit):
            box.currentTextChanged.connect(self._show_check)
        for field in self.spacing:
            field.valueChanged.connect(self._show_check)
        self.unit.textChanged.connect(self._show_check)
        self._show_check()

    @property
    def hints(self) -> dict[str, Any]:
        """The corrections so far, with what was changed here."""
        changed = {name: value for name, value in self._entered.items() if value != self._before[name]}
        return {**self._corrections, **changed}

    @property
    def _entered(self) -> dict[str, Any]:
        return {
            "spacing": tuple(field.value() for field in self.spacing),
            "orientation": "".join(str(box.currentData()) for box in self.axes),
            "length_unit": self.length_unit.currentText().strip(),
            "unit": self.unit.text().strip(),
        }

    def _show_check(self) -> None:
        code = self._entered["orientation"]
        is_possible = len({LETTERS[letter][0] for letter in code}) == 3
        changed = self._entered != self._before
        self.apply.setEnabled(is_possible and changed)
        self.check.setText(
            "" if is_possible else self.tr("Two axes cannot lead along the same line; choose others.")
        )
        self.check.setVisible(not is_possible)

    def _on_apply(self) -> None:
        self.corrected.emit(self.hints, self.remember.isChecked())
        self.accept()

    def _on_reset(self) -> None:
        self.corrected.emit({}, True)
        self.accept()

    def _axis(self, letter: str) -> QComboBox:
        box = NoWheelComboBox(self)
        for code, words in (
            ("L", self.tr("left (+x)")), ("R", self.tr("right (−x)")), ("P", self.tr("back (+y)")),
            ("A", self.tr("front (−y)")), ("S", self.tr("up (+z)")), ("I", self.tr("down (−z)")),
        ):  # fmt: skip
            box.addItem(words, code)
        box.setCurrentIndex(box.findData(letter))
        box.setToolTip(self.tr("Where in the world the next voxel along this axis lies, seen by the patient"))
        return box

    def _length(self, value: float) -> QDoubleSpinBox:
        field = NumberField(parent=self)
        field.setMaximumWidth(QWIDGETSIZE_MAX)
        field.setRange(1e-9, 1e9)
        field.setValue(value)
        field.setToolTip(self.tr("Distance between voxel centres along this axis"))
        return field


def _said(volume: Volume) -> str:
    sizes = " × ".join(str(n) for n in volume.dimensions)
    return ", ".join(
        part for part in (str(volume.metadata.get("format", "")), sizes, str(volume.array.dtype)) if part
    )


def _row(fields: list[QDoubleSpinBox]) -> QHBoxLayout:
    layout = QHBoxLayout()
    layout.setSpacing(4)
    for field in fields:
        layout.addWidget(field, 1)
    return layout
