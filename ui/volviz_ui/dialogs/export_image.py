"""Exporting the picture: which view, how large, what belongs into it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QSpinBox,
    QWidget,
)

from volviz.model.picture import SWITCHES, PictureContents
from volviz_ui.editors.simple import NoWheelComboBox
from volviz_ui.views.picture_parts import PictureRequest
from volviz_ui.widgets.dialog_layout import lay_out
from volviz_ui.widgets.small import quiet_label

LARGEST = 16384
FACTORS = (1, 2, 4)
SCREEN_DPI, PAPER_DPI = 96.0, 300.0
MM_PER_INCH = 25.4
#: Widths of columns in millimetres, as most journals have them.
ONE_COLUMN, COLUMN_AND_HALF, TWO_COLUMNS = 85.0, 120.0, 178.0


class ExportImageDialog(QDialog):
    """Asks for view, size, background and contents.

    Parameters
    ----------
    views : sequence of (number or None, words)
        What may be drawn: views, and None for all that are seen.
    size_of : callable
        From a number of a view, or None, to its size on the screen in device pixels.
    contents : PictureContents
        What stands around the volume in the window.
    """

    methods_wanted = Signal()
    """A sentence on how the picture is made is to be copied."""

    def __init__(
        self,
        views: Sequence[tuple[int | None, str]],
        size_of: Callable[[int | None], tuple[int, int]],
        contents: PictureContents,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Export picture"))
        self._size_of = size_of
        self._dpi = SCREEN_DPI
        self.view = NoWheelComboBox(self)
        self.view.setToolTip(self.tr("Which view is drawn, or all that are seen as one picture"))
        for number, words in views:
            self.view.addItem(words, number)
        self._shown = size_of(views[0][0])
        self.pixel_width, self.pixel_height = self._length(), self._length()
        self.keep = QCheckBox(self.tr("Keep the proportions of the view"), self)
        self.keep.setToolTip(self.tr("Width and height change together"))
        self.keep.setChecked(True)
        self.transparent = QCheckBox(self.tr("Transparent background"), self)
        self.transparent.setToolTip(
            self.tr("Nothing behind the volume; all formats but JPEG keep the transparency")
        )
        self.session = QCheckBox(self.tr("Say in the file how it was made"), self)
        self.session.setToolTip(
            self.tr(
                "PNG and TIFF files carry the session, with the paths of its volumes but nothing out of their headers. "
                "Dropped on the window, such a picture restores the scene"
            )
        )
        self.session.setChecked(True)
        self.title = QLineEdit(contents.title, self)
        self.title.setPlaceholderText(self.tr("None"))
        self.title.setToolTip(self.tr("A line at the upper edge of the picture"))
        self._set_size(*self._shown)
        self.view.currentIndexChanged.connect(self._on_view)
        self.pixel_width.valueChanged.connect(self._on_width)
        self.pixel_height.valueChanged.connect(self._on_height)
        self.switches = {name: self._switch(name, contents) for name in SWITCHES}
        self._lay_out()

    def _lay_out(self) -> None:
        sizes = QHBoxLayout()
        sizes.setSpacing(8)
        sizes.addWidget(self.pixel_width, 1)
        sizes.addWidget(QLabel("×", self))
        sizes.addWidget(self.pixel_height, 1)
        around = QGridLayout()
        around.setHorizontalSpacing(16)
        around.setVerticalSpacing(4)
        for number, switch in enumerate(self.switches.values()):
            around.addWidget(switch, number // 2, number % 2)
        form = QFormLayout()
        form.setHorizontalSpacing(16)
        form.setVerticalSpacing(8)
        form.addRow(self.tr("Picture of"), self.view)
        form.setRowVisible(self.view, self.view.count() > 1)
        form.addRow(self.tr("Size"), sizes)
        form.addRow(self.tr("For screens"), self._screen_sizes())
        form.addRow(self.tr("For papers"), self._paper_sizes())
        self.printed = quiet_label("", self)
        form.addRow("", self.printed)
        form.addRow("", self.keep)
        form.addRow("", self.transparent)
        form.addRow("", self.session)
        form.addRow(self.tr("Around the volume"), around)
        form.addRow(self.tr("Title"), self.title)
        hint = quiet_label(
            self.tr(
                "The picture is drawn again at this size and at full quality. In SVG and PDF files words and lines "
                "can still be changed."
            )
        )
        hint.setWordWrap(True)
        buttons = QDialogButtonBox(self)
        save = buttons.addButton(self.tr("Save as…"), QDialogButtonBox.ButtonRole.AcceptRole)
        save.setToolTip(self.tr("Choose a file"))
        methods = buttons.addButton(self.tr("Copy methods"), QDialogButtonBox.ButtonRole.ActionRole)
        methods.setToolTip(self.tr("Put a sentence for the methods section of a paper on the clipboard"))
        methods.clicked.connect(self.methods_wanted)
        buttons.addButton(QDialogButtonBox.StandardButton.Cancel)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        lay_out(self, form, hint, buttons)
        self.setMinimumWidth(440)
        self._show_printed()

    # ------------------------------------------------------------------ what was chosen

    @property
    def image_size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.pixel_width.value(), self.pixel_height.value()

    @property
    def request(self) -> PictureRequest:
        """The picture that is asked for."""
        names = [name for name, switch in self.switches.items() if switch.isChecked()]
        return PictureRequest(
            self.image_size,
            self.transparent.isChecked(),
            PictureContents.of(names, self.title.text().strip()),
            self.view.currentData(),
            self._dpi,
            self.session.isChecked(),
        )

    # ------------------------------------------------------------------ parts

    def _switch(self, name: str, contents: PictureContents) -> QCheckBox:
        words = {
            "box": self.tr("Box"),
            "axes": self.tr("Axes with units"),
            "marker": self.tr("Orientation marker"),
            "bar": self.tr("Colour bar"),
            "scale": self.tr("Scale bar"),
            "letters": self.tr("Letters at slices"),
            "cross_hair": self.tr("Cross-hair of slices"),
            "measurements": self.tr("Measurements"),
            "legend": self.tr("Legend"),
        }
        switch = QCheckBox(words[name], self)
        switch.setChecked(name in contents.names)
        switch.setToolTip(self.tr("Whether it belongs into the picture; at first as in the window"))
        return switch

    def _screen_sizes(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.setSpacing(4)
        for factor in FACTORS:
            button = QPushButton(f"{factor}×", self)
            button.setToolTip(self.tr("Size of the view times %1").replace("%1", str(factor)))
            button.setAutoDefault(False)
            button.clicked.connect(lambda _checked=False, f=factor: self._multiply(f))
            row.addWidget(button)
        row.addStretch(1)
        return row

    def _paper_sizes(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.setSpacing(4)
        for width, words in (
            (ONE_COLUMN, self.tr("1 column")),
            (COLUMN_AND_HALF, self.tr("1½ columns")),
            (TWO_COLUMNS, self.tr("2 columns")),
        ):
            button = QPushButton(words, self)
            tip = self.tr("%1 mm wide at %2 dpi")
            button.setToolTip(tip.replace("%1", f"{width:.0f}").replace("%2", f"{PAPER_DPI:.0f}"))
            button.setAutoDefault(False)
            button.clicked.connect(lambda _checked=False, w=width: self._print_at(w))
            row.addWidget(button)
        row.addStretch(1)
        return row

    def _length(self) -> QSpinBox:
        field = QSpinBox(self)
        field.setRange(1, LARGEST)
        field.setSuffix(" px")
        field.setToolTip(self.tr("In pixels, at most %1").replace("%1", str(LARGEST)))
        return field

    # ------------------------------------------------------------------ sizes

    def _set_size(self, width: int, height: int) -> None:
        for field, length in ((self.pixel_width, width), (self.pixel_height, height)):
            with QSignalBlocker(field):
                field.setValue(min(max(length, 1), LARGEST))

    def _multiply(self, factor: int) -> None:
        self._dpi = SCREEN_DPI
        self._set_size(self._shown[0] * factor, self._shown[1] * factor)
        self._show_printed()

    def _print_at(self, millimetres: float) -> None:
        self._dpi = PAPER_DPI
        width = round(millimetres / MM_PER_INCH * PAPER_DPI)
        self._set_size(width, round(width * self._shown[1] / self._shown[0]))
        self._show_printed()

    def _show_printed(self) -> None:
        """Say how large the picture is on paper."""
        width, height = (f"{n / self._dpi * MM_PER_INCH:.0f}" for n in self.image_size)
        words = self.tr("%1 × %2 mm at %3 dpi").replace("%1", width).replace("%2", height)
        self.printed.setText(words.replace("%3", f"{self._dpi:.0f}"))

    def _on_view(self) -> None:
        self._shown = self._size_of(self.view.currentData())
        self._on_width(self.pixel_width.value())

    def _on_width(self, width: int) -> None:
        if self.keep.isChecked():
            self._set_size(width, round(width * self._shown[1] / self._shown[0]))
        self._show_printed()

    def _on_height(self, height: int) -> None:
        if self.keep.isChecked():
            self._set_size(round(height * self._shown[0] / self._shown[1]), height)
        self._show_printed()
