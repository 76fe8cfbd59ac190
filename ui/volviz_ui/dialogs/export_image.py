"""Exporting the image: any size, with or without background, always at full quality."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSpinBox,
    QVBoxLayout,
    QWidget,
)

from volviz_ui.widgets.small import quiet_label

LARGEST = 16384
FACTORS = (1, 2, 4)


class ExportImageDialog(QDialog):
    """Asks for size and background."""

    def __init__(self, size: tuple[int, int], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Export picture"))
        self._shown = size
        self.pixel_width, self.pixel_height = self._length(), self._length()
        self.pixel_width.setValue(size[0])
        self.pixel_height.setValue(size[1])
        self.keep = QCheckBox(self.tr("Keep the proportions of the viewport"), self)
        self.keep.setToolTip(self.tr("Width and height change together"))
        self.keep.setChecked(True)
        self.transparent = QCheckBox(self.tr("Transparent background"), self)
        self.transparent.setToolTip(self.tr("Only the volume; PNG and TIFF keep the transparency"))
        self.pixel_width.valueChanged.connect(self._on_width)
        self.pixel_height.valueChanged.connect(self._on_height)

        sizes = QHBoxLayout()
        sizes.setSpacing(8)
        sizes.addWidget(self.pixel_width, 1)
        sizes.addWidget(QLabel("×", self))
        sizes.addWidget(self.pixel_height, 1)
        quick = QHBoxLayout()
        quick.setSpacing(4)
        for factor in FACTORS:
            button = QPushButton(f"{factor}×", self)
            button.setToolTip(self.tr("Size of the viewport times %1").replace("%1", str(factor)))
            button.setAutoDefault(False)
            button.clicked.connect(lambda _checked=False, f=factor: self._multiply(f))
            quick.addWidget(button)
        quick.addStretch(1)
        form = QFormLayout()
        form.setHorizontalSpacing(16)
        form.setVerticalSpacing(8)
        form.addRow(self.tr("Size"), sizes)
        form.addRow(self.tr("As shown"), quick)
        form.addRow("", self.keep)
        form.addRow("", self.transparent)
        hint: QLabel = quiet_label(
            self.tr(
                "The volume of the active view is drawn again at this size and at full quality. Box, axes, colour bar "
                "and marker are not in the file; Copy picture keeps them."
            )
        )
        hint.setWordWrap(True)
        buttons = QDialogButtonBox(self)
        save = buttons.addButton(self.tr("Save as…"), QDialogButtonBox.ButtonRole.AcceptRole)
        save.setToolTip(self.tr("Choose a file"))
        buttons.addButton(QDialogButtonBox.StandardButton.Cancel)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(24, 20, 24, 16)
        layout.setSpacing(12)
        layout.addLayout(form)
        layout.addWidget(hint)
        layout.addWidget(buttons)
        self.setMinimumWidth(400)

    @property
    def image_size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.pixel_width.value(), self.pixel_height.value()

    def _length(self) -> QSpinBox:
        field = QSpinBox(self)
        field.setRange(1, LARGEST)
        field.setSuffix(" px")
        field.setToolTip(self.tr("In pixels, at most %1").replace("%1", str(LARGEST)))
        return field

    def _multiply(self, factor: int) -> None:
        self.pixel_width.setValue(min(self._shown[0] * factor, LARGEST))
        self.pixel_height.setValue(min(self._shown[1] * factor, LARGEST))

    def _on_width(self, width: int) -> None:
        if self.keep.isChecked():
            with QSignalBlocker(self.pixel_height):
                self.pixel_height.setValue(round(width * self._shown[1] / self._shown[0]))

    def _on_height(self, height: int) -> None:
        if self.keep.isChecked():
            with QSignalBlocker(self.pixel_width):
                self.pixel_width.setValue(round(height * self._shown[0] / self._shown[1]))
