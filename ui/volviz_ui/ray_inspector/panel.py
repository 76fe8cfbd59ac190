"""The panel of the ray inspector: which pixel, what became of its ray, the plot, one sample in words."""

from __future__ import annotations

from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPalette, QPen
from PySide6.QtWidgets import QHBoxLayout, QLabel, QSizePolicy, QSpinBox, QVBoxLayout, QWidget

from volviz.ray_inspection import RayInspection
from volviz_ui.ray_inspector import words
from volviz_ui.ray_inspector.plot import RayPlot
from volviz_ui.transfer_editor.painting import small_font
from volviz_ui.widgets.small import quiet_label, small_button

LARGEST_PIXEL = 32767


class Swatch(QWidget):
    """The colour of the pixel as it was gathered, over a checkered ground that shows how dense it is."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.color: tuple[float, float, float, float] | None = None
        self.setFixedSize(40, 22)
        self.setAccessibleName(self.tr("Colour of the ray"))

    def show_color(self, premultiplied: tuple[float, float, float, float] | None) -> None:
        """Show a premultiplied colour, or none."""
        self.color = premultiplied
        words_ = ""
        if premultiplied is not None:
            red, green, blue, alpha = premultiplied
            words_ = f"{red:.3f}, {green:.3f}, {blue:.3f}, {alpha:.3f}"
            self.setToolTip(
                self.tr("Gathered red, green, blue (multiplied by opacity) and opacity: %1").replace(
                    "%1", words_
                )
            )
        self.setAccessibleDescription(words_)
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Squares, the colour over them, a frame."""
        painter = QPainter(self)
        box = QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5)
        painter.fillRect(box, QColor(40, 44, 50))
        for row in range(3):
            for column in range(5):
                if (row + column) % 2:
                    painter.fillRect(QRectF(8 * column, 8 * row, 8, 8).intersected(box), QColor(84, 90, 98))
        if self.color is not None and self.color[3] > 0:
            red, green, blue, alpha = (min(max(c, 0.0), 1.0) for c in self.color)
            straight = (min(c / alpha, 1.0) for c in (red, green, blue))
            painter.fillRect(box, QColor.fromRgbF(*straight, alpha))
        painter.setPen(QPen(self.palette().color(QPalette.ColorRole.Mid), 1.0))
        painter.drawRect(box)


class RayPanel(QWidget):
    """Shows a `RayInspection`; the pixel may be typed as well as clicked.

    Parameters
    ----------
    parent : QWidget, optional
        Owner.
    """

    pixel_entered = Signal(int, int)
    """Column and row that the user has typed, device pixels from the upper left."""
    cleared = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName(self.tr("Ray inspector"))
        self.column, self.row = (
            self._field(self.tr("Column of the pixel")),
            self._field(self.tr("Row of the pixel")),
        )
        self.swatch = Swatch(self)
        self.sentence = QLabel(self)
        self.sentence.setWordWrap(True)
        self.sentence.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.sentence.setToolTip(self.tr("Where the ray ends, and why"))
        self.clear_button = small_button("x-circle", self.tr("Forget the ray and its mark"), self)
        self.clear_button.clicked.connect(self.cleared)
        self.plot = RayPlot(self)
        self.setFocusProxy(self.plot)
        self.sample = QLabel(self)
        self.sample.setToolTip(self.tr("The sample under the pointer, or chosen with the arrow keys"))
        self.sample.setMinimumWidth(1)
        self.note = quiet_label(parent=self)
        self.note.setWordWrap(True)
        for label in (self.sentence, self.sample, self.note):
            label.setFont(small_font(self.font()))
        label = QLabel(self.tr("&Pixel"), self)
        label.setBuddy(self.column)
        head = QHBoxLayout()
        head.setContentsMargins(0, 0, 0, 0)
        head.setSpacing(6)
        for widget in (label, self.column, self.row, self.swatch):
            head.addWidget(widget)
        head.addWidget(self.sentence, 1)
        head.addWidget(self.clear_button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 4, 8, 6)
        layout.setSpacing(4)
        layout.addLayout(head)
        layout.addWidget(self.plot, 1)
        layout.addWidget(self.sample)
        layout.addWidget(self.note)
        self._typing = True
        for field in (self.column, self.row):
            field.valueChanged.connect(self._on_typed)
        self.plot.sample_chosen.connect(self._show_sample)
        self.show_ray(None, "", "", (0.0, 1.0))

    def sizeHint(self) -> QSize:
        """Beside the transfer function."""
        return QSize(500, 236)

    def minimumSizeHint(self) -> QSize:
        """Room for a plot that can be read."""
        return QSize(420, 176)

    def _field(self, name: str) -> QSpinBox:
        field = QSpinBox(self)
        field.setRange(0, LARGEST_PIXEL)
        field.setKeyboardTracking(False)
        field.setButtonSymbols(QSpinBox.ButtonSymbols.NoButtons)
        field.setFixedWidth(52)
        field.setAlignment(Qt.AlignmentFlag.AlignRight)
        field.setAccessibleName(name)
        field.setToolTip(
            self.tr("%1, counted from the upper left; arrow keys go one further").replace("%1", name)
        )
        return field

    def show_pixel(self, pixel: tuple[int, int]) -> None:
        """Show which pixel is inspected."""
        self._typing = False
        self.column.setValue(pixel[0])
        self.row.setValue(pixel[1])
        self._typing = True

    def show_ray(
        self, found: RayInspection | None, unit: str, length_unit: str, value_range: tuple[float, float]
    ) -> None:
        """Show a ray, or that there is none.

        Parameters
        ----------
        found : RayInspection or None
            The ray.
        unit, length_unit : str
            Of the values, and of lengths in the world.
        value_range : tuple of 2 floats
            Range of the data.
        """
        self.plot.show_ray(found, unit, length_unit, value_range)
        self.clear_button.setEnabled(found is not None)
        if found is None:
            self.swatch.show_color(None)
            self.sentence.setText(self.tr("Click in the picture, or type a pixel"))
            self.note.setText("")
        else:
            red, green, blue, alpha = (float(c) for c in found.profile.color)
            self.swatch.show_color((red, green, blue, alpha))
            self.sentence.setText(words.end_words(found, length_unit, self.tr))
            self.note.setText(" ".join(words.notes(found, self.tr)))
        self.note.setVisible(bool(self.note.text()))
        self._show_sample(self.plot.chosen)

    def _show_sample(self, index: int) -> None:
        found = self.plot.found
        text = self.tr("Point at the plot, or use the arrow keys, to read one sample")
        if found is not None and index >= 0:
            text = words.sample_words(found, index, self.plot.unit, self.plot.length_unit, self.tr)
        self.sample.setText(text)
        self.plot.setAccessibleDescription(text)

    def _on_typed(self) -> None:
        if self._typing:
            self.pixel_entered.emit(self.column.value(), self.row.value())
