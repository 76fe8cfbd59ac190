"""Keys and mouse of the editor on one page."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QGridLayout, QLabel, QWidget

from volviz_ui.transfer_editor.keys import shortcuts
from volviz_ui.widgets.dialog_layout import lay_out


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
        lay_out(self, table, buttons, spacing=16)
