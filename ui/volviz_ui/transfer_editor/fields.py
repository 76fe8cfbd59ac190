"""Number fields and colour of what is chosen, and the overall opacity."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, QObject, QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QPainter, QPaintEvent, QPalette, QPen
from PySide6.QtWidgets import (
    QColorDialog,
    QGridLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QWidget,
)

from volviz.model.transfer import edits
from volviz.model.transfer.channels import with_moved_point
from volviz_ui.editors.number import NoWheelSlider, NumberField
from volviz_ui.transfer_editor.painting import color_of

if TYPE_CHECKING:
    from volviz_ui.transfer_editor.model import EditorModel

WIDTH = 212


class Swatch(QPushButton):
    """A button that shows a colour."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.color: QColor | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def sizeHint(self) -> QSize:
        """As high as a field."""
        return QSize(92, 26)

    def set_color(self, color: QColor | None) -> None:
        """Show a colour, or none when several differ."""
        self.color = color
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        """The button with the colour on it."""
        super().paintEvent(event)
        if self.color is None or not self.isEnabled():
            return
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(self.palette().color(QPalette.ColorRole.Mid), 1))
        painter.setBrush(self.color)
        painter.drawRoundedRect(self.rect().adjusted(5, 5, -5, -5), 3, 3)


class Fields(QWidget):
    """Value, opacity and colour of the chosen points; overall opacity of the function."""

    color_requested = Signal()

    def __init__(self, model: EditorModel, parent: QWidget) -> None:
        super().__init__(parent)
        self._model = model
        self._dialog: QColorDialog | None = None
        self._cancelled = False
        self.caption = QLabel(self)
        self.caption.setProperty("quiet", True)
        self.value = NumberField(parent=self)
        self.value.setRange(-1e300, 1e300)
        self.opacity = NumberField(parent=self)
        self.opacity.setRange(0.0, 1.0)
        self.opacity.setSingleStep(0.01)
        self.swatch = Swatch(self)
        self.overall = NoWheelSlider(self)
        self.overall.setRange(0, 1000)
        self.overall.setPageStep(100)
        self.overall.setSingleStep(10)
        self.percent = QLabel(self)
        self.percent.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.percent.setMinimumWidth(self.percent.fontMetrics().horizontalAdvance("100 %"))
        rows = (
            (self.tr("&Value"), self.value, self.tr("Value of the chosen point, in the unit of the data")),
            (
                self.tr("&Opacity"),
                self.opacity,
                self.tr("Opacity of the chosen points, 0 to 1, for one unit distance"),
            ),
            (self.tr("&Colour"), self.swatch, self.tr("Colour of the chosen points (C)")),
        )
        grid = QGridLayout(self)
        grid.setContentsMargins(8, 2, 0, 2)
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(4)
        grid.addWidget(self.caption, 0, 0, 1, 2)
        for row, (text, field, tip) in enumerate(rows, start=1):
            label = QLabel(text, self)
            label.setBuddy(field)
            field.setToolTip(tip)
            label.setToolTip(tip)
            field.setAccessibleName(text.replace("&", ""))
            field.setMaximumWidth(16777215)
            grid.addWidget(label, row, 0)
            grid.addWidget(field, row, 1)
        tip = self.tr("Factor on all opacities: thins the whole picture out without changing the curve")
        label = QLabel(self.tr("Ov&erall"), self)
        label.setBuddy(self.overall)
        label.setToolTip(tip)
        self.overall.setToolTip(tip)
        self.overall.setAccessibleName(self.tr("Overall opacity"))
        self.percent.setToolTip(tip)
        grid.addWidget(label, 4, 0)
        strip = QGridLayout()
        strip.setSpacing(4)
        strip.addWidget(self.overall, 0, 0)
        strip.addWidget(self.percent, 0, 1)
        grid.addLayout(strip, 4, 1)
        grid.setColumnStretch(1, 1)
        grid.setRowStretch(5, 1)
        self.setFixedWidth(WIDTH)
        self.value.valueChanged.connect(self._on_value)
        self.opacity.valueChanged.connect(self._on_opacity)
        self.swatch.clicked.connect(self.choose_color)
        self.overall.sliderPressed.connect(model.begin)
        self.overall.sliderReleased.connect(model.finish)
        self.overall.valueChanged.connect(self._on_overall)
        self.overall.installEventFilter(self)
        model.function_changed.connect(self.refresh)
        model.selection_changed.connect(self.refresh)
        model.range_changed.connect(self.refresh)
        self.refresh()

    def refresh(self) -> None:
        """Show what is chosen."""
        model = self._model
        function = model.function
        chosen = sorted(model.selection)
        color_point = (
            model.color_point
            if model.color_point is not None and model.color_point < len(model.channels[0])
            else None
        )
        self.setEnabled(function is not None)
        for field, there in (
            (self.value, bool(chosen) or color_point is not None),
            (self.opacity, bool(chosen)),
            (self.swatch, bool(chosen) or color_point is not None),
        ):
            field.setEnabled(there)
        self.value.set_unit(model.unit)
        if function is None:
            self.caption.setText("")
            return
        colors = {function.points[i].color for i in chosen}
        if color_point is not None:
            self.caption.setText(
                self.tr("Colour %1 of %2")
                .replace("%1", str(color_point + 1))
                .replace("%2", str(len(model.channels[0])))
            )
            self._show(self.value, model.channels[0][color_point].value)
            self.swatch.set_color(color_of(model.channels[0][color_point].level))
        elif chosen:
            words = self.tr("Point %1 of %2") if len(chosen) == 1 else self.tr("%1 points of %2")
            first = str(chosen[0] + 1) if len(chosen) == 1 else str(len(chosen))
            self.caption.setText(words.replace("%1", first).replace("%2", str(len(function.points))))
            self._show(self.value, function.points[chosen[0]].value)
            self._show(self.opacity, function.points[chosen[0]].opacity)
            self.swatch.set_color(color_of(next(iter(colors))) if len(colors) == 1 else None)
        else:
            words = self.tr("%1 points, none chosen").replace("%1", str(len(function.points)))
            self.caption.setText(words)
            self.swatch.set_color(None)
        if color_point is not None or not chosen:
            self.opacity.clear()
        if color_point is None and not chosen:
            self.value.clear()
        with QSignalBlocker(self.overall):
            if not self.overall.isSliderDown():
                self.overall.setValue(round(function.opacity * 1000))
        self.percent.setText(f"{function.opacity * 100:.0f} %")

    def choose_color(self) -> None:
        """Open the colour dialog; the image follows while it is open, Cancel takes everything back."""
        model = self._model
        if (
            model.function is None
            or not (model.selection or model.color_point is not None)
            or self._dialog is not None
        ):
            return
        self._dialog = dialog = QColorDialog(self.swatch.color or QColor("white"), self)
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

    def _on_color(self, color: QColor) -> None:
        if color.isValid():
            self._model.color_selected((color.redF(), color.greenF(), color.blueF()))

    def _on_value(self, value: float) -> None:
        model, function = self._model, self._model.function
        if function is None:
            return
        if model.color_point is not None:
            colors, opacities = model.channels
            model.apply_channels(
                with_moved_point(colors, model.color_point, value), opacities, self.tr("Move colour")
            )
        elif model.selection:
            offset = value - function.points[min(model.selection)].value
            model.apply(edits.moved(function, model.selection, offset), self.tr("Change value"))
        # Neighbours may have held it back.
        self.refresh()

    def _on_opacity(self, opacity: float) -> None:
        function = self._model.function
        if function is not None:
            for i in self._model.selection:
                function = function.with_changed_point(i, opacity=opacity)
            self._model.apply(function, self.tr("Change opacity"))

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Escape takes a drag of the slider back."""
        if (
            isinstance(event, QKeyEvent)
            and event.type() == QEvent.Type.KeyPress
            and event.key() == Qt.Key.Key_Escape
            and self.overall.isSliderDown()
        ):
            self._cancelled = True
            self._model.cancel()
            self.overall.setSliderDown(False)
            self.refresh()
            return True
        if event.type() == QEvent.Type.MouseButtonRelease:
            self._cancelled = False
        return super().eventFilter(watched, event)

    def _on_overall(self, position: int) -> None:
        if self._cancelled:
            # the button is still down, but nothing is being dragged any more
            self.refresh()
            return
        function = self._model.function
        if function is not None:
            self._model.apply(function.with_opacity(position / 1000.0), self.tr("Overall opacity"))

    @staticmethod
    def _show(field: NumberField, value: float) -> None:
        with QSignalBlocker(field):
            field.setValue(value)
