"""Moving and turning a layer in the world, seen in the picture at once."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QDoubleSpinBox,
    QGridLayout,
    QLabel,
    QVBoxLayout,
    QWidget,
)

from volviz.model.layers import Transform
from volviz.model.placement import Placement
from volviz.volume_data.volume import Volume

FARTHEST = 1e6


class PlaceLayerDialog(QDialog):
    """Three lengths and three angles; none of them leaves the layer where its file says.

    Attributes
    ----------
    transform_changed : signal (object)
        Another matrix, None for none.
    """

    transform_changed = Signal(object)

    def __init__(
        self, name: str, volume: Volume, transform: Transform | None, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        tr = self.tr
        self.setWindowTitle(tr("Place of %1").replace("%1", name))
        self._center = volume.center
        self._placement = Placement.of(transform, volume.center)
        unit = str(volume.metadata.get("length_unit") or "mm")
        grid = QGridLayout()
        grid.setHorizontalSpacing(8)
        self.fields: list[QDoubleSpinBox] = []
        for row, (words, suffix, values, limit, step) in enumerate(
            (
                (tr("Move along"), f" {unit}", self._placement.move, FARTHEST, max(volume.extent) / 100),
                (tr("Turn about"), "°", self._placement.turn, 360.0, 1.0),
            )
        ):
            for axis, (letter, value) in enumerate(zip("xyz", values, strict=True)):
                field = QDoubleSpinBox(self)
                field.setDecimals(3)
                field.setRange(-limit, limit)
                field.setSingleStep(step)
                field.setKeyboardTracking(False)
                field.setSuffix(suffix)
                field.setValue(value)
                field.setAccessibleName(f"{words} {letter}")
                field.valueChanged.connect(self._on_changed)
                label = QLabel(f"{words} {letter}", self)
                label.setBuddy(field)
                grid.addWidget(label, axis, 2 * row)
                grid.addWidget(field, axis, 2 * row + 1)
                self.fields.append(field)
        said = QLabel(
            tr(
                "x points to the left of a patient, y to the back, z upwards; turns go about the middle of the layer."
            ),
            self,
        )
        said.setWordWrap(True)
        said.setProperty("quiet", True)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close, self)
        self.reset = buttons.addButton(tr("Back to the file's place"), QDialogButtonBox.ButtonRole.ResetRole)
        self.reset.clicked.connect(self._on_reset)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addLayout(grid)
        column.addWidget(said)
        column.addWidget(buttons)

    def _on_changed(self) -> None:
        x, y, z, u, v, w = (field.value() for field in self.fields)
        self._placement = replace(self._placement, move=(x, y, z), turn=(u, v, w))
        self.transform_changed.emit(self._placement.transform(self._center))

    def _on_reset(self) -> None:
        self._placement = Placement()
        for field in self.fields:
            field.blockSignals(True)
            field.setValue(0.0)
            field.blockSignals(False)
        self.transform_changed.emit(None)
