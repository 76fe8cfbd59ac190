"""Asking for an address on the network."""

from __future__ import annotations

from PySide6.QtWidgets import QApplication, QDialog, QDialogButtonBox, QLabel, QLineEdit, QWidget

from volviz.volume_data.references import is_address
from volviz_ui.widgets.dialog_layout import lay_out
from volviz_ui.widgets.small import quiet_label


class OpenAddressDialog(QDialog):
    """A field for a URL, with what the clipboard holds when that is one."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Open from URL"))
        self.field = QLineEdit(self)
        self.field.setPlaceholderText("https://…")
        self.field.setClearButtonEnabled(True)
        self.field.setAccessibleName(self.tr("Address"))
        self.field.setToolTip(self.tr("Address of a file, or of a folder that is a Zarr store"))
        label = QLabel(self.tr("&Address of a file or of a Zarr store"), self)
        label.setBuddy(self.field)
        words = quiet_label(
            self.tr(
                "Zarr stores are read where they are, as far as they are needed. Other files are downloaded, up to "
                "8 GB, and kept for the next time."
            )
        )
        words.setWordWrap(True)
        self.buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Open | QDialogButtonBox.StandardButton.Cancel, self
        )
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        lay_out(self, label, self.field, words, self.buttons)
        self.setMinimumWidth(520)
        self.field.textChanged.connect(self._show_check)
        copied = QApplication.clipboard().text().strip()
        self.field.setText(copied if is_address(copied) and len(copied.split()) == 1 else "")
        self.field.selectAll()
        self._show_check()

    @property
    def address(self) -> str:
        """What was entered."""
        return self.field.text().strip()

    def _show_check(self) -> None:
        self.buttons.button(QDialogButtonBox.StandardButton.Open).setEnabled(is_address(self.address))
