"""Editors of yes or no, one of several, colours, vectors and anything that is written as text."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QSignalBlocker, QSize, Qt
from PySide6.QtGui import QColor, QIcon, QPainter, QPalette, QPixmap, QWheelEvent
from PySide6.QtWidgets import (
    QCheckBox,
    QColorDialog,
    QComboBox,
    QFileDialog,
    QHBoxLayout,
    QLineEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from volviz.errors import VolvizError
from volviz.model.parameters import Parameter
from volviz_ui.editors.base import Editor, tooltip_of
from volviz_ui.editors.number import NumberField

QWIDGETSIZE_MAX = 16777215
"""Qt's own limit, which PySide6 does not name."""


class NoWheelComboBox(QComboBox):
    """A list that the wheel changes only with the focus, and that may be narrower than its longest entry."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.setMinimumContentsLength(8)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Scroll the panel when the list is only under the pointer."""
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()


class BoolEditor(Editor):
    """A check box."""

    def __init__(self, parameter: Parameter, parent: QWidget | None = None) -> None:
        super().__init__(parameter, parent)
        self.control = QCheckBox(self)
        self.control.setToolTip(tooltip_of(parameter))
        self.control.setAccessibleName(parameter.label)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.control, 1)
        self.setFocusProxy(self.control)
        self.control.toggled.connect(lambda on: self.value_changed.emit(bool(on)))

    def set_value(self, value: Any) -> None:
        """Show yes or no."""
        with QSignalBlocker(self.control):
            self.control.setChecked(bool(value))


class ChoiceEditor(Editor):
    """A list of words."""

    def __init__(self, parameter: Parameter, parent: QWidget | None = None) -> None:
        super().__init__(parameter, parent)
        self.control = NoWheelComboBox(self)
        for value, label in parameter.choices:
            self.control.addItem(label, value)
        self.control.setToolTip(tooltip_of(parameter))
        self.control.setAccessibleName(parameter.label)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.control, 1)
        self.setFocusProxy(self.control)
        self.control.currentIndexChanged.connect(self._on_index)

    def set_value(self, value: Any) -> None:
        """Show one of the choices."""
        with QSignalBlocker(self.control):
            self.control.setCurrentIndex(self.control.findData(value))

    def _on_index(self, index: int) -> None:
        if index >= 0:
            self.value_changed.emit(self.control.itemData(index))


class ColorButton(QPushButton):
    """A button that shows a colour and opens the colour dialog."""

    def __init__(self, parent: QWidget | None = None, *, with_name: bool = True) -> None:
        super().__init__(parent)
        self.color = QColor("white")
        self._with_name = with_name
        self.setIconSize(QSize(40 if with_name else 28, 14))
        self._show()

    def set_color(self, color: QColor) -> None:
        """Show a colour."""
        self.color = color
        self._show()

    def _show(self) -> None:
        ratio = self.devicePixelRatioF()
        pixmap = QPixmap(self.iconSize() * ratio)
        pixmap.setDevicePixelRatio(ratio)
        pixmap.fill(Qt.GlobalColor.transparent)
        painter = QPainter(pixmap)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(self.palette().color(QPalette.ColorRole.Mid))
        painter.setBrush(self.color)
        size = self.iconSize()
        painter.drawRoundedRect(0, 0, size.width() - 1, size.height() - 1, 3, 3)
        painter.end()
        self.setIcon(QIcon(pixmap))
        if self._with_name:
            self.setText(self.color.name())


class ColorEditor(Editor):
    """A colour, three floats in 0..1."""

    def __init__(self, parameter: Parameter, parent: QWidget | None = None) -> None:
        super().__init__(parameter, parent)
        self.control = ColorButton(self)
        self.control.setToolTip(tooltip_of(parameter))
        self.control.setAccessibleName(parameter.label)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.control)
        layout.addStretch(1)
        self.setFocusProxy(self.control)
        self.control.clicked.connect(self._choose)

    def set_value(self, value: Any) -> None:
        """Show a colour."""
        self.control.set_color(QColor.fromRgbF(*value))

    def _choose(self) -> None:
        color = chosen_color(self, self.control.color, self.parameter.label)
        if color is not None:
            self.control.set_color(color)
            self.value_changed.emit((color.redF(), color.greenF(), color.blueF()))


def chosen_color(parent: QWidget, color: QColor, title: str) -> QColor | None:
    """Ask for a colour; None when the user does not want another one."""
    dialog = QColorDialog(color, parent)
    dialog.setWindowTitle(title)
    chosen = dialog.selectedColor() if dialog.exec() else None
    dialog.deleteLater()
    return chosen


class VectorEditor(Editor):
    """Three numbers (x, y, z)."""

    wide = True

    def __init__(self, parameter: Parameter, parent: QWidget | None = None) -> None:
        super().__init__(parameter, parent)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        self.fields = [NumberField(parent=self) for _ in range(3)]
        for axis, field in zip("xyz", self.fields, strict=True):
            field.setRange(-1e9, 1e9)
            field.setPrefix(f"{axis} ")
            field.setMinimumWidth(60)
            field.setMaximumWidth(QWIDGETSIZE_MAX)
            field.setToolTip(tooltip_of(parameter))
            field.setAccessibleName(f"{parameter.label} {axis}")
            field.valueChanged.connect(self._on_value)
            layout.addWidget(field, 1)
        self.setFocusProxy(self.fields[0])

    def set_value(self, value: Any) -> None:
        """Show a vector."""
        for field, number in zip(self.fields, value, strict=True):
            with QSignalBlocker(field):
                field.setValue(float(number))

    def _on_value(self) -> None:
        self.value_changed.emit(tuple(field.value() for field in self.fields))


class TextEditor(Editor):
    """Anything that `Parameter.parse` understands, written as text; what does not fit is said below."""

    wide = True

    def __init__(self, parameter: Parameter, parent: QWidget | None = None) -> None:
        super().__init__(parameter, parent)
        self.control = QLineEdit(self)
        self.control.setToolTip(tooltip_of(parameter))
        self.control.setAccessibleName(parameter.label)
        self._action = self.control.addAction(QIcon(), QLineEdit.ActionPosition.TrailingPosition)
        self._action.setVisible(False)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.control)
        self.setFocusProxy(self.control)
        self._value: Any = None
        self.control.editingFinished.connect(self._on_finished)

    def set_value(self, value: Any) -> None:
        """Show a value in the form in which it can be typed."""
        self._value = value
        with QSignalBlocker(self.control):
            self.control.setText(written(value))
        self._action.setVisible(False)

    def _on_finished(self) -> None:
        from volviz_ui.style.icons import icon

        try:
            value = self.parameter.parse(self.control.text())
        except VolvizError as error:
            self._action.setIcon(icon("warning", "warning"))
            self._action.setToolTip(str(error))
            self._action.setVisible(True)
            return
        self._action.setVisible(False)
        if value != self._value:
            self._value = value
            self.value_changed.emit(value)


class PathEditor(Editor):
    """The path of a file, with a button that asks for it."""

    wide = True

    def __init__(self, parameter: Parameter, parent: QWidget | None = None) -> None:
        super().__init__(parameter, parent)
        self.control = QLineEdit(self)
        self.control.setToolTip(tooltip_of(parameter))
        self.control.setAccessibleName(parameter.label)
        self.browse = QPushButton(self.tr("Browse…"), self)
        self.browse.setToolTip(self.tr("Choose a file"))
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addWidget(self.control, 1)
        layout.addWidget(self.browse)
        self.setFocusProxy(self.control)
        self._value = ""
        self.control.editingFinished.connect(lambda: self._take(self.control.text().strip()))
        self.browse.clicked.connect(self._ask)

    def set_value(self, value: Any) -> None:
        """Show a path."""
        self._value = str(value or "")
        self.control.setText(self._value)

    def _ask(self) -> None:
        path, _filter = QFileDialog.getOpenFileName(self, self.parameter.label, self._value)
        if path:
            self._take(path)

    def _take(self, path: str) -> None:
        if path != self._value:
            self.set_value(path)
            self.value_changed.emit(path or self.parameter.default)


def written(value: Any) -> str:
    """A value as `Parameter.parse` reads it: numbers with commas, rows with semicolons."""
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if isinstance(value, (tuple, list)):
        if value and isinstance(value[0], (tuple, list)):
            return "; ".join(written(row) for row in value)
        return ", ".join(written(part) for part in value)
    return f"{value:g}" if isinstance(value, float) else str(value)
