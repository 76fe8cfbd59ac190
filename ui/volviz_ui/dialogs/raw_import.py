"""Importing raw files: what the file does not say itself, with a check against the size of the file."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QDoubleSpinBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QSpinBox,
    QVBoxLayout,
    QWidget,
)

from volviz_ui.editors.number import NumberField
from volviz_ui.editors.simple import QWIDGETSIZE_MAX, NoWheelComboBox
from volviz_ui.widgets.small import quiet_label

RAW_SUFFIXES = (".raw", ".raw.gz", ".bin", ".vol")
DTYPES = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64")
_NAME_DIMS = re.compile(r"(\d{2,5})[xX_](\d{2,5})[xX_](\d{2,5})")
_NAME_DTYPE = re.compile("|".join(DTYPES), re.IGNORECASE)


def is_raw(path: str) -> bool:
    """Whether a file is of the kind that says nothing about itself."""
    return path.lower().endswith(RAW_SUFFIXES)


def hints_from_name(path: str) -> dict[str, Any]:
    """Dimensions and data type written in a file name such as ``head_256x256x225_uint8.raw``."""
    name = Path(path).name
    hints: dict[str, Any] = {}
    if found := _NAME_DIMS.search(name):
        hints["dims"] = tuple(int(n) for n in found.groups())
    if found := _NAME_DTYPE.search(name):
        hints["dtype"] = found.group().lower()
    return hints


class RawImportDialog(QDialog):
    """Asks for dimensions, data type, byte order, header and spacing."""

    def __init__(self, path: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Import raw file"))
        self._path = path
        self._compressed = path.lower().endswith(".gz")
        self._size = Path(path).stat().st_size if Path(path).is_file() else 0
        known = hints_from_name(path)

        self.dims = [self._count() for _ in range(3)]
        self.dtype = NoWheelComboBox(self)
        self.dtype.addItems(list(DTYPES))
        self.dtype.setToolTip(self.tr("Type of one value"))
        self.endian = NoWheelComboBox(self)
        self.endian.addItem(self.tr("Little endian (Intel, ARM)"), "little")
        self.endian.addItem(self.tr("Big endian"), "big")
        self.endian.setToolTip(self.tr("Order of the bytes of a value"))
        self.header = QSpinBox(self)
        self.header.setRange(0, 2**31 - 1)
        self.header.setSuffix(self.tr(" bytes"))
        self.header.setToolTip(self.tr("Bytes before the first value"))
        self.spacing = [self._length() for _ in range(3)]
        self.check: QLabel = quiet_label()
        self.check.setWordWrap(True)
        self.check.setMinimumHeight(2 * self.fontMetrics().lineSpacing())

        form = QFormLayout()
        form.setHorizontalSpacing(16)
        form.setVerticalSpacing(8)
        form.addRow(self.tr("Voxels x, y, z"), _row(self.dims))
        form.addRow(self.tr("Values"), self.dtype)
        form.addRow(self.tr("Byte order"), self.endian)
        form.addRow(self.tr("Header"), self.header)
        form.addRow(self.tr("Spacing x, y, z"), _row(self.spacing))
        self.buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Open | QDialogButtonBox.StandardButton.Cancel, self
        )
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(24, 20, 24, 16)
        layout.setSpacing(12)
        layout.addWidget(QLabel(f"<b>{Path(path).name}</b>", self))
        layout.addLayout(form)
        layout.addWidget(self.check)
        layout.addWidget(self.buttons)
        self.setMinimumWidth(460)

        self._guess(known)
        for field in (*self.dims, self.header):
            field.valueChanged.connect(self._show_check)
        self.dtype.currentIndexChanged.connect(self._show_check)
        self._show_check()

    @property
    def hints(self) -> dict[str, Any]:
        """What was entered, as keywords of `volviz.load`."""
        return {
            "dims": tuple(field.value() for field in self.dims),
            "dtype": self.dtype.currentText(),
            "endian": self.endian.currentData(),
            "header": self.header.value(),
            "spacing": tuple(field.value() for field in self.spacing),
        }

    @property
    def expected_bytes(self) -> int:
        """Size that a file with these values has."""
        voxels = 1
        for field in self.dims:
            voxels *= field.value()
        return self.header.value() + voxels * np.dtype(self.dtype.currentText()).itemsize

    def _guess(self, known: dict[str, Any]) -> None:
        self.dtype.setCurrentText(known.get("dtype", "uint8"))
        dims = known.get("dims")
        if dims is None and self._size and not self._compressed:
            side = round((self._size / np.dtype(self.dtype.currentText()).itemsize) ** (1 / 3))
            dims = (max(side, 2),) * 3
        for field, n in zip(self.dims, dims or (256, 256, 256), strict=True):
            field.setValue(n)

    def _show_check(self) -> None:
        expected, size = self.expected_bytes, self._size
        fits = self._compressed or expected <= size
        if self._compressed:
            words = self.tr("The file is compressed: its size is checked while it is read.")
        elif expected == size:
            words = self.tr("These values fit the size of the file exactly.")
        else:
            words = self.tr("These values need %1 bytes; the file has %2.")
            words = words.replace("%1", f"{expected:,}".replace(",", " "))
            words = words.replace("%2", f"{size:,}".replace(",", " "))
        self.check.setText(words)
        self.buttons.button(QDialogButtonBox.StandardButton.Open).setEnabled(fits)

    def _count(self) -> QSpinBox:
        field = QSpinBox(self)
        field.setRange(2, 100000)
        field.setKeyboardTracking(True)
        field.setToolTip(self.tr("Number of voxels along this axis"))
        return field

    def _length(self) -> QDoubleSpinBox:
        field = NumberField(parent=self)
        field.setMaximumWidth(QWIDGETSIZE_MAX)
        field.setRange(1e-9, 1e9)
        field.setValue(1.0)
        field.setToolTip(self.tr("Distance between voxel centres along this axis"))
        return field


def _row(fields: list[Any]) -> QHBoxLayout:
    layout = QHBoxLayout()
    layout.setSpacing(4)
    for field in fields:
        layout.addWidget(field, 1)
    return layout
