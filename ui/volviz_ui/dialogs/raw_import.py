"""Importing raw files: guesses at what the file does not say itself, and slices that show whether they are right."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QImage, QPixmap
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QDoubleSpinBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QSizePolicy,
    QSpinBox,
    QWidget,
)

from volviz.io import endings
from volviz.io.raw import named_type
from volviz.io.raw_guesses import (
    DTYPES,
    RawGuess,
    guesses,
    middle_slices,
    raw_bytes,
    sizes_from_name,
)
from volviz_ui.editors.number import NumberField
from volviz_ui.editors.simple import QWIDGETSIZE_MAX, NoWheelComboBox
from volviz_ui.session.workers import Task, Workers
from volviz_ui.widgets.dialog_layout import lay_out
from volviz_ui.widgets.small import quiet_label

RAW_SUFFIXES = (*endings.RAW, ".vol")
#: Pixels of a slice along its longer side.
SIDE = 160
#: Milliseconds after the last change until slices are read.
DELAY = 60
_GUESSING, _SLICING = "raw guesses", "raw slices"


def is_raw(path: str) -> bool:
    """Whether a file is of the kind that says nothing about itself."""
    return path.lower().endswith(RAW_SUFFIXES)


def says_all(path: str) -> bool:
    """Whether the name of a raw file tells its sizes and the type of its values."""
    name = Path(path).name
    return sizes_from_name(name) is not None and named_type(name) is not None


class RawImportDialog(QDialog):
    """Asks for dimensions, data type, byte order, header and spacing.

    Parameters
    ----------
    path : str
    workers : Workers
        Guess, and read slices.
    """

    def __init__(self, path: str, workers: Workers, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Import raw file"))
        self._workers = workers
        self._name = Path(path).name
        self._data: npt.NDArray[np.uint8] | None = None

        self.guesses = NoWheelComboBox(self)
        self.guesses.setToolTip(self.tr("What fits the size of the file and its values, the likeliest first"))
        self.guesses.addItem(self.tr("Looking at the values…"))
        self.guesses.setEnabled(False)
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
        self.check.setMinimumHeight(3 * self.fontMetrics().lineSpacing())
        self.slices = [
            _slice_label(name) for name in (self.tr("x and y"), self.tr("x and z"), self.tr("y and z"))
        ]

        form = QFormLayout()
        form.setHorizontalSpacing(16)
        form.setVerticalSpacing(8)
        form.addRow(self.tr("Likely"), self.guesses)
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
        pictures = QHBoxLayout()
        pictures.setSpacing(8)
        for label in self.slices:
            pictures.addWidget(label)
        heading = QLabel(f"<b>{self._name}</b>", self)
        lay_out(self, heading, form, pictures, self.check, self.buttons)
        self.setMinimumWidth(3 * (SIDE + 8) + 48)

        self._later = QTimer(self)
        self._later.setSingleShot(True)
        self._later.setInterval(DELAY)
        self._later.timeout.connect(self._read_slices)
        self._fill(
            RawGuess(sizes_from_name(self._name) or (256, 256, 256), named_type(self._name) or DTYPES[0])
        )
        #: What the fields said before anybody touched them.
        self._first = self.guess
        for field in (*self.dims, self.header):
            field.valueChanged.connect(self._on_changed)
        for box in (self.dtype, self.endian):
            box.currentIndexChanged.connect(self._on_changed)
        self.guesses.activated.connect(self._take_guess)
        self.finished.connect(self._stop)
        task = workers.start(partial(_look_at, path), label=self._name, key=_GUESSING)
        task.succeeded.connect(self._on_guessed)
        task.failed.connect(self._on_unreadable)
        self._on_changed()

    @property
    def hints(self) -> dict[str, Any]:
        """What was entered, as keywords of `volviz.load`."""
        return {**self.guess.hints, "spacing": tuple(field.value() for field in self.spacing)}

    @property
    def guess(self) -> RawGuess:
        """What was entered, without the spacing."""
        x, y, z = (field.value() for field in self.dims)
        return RawGuess(
            (x, y, z), self.dtype.currentText(), str(self.endian.currentData()), self.header.value()
        )

    def _fill(self, guess: RawGuess) -> None:
        for field, n in zip(self.dims, guess.dims, strict=True):
            field.setValue(n)
        self.dtype.setCurrentText(guess.dtype)
        self.endian.setCurrentIndex(self.endian.findData(guess.endian))
        self.header.setValue(guess.header)

    def _on_guessed(self, found: tuple[npt.NDArray[np.uint8], list[RawGuess]]) -> None:
        self._data, likely = found
        self.guesses.clear()
        for guess in likely:
            self.guesses.addItem(_words(guess), guess)
        self.guesses.setEnabled(bool(likely))
        if likely and self.guess == self._first:
            self._take_guess(0)
        elif likely:
            # what was entered meanwhile counts
            self.guesses.setCurrentIndex(-1)
        else:
            self.guesses.addItem(self.tr("Nothing fits: no neighbours are alike"))
        self._on_changed()

    def _on_unreadable(self, error: Exception) -> None:
        self.guesses.setItemText(0, self.tr("The file cannot be read"))
        reason = getattr(error, "strerror", None) or str(error)
        self.check.setText(self.tr("The file cannot be read: %1").replace("%1", reason))
        self.buttons.button(QDialogButtonBox.StandardButton.Open).setEnabled(False)

    def _take_guess(self, index: int) -> None:
        guess = self.guesses.itemData(index)
        if guess is not None:
            self._fill(guess)

    def _on_changed(self) -> None:
        self._show_check()
        self._later.start()

    def _show_check(self) -> None:
        fits = True
        if self._data is None:
            words = ""
        else:
            expected, size = self.guess.nbytes, len(self._data)
            fits = expected <= size
            if expected == size:
                words = self.tr("This fits the size of the file exactly.")
            elif fits:
                words = self.tr(
                    "The file is %1 bytes longer than this: they would be left out. Check the numbers, or whether "
                    "there is a header."
                ).replace("%1", _grouped(size - expected))
            else:
                words = self.tr("This needs %1 bytes, and the file has %2: it cannot be so.")
                words = words.replace("%1", _grouped(expected)).replace("%2", _grouped(size))
        self.check.setText(words)
        self.buttons.button(QDialogButtonBox.StandardButton.Open).setEnabled(fits)

    def _read_slices(self) -> None:
        """Show what was entered, read in the background; the newest wins."""
        data, guess = self._data, self.guess
        if data is None:
            return
        if guess.nbytes > len(data):
            self._show_slices(None)
            return
        task = self._workers.start(
            lambda _task: middle_slices(data, guess, SIDE), label=self._name, key=_SLICING
        )
        task.succeeded.connect(self._show_slices)

    def _show_slices(self, found: tuple[npt.NDArray[np.uint8], ...] | None) -> None:
        for number, label in enumerate(self.slices):
            label.setPixmap(QPixmap() if found is None else _pixmap(found[number]))

    def _stop(self) -> None:
        self._later.stop()
        self._workers.cancel(_GUESSING)
        self._workers.cancel(_SLICING)
        # the file is let go of
        self._data = None

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


def _look_at(path: str, task: Task) -> tuple[npt.NDArray[np.uint8], list[RawGuess]]:
    """The bytes of a file and what they may be. Runs on a worker."""
    task.report(-1.0, "")
    data = raw_bytes(Path(path))
    return data, guesses(Path(path).name, data, lambda: task.report(-1.0, ""))


def _words(guess: RawGuess) -> str:
    parts = [" × ".join(str(n) for n in guess.dims), guess.dtype]
    if guess.endian == "big":
        parts.append("big endian")
    if guess.header:
        parts.append(f"header {_grouped(guess.header)} bytes")
    return ", ".join(parts)


def _grouped(count: int) -> str:
    return f"{count:,}".replace(",", " ")


def _slice_label(name: str) -> QLabel:
    label = QLabel()
    label.setObjectName("raw_slice")
    label.setFixedSize(SIDE, SIDE)
    label.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
    label.setAlignment(Qt.AlignmentFlag.AlignCenter)
    label.setToolTip(name)
    label.setAccessibleName(name)
    return label


def _pixmap(picture: npt.NDArray[np.uint8]) -> QPixmap:
    height, width = picture.shape
    gray = np.ascontiguousarray(picture)
    image = QImage(gray.data, width, height, width, QImage.Format.Format_Grayscale8).copy()
    return QPixmap.fromImage(image).scaled(
        SIDE, SIDE, Qt.AspectRatioMode.KeepAspectRatio, Qt.TransformationMode.FastTransformation
    )


def _row(fields: list[Any]) -> QHBoxLayout:
    layout = QHBoxLayout()
    layout.setSpacing(4)
    for field in fields:
        layout.addWidget(field, 1)
    return layout
