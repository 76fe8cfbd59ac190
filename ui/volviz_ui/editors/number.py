"""Numbers: a slider for the usual range beside a field that takes every accepted value."""

from __future__ import annotations

import math
from typing import Any

from PySide6.QtCore import QEvent, QObject, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QHideEvent, QValidator, QWheelEvent
from PySide6.QtWidgets import QDoubleSpinBox, QHBoxLayout, QSlider, QWidget

from volviz.model.parameters import Parameter
from volviz_ui.editors.base import Editor, tooltip_of

STEPS = 1000
LONGEST_UNIT = 8
"""Characters of a unit that find room in a field."""
COUNTED = ("voxels", "steps", "pixels")
"""Units of which there can be one."""
FIELD_WIDTH = 96


class NoWheelSlider(QSlider):
    """A slider that leaves the wheel to the panel it scrolls with, unless it has the focus."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(Qt.Orientation.Horizontal, parent)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMinimumWidth(56)

    def hideEvent(self, event: QHideEvent) -> None:
        """Let go: a slider that is not seen does not hear that the button is up."""
        self.setSliderDown(False)
        super().hideEvent(event)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Scroll the panel when the slider is only under the pointer."""
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()


class NumberField(QDoubleSpinBox):
    """A field that shows as many digits as the number needs and keeps the unit behind it."""

    def __init__(self, *, whole: bool = False, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._whole = whole
        self.setDecimals(0 if whole else 9)
        self.setKeyboardTracking(False)
        self.setAccelerated(True)
        self.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        # all of one width, so that sliders beside them line up
        self.setFixedWidth(FIELD_WIDTH)
        self._unit: str | None = None
        self.valueChanged.connect(self._show_unit)

    def set_unit(self, unit: str) -> None:
        """Show a unit behind the number; one that is too long for that is left to the tooltip."""
        self._unit = unit if len(unit) <= LONGEST_UNIT else ""
        self._show_unit()

    def setValue(self, value: float) -> None:
        """Show another value."""
        super().setValue(value)
        self._show_unit()

    def _show_unit(self) -> None:
        if self._unit is None:
            return  # whoever made the field has given it a suffix, or none
        one = self.value() == 1 and self._unit in COUNTED
        unit = self._unit.removesuffix("s") if one else self._unit
        suffix = f" {unit}" if unit else ""
        if suffix != self.suffix():
            self.setSuffix(suffix)

    def textFromValue(self, value: float) -> str:
        """Four significant digits are enough to read; the full value is kept."""
        if self._whole:
            return str(round(value))
        return f"{value:.4g}" if abs(value) < 1e5 else f"{value:.6g}"

    def valueFromText(self, text: str) -> float:
        """Points and commas both separate decimals; an untouched text stands for all digits of the value."""
        if text.removesuffix(self.suffix()).strip() == self.textFromValue(self.value()):
            return self.value()
        return float(self._number(text) or 0.0)

    def validate(self, text: str, pos: int) -> object:
        """Anything that is, or may become, a number."""
        number = self._number(text)
        if number is not None:
            inside = self.minimum() <= number <= self.maximum()
            return (QValidator.State.Acceptable if inside else QValidator.State.Intermediate), text, pos
        allowed = set("0123456789.,-+eE ") | set(self.suffix())
        state = QValidator.State.Intermediate if set(text) <= allowed else QValidator.State.Invalid
        return state, text, pos

    def fixup(self, text: str) -> str:
        """A number outside the limits becomes the nearest one inside."""
        number = self._number(text)
        if number is None:
            return self.textFromValue(self.value())
        return repr(min(max(number, self.minimum()), self.maximum()))

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Scroll the panel when the field is only under the pointer."""
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()

    def stepBy(self, steps: int) -> None:
        """One step of the last but one digit shown, so that small numbers take small steps."""
        if self._whole:
            super().stepBy(steps)
            return
        size = abs(self.value())
        step = 10 ** math.floor(math.log10(size) - 1e-9) / 10 if size > 0 else self.singleStep()
        self.setValue(round(self.value() + steps * step, 12))

    def _number(self, text: str) -> float | None:
        body = text.removesuffix(self.suffix()).strip().replace(",", ".")
        try:
            number = float(body)
        except ValueError:
            return None
        return number if math.isfinite(number) else None


class Scale:
    """Between a slider's positions 0..STEPS and values, linear or by factors."""

    def __init__(self, low: float, high: float, *, logarithmic: bool = False, whole: bool = False) -> None:
        if logarithmic and low <= 0:
            logarithmic = False
        self.low, self.high, self.logarithmic, self.whole = low, high, logarithmic, whole

    def value(self, position: int) -> float:
        """Value at a position; rounded so that what a slider gives reads well."""
        t = position / STEPS
        if self.logarithmic:
            value = self.low * (self.high / self.low) ** t
            value = float(f"{value:.3g}")
        else:
            value = self.low + (self.high - self.low) * t
            digits = 3 - math.floor(math.log10(self.high - self.low)) if self.high > self.low else 3
            value = round(value, max(digits, 0))
        value = min(max(value, self.low), self.high)
        return float(round(value)) if self.whole else value

    def position(self, value: float) -> int:
        """Position nearest to a value."""
        value = min(max(value, self.low), self.high)
        if self.high <= self.low:
            return 0
        if self.logarithmic:
            return round(STEPS * math.log(value / self.low) / math.log(self.high / self.low))
        return round(STEPS * (value - self.low) / (self.high - self.low))


class SliderField(QWidget):
    """Slider and field for one number; the building block of the number, vector and crop editors."""

    value_changed = Signal(float)
    gesture_started = Signal()
    gesture_finished = Signal()

    def __init__(
        self,
        scale: Scale,
        *,
        minimum: float,
        maximum: float,
        unit: str = "",
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.scale = scale
        self._value = scale.low
        self.slider = NoWheelSlider(self)
        self.slider.setRange(0, STEPS)
        self.slider.setPageStep(STEPS // 10)
        self.slider.setSingleStep(max(1, STEPS // 100))
        if scale.whole and 0 < scale.high - scale.low <= STEPS:
            self.slider.setSingleStep(max(1, math.ceil(STEPS / (scale.high - scale.low))))
        self.field = NumberField(whole=scale.whole, parent=self)
        self.field.setRange(minimum, maximum)
        self.field.setSingleStep((scale.high - scale.low) / 100 or 1.0)
        if scale.whole:
            self.field.setSingleStep(1)
        if unit:
            self.field.set_unit(unit)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(8)
        layout.addWidget(self.slider, 1)
        layout.addWidget(self.field)
        self.setFocusProxy(self.slider)
        self.slider.valueChanged.connect(self._on_slider)
        self.slider.sliderPressed.connect(self.gesture_started)
        self.slider.sliderReleased.connect(self.gesture_finished)
        self.field.valueChanged.connect(self._on_field)

    @property
    def value(self) -> float:
        """The number shown."""
        return self._value

    def set_value(self, value: float) -> None:
        """Show a number; the slider stands still when it is the one that gave it."""
        self._value = value
        with QSignalBlocker(self.field):
            self.field.setValue(value)
        if self.scale.value(self.slider.value()) != value:
            with QSignalBlocker(self.slider):
                self.slider.setValue(self.scale.position(value))

    def _on_slider(self, position: int) -> None:
        self._take(self.scale.value(position))

    def _on_field(self, value: float) -> None:
        self._take(value)

    def _take(self, value: float) -> None:
        if value != self._value:
            self.set_value(value)
            self.value_changed.emit(value)


class NumberEditor(Editor):
    """A real or whole number."""

    def __init__(self, parameter: Parameter, parent: QWidget | None = None) -> None:
        super().__init__(parameter, parent)
        whole = parameter.kind == "int"
        low, high = slider_range(parameter)
        limit = 2**31 - 1 if whole else 1e12
        self.control = SliderField(
            Scale(low, high, logarithmic=parameter.logarithmic, whole=whole),
            minimum=-limit if parameter.minimum is None else parameter.minimum,
            maximum=limit if parameter.maximum is None else parameter.maximum,
            unit=parameter.unit,
            parent=self,
        )
        for part in (self.control.slider, self.control.field):
            part.setToolTip(tooltip_of(parameter))
            part.setAccessibleName(parameter.label)
        self.control.slider.installEventFilter(self)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.control)
        self.setFocusProxy(self.control)
        self._whole = whole
        self.control.value_changed.connect(self._on_value)
        self.control.gesture_started.connect(self.gesture_started)
        self.control.gesture_finished.connect(self.gesture_finished)

    def set_value(self, value: Any) -> None:
        """Show a number."""
        self.control.set_value(float(value))

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Double-click on the slider brings the default back."""
        if event.type() == QEvent.Type.MouseButtonDblClick and self.parameter.default is not None:
            self.control.set_value(float(self.parameter.default))
            self._on_value(float(self.parameter.default))
            return True
        return super().eventFilter(watched, event)

    def _on_value(self, value: float) -> None:
        self.value_changed.emit(int(value) if self._whole else value)


def slider_range(parameter: Parameter) -> tuple[float, float]:
    """The range of a setting's slider, from its usual or its accepted values."""
    default = float(parameter.default) if isinstance(parameter.default, (int, float)) else 0.0
    low = _first(parameter.soft_minimum, parameter.minimum, min(0.0, default * 2))
    high = _first(parameter.soft_maximum, parameter.maximum, max(abs(default) * 4, low + 1))
    return low, max(high, low)


def _first(*values: float | None) -> float:
    return float(next(v for v in values if v is not None))
