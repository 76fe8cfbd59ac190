"""Keys and mouse of the editor on one page."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QGridLayout, QLabel, QVBoxLayout, QWidget

from volviz_ui.transfer_editor.keys import shortcuts


class HelpDialog(QDialog):
    """What can be done in the plot, and how."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Keys and mouse of the transfer function"))
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        table = QGridLayout()
        table.setHorizontalSpacing(32)
        table.setVerticalSpacing(6)
        for row, (what, how) in enumerate(shortcuts(self)):
            table.addWidget(QLabel(what, self), row, 0)
            keys = QLabel(how, self)
            keys.setProperty("quiet", True)
            table.addWidget(keys, row, 1)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close, self)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(24, 20, 24, 16)
        layout.setSpacing(16)
        layout.addLayout(table)
        layout.addWidget(buttons)
