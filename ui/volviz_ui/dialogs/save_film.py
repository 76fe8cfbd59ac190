"""Saving the film of a movie: format, size, background and file."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QFormLayout,
    QLabel,
    QMessageBox,
    QWidget,
)

from volviz.errors import VolvizError
from volviz.movies.encoding import FORMATS, Format, check_encoder, format_of
from volviz_ui.dialogs.error import show_error
from volviz_ui.editors.simple import NoWheelComboBox
from volviz_ui.widgets.dialog_layout import lay_out
from volviz_ui.widgets.small import quiet_label

#: Sizes that films usually have.
SIZES = ((1280, 720), (1920, 1080), (3840, 2160), (1080, 1080))
NAME = "movie"


class SaveFilmDialog(QDialog):
    """Asks for format, size, background and file.

    Parameters
    ----------
    view_size : tuple of 2 ints
        Width and height of the view in pixels.
    words : str
        How long the film is.
    folder : str
        Where the choice of a file begins.

    Attributes
    ----------
    path : str
        What was chosen; empty until then.
    resume : bool
        Whether to go on with frames that are there.
    overwrite : bool
        Whether what is there may be replaced; numbered pictures never without a question.
    """

    def __init__(
        self, view_size: tuple[int, int], words: str, folder: str, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.path, self.resume, self.overwrite = "", False, False
        self._folder = folder
        self.setWindowTitle(self.tr("Save film"))
        self.format = NoWheelComboBox(self)
        self.format.setToolTip(self.tr("Which kind of file"))
        for kind in FORMATS.values():
            self.format.addItem(f"{kind.label} ({kind.suffix})", kind)
        self.format.addItem(self.tr("Numbered pictures (.png)"), None)
        self.size = NoWheelComboBox(self)
        self.size.setToolTip(self.tr("Width and height in pixels"))
        even = (view_size[0] - view_size[0] % 2, view_size[1] - view_size[1] % 2)
        for width, height in dict.fromkeys((SIZES[1], SIZES[0], even, *SIZES[2:])):
            tail = self.tr(" (as shown)") if (width, height) == even else ""
            self.size.addItem(f"{width} × {height}{tail}", (width, height))
        self.transparent = QCheckBox(self.tr("Transparent background"), self)
        self.session = QCheckBox(self.tr("Say in the file how it was made"), self)
        self.session.setChecked(True)
        self.session.setToolTip(
            self.tr(
                "The session is part of the file, with the paths of its volumes; nothing out of their headers is"
            )
        )
        form = QFormLayout()
        form.setHorizontalSpacing(16)
        form.setVerticalSpacing(8)
        form.addRow(self.tr("Format"), self.format)
        form.addRow(self.tr("Size"), self.size)
        form.addRow("", self.transparent)
        form.addRow("", self.session)
        hint: QLabel = quiet_label(
            words + "\n" + self.tr(
                "It is drawn at full quality by a program of its own; the window stays free. What is stopped can be "
                "gone on with. Background and what stands around the volume are those of the view."
            )
        )  # fmt: skip
        hint.setWordWrap(True)
        buttons = QDialogButtonBox(self)
        save = buttons.addButton(self.tr("Save as…"), QDialogButtonBox.ButtonRole.AcceptRole)
        save.setToolTip(self.tr("Choose a file"))
        buttons.addButton(QDialogButtonBox.StandardButton.Cancel)
        buttons.accepted.connect(self.ask_where)
        buttons.rejected.connect(self.reject)
        lay_out(self, form, hint, buttons)
        self.setMinimumWidth(420)
        self.format.currentIndexChanged.connect(self._show_format)
        self._show_format()

    @property
    def pixels(self) -> tuple[int, int]:
        """Width and height of the film."""
        width, height = self.size.currentData()
        return width, height

    @property
    def is_transparent(self) -> bool:
        """Whether the background is left out."""
        return self.transparent.isEnabled() and self.transparent.isChecked()

    def ask_where(self) -> None:
        """Ask for the file, and whether to go on with frames that are there."""
        kind: Format | None = self.format.currentData()
        suffix = ".png" if kind is None else kind.suffix
        name = f"{NAME}%04d.png" if kind is None else NAME + suffix
        path, _filter = QFileDialog.getSaveFileName(
            self, self.windowTitle(), str(Path(self._folder) / name), f"*{suffix}"
        )
        if path:
            self.take(path)

    def take(self, path: str) -> None:
        """Save there; tells why not when that cannot be."""
        kind: Format | None = self.format.currentData()
        suffix = ".png" if kind is None else kind.suffix
        if kind is None and "%" not in path:
            path = str(Path(path).with_suffix("")) + "%04d.png"
        elif not path.lower().endswith(suffix):
            path += suffix
        try:
            format_of(Path(path))
            if kind is not None:
                check_encoder(kind, self.pixels, transparent=self.is_transparent)
        except VolvizError as error:
            show_error(self, self.tr("The film cannot be saved like this"), error)
            return
        # the dialog for files has asked about a film, not about numbered pictures
        self.overwrite = kind is not None
        frames = Path(path + ".frames")
        if kind is None:
            are_left = Path(path).with_name(Path(path).name % 0).exists()
        else:
            are_left = frames.is_dir() and any(frames.glob("*.png"))
        if are_left:
            question = self.tr("Frames of an unfinished film with this name are there. Go on with them?")
            buttons = QMessageBox.StandardButton
            answer = QMessageBox.question(
                self, self.windowTitle(), question, buttons.Yes | buttons.No | buttons.Cancel, buttons.Yes
            )
            if answer == buttons.Cancel:
                return
            self.resume = answer == buttons.Yes
            self.overwrite = True
        self.path = path
        self.accept()

    def _show_format(self) -> None:
        kind: Format | None = self.format.currentData()
        self.transparent.setEnabled(kind is None or kind.is_transparent)
        self.transparent.setToolTip(
            self.tr("Only the volume, for films that are laid over something else")
            if self.transparent.isEnabled()
            else self.tr("This format knows no transparency")
        )
