"""Shape, colour, opacity and softness of the chosen region."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QColorDialog, QComboBox, QGridLayout, QLabel, QWidget

from volviz.model.transfer.function_2d import KINDS
from volviz_ui.editors.number import NumberField
from volviz_ui.transfer_editor.fields import WIDTH, Swatch
from volviz_ui.transfer_editor.painting import color_of

if TYPE_CHECKING:
    from volviz_ui.transfer_editor.plot_2d import GradientPlot


class RegionFields(QWidget):
    """Fields of the chosen region of the two-dimensional function."""

    def __init__(self, plot: GradientPlot, parent: QWidget) -> None:
        super().__init__(parent)
        self._plot = plot
        self._dialog: QColorDialog | None = None
        self.caption = QLabel(self)
        self.caption.setProperty("quiet", True)
        self.kind = QComboBox(self)
        names = {
            "rectangle": self.tr("Rectangle"),
            "ellipse": self.tr("Ellipse"),
            "triangle": self.tr("Triangle"),
        }
        for kind in KINDS:
            self.kind.addItem(names[kind], kind)
        self.opacity = NumberField(parent=self)
        self.softness = NumberField(parent=self)
        for field in (self.opacity, self.softness):
            field.setRange(0.0, 1.0)
            field.setSingleStep(0.01)
            field.setMaximumWidth(16777215)
        self.swatch = Swatch(self)
        grid = QGridLayout(self)
        grid.setContentsMargins(8, 2, 0, 2)
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(4)
        grid.addWidget(self.caption, 0, 0, 1, 2)
        rows: tuple[tuple[str, QWidget, str], ...] = (
            (self.tr("&Shape"), self.kind, self.tr("Shape of the chosen region")),
            (self.tr("&Opacity"), self.opacity, self.tr("Opacity in the middle of the region, 0 to 1")),
            (
                self.tr("So&ftness"),
                self.softness,
                self.tr("0: hard edge, 1: the opacity falls from the middle on"),
            ),
            (self.tr("&Colour"), self.swatch, self.tr("Colour of the chosen region (C)")),
        )
        for row, (text, widget, tip) in enumerate(rows, start=1):
            label = QLabel(text, self)
            label.setBuddy(widget)
            label.setToolTip(tip)
            widget.setToolTip(tip)
            widget.setAccessibleName(text.replace("&", ""))
            grid.addWidget(label, row, 0)
            grid.addWidget(widget, row, 1)
        grid.setColumnStretch(1, 1)
        grid.setRowStretch(5, 1)
        self.setFixedWidth(WIDTH)
        self.kind.activated.connect(self._on_kind)
        self.opacity.valueChanged.connect(lambda v: plot.change(self.tr("Change opacity"), opacity=v))
        self.softness.valueChanged.connect(lambda v: plot.change(self.tr("Change softness"), softness=v))
        self.swatch.clicked.connect(self.choose_color)
        plot.color_requested.connect(self.choose_color)
        plot.selection_changed.connect(self.refresh)
        self.refresh()

    def refresh(self) -> None:
        """Show the chosen region."""
        region, count = self._plot.region, len(self._plot.function.regions)
        for widget in (self.kind, self.opacity, self.softness, self.swatch):
            widget.setEnabled(region is not None)
        if region is None:
            self.caption.setText(self.tr("%1 regions, none chosen").replace("%1", str(count)))
            self.swatch.set_color(None)
            return
        words = self.tr("Region %1 of %2").replace("%1", str((self._plot.selected or 0) + 1))
        self.caption.setText(words.replace("%2", str(count)))
        self.kind.setCurrentIndex(KINDS.index(region.kind))
        for field, value in ((self.opacity, region.opacity), (self.softness, region.softness)):
            with QSignalBlocker(field):
                field.setValue(value)
        self.swatch.set_color(color_of(region.color))

    def choose_color(self) -> None:
        """Open the colour dialog; the image follows, Cancel takes everything back."""
        region, model = self._plot.region, self._plot.model
        if region is None or self._dialog is not None:
            return
        self._dialog = dialog = QColorDialog(color_of(region.color), self)
        dialog.setWindowTitle(self.tr("Colour"))
        dialog.setOption(QColorDialog.ColorDialogOption.DontUseNativeDialog)
        dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        model.begin()
        dialog.currentColorChanged.connect(self._on_color)
        dialog.accepted.connect(model.finish)
        dialog.rejected.connect(model.cancel)
        dialog.finished.connect(self._on_dialog_finished)
        dialog.open()

    def _on_dialog_finished(self) -> None:
        self._dialog = None

    def _on_kind(self) -> None:
        self._plot.change(self.tr("Change shape"), kind=self.kind.currentData())

    def _on_color(self, color: QColor) -> None:
        if color.isValid():
            rgb = (color.redF(), color.greenF(), color.blueF())
            self._plot.change(self.tr("Change colour"), color=rgb)
